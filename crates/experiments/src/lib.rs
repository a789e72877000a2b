//! Experiments: a sequence of setpoints, its run over virtual time, and the figures that follow from it.
//!
//! There is no port, clock or page here: time is an argument, and what a run needs goes in and comes out
//! as values. What each figure means is in `docs/experiments.md`.
//!
//! | module | what it is |
//! |---|---|
//! | [`sequence`] | steps and limits as types; JSON, CSV and templates |
//! | [`plan`] | a sequence that has been checked, ready to run or to draw |
//! | [`runner`] | armed, running, paused, ended: what to send at each tick, and what ends a run |
//! | [`analysis`] | figures of samples: step response, frequency response, friction, inertia, heating |
//! | [`generate`] | a sequence as a program: Python, Arduino, Rust, and a setup for ROS 2 |
//!
//! # Example
//!
//! ```
//! use motorlink_experiments::{plan::{Fleet, Plan}, sequence::Sequence};
//! use motorlink_protocol::MotorId;
//!
//! let fleet = Fleet::of([MotorId::FIRST]);
//! let text = r#"{ "motorlink_sequence": 1, "steps": [{ "rpm": 400, "for_s": 1 }] }"#;
//! let sequence = Sequence::from_json(text)?;
//! let refused = Plan::new(&sequence, &fleet).unwrap_err();
//! assert_eq!(refused.to_string(), "steps[0].rpm: 400 is above 330");
//! # Ok::<(), motorlink_experiments::sequence::SequenceError>(())
//! ```

pub mod analysis;
pub mod generate;
mod number;
pub mod plan;
pub mod runner;
pub mod sequence;

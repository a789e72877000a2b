//! Experiments: a sequence of setpoints, its run over virtual time, and the figures computed from it.
//!
//! This crate uses no port, clock or page: time is an argument, and all inputs and outputs are values.
//! `docs/experiments.md` explains each figure.
//!
//! | module | what it is |
//! |---|---|
//! | [`sequence`] | steps and limits as types; JSON, CSV and templates |
//! | [`plan`] | a checked sequence, ready to run or to draw |
//! | [`runner`] | a run: what to send at each tick, and what ends it |
//! | [`analysis`] | figures from samples: step response, frequency response, friction, inertia, heating |
//! | [`study`] | what is asked of a motor: its sequence, and the figures of a run of it |
//! | [`chart`] | charts of findings, as data and as SVG |
//! | [`kept`] | a run that is kept, and its exports |
//! | [`vehicle`] | a vehicle on hub motors: its measures, its wheels, its motion from their speeds |
//! | [`odometry`] | the motion of a vehicle from the replies of its wheels |
//! | [`number`] | functions of numbers |
//! | [`generate`] | a sequence as a program: Python, Arduino; a vehicle as a robot for ROS 2 |
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
pub mod chart;
pub mod generate;
pub mod kept;
pub mod number;
pub mod odometry;
pub mod plan;
pub mod runner;
pub mod sequence;
pub mod study;
pub mod vehicle;

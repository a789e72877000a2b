//! The test bench: a headless, unmodified Chromium. Its real Web Serial stack sees pseudo-terminals as USB adapters,
//! with virtual motors at their far ends. Each wire is logged.
//!
//! A test starts a [`Bench`], plugs adapters into it ([`Bench::plug`]) and opens the page ([`Bench::open`]). It uses
//! the page like a user of a screen reader, by roles and names ([`Page::click`], [`Page::wait_for_text`]), and checks
//! the frames on the wire ([`Adapter::wire`]). Every call has a timeout, and everything ends when dropped.
//!
//! It needs Linux, Chromium, and three artefacts, which `cargo xtask test` builds and names in
//! environment variables: see [`artefacts`].
//!
//! ```no_run
//! use end_to_end::{Bench, Line, Usb};
//!
//! let bench = Bench::start()?;
//! let adapter = bench.plug(Line::default(), Usb::default())?;
//! let page = bench.open("/")?;
//! page.click("button", "Connect motor")?;
//! page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
//! assert!(!adapter.wire()?.from_host().is_empty());
//! bench.close(page)?;
//! # anyhow::Ok(())
//! ```

mod adapter;
pub mod artefacts;
mod bench;
mod cdp;
mod chromium;
mod clock;
mod console;
mod control;
mod discard;
mod document;
mod downloads;
mod equipment;
pub mod figures;
mod first_press;
mod installing;
mod keyboard;
mod line;
mod lookup;
mod main_thread;
mod memory;
mod motors;
mod mouse;
mod moving_picture;
mod page;
mod places;
mod processor_time;
mod reading;
mod retry;
mod stopwatch;
mod tab;
mod view;
mod wait;
mod wire_log;
mod worker;

pub use adapter::{Adapter, Held, Usb};
pub use bench::Bench;
pub use clock::now_us;
pub use control::Control;
pub use downloads::Download;
pub use first_press::{FirstPress, Slowness};
pub use line::Line;
pub use main_thread::Work;
pub use memory::Memory;
pub use motors::Motors;
pub use page::Page;
pub use processor_time::threads_time;
pub use retry::retry;
pub use stopwatch::KeyPress;
pub use view::{Scheme, View};
pub use wait::{WAIT_MAX, wait_until};
pub use wire_log::{Frame, Gaps, Side, WireLog};

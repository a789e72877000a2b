//! The links to the workers, and the browser's serial ports.

pub(crate) mod address;
pub(crate) mod clock;
pub(crate) mod files;
pub(crate) mod recorder_link;
pub(crate) mod serial_ports;
pub(crate) mod sessions_link;
pub(crate) mod started_worker;
pub(crate) mod worker_link;

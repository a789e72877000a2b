//! The motors that were left driven on adapters that are not open now.

use js_sys::Object;
use motorlink_messages::{LeftBehind, UsbId};
use web_sys::SerialPort;

/// What was left driven, by make of adapter: two of one make cannot be told apart.
#[derive(Debug, Default)]
pub(crate) struct Left {
    of_makes: Vec<(Option<UsbId>, LeftBehind)>,
    /// Ports that were there while the lost one was open: it is none of them.
    pub(crate) foreign: Vec<SerialPort>,
}

impl Left {
    /// What was left driven on adapters of this make.
    pub(crate) fn of(&mut self, usb: Option<UsbId>) -> &mut LeftBehind {
        let known = self.of_makes.iter().position(|(make, _)| *make == usb);
        let place = known.unwrap_or_else(|| {
            self.of_makes.push((usb, LeftBehind::default()));
            self.of_makes.len() - 1
        });
        #[expect(clippy::indexing_slicing, reason = "it is there")]
        &mut self.of_makes[place].1
    }

    /// Whether this port is not the lost one.
    pub(crate) fn is_foreign(&self, port: &SerialPort) -> bool {
        self.foreign.iter().any(|other| Object::is(other, port))
    }

    /// How many of these may be the lost one.
    pub(crate) fn strangers_among(&self, ports: &[SerialPort]) -> usize {
        ports.iter().filter(|port| !self.is_foreign(port)).count()
    }
}

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
    /// Adapters that were lost while they were tried. They may have the motors.
    pub(crate) lost_on_trial: usize,
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

    /// How many ports besides the open one may have the motors: those of these that may be the lost one, and those that
    /// are gone.
    pub(crate) fn others(&self, ports: &[SerialPort]) -> usize {
        let there = ports.iter().filter(|port| !self.is_foreign(port));
        there.count() + self.lost_on_trial
    }
}

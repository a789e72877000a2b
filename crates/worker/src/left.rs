//! The motors that were left driven on adapters that are not open now.

use js_sys::Object;
use motorlink_bus::LeftDriven;
use motorlink_messages::{LeftBehind, UsbId};
use motorlink_protocol::family::Model;
use web_sys::SerialPort;

/// What was left driven, by make of adapter: two of one make cannot be told apart.
#[derive(Debug, Default)]
pub(crate) struct Left {
    of_makes: Vec<(Option<UsbId>, LeftBehind)>,
    /// Ports that were there while the lost one was open: it is none of them.
    pub(crate) foreign: Vec<SerialPort>,
}

impl Left {
    /// Adds what was left driven on an adapter.
    pub(crate) fn add(&mut self, usb: Option<UsbId>, left: LeftBehind) {
        if left.motors.is_empty() {
            return;
        }
        match self.of_makes.iter_mut().find(|(make, _)| *make == usb) {
            Some((_, all)) => all.add(left.motors),
            None => self.of_makes.push((usb, left)),
        }
    }

    /// The model of the motors on adapters of this make.
    pub(crate) fn model(&self, usb: Option<UsbId>) -> Option<Model> {
        let of_make = self.of_makes.iter().find(|(make, _)| *make == usb);
        of_make.map(|(_, left)| left.model)
    }

    /// The motors on adapters of this make.
    pub(crate) fn of(&self, usb: Option<UsbId>) -> impl Iterator<Item = LeftDriven> + Clone {
        let of_make = self.of_makes.iter().filter(move |(make, _)| *make == usb);
        of_make.flat_map(|(_, left)| left.motors.iter().copied())
    }

    /// The same; from now on the bus on the open port has them.
    pub(crate) fn take(&mut self, usb: Option<UsbId>) -> Vec<LeftDriven> {
        let taken = self.of_makes.extract_if(.., |(make, _)| *make == usb);
        taken.flat_map(|(_, left)| left.motors).collect()
    }

    /// Whether this port is not the lost one.
    pub(crate) fn is_foreign(&self, port: &SerialPort) -> bool {
        self.foreign.iter().any(|other| Object::is(other, port))
    }

    /// Whether none of these is the lost one.
    pub(crate) fn are_foreign(&self, ports: &[SerialPort]) -> bool {
        ports.iter().all(|port| self.is_foreign(port))
    }
}

//! The serial ports that the browser has permitted, and its picker for others.

use motorlink_messages::{PortRef, UsbId};

#[cfg(target_arch = "wasm32")]
mod browser;
/// Web Serial is bound for the browser's target only.
#[cfg(not(target_arch = "wasm32"))]
#[path = "serial_ports/no_browser.rs"]
mod browser;

/// What can go wrong before the worker is asked to open a port.
#[cfg_attr(
    not(target_arch = "wasm32"),
    allow(dead_code, reason = "found out where there is a browser")
)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PickTrouble {
    /// The browser has no Web Serial.
    NoWebSerial,
    /// The picker was closed without a choice; if `filtered`, it showed only usual adapters.
    Dismissed { filtered: bool },
    /// The browser forbids serial ports to this page.
    Forbidden,
    /// The page is within another one, which does not let it have serial ports.
    Framed,
    /// The picked port is not among the permitted ones: it was unplugged meanwhile.
    Vanished,
    /// Anything else.
    Unknown,
}

pub(crate) use browser::{is_supported, permitted, pick};

#[cfg_attr(
    not(target_arch = "wasm32"),
    allow(dead_code, reason = "used where there is a browser")
)]
/// The adapter used last before all others, else in the order of the browser.
fn best_first(ports: &[Option<UsbId>], last: Option<UsbId>) -> Vec<PortRef> {
    let ports = ports
        .iter()
        .zip(0_u16..)
        .map(|(usb, place)| PortRef { place, usb: *usb });
    let (mut best, others): (Vec<_>, Vec<_>) =
        ports.partition(|port| last.is_some() && port.usb == last);
    best.extend(others);
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    const CH340: UsbId = UsbId {
        vendor: 0x1A86,
        product: 0x7523,
    };
    const FTDI: UsbId = UsbId {
        vendor: 0x0403,
        product: 0x6001,
    };

    fn places(ports: &[Option<UsbId>], last: Option<UsbId>) -> Vec<u16> {
        let sorted = best_first(ports, last).into_iter();
        sorted.map(|port| port.place).collect()
    }

    #[test]
    fn the_adapter_used_last_comes_first_and_its_twins_with_it() {
        let ports = [None, Some(FTDI), Some(CH340), Some(CH340)];
        assert_eq!(places(&ports, Some(CH340)), [2, 3, 0, 1]);
        assert_eq!(places(&ports, Some(FTDI)), [1, 0, 2, 3]);
        assert_eq!(places(&ports, None), [0, 1, 2, 3]);
        assert_eq!(places(&[], Some(FTDI)), [0_u16; 0]);
    }
}

//! What is at the near end of the line.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::VirtualLine;

/// What the bus speaks through.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Adapter {
    /// The built-in virtual line, with these motors.
    Virtual(VirtualLine),
    /// A serial port; `None` where the browser names no USB device behind it.
    Serial(Option<UsbId>),
    /// A recorded session that is replayed: no port is open, and no command is sent.
    Recording,
    /// The motors of a server, over a network. This page may drive them.
    Remote,
    /// The same, and this page only watches.
    Watched,
}

impl Adapter {
    /// The virtual line with one DDSM115.
    pub const VIRTUAL: Self = Self::Virtual(VirtualLine::DEFAULT);

    /// The virtual line, if it is one.
    #[must_use]
    pub const fn virtual_line(self) -> Option<VirtualLine> {
        match self {
            Self::Virtual(line) => Some(line),
            Self::Serial(_) | Self::Recording | Self::Remote | Self::Watched => None,
        }
    }
}

/// The USB vendor and product of an adapter. There is no serial number in Web Serial, so two
/// adapters of one make are alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct UsbId {
    /// Vendor, such as 1A86.
    pub vendor: u16,
    /// Product, such as 7523.
    pub product: u16,
}

/// Adapters that people have on the bench: vendor, product (any with `None`), name of the chip.
const KNOWN: [(u16, Option<u16>, &str); 8] = [
    (0x1A86, Some(0x7523), "CH340"),
    (0x1A86, Some(0x55D3), "CH343"),
    (0x1A86, Some(0x55D2), "CH9102"),
    (0x1A86, None, "CH34x"),
    (0x0403, Some(0x6001), "FTDI FT232R"),
    (0x0403, Some(0x6015), "FTDI FT-X"),
    (0x0403, None, "FTDI"),
    (0x10C4, None, "CP210x"),
];

impl UsbId {
    /// Vendors whose chips stand in usual USB-RS485 adapters: WCH, FTDI, Silicon Labs. The picker
    /// shows these first.
    pub const USUAL_VENDORS: [u16; 3] = [0x1A86, 0x0403, 0x10C4];

    /// The chip by its usual name.
    #[must_use]
    pub fn chip(self) -> Option<&'static str> {
        let fits = |(vendor, product, _): &&(u16, Option<u16>, &str)| {
            *vendor == self.vendor && product.is_none_or(|product| product == self.product)
        };
        KNOWN.iter().find(fits).map(|(_, _, name)| *name)
    }
}

/// `1a86:7523`, as system tools write it.
impl fmt::Display for UsbId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:04x}:{:04x}", self.vendor, self.product)
    }
}

/// `CH340 · 1a86:7523`
impl fmt::Display for Adapter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Virtual(_) => f.write_str("Virtual motor"),
            Self::Recording => f.write_str("Recording"),
            Self::Remote | Self::Watched => f.write_str("Remote"),
            Self::Serial(None) => f.write_str("Serial port"),
            Self::Serial(Some(usb)) => match usb.chip() {
                Some(chip) => write!(f, "{chip} · {usb}"),
                None => write!(f, "USB serial · {usb}"),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_adapter_is_named_by_its_chip() {
        let named = |vendor, product| Adapter::Serial(Some(UsbId { vendor, product })).to_string();
        assert_eq!(named(0x1A86, 0x55D3), "CH343 · 1a86:55d3");
        assert_eq!(named(0x1A86, 0x1234), "CH34x · 1a86:1234");
        assert_eq!(named(0x10C4, 0xEA60), "CP210x · 10c4:ea60");
        assert_eq!(named(0xDEAD, 0xBEEF), "USB serial · dead:beef");
    }
}

//! The serial ports of this computer.

use std::{fmt, fs};

use serialport::{SerialPortType, UsbPortInfo, available_ports};

use crate::{
    holder::{Holder, holder_of},
    open_failure::OpenFailure,
    virtual_line::VirtualLine,
};

/// Where the motors are.
#[derive(Clone, Debug)]
pub enum Place {
    /// The only USB adapter.
    OnlyAdapter,
    /// The port with this name, such as `/dev/ttyUSB0` or `COM3`.
    Port(String),
    /// Virtual motors.
    Virtual(VirtualLine),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OnlyAdapter => f.write_str("the only adapter"),
            Self::Port(path) => f.write_str(path),
            Self::Virtual(_) => f.write_str("virtual motors"),
        }
    }
}

/// A serial port that is there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoundPort {
    /// Its name.
    pub path: String,
    /// Its USB adapter.
    pub usb: Option<UsbAdapter>,
    /// The program that has it open, if the system tells.
    pub holder: Option<Holder>,
}

/// A USB adapter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UsbAdapter {
    /// Vendor ID.
    pub vendor_id: u16,
    /// Product ID.
    pub product_id: u16,
    /// Serial number, if it has one.
    pub serial: Option<String>,
    /// What it calls itself.
    pub product: Option<String>,
}

impl From<UsbPortInfo> for UsbAdapter {
    fn from(usb: UsbPortInfo) -> Self {
        Self {
            vendor_id: usb.vid,
            product_id: usb.pid,
            serial: usb.serial_number,
            product: usb.product,
        }
    }
}

/// The serial ports, USB adapters first, and which programs hold them.
///
/// # Errors
/// The system does not list them.
pub fn found_ports() -> Result<Vec<FoundPort>, OpenFailure> {
    let mut ports = listed_ports()?;
    for port in &mut ports {
        port.holder = holder_of(&port.path);
    }
    Ok(ports)
}

/// The serial port with this name.
///
/// # Errors
/// There is none.
pub fn found_port(path: &str) -> Result<FoundPort, OpenFailure> {
    let ChosenPort { path, usb } = ChosenPort::find(Some(path))?.that_exists()?;
    let holder = holder_of(&path);
    Ok(FoundPort { path, usb, holder })
}

/// The same as [`found_ports`] without the programs, which takes a fraction of the time.
fn listed_ports() -> Result<Vec<FoundPort>, OpenFailure> {
    let ports = available_ports().map_err(|error| OpenFailure::of("serial ports", &error))?;
    let listed = ports.into_iter().map(|port| FoundPort {
        path: port.port_name,
        usb: match port.port_type {
            SerialPortType::UsbPort(usb) => Some(usb.into()),
            _ => None,
        },
        holder: None,
    });
    let mut listed: Vec<_> = listed.collect();
    listed.sort_by(|a, b| (a.usb.is_none(), &a.path).cmp(&(b.usb.is_none(), &b.path)));
    Ok(listed)
}

/// A port that was chosen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChosenPort {
    /// Its name.
    pub path: String,
    /// Its adapter. After a replug, the same adapter may have a port of another name.
    pub usb: Option<UsbAdapter>,
}

impl ChosenPort {
    /// The port with this name, or the only USB adapter.
    pub(crate) fn find(path: Option<&str>) -> Result<Self, OpenFailure> {
        let found = listed_ports();
        if let Some(path) = path {
            // A link such as /dev/serial/by-id/.. is listed by its target.
            let target = fs::canonicalize(path).ok();
            let target = target.as_ref().and_then(|target| target.to_str());
            let listed = found.unwrap_or_default().into_iter();
            let mut listed =
                listed.filter(|port| Some(port.path.as_str()) == target.or(Some(path)));
            return Ok(Self {
                path: path.to_owned(),
                usb: listed.next().and_then(|port| port.usb),
            });
        }
        let mut adapters: Vec<_> = found?
            .into_iter()
            .filter(|port| port.usb.is_some())
            .collect();
        match (adapters.pop(), adapters.is_empty()) {
            (None, _) => Err(OpenFailure::NoPort),
            (Some(FoundPort { path, usb, .. }), true) => Ok(Self { path, usb }),
            (Some(last), false) => {
                let paths = adapters.into_iter().chain([last]).map(|port| port.path);
                Err(OpenFailure::SeveralPorts(paths.collect()))
            }
        }
    }

    /// This port, if it is there.
    pub(crate) fn that_exists(self) -> Result<Self, OpenFailure> {
        // A name of Windows is no path.
        if cfg!(unix) && !fs::exists(&self.path).is_ok_and(|is_there| is_there) {
            return Err(OpenFailure::NotFound(self.path));
        }
        Ok(self)
    }

    /// Identifies this adapter: by its serial number, or else by its port. Another adapter without a serial number at the
    /// same port counts as the same.
    pub(crate) fn identity(&self) -> String {
        let port = fs::canonicalize(&self.path).ok();
        // A pseudo-terminal that is made again has another name, and its link has the same.
        let port = port.filter(|port| !port.starts_with("/dev/pts"));
        let port = port.and_then(|port| port.to_str().map(str::to_owned));
        let absolute = || {
            let path = std::path::absolute(&self.path).ok();
            path.and_then(|path| path.to_str().map(str::to_owned))
        };
        let port = port.or_else(absolute).unwrap_or_else(|| self.path.clone());
        match &self.usb {
            Some(usb) => format!(
                "usb {:04x} {:04x} {}",
                usb.vendor_id,
                usb.product_id,
                usb.serial.as_deref().unwrap_or(&port)
            ),
            None => port,
        }
    }

    /// The name of the port of the same adapter now, after it was lost; `None` while it is not there.
    pub(crate) fn again(&self) -> Option<String> {
        let Some(usb) = &self.usb else {
            return fs::exists(&self.path).ok()?.then(|| self.path.clone());
        };
        let found = listed_ports().ok()?;
        let same = |port: &&FoundPort| port.usb.as_ref() == Some(usb);
        let of_path = found
            .iter()
            .find(|port| same(port) && port.path == self.path);
        let any = || {
            // Without a serial number, another adapter of this make is not the lost one.
            let mut same = found.iter().filter(same).filter(|_| usb.serial.is_some());
            same.next()
        };
        of_path.or_else(any).map(|port| port.path.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chosen(serial: Option<&str>) -> ChosenPort {
        ChosenPort {
            path: "/dev/ttyUSB3".to_owned(),
            usb: Some(UsbAdapter {
                vendor_id: 0x0403,
                product_id: 0x6001,
                serial: serial.map(str::to_owned),
                product: None,
            }),
        }
    }

    #[test]
    fn an_adapter_is_remembered_by_its_serial_number_or_else_by_its_place() {
        assert_eq!(
            chosen(Some("A50285BI")).identity(),
            "usb 0403 6001 A50285BI"
        );
        assert_eq!(chosen(None).identity(), "usb 0403 6001 /dev/ttyUSB3");
        // One that is named from another folder.
        let named = |path: &str| ChosenPort {
            path: path.to_owned(),
            usb: None,
        };
        let here = std::env::current_dir().unwrap();
        let absolute = here.join("motors");
        let absolute = absolute.to_str().unwrap();
        assert_eq!(named("motors").identity(), named(absolute).identity());
    }
}

//! A USB-RS485 adapter that can be plugged and unplugged, with virtual motors on its bus.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use rustix::termios::{ioctl_tiocexcl, ioctl_tiocnxcl};

use crate::line::Line;
use crate::motors::Motors;
use crate::wire_log::WireLog;

/// The USB descriptors of the adapter.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Usb {
    /// Vendor ID.
    pub vendor: u16,
    /// Product ID.
    pub product: u16,
    /// Product name, shown in the browser's picker.
    pub name: String,
    /// Whether the page may use it without asking.
    pub permitted: bool,
}

impl Usb {
    /// A CH340, the usual chip of such adapters.
    pub const CH340: (u16, u16) = (0x1a86, 0x7523);
    /// An FTDI FT232R.
    pub const FTDI: (u16, u16) = (0x0403, 0x6001);
    /// The chips whose permitted adapters the page may use without asking.
    pub const PERMITTED: [(u16, u16); 2] = [Self::CH340, Self::FTDI];

    /// The serial number of a permitted adapter. Chromium remembers a permission by vendor, product and serial
    /// number, and only for adapters that have one. Pages never see it, and identical adapters can share it.
    pub(crate) const SERIAL_PERMITTED: &str = "permitted";

    /// A permitted adapter with this chip.
    #[must_use]
    pub fn of((vendor, product): (u16, u16)) -> Self {
        Self {
            vendor,
            product,
            name: "USB Serial".to_owned(),
            permitted: true,
        }
    }

    /// The same adapter without the permission: the page can use it only after the user picks it.
    #[must_use]
    pub fn unpermitted(self) -> Self {
        Self {
            permitted: false,
            ..self
        }
    }

    /// The udev properties of this adapter, one per line.
    fn properties(&self, node: &Path) -> String {
        let Self {
            vendor,
            product,
            name,
            permitted,
        } = self;
        // udev writes a space in the name as \x20.
        let name = name.replace(' ', r"\x20");
        let serial = if *permitted {
            Self::SERIAL_PERMITTED
        } else {
            "unknown"
        };
        format!(
            "DEVNAME={}\nID_VENDOR_ID={vendor:04x}\nID_MODEL_ID={product:04x}\n\
             ID_MODEL_ENC={name}\nID_SERIAL_SHORT={serial}\n",
            node.display()
        )
    }
}

impl Default for Usb {
    fn default() -> Self {
        Self::of(Self::CH340)
    }
}

/// A port that another program has opened exclusively, until dropped.
pub struct Held(File);

impl Drop for Held {
    fn drop(&mut self) {
        // Closing it is not enough: the program at the other end keeps the terminal open.
        let _ = ioctl_tiocnxcl(&self.0);
    }
}

/// An adapter of a bench.
pub struct Adapter {
    line: Line,
    usb: Usb,
    name: String,
    /// Directory of its node, its logs and the program's errors.
    dir: PathBuf,
    /// Directory in which the browser looks for adapters.
    udev_dir: PathBuf,
    motors: Option<Motors>,
    /// Whether the browser sees it.
    plugged: bool,
    /// A log for each time that the motors got power, oldest first.
    logs: Vec<PathBuf>,
}

impl Adapter {
    /// An adapter that is not yet plugged.
    pub(crate) fn new(name: String, dir: PathBuf, udev_dir: PathBuf, line: Line, usb: Usb) -> Self {
        Self {
            line,
            usb,
            name,
            dir,
            udev_dir,
            motors: None,
            plugged: false,
            logs: Vec::new(),
        }
    }

    /// Plugs it: the motors get power if they have none, then the browser sees the adapter.
    ///
    /// # Errors
    ///
    /// When it is plugged already, or its program does not start.
    pub fn plug(&mut self) -> Result<()> {
        ensure!(!self.plugged, "{} is plugged already", self.name);
        let node = self.dir.join("node");
        if let Some(motors) = &mut self.motors {
            motors.send_command("plug")?;
        } else {
            let log = self.dir.join(format!("wire-{}.log", self.logs.len()));
            self.motors = Some(Motors::start(&self.line, &node, &log, &self.dir)?);
            self.logs.push(log);
        }
        let hidden = self.udev_dir.join(format!(".{}", self.name));
        // The node is given by its own path, as by udev. The link only serves to find it.
        fs::write(&hidden, self.usb.properties(&fs::canonicalize(&node)?))?;
        fs::rename(hidden, self.udev_dir.join(&self.name))?;
        self.plugged = true;
        Ok(())
    }

    /// Unplugs it: its node disappears, then the browser is notified, as with a real one. The motors have power and do
    /// what they were told last.
    ///
    /// # Errors
    ///
    /// When it is not plugged.
    pub fn unplug(&mut self) -> Result<()> {
        if let Some(motors) = &mut self.motors {
            motors.send_command("unplug")?;
        }
        self.plugged = false;
        fs::remove_file(self.udev_dir.join(&self.name))
            .with_context(|| format!("{} is not plugged", self.name))
    }

    /// Cuts the power of the motors, and unplugs it.
    ///
    /// # Errors
    ///
    /// When it is not plugged.
    pub fn unplug_and_cut_power(&mut self) -> Result<()> {
        self.motors = None;
        self.unplug()
    }

    /// Opens it exclusively, as another program. A browser of [`crate::Bench::start_as_user`] cannot open it then.
    ///
    /// # Errors
    ///
    /// When it does not open.
    pub fn hold(&self) -> Result<Held> {
        let file = File::options().read(true).write(true).open(self.node()?)?;
        ioctl_tiocexcl(&file)?;
        Ok(Held(file))
    }

    /// Removes its node while the browser still lists it. Opening it then fails, as for a port that another program
    /// has opened or that the user has no right to open.
    ///
    /// # Errors
    ///
    /// When it is not plugged.
    pub fn take_node(&mut self) -> Result<()> {
        ensure!(self.motors.is_some(), "{} is not plugged", self.name);
        self.motors = None;
        Ok(())
    }

    /// Changes the physics or the state of a motor: `block 1 on`, `load 1 0.5`, `temperature 1 85`, `power 1 off`,
    /// `mute 1 on`. Returns the answer.
    ///
    /// # Errors
    ///
    /// When it is not plugged, or the motors do not know the command.
    pub fn act(&mut self, command: &str) -> Result<String> {
        let motors = self.motors.as_mut();
        motors
            .with_context(|| format!("{} is not plugged", self.name))?
            .send_command(command)
    }

    /// All frames on its bus so far, over all times that it was plugged.
    ///
    /// # Errors
    ///
    /// When the log cannot be read or understood.
    pub fn wire(&self) -> Result<WireLog> {
        self.logs
            .iter()
            .try_fold(WireLog::default(), |log, path| log.followed_by(path))
    }

    /// The path of the pseudo-terminal that the browser opens.
    ///
    /// # Errors
    ///
    /// When it is not plugged.
    pub fn node(&self) -> Result<PathBuf> {
        fs::canonicalize(self.dir.join("node"))
            .with_context(|| format!("{} has no node", self.name))
    }
}

impl Drop for Adapter {
    fn drop(&mut self) {
        self.motors = None;
        let _ = fs::remove_file(self.udev_dir.join(&self.name));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn udev_learns_what_the_adapter_is() {
        let usb = Usb {
            name: "My Adapter".to_owned(),
            ..Usb::of(Usb::FTDI)
        };
        let expected = "DEVNAME=/dev/pts/3\nID_VENDOR_ID=0403\nID_MODEL_ID=6001\n\
                        ID_MODEL_ENC=My\\x20Adapter\nID_SERIAL_SHORT=permitted\n";
        assert_eq!(usb.properties(Path::new("/dev/pts/3")), expected);
        assert!(
            usb.unpermitted()
                .properties(Path::new("x"))
                .ends_with("SHORT=unknown\n")
        );
    }
}

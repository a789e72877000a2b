//! Virtual motors in a program of their own, and the log of their wire.

use std::{
    collections::BTreeMap,
    env, fs,
    io::{BufRead, BufReader},
    path::PathBuf,
    process::{Child, Command as Process, Stdio},
};

use motorlink_bus::{BusSettings, CommandRate};
use motorlink_driver::{Driver, Options, Place};
use motorlink_protocol::MotorId;
use tempfile::TempDir;

use crate::Done;

/// `motorlink virtual` at a port of its own.
pub struct Motors {
    child: Child,
    folder: TempDir,
}

impl Motors {
    pub fn start(flags: &[&str]) -> Done<Self> {
        let folder = tempfile::tempdir()?;
        let mut child = Process::new(command())
            .arg("virtual")
            .args(flags)
            .arg("--link")
            .arg(folder.path().join("port"))
            .arg("--log")
            .arg(folder.path().join("wire.log"))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let out = child.stdout.as_mut().ok_or("no output")?;
        BufReader::new(out).read_line(&mut String::new())?;
        Ok(Self { child, folder })
    }

    pub fn port(&self) -> String {
        self.folder.path().join("port").display().to_string()
    }

    pub fn driver(&self, hertz: u16, watch: &[u8]) -> Done<Driver> {
        let mut options = Options::at(Place::Port(self.port()));
        options.state_folder = Some(self.folder.path().to_owned());
        options.watch = watch
            .iter()
            .map(|id| MotorId::new(*id))
            .collect::<Result<_, _>>()?;
        options.settings = BusSettings {
            rate: CommandRate::new(hertz)?,
            ..BusSettings::default()
        };
        Ok(Driver::open(options)?)
    }

    /// The times of the drive frames to each motor, in microseconds.
    pub fn drive_frames(&self) -> Done<BTreeMap<u8, Vec<u64>>> {
        let mut frames = BTreeMap::<u8, Vec<u64>>::new();
        for line in fs::read_to_string(self.folder.path().join("wire.log"))?.lines() {
            let mut words = line.split('\t');
            if let (Some(at), Some("HOST"), Some(frame)) =
                (words.next(), words.next(), words.next())
                && let Some((id, rest)) = frame.split_once(' ')
                && rest.starts_with("64 ")
            {
                frames
                    .entry(u8::from_str_radix(id, 16)?)
                    .or_default()
                    .push(at.parse()?);
            }
        }
        Ok(frames)
    }

    pub fn command(&self, line: &str) -> Process {
        let mut process = Process::new(command());
        process
            .args(["--port", &self.port()])
            .args(line.split(' '))
            .env("XDG_STATE_HOME", self.folder.path())
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        process
    }
}

impl Drop for Motors {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn command() -> PathBuf {
    env::var_os("MOTORLINK_COMMAND").map_or_else(|| "motorlink".into(), PathBuf::from)
}

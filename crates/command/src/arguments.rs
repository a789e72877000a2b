//! The command line.

use std::{ffi::OsString, path::PathBuf, time::Duration};

use clap::{Args, Parser, Subcommand};
use motorlink_bus::{CommandRate, Ramp};
use motorlink_experiments::study::StudyKind;
use motorlink_protocol::{AssignableId, Frame, family::Model};

use crate::{
    control::arguments::Control,
    experiment::arguments::{Property, RunHow, parameters_of},
    parsers::{Assignment, assignable, assignment, frame, hertz, ramp, rate, seconds},
    replay::arguments::Replay,
    serve::arguments::Serve,
    session::arguments::SessionAction,
    signed_id::SignedId,
    wizard::arguments::Wizard,
};

/// Drives hub motors DDSM115 (M0601), DDSM315, DDSM210 and DDSM400 on a serial port, and shows what they do.
///
/// Motors are stopped, and their standstill is confirmed, whenever this program ends. If it is killed, or the computer
/// fails, the wheel may keep turning: cut its power, or run any command of motorlink, which stops it first.
#[derive(Debug, Parser)]
#[command(name = "motorlink", version, after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    pub global: Global,
    #[command(subcommand)]
    pub action: Action,
}

const EXAMPLES: &str = "\
Examples:
  motorlink scan                                 which motors are on the bus
  motorlink drive velocity 100 --secs 3          100 rpm for three seconds, then a confirmed stop
  motorlink --id 1,-2 drive velocity 60          two wheels of a rover; the second is mirrored
  motorlink --virtual=2 control                  by keys, without hardware
  motorlink set-id --new 2                       give the only motor on the bus another ID
  motorlink wizard --count 4                     give four motors the IDs 1 to 4, one after the other
  motorlink monitor --csv > telemetry.csv
  motorlink serve --listen 0.0.0.0               drive from the browser of another computer, by the printed link
  motorlink doctor --rpm 60                      what is wrong with the line, at rest and while the wheel turns
  motorlink step to_rpm=120 --out results        figures of the speed loop, and a report

Exit codes: 0 done; 1 not done, or a stop was not confirmed; 2 the command line or a file cannot be used.";

/// What every command takes.
#[derive(Debug, Args)]
pub struct Global {
    /// Serial port, such as /dev/ttyUSB0 or COM3; without it, the only USB adapter
    #[arg(long, global = true, value_name = "PORT")]
    pub port: Option<String>,
    /// Motors, 1-254 or 0x01-0xFE, with commas between; a minus mirrors one, which is mounted the other way round
    #[arg(
        long,
        global = true,
        value_delimiter = ',',
        allow_hyphen_values = true,
        value_name = "ID,ID.."
    )]
    pub id: Vec<SignedId>,
    /// Model of the motors: ddsm115, ddsm315, ddsm210 or ddsm400, or the maker's name (M0601, M0602C, M0603C, M0603A);
    /// without it, by their replies. A ddsm315 answers as a ddsm115
    #[arg(long, global = true, value_name = "MODEL")]
    pub model: Option<Model>,
    /// Use virtual motors in place of a port: so many, with IDs from 1
    #[arg(
        long = "virtual",
        global = true,
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "1",
        value_parser = clap::value_parser!(u8).range(1..=16),
        value_name = "COUNT"
    )]
    pub virtual_motors: Option<u8>,
    /// How long to wait for the first reply of a motor, in seconds
    #[arg(long, global = true, default_value = "1", value_parser = seconds, value_name = "SECS")]
    pub timeout: Duration,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Action {
    /// List the serial ports or that of --port: the adapter, what holds it, and which motors answered last
    Ports {
        /// As JSON
        #[arg(long)]
        json: bool,
    },
    /// Find the motors on the bus: every ID is asked, in about two seconds
    Scan {
        /// As JSON
        #[arg(long)]
        json: bool,
        /// Every scan is a full one; for scripts written for m0601
        #[arg(long, hide = true)]
        full: bool,
    },
    /// What each motor reports now
    Info {
        /// As JSON
        #[arg(long)]
        json: bool,
    },
    /// Show what the motors report until Ctrl-C
    Monitor(Monitor),
    /// Drive motors, then stop them and confirm their standstill
    Drive {
        #[command(subcommand)]
        drive: Drive,
    },
    /// Drive motors by keys, full screen: hold a key to run
    Control(Control),
    /// Stop motors that turn: those of --id, or all that answer
    Stop {
        /// Stop none, but forget those that an earlier program left driven and that have lost their power
        #[arg(long)]
        forget: bool,
    },
    /// Say what is likely to be wrong with the line, and what to do about it
    Doctor(Doctor),
    /// Give the only motor on the bus another ID, which it keeps without power
    SetId {
        /// The new ID
        #[arg(long, value_parser = assignable, value_name = "ID")]
        new: AssignableId,
        /// Do not ask first
        #[arg(long)]
        yes: bool,
    },
    /// Give the motors of a rover their IDs, one after the other, and find out which wheel each of them turns
    Wizard(Wizard),
    /// Serve the page on the network: it watches and drives the motors of this computer
    Serve(Serve),
    /// Show the robots in a Zenoh network, by the program motorlink-fleet: see docs/fleet.md
    #[command(disable_help_flag = true)]
    Fleet {
        /// What motorlink-fleet takes; --help shows it
        #[arg(
            trailing_var_arg = true,
            allow_hyphen_values = true,
            value_name = "ARGUMENT"
        )]
        arguments: Vec<OsString>,
    },
    /// Send ten bytes as they are, or nine with their CRC added, and show the answer
    Raw {
        /// Bytes in hex, such as "01 74 00 00 00 00 00 00 00"
        #[arg(value_parser = frame, value_name = "BYTES")]
        frame: Frame,
        /// Send what may move a wheel or change a motor without asking
        #[arg(long)]
        yes: bool,
    },
    /// Run a sequence of setpoints from a file (JSON or CSV, as the page saves it), or a study, and print its figures
    Run {
        /// The file
        file: PathBuf,
        #[command(flatten)]
        how: RunHow,
    },
    /// Measure the step response of the speed: rise, overshoot, settling, and a fitted model
    #[command(after_help = parameters_of(&[StudyKind::Step]))]
    Step {
        #[arg(help = "Parameters, such as to_rpm=120 repeats=5 accelerations=1,10", value_name = "NAME=VALUE", value_parser = assignment)]
        set: Vec<Assignment>,
        #[command(flatten)]
        how: RunHow,
    },
    /// Measure the frequency response of the speed: gain, phase, bandwidth, and a fitted model
    #[command(after_help = parameters_of(&[StudyKind::Frequency]))]
    Sweep {
        #[arg(help = "Parameters, such as highest_hz=10 points=11", value_name = "NAME=VALUE", value_parser = assignment)]
        set: Vec<Assignment>,
        #[command(flatten)]
        how: RunHow,
    },
    /// Measure a property of a motor and its wheel
    #[command(after_help = parameters_of(&Property::KINDS))]
    Characterise {
        /// Which one
        #[arg(value_enum)]
        what: Property,
        #[arg(help = "Parameters, such as highest_rpm=100", value_name = "NAME=VALUE", value_parser = assignment)]
        set: Vec<Assignment>,
        #[command(flatten)]
        how: RunHow,
    },
    /// Record the line to a session file, which the page opens and replays
    Record {
        /// The file (.mcap)
        file: PathBuf,
        /// End after so many seconds; without it, at Ctrl-C
        #[arg(long, value_parser = seconds, value_name = "SECS")]
        secs: Option<Duration>,
    },
    /// Play a session file in the terminal, or write its telemetry. Exit code 1 if something of it is missing or damaged
    Replay(Replay),
    /// Show virtual motors on a pseudo-terminal, for any serial program
    ///
    /// Prints `ready <path>` when a serial program may open that path, 8N1 at the baud of the model: 115200, or 38400 of a
    /// ddsm400. At another baud no motor answers. Commands on standard input, one a line, each answered by `ok ..` or
    /// `error: ..`: `block 1 on|off`, `load 1 <N.m>`, `temperature 1 <C>`, `power 1 on|off`, `mute 1 on|off`, `state 1`,
    /// and `stall <ms>`, during which nothing passes the adapter.
    #[cfg(unix)]
    Virtual(crate::virtual_motors::VirtualMotors),
    /// Print the completions of a shell, to be sourced by it
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Write the man pages to a folder
    Man {
        /// The folder
        folder: PathBuf,
    },
    /// Print, check and convert session files
    Session {
        #[command(subcommand)]
        action: SessionAction,
    },
}

/// How `monitor` shows what it gets.
#[derive(Debug, Args)]
pub struct Monitor {
    /// How often a line is shown, or a row is written at most. An idle motor is asked ten times a second
    #[arg(long, default_value_t = 5.0, value_parser = hertz)]
    pub hz: f64,
    /// CSV: to this file, or to the standard output
    #[arg(long, num_args = 0..=1, value_name = "FILE")]
    #[expect(clippy::option_option, reason = "absent, without a value, or with one")]
    pub csv: Option<Option<PathBuf>>,
    /// Name of the columns of the CSV: both names mean the same columns
    #[arg(long, requires = "csv", value_parser = ["article", "m0601-cli"])]
    format: Option<String>,
    /// A line of JSON for every reply
    #[arg(long, conflicts_with = "csv")]
    pub json: bool,
    /// End after so many seconds; without it, at Ctrl-C
    #[arg(long, value_parser = seconds, value_name = "SECS")]
    pub secs: Option<Duration>,
}

/// How `doctor` examines the line.
#[derive(Debug, Args)]
pub struct Doctor {
    /// Watch the line for so many seconds, 6-30; the last ten are judged
    #[arg(long, default_value_t = 10, value_name = "SECS", value_parser = clap::value_parser!(u64).range(6..=30))]
    pub secs: u64,
    /// If the line is well, turn the wheels so fast, in rpm, and watch for as long again: some faults show only then
    #[arg(long, allow_hyphen_values = true, value_name = "RPM")]
    pub rpm: Option<i32>,
    /// Turn the wheels without asking
    #[arg(long, requires = "rpm")]
    pub yes: bool,
    /// As JSON
    #[arg(long)]
    pub json: bool,
}

/// The loop to drive in.
#[derive(Debug, Subcommand)]
pub enum Drive {
    /// Hold a speed
    Velocity {
        /// Speed in rpm, such as 100 or -50
        #[arg(
            allow_hyphen_values = true,
            required_unless_present = "rpm",
            value_name = "RPM"
        )]
        value: Option<i32>,
        /// The same
        #[arg(
            long,
            allow_hyphen_values = true,
            conflicts_with = "value",
            hide = true
        )]
        rpm: Option<i32>,
        /// How gently the motor itself speeds up, 0-255; more is gentler, and 0 is its default
        #[arg(long, default_value_t = 0)]
        accel: u8,
        /// How fast the commanded speed may grow, in rpm a second
        #[arg(long, value_parser = ramp, value_name = "RPM/S")]
        ramp: Option<Ramp>,
        #[command(flatten)]
        how: How,
    },
    /// Hold a torque current
    Current {
        /// Current in A, such as 0.5 or -0.5
        #[arg(
            allow_hyphen_values = true,
            required_unless_present = "amps",
            value_name = "A"
        )]
        value: Option<f32>,
        /// The same
        #[arg(
            long,
            allow_hyphen_values = true,
            conflicts_with = "value",
            hide = true
        )]
        amps: Option<f32>,
        /// Allow more than 6.1 A
        #[arg(long)]
        high_current: bool,
        #[command(flatten)]
        how: How,
    },
    /// Go to an angle and hold it
    Position {
        /// Angle in degrees, 0-360
        #[arg(required_unless_present = "deg", value_name = "DEGREES")]
        value: Option<f32>,
        /// The same
        #[arg(long, conflicts_with = "value", hide = true)]
        deg: Option<f32>,
        #[command(flatten)]
        how: How,
    },
}

/// How long and how fast to drive.
#[derive(Clone, Debug, Args)]
pub struct How {
    /// Stop after so many seconds; without it, at Ctrl-C
    #[arg(long, value_parser = seconds, value_name = "SECS")]
    pub secs: Option<Duration>,
    /// Drive frames a second to each motor, 1-500
    #[arg(long, default_value = "50", value_parser = rate, value_name = "HZ")]
    pub rate: CommandRate,
    /// Record to this session file (.mcap)
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
}

//! The flags of `motorlink virtual`, read once into a world and where to show it.

use std::{ops::RangeInclusive, path::PathBuf, time::Duration};

use clap::Args;
use motorlink_protocol::{MotorId, family::Model};
use motorlink_simulator::{Echo, MotorConfig, Split, WhenSilent, WireFaults, WorldConfig};

use crate::failure::Failure;

/// Longest turnaround and latency taken: beyond a second no host waits.
const DELAY_MAX: u64 = 1_000_000;

/// What `motorlink virtual` is given.
#[derive(Debug, Args)]
pub struct VirtualMotors {
    /// IDs of the motors, 1-254, with commas between
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "1",
        value_name = "ID,ID.."
    )]
    ids: Vec<MotorId>,
    /// So many motors, with the IDs from 1 on
    #[arg(long, conflicts_with = "ids", value_name = "N",
        value_parser = clap::value_parser!(u8).range(1..=254))]
    motors: Option<u8>,
    /// Make a symbolic link to the terminal here; removed at the end
    #[arg(long, value_name = "PATH")]
    link: Option<PathBuf>,
    /// From the end of a request to the start of its reply, in microseconds
    #[arg(long, default_value_t = 600, value_name = "US",
        value_parser = clap::value_parser!(u64).range(..=DELAY_MAX))]
    turnaround_us: u64,
    /// What the motors do when drive frames cease: `keep` their last command for ever, as the maker's own examples rely
    /// on; `coast` or `brake` after 100 ms, which is a guess
    #[arg(long, default_value = "keep", value_parser = when_silent, value_name = "keep|coast|brake")]
    when_silent: WhenSilent,
    /// Load that opposes motion, in N.m
    #[arg(long, default_value = "0", value_name = "N.M", value_parser = load_nm)]
    load_nm: f32,
    /// Temperature of the winding at the start and of the air for good, in degrees Celsius
    #[arg(long, value_name = "C", value_parser = celsius)]
    temperature: Option<f32>,
    /// Set-ID frames in a row before a motor takes an ID; M0601 units are reported to want more than 5
    #[arg(long, default_value_t = 5, value_name = "N",
        value_parser = clap::value_parser!(u8).range(1..))]
    set_id_frames: u8,
    /// The adapter hears itself: `whole`, or `cut:N` for the first N bytes of every frame
    #[arg(long, value_parser = echo, value_name = "whole|cut:N")]
    echo: Option<Echo>,
    /// Probability that a frame is lost, either way, 0 to 1
    #[arg(long, default_value = "0", value_name = "P", value_parser = probability)]
    loss: f64,
    /// Probability that a frame has one bit wrong, either way, 0 to 1
    #[arg(long, default_value = "0", value_name = "P", value_parser = probability)]
    corrupt: f64,
    /// Probability that a reply is lost on top of that, 0 to 1
    #[arg(long, default_value = "0", value_name = "P", value_parser = probability)]
    lose_replies: f64,
    /// Probability that a reply has one bit wrong on top of that, 0 to 1
    #[arg(long, default_value = "0", value_name = "P", value_parser = probability)]
    corrupt_replies: f64,
    /// Deliver replies in up to three pieces, up to 1 ms apart
    #[arg(long)]
    split: bool,
    /// Hold received bytes for so long after the first, as FTDI adapters do (16)
    #[arg(long, default_value_t = 0, value_name = "MS",
        value_parser = clap::value_parser!(u64).range(..=DELAY_MAX / 1000))]
    latency_ms: u64,
    /// Answer as a DDSM Driver HAT whose switch is at ESP32: a line of JSON to all that is written, and no frame
    /// reaches a motor
    #[arg(long)]
    json: bool,
    /// The same seed gives the same noise and the same faults
    #[arg(long, default_value_t = 1, value_name = "N")]
    seed: u64,
    /// Write every frame here: microseconds of `CLOCK_MONOTONIC`, HOST or MOTOR, ten bytes in hex,
    /// with tabs between
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
}

/// A command line that makes sense.
pub(crate) struct Arguments {
    pub(crate) world: WorldConfig,
    pub(crate) json: bool,
    pub(crate) link: Option<PathBuf>,
    pub(crate) log: Option<PathBuf>,
}

impl VirtualMotors {
    /// Makes a world of the flags.
    ///
    /// # Errors
    /// Two motors have the same ID.
    pub(crate) fn check(mut self, model: Model) -> Result<Arguments, Failure> {
        if let Some(count) = self.motors {
            self.ids = (1..=count).flat_map(MotorId::new).collect();
        }
        let mut seen = Vec::new();
        for id in &self.ids {
            if seen.contains(id) {
                let text = format!(
                    "--ids: {} is given twice; every motor needs its own",
                    id.get()
                );
                return Err(Failure::Usage(text));
            }
            seen.push(*id);
        }
        let motor = |id: MotorId| {
            let plain = MotorConfig::of(model, id);
            MotorConfig {
                load_nm: self.load_nm,
                when_silent: self.when_silent,
                ambient_c: self.temperature.unwrap_or(plain.ambient_c),
                set_id_frames: self.set_id_frames,
                // A real wheel does not stand at exactly 0: there the odometry reply is the query, as an echo is.
                angle_deg: if model.has_separate_frames() {
                    30.0
                } else {
                    plain.angle_deg
                },
                ..plain
            }
        };
        Ok(Arguments {
            world: WorldConfig {
                baud: model.spec().baud,
                seed: self.seed,
                motors: self.ids.iter().copied().map(motor).collect(),
                turnaround: Duration::from_micros(self.turnaround_us),
                faults: WireFaults {
                    echo: self.echo.unwrap_or_default(),
                    lose_request: self.loss,
                    lose_reply: either(self.loss, self.lose_replies),
                    corrupt_request: self.corrupt,
                    corrupt_reply: either(self.corrupt, self.corrupt_replies),
                    split: self.split.then(Split::default),
                    hold: Duration::from_millis(self.latency_ms),
                    ..WireFaults::default()
                },
            },
            json: self.json,
            link: self.link,
            log: self.log,
        })
    }
}

/// The probability that one of two independent things happens, or both.
fn either(one: f64, other: f64) -> f64 {
    1.0 - (1.0 - one) * (1.0 - other)
}

fn number<T: std::str::FromStr + PartialOrd>(
    text: &str,
    range: RangeInclusive<T>,
    expected: &str,
) -> Result<T, String> {
    // Not a number compares false and is refused with the rest.
    let parsed = text.parse::<T>().ok();
    parsed
        .filter(|value| range.contains(value))
        .ok_or_else(|| format!("expected {expected}"))
}

fn probability(text: &str) -> Result<f64, String> {
    number(text, 0.0..=1.0, "a probability from 0 to 1")
}

/// A load in N.m. Ten times stall torque holds any wheel.
pub(crate) fn load_nm(text: &str) -> Result<f32, String> {
    number(text, 0.0..=20.0, "a load from 0 to 20 N.m")
}

/// A temperature that a motor may be brought to and that its one byte can report.
pub(crate) fn celsius(text: &str) -> Result<f32, String> {
    number(
        text,
        0.0..=200.0,
        "a temperature from 0 to 200 degrees Celsius",
    )
}

fn when_silent(text: &str) -> Result<WhenSilent, String> {
    WhenSilent::of_name(text).ok_or_else(|| "expected `keep`, `coast` or `brake`".to_owned())
}

fn echo(text: &str) -> Result<Echo, String> {
    if text == "whole" {
        return Ok(Echo::Whole);
    }
    let bytes = text.strip_prefix("cut:").unwrap_or_default();
    number(bytes, 1..=9, "`whole` or `cut:N` with 1 to 9 bytes").map(Echo::Cut)
}

//! Initial state of a world.

use std::time::Duration;

use motorlink_protocol::{
    MotorId, Position,
    family::{Fault, Model},
};

use crate::wire::WireFaults;

/// What a motor does when drive frames cease.
///
/// The sources disagree, and firmware differs: `motor.md`, "When frames cease". Waveshare's DDSM115 and DDSM210 keep their
/// last command, the article on the M0601 says that one command does not sustain motion, and of the others nothing is
/// known. So the dangerous case is the default of every model, and a host must be safe with all three.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WhenSilent {
    /// The last drive frame stays in force: a speed, a current, an angle, a voltage, and a brake too.
    #[default]
    Keep,
    /// After this time without a drive frame the windings are open, and the wheel coasts.
    CoastAfter(Duration),
    /// After this time without a drive frame the windings are shorted, until the next drive frame.
    BrakeAfter(Duration),
}

impl WhenSilent {
    /// The time of firmware that coasts or brakes. A guess: five missed frames at 50 Hz. No figure is published.
    pub const AFTER: Duration = Duration::from_millis(100);
    /// The three behaviours, with the guessed time.
    pub const ALL: [Self; 3] = [
        Self::Keep,
        Self::CoastAfter(Self::AFTER),
        Self::BrakeAfter(Self::AFTER),
    ];

    /// `keep`, `coast` or `brake`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Keep => "keep",
            Self::CoastAfter(_) => "coast",
            Self::BrakeAfter(_) => "brake",
        }
    }

    /// The behaviour of this name, with the guessed time.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|it| it.name() == name)
    }

    /// Whether a drive frame of this age is not in force any more.
    pub(crate) fn ends(self, age: Duration) -> bool {
        match self {
            Self::Keep => false,
            Self::CoastAfter(after) | Self::BrakeAfter(after) => age > after,
        }
    }
}

/// Initial state of a motor.
#[derive(Clone, Debug, PartialEq)]
pub struct MotorConfig {
    /// Its model. Default DDSM115.
    pub model: Model,
    /// The address in its flash. Default 1, as new motors have.
    pub id: MotorId,
    /// The reported angle at the start, 0-360 degrees. Default 0.
    pub angle_deg: f32,
    /// Ambient temperature and start temperature of the winding, in degrees Celsius. Default 28:
    /// the captures show 30 to 32 in motors that had been on for a while.
    pub ambient_c: f32,
    /// Supply voltage. Default 18, the rated one of a DDSM115; of the others none is published.
    pub supply_v: f32,
    /// A load that opposes motion, in N.m. Default 0.
    pub load_nm: f32,
    /// What it does when drive frames cease. Default: it keeps its last command.
    pub when_silent: WhenSilent,
    /// Mode switch frames for the same mode before it is taken. Default 1; hosts are told to send
    /// five, so any number up to 5 is plausible. Drive frames in between do not matter.
    pub mode_switch_frames: u8,
    /// Set-ID frames in a row before the ID is taken. Default 5 (DDSM115); M0601 units are reported
    /// to take more.
    pub set_id_frames: u8,
    /// Whether it obeys a drive frame to 0xC8, the address of the ID query, as one report says. Default
    /// no.
    pub obeys_all: bool,
    /// A fault that it reports at all times, for whatever cause. As with any active fault, drive frames are
    /// answered but not obeyed. A fault that the model does not have is not reported. Default none.
    pub fault: Option<Fault>,
    /// The speed in rpm that every reply reports, however fast the wheel turns. A DDSM210 that turned was seen to report
    /// -0.1 rpm for ever (`waveshareteam/ddsm_example#2`). Default none.
    pub speed_stuck_rpm: Option<f32>,
    /// The angle that every drive reply of combined frames reports, wherever the wheel is; replies to queries stay true.
    /// A motor was seen to report 0x1234 for ever (`DDTRobot/motor-driver-examples#1`). Default none.
    pub drive_angle_stuck: Option<Position>,
}

impl MotorConfig {
    /// A motor with this address and everything else by default.
    #[must_use]
    pub fn new(id: MotorId) -> Self {
        Self {
            id,
            ..Self::default()
        }
    }

    /// A motor of this model with this address and everything else by default.
    #[must_use]
    pub fn of(model: Model, id: MotorId) -> Self {
        Self {
            model,
            set_id_frames: model.spec().set_id_frames,
            ..Self::new(id)
        }
    }
}

impl Default for MotorConfig {
    fn default() -> Self {
        Self {
            model: Model::Ddsm115,
            id: MotorId::FIRST,
            angle_deg: 0.0,
            ambient_c: 28.0,
            supply_v: 18.0,
            load_nm: 0.0,
            when_silent: WhenSilent::Keep,
            mode_switch_frames: 1,
            set_id_frames: 5,
            obeys_all: false,
            fault: None,
            speed_stuck_rpm: None,
            drive_angle_stuck: None,
        }
    }
}

/// Motors, wire and random seed.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldConfig {
    /// Baud of the host. A motor of another baud hears nothing. Default 115200.
    pub baud: u32,
    /// The same seed gives the same bytes at the same times.
    pub seed: u64,
    /// The motors on the wire. Default: one with ID 1.
    pub motors: Vec<MotorConfig>,
    /// From the last byte of a request to the first of its reply. Default 600 us.
    pub turnaround: Duration,
    /// Faults of the wire. Default: none.
    pub faults: WireFaults,
}

impl WorldConfig {
    /// Motors of this model with these addresses on a good wire, and a host of their baud.
    pub fn of(model: Model, ids: impl IntoIterator<Item = MotorId>) -> Self {
        let motor = |id| MotorConfig::of(model, id);
        Self {
            baud: model.spec().baud,
            motors: ids.into_iter().map(motor).collect(),
            ..Self::default()
        }
    }

    /// Default motors with these addresses on a good wire.
    pub fn with_ids(ids: impl IntoIterator<Item = MotorId>) -> Self {
        Self {
            motors: ids.into_iter().map(MotorConfig::new).collect(),
            ..Self::default()
        }
    }
}

impl Default for WorldConfig {
    fn default() -> Self {
        Self {
            baud: Model::Ddsm115.spec().baud,
            seed: 1,
            motors: vec![MotorConfig::default()],
            turnaround: Duration::from_micros(600),
            faults: WireFaults::default(),
        }
    }
}

//! The models: everything that differs between them, as data. A new model is a variant and a
//! [`Spec`] in this file.
//!
//! What sources disagree about, or only one source says, is in [`Model::uncertain`].
//!
//! Sources: the maker's manual, its tester, the vendor's library, independent clients, and wikis.

use core::{fmt, str::FromStr, time::Duration};

use crate::{fault::Fault, frame::FRAME_LEN, mode::Mode};

mod current_scale;
mod spec;

pub use current_scale::CurrentScale;
pub use spec::{FrameSet, Nominal, Spec, Wiring};

/// A hub motor of the family. All motors of a line have the same one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Model {
    /// Waveshare DDSM115, the maker's M0601.
    #[default]
    Ddsm115,
    /// Waveshare DDSM315, the maker's M0602C. Its frames are those of a DDSM115.
    Ddsm315,
    /// Waveshare DDSM210, the maker's M0603C.
    Ddsm210,
    /// Waveshare DDSM400, the maker's M0603A.
    Ddsm400,
}

/// The loops of DDSM115 and DDSM315.
const THREE_LOOPS: &[Mode] = &[Mode::Current, Mode::Velocity, Mode::Position];

/// The maker's manual and captures (`motor.md`).
const DDSM115: Spec = Spec {
    name: "DDSM115",
    maker_name: "M0601",
    key: "ddsm115",
    wiring: Wiring::Rs485,
    baud: 115_200,
    frames: FrameSet::Combined,
    modes: THREE_LOOPS,
    needs_enable: false,
    speed_units_per_rpm: 1,
    speed_rpm_max: 330,
    current: CurrentScale::of(8_000),
    acceleration_us_per_rpm: 3_600,
    faults: &[
        Fault::Sensor,
        Fault::BusOvercurrent,
        Fault::PhaseOvercurrent,
        Fault::Stall,
        Fault::OverTemperature,
    ],
    set_id_frames: 5,
    set_id_has_crc: false,
    nominal: Nominal {
        no_load_rpm: 200,
        rated_rpm: Some(115),
        no_load_ma: Some(250),
        rated_mnm: Some(960),
        supply_v: Some(18),
        supply_range_v: Some((12, 24)),
        trips_at_c: Some(80),
    },
};

/// The maker's tester and independent clients. Its frames are those of a DDSM115.
const DDSM315: Spec = Spec {
    name: "DDSM315",
    maker_name: "M0602C",
    key: "ddsm315",
    speed_rpm_max: 315,
    nominal: Nominal {
        no_load_rpm: 315,
        rated_rpm: None,
        no_load_ma: None,
        rated_mnm: None,
        supply_v: None,
        supply_range_v: None,
        trips_at_c: None,
    },
    ..DDSM115
};

/// The maker's tester, the vendor's library, and independent clients.
const DDSM210: Spec = Spec {
    name: "DDSM210",
    maker_name: "M0603C",
    key: "ddsm210",
    wiring: Wiring::TtlUart,
    frames: FrameSet::Separate { reply_offset: 0 },
    modes: &[Mode::OpenLoop, Mode::Velocity, Mode::Position],
    speed_units_per_rpm: 10,
    speed_rpm_max: 210,
    // Times 8 A / 32767, or in tenths of a milliamp (3.28 A at full scale).
    current: CurrentScale::disputed(8_000),
    acceleration_us_per_rpm: 1_000,
    faults: &[Fault::Overcurrent, Fault::OverTemperature],
    set_id_has_crc: true,
    nominal: Nominal {
        no_load_rpm: 210,
        rated_rpm: Some(98),
        no_load_ma: Some(150),
        rated_mnm: None,
        supply_v: None,
        supply_range_v: Some((9, 28)),
        trips_at_c: Some(80),
    },
    ..DDSM115
};

/// The maker's tester and independent clients.
const DDSM400: Spec = Spec {
    name: "DDSM400",
    maker_name: "M0603A",
    key: "ddsm400",
    wiring: Wiring::SingleWire,
    baud: 38_400,
    frames: FrameSet::Separate { reply_offset: 1 },
    modes: &[
        Mode::OpenLoop,
        Mode::Current,
        Mode::Velocity,
        Mode::Position,
    ],
    needs_enable: true,
    speed_rpm_max: 380,
    current: CurrentScale::of(4_000),
    faults: &[
        Fault::Sensor,
        Fault::Overcurrent,
        Fault::Stall,
        Fault::OverTemperature,
        Fault::Disconnected,
        Fault::Voltage,
    ],
    nominal: Nominal {
        no_load_rpm: 400,
        rated_rpm: Some(100),
        no_load_ma: None,
        rated_mnm: Some(150),
        supply_v: None,
        supply_range_v: None,
        trips_at_c: None,
    },
    ..DDSM210
};

impl Model {
    /// Every model.
    pub const ALL: [Self; 4] = [Self::Ddsm115, Self::Ddsm315, Self::Ddsm210, Self::Ddsm400];

    /// Everything that differs between models.
    #[must_use]
    pub const fn spec(self) -> &'static Spec {
        match self {
            Self::Ddsm115 => &DDSM115,
            Self::Ddsm315 => &DDSM315,
            Self::Ddsm210 => &DDSM210,
            Self::Ddsm400 => &DDSM400,
        }
    }

    /// Whether motors of the other model have the same frames and the same baud: they cannot be told apart, and obey the
    /// same stop.
    #[must_use]
    pub fn is_like(self, other: Self) -> bool {
        let (own, other) = (self.spec(), other.spec());
        own.baud == other.baud && own.frames == other.frames
    }

    /// What is not certain. Show it as such, and rely on none of it for safety.
    ///
    /// Not a part of [`Spec`], so that only programs that show it carry the texts.
    #[must_use]
    pub const fn uncertain(self) -> &'static [&'static str] {
        match self {
            Self::Ddsm115 => &[
                "how long a drive frame is obeyed",
                "how many set-ID frames an M0601 takes",
            ],
            Self::Ddsm315 => &[
                "the greatest speed: 315 rpm by the maker's tester, 330 or 475 rpm by clients",
                "stop frames 300 ms apart: one source",
                "the nominal figures: none is published",
                "the acceleration: taken to be that of a DDSM115",
            ],
            Self::Ddsm210 => &[
                "the scale of the current: 8 A or 3.28 A at full scale",
                "the unit of the acceleration: 1 ms or 0.1 ms per rpm",
                "bytes 2-3 of a drive reply in the position loop: the position, by one source",
                "the direction in which the angle grows",
                "faults other than overcurrent and over-temperature",
                "the last byte of a set-ID frame: its CRC, or 00",
            ],
            Self::Ddsm400 => &[
                "the scale of a commanded current: taken to be that of a reported one",
                "bytes 2-3 of a drive reply in the position loop",
                "angle 0 of the position loop: taken to be where it was entered, as of a DDSM210",
                "the direction in which the angle grows",
                "what the mode query answers before the motor is enabled",
                "the last byte of a set-ID frame: its CRC, or 00",
            ],
        }
    }

    /// The loops that it has, in the order of their bytes.
    #[must_use]
    pub const fn modes(self) -> &'static [Mode] {
        self.spec().modes
    }

    /// Whether it has this loop.
    #[must_use]
    pub fn has(self, mode: Mode) -> bool {
        self.modes().contains(&mode)
    }

    /// The loop of this byte in its frames, if it has one.
    #[must_use]
    pub fn mode_of(self, byte: u8) -> Option<Mode> {
        let mut modes = self.modes().iter().copied();
        modes.find(|mode| mode.byte() == byte)
    }

    /// Whether its frames are those of [`FrameSet::Separate`].
    #[must_use]
    pub const fn has_separate_frames(self) -> bool {
        matches!(self.spec().frames, FrameSet::Separate { .. })
    }

    /// Whether a reply of it may be identical to its request, so that an echo looks like a reply.
    #[must_use]
    pub const fn replies_look_like_requests(self) -> bool {
        matches!(self.spec().frames, FrameSet::Separate { reply_offset: 0 })
    }

    /// Time that a frame occupies the line: ten bytes of ten bits.
    #[must_use]
    pub const fn frame_airtime(self) -> Duration {
        Duration::from_micros(FRAME_LEN as u64 * 10 * 1_000_000 / self.spec().baud as u64)
    }
}

/// `DDSM115`
impl fmt::Display for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.spec().name)
    }
}

/// A name that no model has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnknownModel;

impl fmt::Display for UnknownModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("no such model: use one of")?;
        for (place, model) in Model::ALL.into_iter().enumerate() {
            let separator = if place == 0 { " " } else { ", " };
            write!(f, "{separator}{}", model.spec().key)?;
        }
        Ok(())
    }
}

impl core::error::Error for UnknownModel {}

/// By any of its names, in upper or lower case: `ddsm115` or `M0601`.
impl FromStr for Model {
    type Err = UnknownModel;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let is_its = |model: &Self| {
            let Spec {
                name, maker_name, ..
            } = model.spec();
            text.eq_ignore_ascii_case(name) || text.eq_ignore_ascii_case(maker_name)
        };
        Self::ALL.into_iter().find(is_its).ok_or(UnknownModel)
    }
}

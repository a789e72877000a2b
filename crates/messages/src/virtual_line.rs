//! The virtual line: how many motors of which model are on it.

use motorlink_protocol::{
    MotorId,
    family::{Fault, Model},
};
use serde::{Deserialize, Serialize};

/// The built-in virtual line. All its motors have one model, as on a real line.
///
/// It crosses, and is stored, as one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "u8", from = "u8")]
pub struct VirtualLine {
    /// How many motors, and of what kind.
    pub motors: VirtualMotors,
    /// Their model.
    pub model: Model,
}

/// The motors of a virtual line. Their IDs are 1, 2 and so on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VirtualMotors {
    /// One motor.
    #[default]
    One,
    /// The left and the right wheel of a vehicle.
    Two,
    /// Front left, front right, rear left and rear right.
    Four,
    /// Eight motors.
    Eight,
    /// One motor for each fault of the model, which reports that fault.
    Faults,
}

impl VirtualMotors {
    /// All of them, in the order in which a list shows them.
    pub const ALL: [Self; 5] = [Self::One, Self::Two, Self::Four, Self::Eight, Self::Faults];

    /// The name in the address of the page and in its storage.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::One => "1",
            Self::Two => "2",
            Self::Four => "4",
            Self::Eight => "8",
            Self::Faults => "faults",
        }
    }

    /// The motors with this name.
    #[must_use]
    pub fn from_key(key: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|motors| motors.key() == key)
    }
}

impl VirtualLine {
    /// One DDSM115.
    pub const DEFAULT: Self = Self {
        motors: VirtualMotors::One,
        model: Model::Ddsm115,
    };

    /// The number of its motors.
    #[must_use]
    pub const fn count(self) -> usize {
        match self.motors {
            VirtualMotors::One => 1,
            VirtualMotors::Two => 2,
            VirtualMotors::Four => 4,
            VirtualMotors::Eight => 8,
            VirtualMotors::Faults => self.model.spec().faults.len(),
        }
    }

    /// The IDs of its motors.
    pub fn ids(self) -> impl Iterator<Item = MotorId> {
        MotorId::all().take(self.count())
    }

    /// The fault that each of its motors reports, in the order of their IDs.
    #[must_use]
    pub const fn faults(self) -> &'static [Fault] {
        match self.motors {
            VirtualMotors::Faults => self.model.spec().faults,
            _ => &[],
        }
    }
}

/// The place of the motors in [`VirtualMotors::ALL`], times ten, plus the place of the model in [`Model::ALL`].
impl From<VirtualLine> for u8 {
    fn from(line: VirtualLine) -> Self {
        line.motors as Self * 10 + line.model as Self
    }
}

/// An unknown number is the default line.
impl From<u8> for VirtualLine {
    fn from(number: u8) -> Self {
        let motors = VirtualMotors::ALL.get(usize::from(number / 10));
        let model = Model::ALL.get(usize::from(number % 10));
        match (motors, model) {
            (Some(motors), Some(model)) => Self {
                motors: *motors,
                model: *model,
            },
            _ => Self::DEFAULT,
        }
    }
}

impl Default for VirtualLine {
    fn default() -> Self {
        Self::DEFAULT
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_line_has_its_motors() {
        for (motors, model, count) in [
            (VirtualMotors::One, Model::Ddsm115, 1),
            (VirtualMotors::Two, Model::Ddsm315, 2),
            (VirtualMotors::Four, Model::Ddsm400, 4),
            (VirtualMotors::Eight, Model::Ddsm210, 8),
            (VirtualMotors::Faults, Model::Ddsm115, 5),
            (VirtualMotors::Faults, Model::Ddsm210, 2),
            (VirtualMotors::Faults, Model::Ddsm400, 6),
        ] {
            let line = VirtualLine { motors, model };
            let ids: Vec<_> = line.ids().map(MotorId::get).collect();
            let expected: Vec<_> = (1..=count).collect();
            assert_eq!(ids, expected, "{line:?}");
            let has_faults = motors == VirtualMotors::Faults;
            assert_eq!(line.faults().len(), if has_faults { ids.len() } else { 0 });
        }
    }

    #[test]
    fn a_line_is_one_number() {
        for motors in VirtualMotors::ALL {
            for model in Model::ALL {
                let line = VirtualLine { motors, model };
                assert_eq!(VirtualLine::from(u8::from(line)), line);
            }
        }
        let rover = VirtualLine {
            motors: VirtualMotors::Four,
            model: Model::Ddsm400,
        };
        assert_eq!(u8::from(rover), 23);
        for unknown in [4, 9, 50, 255] {
            assert_eq!(VirtualLine::from(unknown), VirtualLine::DEFAULT);
        }
    }

    #[test]
    fn keys_name_their_motors() {
        for motors in VirtualMotors::ALL {
            assert_eq!(VirtualMotors::from_key(motors.key()), Some(motors));
        }
        for unknown in ["", "99", "3", "Faults"] {
            assert_eq!(VirtualMotors::from_key(unknown), None);
        }
    }
}

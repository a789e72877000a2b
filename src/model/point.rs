//! One reply in the history.

use motorlink_messages::protocol::{
    Celsius, CoarsePosition, Current, Detail, Instant, Position, Reply, Rpm,
};

/// The drawn values of one reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Point {
    /// When its last byte was read, on the history's clock.
    pub(crate) at: Instant,
    /// [`UNKNOWN`] if the reply does not tell it, and so is the current.
    speed: i16,
    current: i16,
    /// The angle, and the temperature if the reply has one.
    pub(crate) detail: Kept,
}

/// Beyond the range of a speed and of a current. An `Option` would make each point half as large again.
const UNKNOWN: i16 = i16::MIN;

/// What is drawn of a [`Detail`]. Without the turns, which would make each point half as large again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kept {
    Fine(Position),
    /// Of an odometry reply. No source says whether this angle grows at positive speed.
    Odometry(Position),
    Coarse(Celsius, CoarsePosition),
    Temperature(Celsius),
    Nothing,
}

impl From<Detail> for Kept {
    fn from(detail: Detail) -> Self {
        match detail {
            Detail::Drive { position } => Self::Fine(position),
            Detail::Odometry { position, .. } => Self::Odometry(position),
            Detail::Query {
                temperature,
                position,
            } => Self::Coarse(temperature, position),
            Detail::Temperature(temperature) => Self::Temperature(temperature),
            Detail::Undetermined(_) => Self::Nothing,
        }
    }
}

impl Point {
    pub(crate) fn of(at: Instant, reply: &Reply) -> Self {
        Self {
            at,
            speed: reply.speed.map_or(UNKNOWN, Rpm::rpm),
            current: reply.current.map_or(UNKNOWN, Current::raw),
            detail: reply.detail.into(),
        }
    }

    /// 0 to 360, in the resolution of the reply.
    pub(crate) fn degrees(&self) -> Option<f32> {
        match self.detail {
            Kept::Fine(position) | Kept::Odometry(position) => Some(position.degrees()),
            Kept::Coarse(_, position) => Some(position.degrees()),
            Kept::Temperature(_) | Kept::Nothing => None,
        }
    }

    pub(crate) fn speed(&self) -> Option<Rpm> {
        (self.speed != UNKNOWN).then_some(Rpm::new(self.speed))
    }

    pub(crate) fn current(&self) -> Option<Current> {
        (self.current != UNKNOWN).then_some(Current::from_raw(self.current))
    }

    pub(crate) fn temperature(&self) -> Option<Celsius> {
        match self.detail {
            Kept::Coarse(temperature, _) | Kept::Temperature(temperature) => Some(temperature),
            Kept::Fine(_) | Kept::Odometry(_) | Kept::Nothing => None,
        }
    }
}

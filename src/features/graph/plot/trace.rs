//! The traces: four reported quantities, and the goal.

use motorlink_i18n::tr;
use motorlink_messages::protocol::{Setpoint, family::Model};
use strum::IntoStaticStr;

use crate::{
    model::{history::Point, mirror::Mirror},
    ui::format::rpm,
};

/// A trace of the graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, IntoStaticStr)]
#[strum(serialize_all = "snake_case", const_into_str)]
pub(crate) enum Trace {
    Speed,
    Current,
    /// The setpoint, in its own quantity.
    Goal,
    Temperature,
    Position,
}

impl Trace {
    /// In the order of the legend.
    pub(crate) const ALL: [Self; 5] = [
        Self::Speed,
        Self::Current,
        Self::Goal,
        Self::Temperature,
        Self::Position,
    ];

    /// The index in [`Trace::ALL`].
    pub(crate) fn place(self) -> usize {
        Self::ALL.iter().position(|it| *it == self).unwrap_or(0)
    }

    /// The name in the legend.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Speed => tr!("Speed"),
            Self::Current => tr!("Current" as "electric"),
            Self::Goal => tr!("Target"),
            Self::Temperature => tr!("Temperature"),
            Self::Position => tr!("Position"),
        }
    }

    /// The name before its value in a sentence.
    pub(crate) fn name_in_sentence(self) -> &'static str {
        match self {
            Self::Speed => tr!("speed"),
            Self::Current => tr!("current" as "electric"),
            Self::Goal => tr!("target"),
            Self::Temperature => tr!("temperature"),
            Self::Position => tr!("position"),
        }
    }

    /// The name in two parts: a short one that is enough where there is little room, and the rest.
    pub(crate) fn name_in_parts(self) -> (&'static str, &'static str) {
        let name = self.name();
        let short = match self {
            Self::Temperature => tr!("Temp" as "what Temperature begins with"),
            _ => name,
        };
        // A name with another beginning has no short part.
        name.strip_prefix(short)
            .map_or((name, ""), |rest| (short, rest))
    }

    /// The accessible name of its switch.
    pub(crate) fn switch_name(self) -> &'static str {
        match self {
            Self::Speed => tr!("Show speed"),
            Self::Current => tr!("Show current"),
            Self::Goal => tr!("Show target"),
            Self::Temperature => tr!("Show temperature"),
            Self::Position => tr!("Show position"),
        }
    }

    /// The class with its colour.
    pub(crate) const fn class(self) -> &'static str {
        self.into_str()
    }

    /// Empty for the goal, which has the unit of its quantity. A current whose scale is not certain is drawn at 8 A full
    /// scale, the greatest that a source names.
    pub(crate) fn unit(self, model: Model) -> &'static str {
        match self {
            Self::Speed => rpm(),
            Self::Current if !model.spec().current.is_certain() => "A ?",
            Self::Current => "A",
            Self::Goal => "",
            Self::Temperature => "°C",
            Self::Position => "°",
        }
    }

    /// The value in this reply, in its unit and with the sign of a mirrored motor; `None` if the reply does not
    /// contain it.
    pub(crate) fn value(self, point: &Point, mirror: Mirror) -> Option<f32> {
        match self {
            Self::Speed => point.speed().map(|it| f32::from(mirror.speed(it).rpm())),
            Self::Current => point.current().map(|it| mirror.current(it).amps()),
            Self::Goal => None,
            Self::Temperature => point.temperature().map(|it| f32::from(it.degrees())),
            Self::Position => point.degrees(),
        }
    }

    /// Whether the step between two values wraps: an angle that exceeds 360 continues at 0.
    pub(crate) fn wraps(self, from: f32, to: f32) -> bool {
        self == Self::Position && (from - to).abs() > 180.0
    }

    /// The trace of a class.
    pub(crate) fn from_class(class: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|trace| trace.class() == class)
    }

    /// Whether its values have a direction, which their sign tells.
    pub(crate) const fn is_signed(self) -> bool {
        matches!(self, Self::Speed | Self::Current)
    }

    const fn bit(self) -> u8 {
        match self {
            Self::Speed => 1,
            Self::Current => 2,
            Self::Goal => 4,
            Self::Temperature => 8,
            Self::Position => 16,
        }
    }
}

/// The quantity and the value of a setpoint, if the graph draws it. The brake is 0 rpm.
pub(crate) fn of_setpoint(setpoint: Setpoint) -> Option<(Trace, f32)> {
    Some(match setpoint {
        Setpoint::Velocity { speed, .. } => (Trace::Speed, f32::from(speed.rpm())),
        Setpoint::Brake => (Trace::Speed, 0.0),
        Setpoint::Current(target) => (Trace::Current, target.amps()),
        Setpoint::Position(target) => (Trace::Position, target.degrees()),
        Setpoint::OpenLoop(_) => return None,
    })
}

/// The visible traces, or the one that is compared across motors instead.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Traces {
    on: u8,
    /// `None` while the graph shows one motor.
    pub(crate) compared: Option<Trace>,
}

impl Default for Traces {
    /// Speed, current and their goal.
    fn default() -> Self {
        Self {
            on: Trace::Speed.bit() | Trace::Current.bit() | Trace::Goal.bit(),
            compared: None,
        }
    }
}

impl Traces {
    pub(crate) const fn has(self, trace: Trace) -> bool {
        self.on & trace.bit() != 0
    }

    /// The traces that have a pane of their own, from the top. The goal is in the pane of its quantity.
    pub(crate) fn panes(self) -> Vec<Trace> {
        let all = Trace::ALL.into_iter();
        match self.compared {
            Some(trace) => vec![trace],
            None => all
                .filter(|trace| *trace != Trace::Goal && self.has(*trace))
                .collect(),
        }
    }

    /// The same traces with one of them switched on or off.
    pub(crate) const fn with(self, trace: Trace, on: bool) -> Self {
        let on = if on {
            self.on | trace.bit()
        } else {
            self.on & !trace.bit()
        };
        Self { on, ..self }
    }
}

#[cfg(test)]
mod tests {
    use motorlink_messages::protocol::{
        Celsius, CoarsePosition, Current, CurrentTarget, Detail, Faults, Instant, Mode, MotorId,
        PositionTarget, Reply, Rpm, SpeedTarget,
    };

    use super::*;

    #[test]
    fn a_reply_gives_each_trace_its_value_or_none() {
        let reply = Reply {
            id: MotorId::FIRST,
            mode: Mode::Velocity,
            current: Some(Current::from_amps(-0.5)),
            speed: Some(Rpm::new(-60)),
            detail: Detail::Query {
                temperature: Celsius::new(33),
                position: CoarsePosition::from_raw(51),
            },
            faults: Faults::NONE,
        };
        let of = |reply: Reply| Point::of(Instant::ZERO, &reply);
        let point = of(reply);
        let values = Trace::ALL.map(|trace| trace.value(&point, Mirror::Straight));
        let rounded = values.map(|value| value.map(|value| (value * 10.0).round()));
        let wanted = [Some(-600.0), Some(-5.0), None, Some(330.0), Some(720.0)];
        assert_eq!(rounded, wanted);
        let mirrored = Trace::ALL.map(|trace| trace.value(&point, Mirror::Mirrored));
        let turned = [0, 1].map(|place| values[place].map(|value| -value));
        assert_eq!(mirrored[..2], turned, "speed and current");
        assert_eq!(mirrored[2..], values[2..], "and nothing else");
        let undetermined = of(reply.undetermined());
        assert_eq!(
            Trace::Temperature.value(&undetermined, Mirror::Straight),
            None
        );
        assert_eq!(Trace::Position.value(&undetermined, Mirror::Straight), None);
        let untold = of(Reply {
            current: None,
            speed: None,
            ..reply
        });
        assert_eq!(Trace::Speed.value(&untold, Mirror::Straight), None);
        assert_eq!(Trace::Current.value(&untold, Mirror::Straight), None);
    }

    #[test]
    fn a_long_name_has_a_short_beginning() {
        assert_eq!(Trace::Temperature.name_in_parts(), ("Temp", "erature"));
        assert_eq!(Trace::Position.name_in_parts(), ("Position", ""));
    }

    #[test]
    fn only_an_angle_wraps() {
        assert!(Trace::Position.wraps(359.0, 2.0) && Trace::Position.wraps(1.0, 300.0));
        assert!(!Trace::Position.wraps(10.0, 170.0));
        assert!(!Trace::Speed.wraps(330.0, -330.0));
    }

    #[test]
    fn a_goal_belongs_to_the_quantity_it_asks_for() {
        let speed = Setpoint::velocity(SpeedTarget::new(-60).unwrap());
        assert_eq!(of_setpoint(speed), Some((Trace::Speed, -60.0)));
        assert_eq!(of_setpoint(Setpoint::Brake), Some((Trace::Speed, 0.0)));
        let current = Setpoint::Current(CurrentTarget::new(-32_767).unwrap());
        assert_eq!(of_setpoint(current), Some((Trace::Current, -8.0)));
        let position = Setpoint::Position(PositionTarget::new(32_767).unwrap());
        assert_eq!(of_setpoint(position), Some((Trace::Position, 360.0)));
    }

    #[test]
    fn traces_are_switched_one_by_one() {
        let mut traces = Traces::default();
        let on = |traces: Traces| Trace::ALL.map(|trace| traces.has(trace));
        assert_eq!(on(traces), [true, true, true, false, false]);
        traces = traces.with(Trace::Position, true).with(Trace::Speed, false);
        assert_eq!(on(traces), [false, true, true, false, true]);
        assert_eq!(traces.with(Trace::Position, true), traces);
        assert_eq!(traces.panes(), [Trace::Current, Trace::Position]);
        traces.compared = Some(Trace::Speed);
        assert_eq!(traces.panes(), [Trace::Speed]);
        assert_eq!(
            on(traces),
            [false, true, true, false, true],
            "they come back"
        );
    }
}

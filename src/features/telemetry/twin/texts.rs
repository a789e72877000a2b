//! The texts and figures of the twin.

use motorlink_i18n::{terms::in_language, tr};
use motorlink_messages::Connection;
use motorlink_messages::bus::{Activity, Turns};
use motorlink_messages::protocol::{Rpm, Setpoint};

use crate::ui::{format::UNKNOWN, mathematics::modulo};

/// The motion of the wheel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Motion {
    /// Standstill.
    Stationary,
    /// Clockwise as seen from its face: negative speed.
    SpinningCw,
    /// Counter-clockwise as seen from its face: positive speed.
    SpinningCcw,
    /// It is being stopped but still turns.
    Braking,
    /// There is no report of the last half second.
    #[default]
    NoData,
}

impl Motion {
    /// The motion by the last speed if it is fresh, the setpoint, and the activity of the bus.
    #[must_use]
    pub fn of(speed: Option<Rpm>, goal: Option<Setpoint>, activity: Option<Activity>) -> Self {
        let Some(speed) = speed else {
            return Self::NoData;
        };
        let stopped = match activity {
            Some(Activity::Stopping { .. }) => true,
            Some(Activity::Driven { setpoint }) => setpoint == Setpoint::Brake,
            Some(Activity::Idle | Activity::Switching { .. } | Activity::DrivenRaw) | None => {
                goal == Some(Setpoint::Brake)
            }
        };
        match speed.rpm() {
            0 => Self::Stationary,
            _ if stopped => Self::Braking,
            1.. => Self::SpinningCcw,
            _ => Self::SpinningCw,
        }
    }

    /// The text.
    #[must_use]
    pub fn text(self) -> &'static str {
        match self {
            Self::Stationary => tr!("Stationary"),
            Self::SpinningCw => tr!("Spinning CW"),
            Self::SpinningCcw => tr!("Spinning CCW"),
            Self::Braking => tr!("Braking"),
            Self::NoData => tr!("No data"),
        }
    }
}

/// The figures below the wheel, rounded to the displayed resolution, so that equal figures are equal values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Figures {
    /// Last reported speed.
    pub speed: Rpm,
    /// Tenths of a degree, 0 to 3599; unknown before the first reported angle.
    pub angle_tenths: Option<i32>,
    /// Tenths of a turn, positive in the direction of positive speed; unknown before the first reported angle.
    pub turns_tenths: Option<i32>,
}

impl Figures {
    /// The figures for the drawn angle in degrees, unwrapped, and the turns.
    #[must_use]
    #[allow(clippy::cast_possible_truncation, reason = "an angle within a turn")]
    pub fn new(speed: Rpm, angle_deg: Option<f64>, turns: Option<Turns>) -> Self {
        Self {
            speed,
            // Rounded before it wraps: 359.96 gives 0.0, not 360.0.
            angle_tenths: angle_deg.map(|deg| modulo((deg * 10.0).round(), 3_600.0) as i32),
            turns_tenths: turns.map(Turns::tenths),
        }
    }

    /// `100 rpm`: the words beside it have the direction, and the sign of a mirrored motor is another one in its card.
    #[must_use]
    pub fn speed_text(self) -> String {
        tr!("{speed} rpm", speed = self.speed.magnitude())
    }

    /// `66.9°`
    #[must_use]
    pub fn angle_text(self) -> String {
        self.angle_tenths.map_or_else(
            || "\u{2013}°".to_owned(),
            |tenths| in_language(format!("{}.{}°", tenths / 10, tenths % 10)),
        )
    }

    /// `+12.4 turns`
    #[must_use]
    pub fn turns_text(self) -> String {
        let unknown = || tr!("{turns} turns", turns = UNKNOWN);
        self.turns_tenths.map_or_else(unknown, turns_text)
    }
}

/// `+12.4 turns`
#[must_use]
pub fn turns_text(tenths: i32) -> String {
    let sign = if tenths < 0 { '\u{2212}' } else { '+' };
    let tenths = tenths.unsigned_abs();
    tr!(
        "{turns} turns",
        turns = in_language(format!("{sign}{}.{}", tenths / 10, tenths % 10))
    )
}

/// The description of the picture for screen readers: it changes with the motion and with every ten rpm, not with
/// every report.
#[must_use]
pub fn description(motion: Motion, speed: Option<Rpm>) -> String {
    match (motion, speed) {
        (Motion::NoData, _) | (_, None) => {
            tr!("Greyed-out wheel: no data from its motor.").to_owned()
        }
        (Motion::Stationary, _) => tr!("The wheel is stationary.").to_owned(),
        (Motion::Braking, _) => tr!("The wheel is braking.").to_owned(),
        (Motion::SpinningCw | Motion::SpinningCcw, Some(speed)) => {
            let clockwise = motion == Motion::SpinningCw;
            match (speed.magnitude() + 5) / 10 * 10 {
                0 if clockwise => tr!("The wheel turns clockwise, slowly.").to_owned(),
                0 => tr!("The wheel turns counter-clockwise, slowly.").to_owned(),
                rpm if clockwise => tr!("The wheel turns clockwise at about {rpm} rpm.", rpm),
                rpm => tr!("The wheel turns counter-clockwise at about {rpm} rpm.", rpm),
            }
        }
    }
}

/// The text above the wheel before the motor has answered.
pub(crate) fn no_motor(connection: Connection) -> &'static str {
    match connection {
        Connection::Connected(_) => tr!("No motor found yet"),
        _ => tr!("No motor: press Connect motor"),
    }
}

#[cfg(test)]
mod tests {
    use motorlink_messages::protocol::{Mode, SpeedTarget};

    use super::*;

    const fn driven(setpoint: Setpoint) -> Activity {
        Activity::Driven { setpoint }
    }

    #[test]
    fn motion_follows_what_is_known() {
        let run = Setpoint::velocity(SpeedTarget::new(100).unwrap());
        let stop = Some(Activity::Stopping { confirmed: false });
        let table = [
            (None, None, None, "No data"),
            (None, Some(run), stop, "No data"),
            (Some(0), None, None, "Stationary"),
            (Some(0), Some(Setpoint::Brake), stop, "Stationary"),
            (Some(100), Some(run), Some(driven(run)), "Spinning CCW"),
            (Some(-1), Some(run), Some(driven(run)), "Spinning CW"),
            (Some(100), Some(run), stop, "Braking"),
            (Some(-40), None, Some(driven(Setpoint::Brake)), "Braking"),
            (Some(-40), Some(Setpoint::Brake), None, "Braking"),
            // The sent setpoint counts, not the entered one.
            (
                Some(40),
                Some(Setpoint::Brake),
                Some(driven(run)),
                "Spinning CCW",
            ),
            (
                Some(40),
                None,
                Some(Activity::Switching { to: Mode::Current }),
                "Spinning CCW",
            ),
        ];
        for (rpm, goal, activity, expected) in table {
            let motion = Motion::of(rpm.map(Rpm::new), goal, activity);
            assert_eq!(motion.text(), expected, "{rpm:?} {goal:?} {activity:?}");
        }
    }

    #[test]
    fn figures_carry_a_real_minus_and_wrap_after_rounding() {
        let turns = |number| Some(Turns::new(number));
        let figures = Figures::new(Rpm::new(-100), Some(359.96), turns(-12.44));
        assert_eq!(figures.speed_text(), "100 rpm");
        assert_eq!(figures.angle_text(), "0.0°");
        assert_eq!(figures.turns_text(), "\u{2212}12.4 turns");
        let figures = Figures::new(Rpm::new(7), Some(-293.0), turns(0.04));
        assert_eq!(figures.angle_text(), "67.0°");
        assert_eq!(figures.turns_text(), "+0.0 turns");
        let figures = Figures::new(Rpm::new(0), None, None);
        assert_eq!(figures.angle_text(), "–°");
        assert_eq!(figures.turns_text(), "– turns");
    }

    #[test]
    fn the_description_does_not_chatter() {
        let said = |rpm| description(Motion::SpinningCcw, Some(Rpm::new(rpm)));
        assert_eq!(said(97), said(104));
        assert_eq!(
            said(100),
            "The wheel turns counter-clockwise at about 100 rpm."
        );
        assert_eq!(said(2), "The wheel turns counter-clockwise, slowly.");
    }
}

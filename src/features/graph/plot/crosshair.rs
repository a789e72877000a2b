//! The values at one moment: the nearest reply of each trace.

use motorlink_i18n::terms::in_language;
use motorlink_messages::protocol::{
    Celsius, Current, Instant, MotorId, Rpm, Setpoint, family::Model,
};

use crate::{
    features::graph::plot::{comparison::Comparison, trace::Trace},
    model::{
        history::{History, Point, Track},
        mirror::Mirror,
    },
    ui::format::{self, UNKNOWN},
};

/// Maximal distance of a reply from the moment. A motor is queried ten times a second, so this allows for a few lost
/// replies.
const NEAR_US: u64 = 500_000;

/// The values at a moment.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub(crate) struct Values {
    pub(crate) model: Model,
    pub(crate) speed: Option<Rpm>,
    pub(crate) current: Option<Current>,
    pub(crate) goal: Option<Setpoint>,
    pub(crate) temperature: Option<Celsius>,
    /// In degrees.
    pub(crate) angle: Option<f32>,
}

/// The values of the nearest replies to a moment. Some replies contain a fine angle and others a temperature, so the
/// nearest reply is searched for each value.
pub(crate) fn values(track: &Track, mirror: Mirror, model: Model, at: Instant) -> Values {
    Values {
        model,
        speed: nearest(track, at, Point::speed).map(|it| mirror.speed(it)),
        current: nearest(track, at, Point::current).map(|it| mirror.current(it)),
        goal: track.goal_at(at).map(|goal| mirror.setpoint(goal)),
        temperature: nearest(track, at, Point::temperature),
        angle: nearest(track, at, Point::degrees),
    }
}

/// The place of each motor, its ID, and its value at a moment as text.
pub(crate) fn compared(
    history: &History,
    comparison: &Comparison,
    model: Model,
    at: Instant,
) -> Vec<(usize, MotorId, String)> {
    let motors = comparison.motors().filter_map(|(place, id, mirror)| {
        let values = values(history.track(id)?, mirror, model, at);
        Some((place, id, values.text(comparison.trace)))
    });
    motors.collect()
}

/// The value in the nearest reply that contains one.
fn nearest<'a, T>(
    track: &'a Track,
    at: Instant,
    read: impl Fn(&'a Point) -> Option<T>,
) -> Option<T> {
    let away_us = |point: &Point| point.at.as_micros().abs_diff(at.as_micros());
    let look = |points: &mut dyn Iterator<Item = &'a Point>| {
        points
            .take_while(|point| away_us(point) <= NEAR_US)
            .find_map(|point| Some((away_us(point), read(point)?)))
    };
    let (mut before, mut after) = track.around(at);
    let (before, after) = (look(&mut before), look(&mut after));
    let nearer = match (before, after) {
        (Some(before), Some(after)) if before.0 < after.0 => Some(before),
        (before, after) => after.or(before),
    };
    nearer.map(|(_, value)| value)
}

impl Values {
    /// The difference to the values at another moment: `+50 rpm`; a dash if either is unknown. A target has the unit of
    /// its quantity, so that two of them are not compared.
    pub(crate) fn since(&self, other: &Self, trace: Trace) -> String {
        let text = match trace {
            Trace::Speed => self
                .speed
                .zip(other.speed)
                .map(|(to, from)| format::signed(i32::from(to.rpm()) - i32::from(from.rpm()))),
            Trace::Current => self
                .current
                .zip(other.current)
                .map(|(to, from)| format::signed_decimal(to.amps() - from.amps(), 2)),
            Trace::Goal => None,
            Trace::Temperature => self.temperature.zip(other.temperature).map(|(to, from)| {
                format::signed(i32::from(to.degrees()) - i32::from(from.degrees()))
            }),
            Trace::Position => self
                .angle
                .zip(other.angle)
                .map(|(to, from)| format::signed_decimal(to - from, 1)),
        };
        let space = if trace == Trace::Position { "" } else { " " };
        text.map_or_else(
            || UNKNOWN.to_owned(),
            |text| text + space + trace.unit(self.model),
        )
    }

    /// `−60 rpm`; a dash for an unknown value.
    pub(crate) fn text(&self, trace: Trace) -> String {
        let text = match trace {
            Trace::Speed => self.speed.map(format::speed_in_rpm),
            Trace::Current => self
                .current
                .map(|it| format!("{} {}", format::current(it), trace.unit(self.model))),
            Trace::Goal => self.goal.map(format::goal),
            Trace::Temperature => self.temperature.map(|it| format!("{} °C", it.degrees())),
            Trace::Position => self.angle.map(|it| in_language(format::fixed(it, 1) + "°")),
        };
        text.unwrap_or_else(|| UNKNOWN.to_owned())
    }
}

#[cfg(test)]
mod tests {
    use motorlink_messages::{
        bus::Sample,
        protocol::{CoarsePosition, Detail},
    };

    use super::*;
    use crate::model::{
        history::tests::{sample, update},
        names_and_sides::{NamesAndSides, Side},
        scan_texts::tests::id,
        snapshot::tests::ID,
    };

    fn query(at_ms: u64, rpm: i16, degrees: u8) -> Sample {
        let mut sample = sample(ID, at_ms, rpm);
        sample.reply.detail = Detail::Query {
            temperature: Celsius::new(degrees),
            position: CoarsePosition::from_raw(51),
        };
        sample
    }

    fn history() -> History {
        let mut history = History::default();
        let samples = vec![
            query(1_000, 10, 30),
            sample(ID, 1_020, 20),
            sample(ID, 1_040, 30),
            query(1_060, 40, 31),
        ];
        history.take(&update(1_060, samples, vec![]));
        history
    }

    fn at(at_ms: u64) -> Values {
        let history = history();
        values(
            history.track(ID).unwrap(),
            Mirror::Straight,
            Model::Ddsm115,
            Instant::from_millis(at_ms),
        )
    }

    #[test]
    fn the_nearest_reply_is_read() {
        let speeds = [999, 1_009, 1_011, 1_020, 1_029, 1_031, 1_400];
        let speeds = speeds.map(|at_ms| at(at_ms).speed.unwrap().rpm());
        assert_eq!(speeds, [10, 10, 20, 20, 20, 30, 40]);
    }

    #[test]
    fn each_trace_has_the_nearest_reply_that_holds_it() {
        assert_eq!(at(1_025).temperature, Some(Celsius::new(30)));
        assert_eq!(at(1_035).temperature, Some(Celsius::new(31)));
        assert!((at(1_040).angle.unwrap() - 66.96).abs() < 0.01);
        assert!((at(1_060).angle.unwrap() - 72.0).abs() < 0.01);
    }

    #[test]
    fn the_difference_of_two_moments_has_a_sign_and_the_unit() {
        let (from, to) = (at(1_000), at(1_060));
        let texts = Trace::ALL.map(|trace| to.since(&from, trace));
        assert_eq!(
            texts,
            ["+30 rpm", "+0.01 A", "–", "+1 °C", "0.0°"].map(str::to_owned)
        );
        assert_eq!(from.since(&to, Trace::Speed), "\u{2212}30 rpm");
        assert_eq!(to.since(&at(499), Trace::Speed), "–");
    }

    #[test]
    fn far_from_every_reply_nothing_is_known() {
        assert_eq!(at(1_561), Values::default());
        assert_eq!(at(499), Values::default());
        let texts = Trace::ALL.map(|trace| at(499).text(trace));
        assert_eq!(texts, ["–"; 5].map(str::to_owned));
    }

    #[test]
    fn every_compared_motor_is_read_at_the_same_moment() {
        let mut history = history();
        let other = id(2);
        let mut names = NamesAndSides::default();
        names.change(other, |member| member.side = Side::Right);
        let late = vec![sample(other, 1_900, -7)];
        history.take(&update(1_900, late, vec![]));
        let comparison = Comparison::new(Trace::Speed, &history, &names, ID);
        let at = |at_ms| {
            compared(
                &history,
                &comparison,
                Model::Ddsm115,
                Instant::from_millis(at_ms),
            )
        };
        let words = |first: &str, second: &str| {
            vec![(0, ID, first.to_owned()), (1, other, second.to_owned())]
        };
        assert_eq!(at(1_050), words("+40 rpm", "–"));
        assert_eq!(at(1_500), words("+40 rpm", "+7 rpm"));
    }

    #[test]
    fn values_are_read_with_their_units() {
        let texts = Trace::ALL.map(|trace| at(1_060).text(trace));
        assert_eq!(texts, ["+40 rpm", "+0.01 A", "–", "31 °C", "72.0°"]);
    }

    #[test]
    fn a_current_whose_scale_is_uncertain_is_marked() {
        let model = Model::Ddsm210;
        let values = Values { model, ..at(1_060) };
        assert_eq!(values.text(Trace::Current), "+0.01 A ?");
    }
}

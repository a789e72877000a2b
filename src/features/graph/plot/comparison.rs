//! The content of the graph: the traces of the chosen motor, or one trace of several motors.

use motorlink_i18n::tr;
use motorlink_messages::protocol::{Instant, MotorId};

use crate::{
    features::graph::plot::{
        columns::Grid,
        trace::{Trace, Traces},
    },
    model::{
        history::{History, Track},
        mirror::Mirror,
        names_and_sides::NamesAndSides,
    },
};

/// Maximal number of lines that can be told apart by their colours.
pub(crate) const MOTORS_MAX: usize = 8;

/// The traces that can be compared, in the order of the list. The goal cannot: it has no unit of its own.
pub(crate) const COMPARABLE: [Trace; 4] = [
    Trace::Speed,
    Trace::Current,
    Trace::Temperature,
    Trace::Position,
];

/// The content of the graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Subject {
    /// These traces of this motor.
    Motor {
        id: MotorId,
        mirror: Mirror,
        traces: Traces,
    },
    /// One trace of several motors.
    Compared(Comparison),
}

/// One trace of several motors. A motor's place decides its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Comparison {
    pub(crate) trace: Trace,
    motors: [Option<(MotorId, Mirror)>; MOTORS_MAX],
    /// Number of motors without a place.
    pub(crate) left_out: usize,
}

impl Comparison {
    /// Compares all motors that have reported, in the order of their IDs. If there are more than [`MOTORS_MAX`], the
    /// chosen one takes the last place.
    pub(crate) fn new(
        trace: Trace,
        history: &History,
        names: &NamesAndSides,
        chosen: MotorId,
    ) -> Self {
        let mut ids = history.reported();
        ids.sort_unstable();
        let left_out = ids.len().saturating_sub(MOTORS_MAX);
        if let Some(place) = ids.iter().skip(MOTORS_MAX).position(|id| *id == chosen) {
            ids.swap(MOTORS_MAX - 1, MOTORS_MAX + place);
        }
        let mut motors = [None; MOTORS_MAX];
        for (place, id) in motors.iter_mut().zip(ids) {
            *place = Some((id, names.mirror(id)));
        }
        Self {
            trace,
            motors,
            left_out,
        }
    }

    /// The place of each drawn motor, its ID, and whether it is mirrored.
    pub(crate) fn motors(&self) -> impl Iterator<Item = (usize, MotorId, Mirror)> {
        let places = self.motors.iter().enumerate();
        places.filter_map(|(place, id)| id.map(|(id, mirror)| (place, id, mirror)))
    }

    /// `and 3 more, not shown`, if there are more motors than places.
    pub(crate) fn more(&self) -> Option<String> {
        let more = self.left_out;
        (more > 0).then(|| tr!("and {count} more, not shown", count = more))
    }
}

impl Subject {
    /// The content that the user has chosen.
    pub(crate) fn new(
        history: &History,
        names: &NamesAndSides,
        id: MotorId,
        traces: Traces,
    ) -> Self {
        match traces.compared {
            Some(trace) => Self::Compared(Comparison::new(trace, history, names, id)),
            None => Self::Motor {
                id,
                mirror: names.mirror(id),
                traces,
            },
        }
    }

    pub(crate) const fn comparison(&self) -> Option<&Comparison> {
        match self {
            Self::Compared(comparison) => Some(comparison),
            Self::Motor { .. } => None,
        }
    }

    /// Whether any of the motors has a value in these columns.
    pub(crate) fn is_seen(&self, history: &History, grid: Grid) -> bool {
        let newest = self.newest(history);
        newest.is_some_and(|newest| newest.as_micros() >= grid.left_us())
    }

    /// The recorded tracks of the drawn motors.
    fn tracks<'a>(&self, history: &'a History) -> impl Iterator<Item = &'a Track> + use<'a> {
        let ids: Vec<MotorId> = match self {
            Self::Motor { id, .. } => vec![*id],
            Self::Compared(comparison) => comparison.motors().map(|(_, id, _)| id).collect(),
        };
        ids.into_iter().filter_map(|id| history.track(id))
    }

    /// The time of the oldest kept reply.
    pub(crate) fn oldest(&self, history: &History) -> Option<Instant> {
        let oldest = self.tracks(history).filter_map(Track::oldest);
        oldest.map(|point| point.at).min()
    }

    /// The time of the newest reply.
    pub(crate) fn newest(&self, history: &History) -> Option<Instant> {
        let newest = self.tracks(history).filter_map(Track::newest);
        newest.map(|point| point.at).max()
    }
}

/// A time, marked if the motor is mirrored.
pub(crate) fn marked(when: String, mirror: Mirror) -> String {
    if mirror.is_mirrored() {
        tr!("{when}, mirrored", when)
    } else {
        when
    }
}

/// `0x01 Front left`, or only the ID of a motor without a name; `0x02 (mirrored)`.
pub(crate) fn motor_name(id: MotorId, names: &NamesAndSides) -> String {
    let mut words = id.to_string();
    let name = names.name(id);
    let mirrored = names.mirror(id).is_mirrored().then(|| tr!("(mirrored)"));
    for part in [name, mirrored.unwrap_or_default()] {
        if !part.is_empty() {
            words = words + " " + part;
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{
        history::tests::{sample, update},
        names_and_sides::Side,
        scan_texts::tests::id,
    };

    /// Motors of these IDs have each reported once, one millisecond after the other.
    fn history(ids: &[u8]) -> History {
        let mut history = History::default();
        let samples = (1_000..)
            .zip(ids)
            .map(|(at_ms, of)| sample(id(*of), at_ms, 5));
        history.take(&update(2_000, samples.collect(), vec![]));
        history
    }

    fn drawn(comparison: &Comparison) -> Vec<(usize, u8)> {
        let motors = comparison.motors();
        motors.map(|(place, id, _)| (place, id.get())).collect()
    }

    #[test]
    fn every_motor_that_reported_has_a_place_by_its_id() {
        let comparison = Comparison::new(
            Trace::Speed,
            &history(&[7, 2, 9]),
            &NamesAndSides::default(),
            id(7),
        );
        assert_eq!(drawn(&comparison), [(0, 2), (1, 7), (2, 9)]);
        assert_eq!(comparison.more(), None);
        let nobody = Comparison::new(
            Trace::Speed,
            &History::default(),
            &NamesAndSides::default(),
            id(7),
        );
        assert!(drawn(&nobody).is_empty());
    }

    #[test]
    fn beyond_eight_the_rest_is_said_and_the_chosen_one_is_drawn() {
        let history = history(&[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11]);
        let ids = |chosen| {
            let comparison = Comparison::new(
                Trace::Current,
                &history,
                &NamesAndSides::default(),
                id(chosen),
            );
            assert_eq!(comparison.more().unwrap(), "and 3 more, not shown");
            drawn(&comparison)
                .into_iter()
                .map(|(_, id)| id)
                .collect::<Vec<_>>()
        };
        assert_eq!(ids(3), [1, 2, 3, 4, 5, 6, 7, 8]);
        assert_eq!(ids(8), [1, 2, 3, 4, 5, 6, 7, 8]);
        assert_eq!(ids(9), [1, 2, 3, 4, 5, 6, 7, 9]);
        assert_eq!(ids(11), [1, 2, 3, 4, 5, 6, 7, 11]);
    }

    #[test]
    fn there_is_to_see_what_any_of_them_has_reported() {
        let history = history(&[4, 2, 3]);
        let of = |compared, chosen| {
            let mut traces = Traces::default();
            traces.compared = compared;
            let subject = Subject::new(&history, &NamesAndSides::default(), id(chosen), traces);
            let ends = subject.oldest(&history).zip(subject.newest(&history));
            ends.map(|(oldest, newest)| (oldest.as_micros(), newest.as_micros()))
        };
        assert_eq!(of(Some(Trace::Speed), 2), Some((1_000_000, 1_002_000)));
        assert_eq!(of(None, 2), Some((1_001_000, 1_001_000)));
        assert_eq!(of(None, 9), None);
    }

    #[test]
    fn a_motor_is_named_by_its_id_and_what_it_was_given() {
        let mut names = NamesAndSides::default();
        assert_eq!(motor_name(id(1), &names), "0x01");
        names.change(id(1), |member| member.set_name(" Front left "));
        assert_eq!(motor_name(id(1), &names), "0x01 Front left");
        names.change(id(1), |member| member.side = Side::Right);
        assert_eq!(motor_name(id(1), &names), "0x01 Front left (mirrored)");
        names.change(id(1), |member| member.side = Side::Left);
        names.change(id(1), |member| member.set_name("  "));
        assert_eq!(motor_name(id(1), &names), "0x01");
    }
}

//! The moments at which two runs are laid over each other.

use std::time::Duration;

use motorlink_messages::protocol::{Instant, Setpoint};

use crate::model::history::{GoalChange, Track};

/// Changes of the target that follow each other sooner are one change: a recording has each step of a ramp as a target
/// of its own, 20 ms apart at 50 Hz.
const ONE_CHANGE: Duration = Duration::from_millis(150);

/// The event that is laid over that of the other run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Align {
    /// The motor is driven after it was not.
    #[default]
    Start,
    /// It gets another target.
    NewTarget,
    /// It is driven no more.
    Stop,
}

impl Align {
    /// In the order of the list.
    pub(crate) const ALL: [Self; 3] = [Self::Start, Self::NewTarget, Self::Stop];

    /// Its name in the markup.
    pub(crate) const fn key(self) -> &'static str {
        match self {
            Self::Start => "start",
            Self::NewTarget => "target",
            Self::Stop => "stop",
        }
    }

    /// The last such moment up to a time.
    pub(crate) fn last(self, track: &Track, until: Instant) -> Option<Instant> {
        let moments = moments(track).take_while(|(change, _)| change.at <= until);
        let is_it = |(change, align): (&GoalChange, Self)| (align.is(self)).then_some(change.at);
        moments.filter_map(is_it).last()
    }

    /// A start gives a target too.
    fn is(self, other: Self) -> bool {
        self == other || (self, other) == (Self::Start, Self::NewTarget)
    }
}

/// The changes of the goal that are such a moment, with what it is.
pub(crate) fn moments(track: &Track) -> impl Iterator<Item = (&GoalChange, Align)> {
    let mut before = None;
    let mut changed: Option<Instant> = None;
    track.goals().filter_map(move |change| {
        let (was, is) = (driven_to(before), driven_to(change.goal));
        let is_one_change = changed.is_some_and(|at| change.at.since(at) < ONE_CHANGE);
        (changed, before) = (Some(change.at), change.goal);
        let align = match (was, is) {
            (None, Some(_)) => Align::Start,
            (Some(_), None) => Align::Stop,
            (Some(was), Some(is)) if is != was && !is_one_change => Align::NewTarget,
            _ => return None,
        };
        Some((change, align))
    })
}

/// The target of a change and of those that count as one with it: that of a slider when it comes to rest.
pub(crate) fn goal_after(track: &Track, change: &GoalChange) -> Option<Setpoint> {
    let mut last = *change;
    for next in track.goals().skip_while(|goal| goal.at <= change.at) {
        if next.at.since(last.at) >= ONE_CHANGE || driven_to(next.goal).is_none() {
            break;
        }
        last = *next;
    }
    last.goal
}

/// The brake ends a drive.
fn driven_to(goal: Option<Setpoint>) -> Option<Setpoint> {
    goal.filter(|goal| *goal != Setpoint::Brake)
}

/// How much later a kept run is drawn, in microseconds, so that its event is at the event of the shown run.
pub(crate) fn shift_us(kept: Instant, shown: Instant) -> i64 {
    let micros = |at: Instant| i64::try_from(at.as_micros()).unwrap_or(i64::MAX);
    micros(shown).saturating_sub(micros(kept))
}

#[cfg(test)]
pub(crate) mod tests {
    use motorlink_messages::{
        bus::{Activity, MotorStatus},
        protocol::{Mode, SpeedTarget},
    };

    use super::*;
    use crate::model::{
        history::{
            History,
            tests::{sample, update},
        },
        snapshot::tests::{ID, status},
    };

    pub(crate) fn rpm(rpm: i32) -> Activity {
        let setpoint = Setpoint::velocity(SpeedTarget::new(rpm).unwrap());
        Activity::Driven { setpoint }
    }

    /// The activity from each time on.
    fn history(activities: &[(u64, Activity)]) -> History {
        let mut history = History::default();
        for &(at_ms, activity) in activities {
            let motor = MotorStatus {
                activity,
                ..status(at_ms, Mode::Velocity, 0)
            };
            history.take(&update(at_ms, vec![sample(ID, at_ms, 0)], vec![motor]));
        }
        history
    }

    fn last_ms(history: &History, align: Align, until_ms: u64) -> Option<u64> {
        let until = Instant::from_micros(until_ms * 1_000);
        let last = align.last(history.track(ID).unwrap(), until)?;
        Some(last.as_micros() / 1_000)
    }

    const STOPPING: Activity = Activity::Stopping { confirmed: false };

    #[test]
    fn each_event_is_found_up_to_the_shown_time() {
        let history = history(&[
            (1_000, Activity::Idle),
            (2_000, rpm(50)),
            (3_000, rpm(100)),
            (4_000, STOPPING),
            (4_500, Activity::Idle),
            (6_000, rpm(80)),
            (7_000, Activity::Idle),
        ]);
        let at = |align, until_ms| last_ms(&history, align, until_ms);
        assert_eq!(at(Align::Start, 1_999), None);
        assert_eq!(at(Align::Start, 5_000), Some(2_000));
        assert_eq!(at(Align::Start, 9_000), Some(6_000));
        assert_eq!(at(Align::NewTarget, 5_000), Some(3_000));
        assert_eq!(at(Align::Stop, 5_000), Some(4_000), "the begin of the stop");
        assert_eq!(at(Align::Stop, 9_000), Some(7_000));
    }

    #[test]
    fn the_steps_of_a_ramp_are_one_change() {
        let ramp = (0..20).map(|step| (2_000 + 20 * step, rpm(i32::try_from(step).unwrap() + 1)));
        let mut activities = vec![(1_000, Activity::Idle)];
        activities.extend(ramp);
        activities.push((5_000, rpm(100)));
        let history = history(&activities);
        assert_eq!(last_ms(&history, Align::NewTarget, 4_000), Some(2_000));
        assert_eq!(last_ms(&history, Align::NewTarget, 6_000), Some(5_000));
    }

    #[test]
    fn a_shift_has_both_directions() {
        let at = Instant::from_micros;
        assert_eq!(shift_us(at(5), at(12)), 7);
        assert_eq!(shift_us(at(12), at(5)), -7);
    }
}

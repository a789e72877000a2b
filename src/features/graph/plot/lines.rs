//! Traces as lines: telemetry and setpoints.

use motorlink_messages::protocol::Instant;

use crate::{
    features::graph::plot::{
        columns::{Dot, Grid, Lines, Spread},
        trace::{self, Trace},
    },
    model::{
        history::{GoalChange, History, Track},
        mirror::Mirror,
    },
};

/// The lines of the reports, with gaps where nothing is known.
pub(crate) fn trace_lines(
    history: &History,
    track: &Track,
    of: Trace,
    mirror: Mirror,
    grid: Grid,
) -> Vec<Vec<Dot>> {
    let lines = Lines::new(grid);
    fill(lines, (history, track), of, mirror, grid).finish()
}

/// The lines of the means, and the columns of several values with their spread: a noisy trace fills its pane otherwise.
pub(crate) fn mean_lines(
    history: &History,
    track: &Track,
    of: Trace,
    mirror: Mirror,
    grid: Grid,
) -> (Vec<Vec<Dot>>, Vec<Spread>) {
    let lines = Lines::averaged(grid);
    fill(lines, (history, track), of, mirror, grid).finish_with_spreads()
}

fn fill(
    mut lines: Lines,
    (history, track): (&History, &Track),
    of: Trace,
    mirror: Mirror,
    grid: Grid,
) -> Lines {
    let (from, to) = ends(grid.left_us(), grid.right_us());
    let mut last: Option<(Instant, f32)> = None;
    for points in track.between(from, to) {
        for point in points {
            let Some(value) = of.value(point, mirror) else {
                continue;
            };
            if let Some((at, before)) = last
                && (of.wraps(before, value) || history.is_gap(at, point.at))
            {
                lines.cut();
            }
            lines.to(point.at.as_micros(), value);
            last = Some((point.at, value));
        }
    }
    lines
}

/// The goal while it had this quantity, up to now. The line has steps, because a goal is valid until it changes.
pub(crate) fn goal_lines(
    track: &Track,
    of: Trace,
    mirror: Mirror,
    grid: Grid,
    now_us: u64,
) -> Vec<Vec<Dot>> {
    let end_us = now_us.min(grid.right_us());
    let (from, to) = ends(grid.left_us(), end_us);
    let mut lines = Lines::new(grid);
    let mut standing = None;
    for GoalChange { at, goal } in track.goals_between(from, to) {
        // A goal from before the view begins at its left edge.
        let at_us = at.as_micros().max(grid.left_us());
        if let Some(value) = standing {
            lines.to(at_us, value);
        }
        let goal = goal.and_then(|goal| trace::of_setpoint(mirror.setpoint(goal)));
        standing = match goal {
            Some((quantity, value)) if quantity == of => {
                // The way from one angle to another is ambiguous.
                if standing.is_some_and(|standing| of.wraps(standing, value)) {
                    lines.cut();
                }
                lines.to(at_us, value);
                Some(value)
            }
            _ => {
                lines.cut();
                None
            }
        };
    }
    if let Some(value) = standing {
        lines.to(end_us, value);
    }
    lines.finish()
}

fn ends(from_us: u64, to_us: u64) -> (Instant, Instant) {
    (Instant::from_micros(from_us), Instant::from_micros(to_us))
}

#[cfg(test)]
mod tests {
    use motorlink_messages::{
        bus::{Activity, MotorStatus},
        protocol::{
            Celsius, CoarsePosition, CurrentTarget, Detail, Mode, Position, Setpoint, SpeedTarget,
        },
    };

    use super::*;
    use crate::model::{
        history::{
            History,
            tests::{sample, update},
        },
        snapshot::tests::{ID, status},
    };

    fn history(goals: &[(u64, Option<Setpoint>)]) -> History {
        let mut history = History::default();
        for &(at_ms, goal) in goals {
            let activity = match goal {
                Some(setpoint) => Activity::Driven { setpoint },
                None => Activity::Idle,
            };
            let motor = MotorStatus {
                activity,
                ..status(at_ms, Mode::Velocity, 0)
            };
            history.take(&update(at_ms, vec![sample(ID, at_ms, 0)], vec![motor]));
        }
        history
    }

    fn rpm(rpm: i32) -> Setpoint {
        Setpoint::velocity(SpeedTarget::new(rpm).unwrap())
    }

    /// Ten columns of 100 ms, from 1 s to 2 s.
    fn grid() -> Grid {
        Grid::new(1_000_000, 1_999_999, 10)
    }

    #[test]
    fn a_silence_is_not_bridged() {
        let mut history = History::default();
        let samples = [1_050, 1_150, 2_250, 2_350].map(|at_ms| sample(ID, at_ms, 7));
        history.take(&update(2_350, samples.to_vec(), vec![]));
        let grid = Grid::new(2_000_000, 2_999_999, 20);
        let lines = trace_lines(
            &history,
            history.track(ID).unwrap(),
            Trace::Speed,
            Mirror::Straight,
            grid,
        );
        assert_eq!(
            lines,
            [[(0.5, 7.0), (1.5, 7.0)], [(12.5, 7.0), (13.5, 7.0)]]
        );
    }

    /// The angle falls from 20 degrees through zero to 340, several times in one column. No line connects both ends
    /// of the scale.
    #[test]
    fn an_angle_that_wraps_draws_no_line_across() {
        let mut history = History::default();
        let samples = (0..400_u16).map(|step| {
            let mut sample = sample(ID, 1_000 + 2 * u64::from(step), 300);
            let raw = 32_767 - step.wrapping_mul(1_009) % 32_768;
            sample.reply.detail = Detail::Drive {
                position: Position::from_raw(raw),
            };
            sample
        });
        history.take(&update(1_800, samples.collect(), vec![]));
        let track = history.track(ID).unwrap();
        for count in [4, 10, 100, 1_000] {
            let grid = Grid::new(1_000_000, 1_999_999, count);
            let lines = trace_lines(&history, track, Trace::Position, Mirror::Straight, grid);
            assert!(lines.len() > 10, "it wraps a dozen times");
            for pair in lines.iter().flat_map(|line| line.windows(2)) {
                let [from, to] = pair else { unreachable!() };
                // The angle only falls; a rise would connect both ends of the scale.
                assert!(to.1 <= from.1 + 1e-9, "{from:?} to {to:?}");
            }
        }
    }

    #[test]
    fn a_trace_that_few_replies_hold_is_a_line_all_the_same() {
        let mut history = History::default();
        let samples = (0..100_u64).map(|step| {
            let mut sample = sample(ID, 1_000 + 10 * step, 0);
            if step % 10 == 0 {
                sample.reply.detail = Detail::Query {
                    temperature: Celsius::new(33),
                    position: CoarsePosition::from_raw(0),
                };
            }
            sample
        });
        history.take(&update(2_000, samples.collect(), vec![]));
        let lines = trace_lines(
            &history,
            history.track(ID).unwrap(),
            Trace::Temperature,
            Mirror::Straight,
            grid(),
        );
        assert_eq!(lines, [[(0.5, 33.0), (9.5, 33.0)]]);
    }

    #[test]
    fn a_goal_is_a_line_of_steps_up_to_now() {
        let history = history(&[(500, Some(rpm(50))), (1_350, Some(rpm(100))), (1_650, None)]);
        let lines = goal_lines(
            history.track(ID).unwrap(),
            Trace::Speed,
            Mirror::Straight,
            grid(),
            1_900_000,
        );
        assert_eq!(
            lines,
            [[(0.5, 50.0), (3.5, 50.0), (3.5, 100.0), (6.5, 100.0)]]
        );
    }

    /// The history keeps values as reported. If the motor is mirrored, all of them change sign, including the goal.
    #[test]
    fn of_a_mirrored_motor_report_and_goal_turn_together() {
        let history = history(&[(500, Some(rpm(50))), (1_350, None)]);
        let track = history.track(ID).unwrap();
        let goal = |mirror| goal_lines(track, Trace::Speed, mirror, grid(), 1_900_000);
        assert_eq!(goal(Mirror::Straight), [[(0.5, 50.0), (3.5, 50.0)]]);
        assert_eq!(goal(Mirror::Mirrored), [[(0.5, -50.0), (3.5, -50.0)]]);
        let mut history = History::default();
        let samples = [1_050, 1_150].map(|at_ms| sample(ID, at_ms, 7));
        history.take(&update(2_350, samples.to_vec(), vec![]));
        let track = history.track(ID).unwrap();
        let lines = trace_lines(&history, track, Trace::Speed, Mirror::Mirrored, grid());
        assert_eq!(lines, [[(0.5, -7.0), (1.5, -7.0)]]);
    }

    #[test]
    fn a_goal_that_stands_ends_now_and_not_at_the_edge() {
        let history = history(&[(500, Some(rpm(50)))]);
        let track = history.track(ID).unwrap();
        let lines = goal_lines(track, Trace::Speed, Mirror::Straight, grid(), 1_710_000);
        assert_eq!(lines, [[(0.5, 50.0), (7.5, 50.0)]]);
        let lines = goal_lines(track, Trace::Speed, Mirror::Straight, grid(), 7_000_000);
        assert_eq!(lines[0].last(), Some(&(10.0, 50.0)));
    }

    #[test]
    fn a_goal_is_in_the_trace_it_belongs_to() {
        let current = Setpoint::Current(CurrentTarget::new(32_767).unwrap());
        let history = history(&[
            (1_100, Some(rpm(50))),
            (1_300, Some(current)),
            (1_600, None),
        ]);
        let of = |trace| {
            goal_lines(
                history.track(ID).unwrap(),
                trace,
                Mirror::Straight,
                grid(),
                1_900_000,
            )
        };
        assert_eq!(of(Trace::Speed), [[(1.5, 50.0), (3.5, 50.0)]]);
        assert_eq!(of(Trace::Current), [[(3.5, 8.0), (6.5, 8.0)]]);
        assert!(of(Trace::Position).is_empty());
    }
}

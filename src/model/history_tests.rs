//! What the history keeps, and for how long.

use motorlink_messages::{
    bus::MotorStatus,
    protocol::{
        Celsius, CoarsePosition, Current, CurrentTarget, Detail, Faults, Mode, Position, Reply, Rpm,
    },
};

use super::*;
use crate::model::snapshot::tests::{ID, status};

const OTHER: MotorId = match MotorId::new(2) {
    Ok(id) => id,
    Err(_) => panic!("2 is an ID"),
};

/// A reply to a drive frame.
pub(crate) fn sample(id: MotorId, at_ms: u64, rpm: i16) -> Sample {
    Sample {
        at: Instant::from_millis(at_ms),
        reply: Reply {
            id,
            mode: Mode::Velocity,
            current: Some(Current::from_raw(rpm)),
            speed: Some(Rpm::new(rpm)),
            detail: Detail::Drive {
                position: Position::from_raw(6_095),
            },
            faults: Faults::NONE,
        },
    }
}

/// An update of the worker while a port is open.
pub(crate) fn update(now_ms: u64, samples: Vec<Sample>, motors: Vec<MotorStatus>) -> Update {
    Update {
        now: Instant::from_millis(now_ms),
        connection: Connection::Connected(Adapter::VIRTUAL),
        halted: false,
        motors,
        job: None,
        raw: None,
        line: None,
        samples,
        notices: vec![],
    }
}

fn disconnected(now_ms: u64) -> Update {
    Update {
        connection: Connection::Disconnected,
        ..update(now_ms, vec![], vec![])
    }
}

fn driven(at_ms: u64, activity: Activity) -> MotorStatus {
    MotorStatus {
        activity,
        ..status(at_ms, Mode::Velocity, 0)
    }
}

fn millis(at_ms: u64) -> Instant {
    Instant::from_millis(at_ms)
}

fn speeds<'a>(points: impl IntoIterator<Item = &'a Point>) -> Vec<i16> {
    points
        .into_iter()
        .map(|point| point.speed().unwrap().rpm())
        .collect()
}

/// The speeds of a stretch of time.
fn between(track: &Track, from_ms: u64, to_ms: u64) -> Vec<i16> {
    let pieces = track.between(millis(from_ms), millis(to_ms));
    speeds(pieces.into_iter().flatten())
}

#[test]
fn a_point_is_as_small_as_it_can_be() {
    assert_eq!(size_of::<Point>(), 16);
    assert!(size_of::<GoalChange>() <= 16);
}

#[test]
fn every_reply_of_every_motor_is_kept() {
    let mut history = History::default();
    history.take(&update(
        30,
        vec![
            sample(ID, 10, 1),
            sample(OTHER, 12, -7),
            sample(ID, 20, 2),
            sample(ID, 30, 3),
        ],
        vec![],
    ));
    let of = |id| between(history.track(id).unwrap(), 0, 99);
    assert_eq!(of(ID), [1, 2, 3]);
    assert_eq!(of(OTHER), [-7]);
    assert!(history.track(MotorId::new(3).unwrap()).is_none());
}

#[test]
fn replies_of_another_adapter_begin_a_graph_of_their_own() {
    let mut history = History::default();
    history.take(&update(20, vec![sample(ID, 10, 1)], vec![]));
    let real = Update {
        connection: Connection::Connected(Adapter::Serial(None)),
        ..update(40, vec![sample(ID, 30, 3)], vec![])
    };
    history.take(&real);
    assert_eq!(between(history.track(ID).unwrap(), 0, 99), [3]);
}

#[test]
fn a_stretch_of_time_comes_with_a_point_on_either_side() {
    let mut history = History::default();
    let samples = (1..=9_i16).map(|step| sample(ID, 10 * u64::from(step.unsigned_abs()), step));
    history.take(&update(90, samples.collect(), vec![]));
    let track = history.track(ID).unwrap();
    let of = |from, to| between(track, from, to);
    assert_eq!(of(30, 51), [2, 3, 4, 5, 6]);
    assert_eq!(of(33, 37), [3, 4], "between two points");
    assert_eq!(of(0, 500), [1, 2, 3, 4, 5, 6, 7, 8, 9]);
    assert_eq!(of(300, 500), [9]);
    assert_eq!(of(0, 5), [1]);
    assert!(of(50, 20).is_empty(), "it ends before it begins");
    let (before, after) = track.around(millis(50));
    assert_eq!(
        (speeds(before), speeds(after)),
        (vec![4, 3, 2, 1], vec![5, 6, 7, 8, 9])
    );
}

#[test]
fn what_comes_too_late_is_passed_over() {
    let mut history = History::default();
    let samples = vec![sample(ID, 20, 2), sample(ID, 10, 1), sample(ID, 20, 3)];
    history.take(&update(30, samples, vec![]));
    assert_eq!(between(history.track(ID).unwrap(), 0, 99), [2, 3]);
}

/// Ten minutes at the fastest rate of a command and ten queries a second.
#[test]
fn ten_minutes_at_full_rate_are_kept_and_the_oldest_give_way() {
    let mut track = Track::default();
    for count in 0..400_000_u64 {
        let Sample { at, reply } = sample(ID, count * 1_000 / 510, 0);
        track.take(Point::of(at, &reply));
    }
    let newest = track.newest().unwrap().at;
    let kept = newest.since(track.oldest().unwrap().at);
    assert!((599_990..=600_000).contains(&kept.as_millis()), "{kept:?}");
    assert!(track.points.len() >= 300_000 && track.points.len() <= POINTS_MAX);
}

/// After the oldest points were dropped, the ring buffer has two slices.
#[test]
fn a_stretch_of_time_may_lie_in_two_pieces() {
    let mut track = Track::default();
    for step in 0..800_000_u64 {
        let Sample { at, reply } = sample(ID, step, i16::try_from(step % 1_000).unwrap());
        track.take(Point::of(at, &reply));
    }
    let oldest = track.oldest().unwrap().at.as_micros() / 1_000;
    let pieces = track.between(millis(oldest), millis(800_000));
    assert!(pieces.iter().all(|piece| !piece.is_empty()), "two pieces");
    for (from, to) in [(oldest, 800_000), (500_000, 750_000), (oldest, oldest + 9)] {
        let wanted = (from.max(oldest + 1) - 1..=to).take_while(|at| *at < 800_000);
        let wanted: Vec<i16> = wanted
            .map(|at| i16::try_from(at % 1_000).unwrap())
            .collect();
        assert_eq!(between(&track, from, to), wanted);
    }
}

/// A clock that stands still must not fill the memory.
#[test]
fn the_number_of_points_is_bounded_whatever_the_clock_says() {
    let mut track = Track::default();
    for _ in 0..POINTS_MAX + 10 {
        let Sample { at, reply } = sample(ID, 5, 0);
        track.take(Point::of(at, &reply));
    }
    assert_eq!(track.points.len(), POINTS_MAX);
}

#[test]
fn the_goal_is_kept_where_it_changes() {
    let current = Setpoint::Current(CurrentTarget::new(4_096).unwrap());
    let mut history = History::default();
    for (now_ms, activity) in [
        (100, Activity::Idle),
        (200, Activity::Driven { setpoint: current }),
        (216, Activity::Driven { setpoint: current }),
        (300, Activity::Stopping { confirmed: false }),
        (316, Activity::Stopping { confirmed: true }),
        (400, Activity::Idle),
    ] {
        let samples = vec![sample(ID, now_ms - 1, 0)];
        history.take(&update(now_ms, samples, vec![driven(now_ms, activity)]));
    }
    let track = history.track(ID).unwrap();
    let goals = [50, 199, 200, 299, 300, 400].map(|at_ms| track.goal_at(millis(at_ms)));
    let (driven, braked) = (Some(current), Some(Setpoint::Brake));
    assert_eq!(goals, [None, None, driven, driven, braked, None]);
    let changes = track.goals_between(millis(250), millis(350));
    let at: Vec<Instant> = changes.map(|change| change.at).collect();
    assert_eq!(at, [millis(200), millis(300)], "with the one before");
}

#[test]
fn a_new_connection_begins_a_gap_and_ends_the_goal() {
    let goal = Activity::Driven {
        setpoint: Setpoint::Brake,
    };
    let mut history = History::default();
    history.take(&update(
        110,
        vec![sample(ID, 100, 1)],
        vec![driven(110, goal)],
    ));
    history.take(&disconnected(200));
    history.take(&update(300, vec![], vec![]));
    history.take(&update(
        410,
        vec![sample(ID, 400, 2), sample(ID, 410, 3)],
        vec![],
    ));
    let track = history.track(ID).unwrap();
    assert_eq!(between(track, 0, 999), [1, 2, 3]);
    assert!(
        history.is_gap(millis(100), millis(400)),
        "another connection"
    );
    assert!(!history.is_gap(millis(400), millis(410)));
    assert_eq!(track.goal_at(millis(199)), Some(Setpoint::Brake));
    assert_eq!(track.goal_at(millis(200)), None);
}

#[test]
fn a_second_of_silence_is_a_gap() {
    let history = History::default();
    assert!(!history.is_gap(millis(0), millis(1_000)));
    assert!(history.is_gap(millis(0), millis(1_001)));
}

#[test]
fn replies_wake_what_draws_them() {
    let woken = Rc::new(std::cell::Cell::new(0));
    let mut history = History::default();
    history.on_new_data(Rc::new({
        let woken = Rc::clone(&woken);
        move |update: Option<&Update>| woken.set(woken.get() + update.unwrap().samples.len())
    }));
    history.take(&update(1, vec![], vec![]));
    history.take(&update(2, vec![sample(ID, 2, 0), sample(ID, 2, 0)], vec![]));
    assert_eq!(woken.get(), 2);
}

#[test]
fn a_point_knows_what_its_reply_held() {
    let Sample { at, reply } = sample(ID, 5, 0);
    let of = |detail: Detail| Point::of(at, &Reply { detail, ..reply });
    let fine = of(reply.detail);
    assert!((fine.degrees().unwrap() - 66.96).abs() < 0.01);
    assert_eq!(fine.temperature(), None);
    let coarse = of(Detail::Query {
        temperature: Celsius::new(33),
        position: CoarsePosition::from_raw(51),
    });
    assert!((coarse.degrees().unwrap() - 72.0).abs() < 0.01);
    assert_eq!(coarse.temperature(), Some(Celsius::new(33)));
    assert_eq!(of(Detail::Undetermined([1, 2])).degrees(), None);
}

/// Samples of a session that ended a minute before this one began.
fn before(at_ms: impl IntoIterator<Item = u64>) -> Vec<Sample> {
    let samples = at_ms.into_iter().map(|at_ms| sample(ID, at_ms, 7));
    samples.collect()
}

fn on(history: &History, worker_ms: i64) -> Instant {
    let zero_ms = history.at(Instant::ZERO).as_micros() / 1_000;
    millis(zero_ms.saturating_add_signed(worker_ms))
}

#[test]
fn restored_samples_stand_at_their_times_before_the_present_ones_and_nothing_joins_them() {
    let mut history = History::with_past();
    history.take(&update(
        600,
        vec![sample(ID, 500, 1), sample(ID, 600, 2)],
        vec![],
    ));
    history.begin_past();
    // Their zero is a second before the worker's.
    history.recall(-1_000_000, &before([1_100, 1_200]));
    history.recall(-1_000_000, &before([900, 1_000]));
    let track = history.track(ID).unwrap();
    let (points, none) = track.around(on(&history, 9_999));
    let mut at: Vec<Instant> = points.map(|point| point.at).collect();
    at.reverse();
    let expected = [-100, 0, 100, 200, 500, 600].map(|ms| on(&history, ms));
    assert_eq!(at, expected);
    assert_eq!(none.count(), 0);
    let gap = |from, to| history.is_gap(on(&history, from), on(&history, to));
    assert!(gap(200, 500), "another session");
    assert!(!gap(0, 100) && !gap(500, 600));
}

#[test]
fn of_restored_samples_ten_minutes_are_kept_up_to_the_newest() {
    let mut history = History::with_past();
    history.recall(-3_600_000_000, &before([0, 599_000, 600_001]));
    let kept = |history: &History| {
        let track = history.track(ID).unwrap();
        speeds(track.around(on(history, 999_999)).0)
    };
    assert_eq!(kept(&history), [7, 7], "nothing newer is there");
    history.take(&update(10, vec![sample(ID, 10, 1)], vec![]));
    assert_eq!(kept(&history), [1]);
    history.recall(-3_600_000_000, &before([5]));
    assert_eq!(kept(&history), [1]);
}

#[test]
fn restored_samples_wake_what_draws_them_and_are_another_picture() {
    let woken = Rc::new(std::cell::Cell::new(0));
    let mut history = History::with_past();
    history.on_new_data(Rc::new({
        let woken = Rc::clone(&woken);
        move |update: Option<&Update>| woken.set(woken.get() + usize::from(update.is_none()))
    }));
    let pictures = [history.recalled(), {
        history.recall(0, &before([1]));
        history.recalled()
    }];
    assert_ne!(pictures[0], pictures[1]);
    assert_eq!(woken.get(), 1);
}

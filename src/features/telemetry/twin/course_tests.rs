//! The course against a wheel with a known true angle, updated as seldom as on the page.

use super::*;
use crate::{
    features::telemetry::twin::motion::{AngleQuality, Estimator, ReportedAngle},
    ui::frame_rate::{FrameRate, set_frame_rate},
};

/// The drawn frames, sixty a second, and the number of changes of course.
struct Drawn {
    /// Time, drawn angle and true angle.
    frames: Vec<(f64, f64, f64)>,
    corrections: usize,
}

impl Drawn {
    fn worst_off_deg(&self, from_ms: f64) -> f64 {
        let off = |(_, drawn, truth): &(f64, f64, f64)| {
            ((drawn - truth + 180.0).rem_euclid(360.0) - 180.0).abs()
        };
        let seen = self.frames.iter().filter(|(ms, ..)| *ms >= from_ms);
        seen.map(off).fold(0.0, f64::max)
    }
}

/// How often the worker posts readings, and how often while a motor is being stopped.
const POSTED_EVERY_MS: u32 = 50;
const POSTED_EVERY_STOPPING_MS: u32 = 17;

/// A wheel at these speeds, each for a number of milliseconds, with fifty reports a second.
fn drive(speeds: &[(f64, u32)]) -> Drawn {
    drive_posted(speeds, POSTED_EVERY_MS)
}

fn drive_posted(speeds: &[(f64, u32)], posted_every_ms: u32) -> Drawn {
    let mut estimator = Estimator::default();
    let mut course: Option<Course> = None;
    let mut drawn = Drawn {
        frames: Vec::new(),
        corrections: 0,
    };
    let (mut truth, mut now, mut looked) = (0.0, 0.0_f64, f64::NEG_INFINITY);
    let mut step = 0_u32;
    let mut waiting = Vec::new();
    for (rpm, ms) in speeds {
        for _ in 0..*ms {
            if step.is_multiple_of(20) {
                let angle = ReportedAngle {
                    degrees: f64::rem_euclid(truth, 360.0),
                    quality: AngleQuality::Fine,
                };
                waiting.push((now, angle));
            }
            if step.is_multiple_of(posted_every_ms) {
                for (reported, angle) in waiting.drain(..) {
                    estimator.report(reported, Some(angle), rpm.round());
                }
            }
            // One frame later than requested, as timers and frames are.
            if now - looked >= frame_rate().step_ms() + 16.0 {
                looked = now;
                let heading = estimator.frame(now).heading;
                let next = Course::next(course, heading, now);
                drawn.corrections += usize::from(next.is_some());
                course = next.or(course);
            }
            if let Some(course) = course.filter(|_| step.is_multiple_of(17)) {
                drawn.frames.push((now, course.angle_at(now), truth));
            }
            truth -= 6.0 * rpm / 1_000.0;
            now += 1.0;
            step += 1;
        }
    }
    drawn
}

#[test]
fn a_wheel_that_runs_evenly_is_seldom_sent_on_and_never_far_off() {
    for rpm in [20.0, 100.4, -210.3, 330.0] {
        let drawn = drive(&[(rpm, 10_000)]);
        assert!(
            drawn.worst_off_deg(1_000.0) < 4.0,
            "{rpm}: {}",
            drawn.worst_off_deg(1_000.0)
        );
        let corrections = drawn.corrections;
        assert!(corrections < 60, "{rpm}: {corrections} in 10 s");
    }
}

/// The looks are rarer at a lower rate, and the course is renewed in time.
#[test]
fn at_every_frame_rate_the_wheel_is_never_far_off() {
    for rate in [FrameRate::Hz30, FrameRate::Hz20, FrameRate::Hz10] {
        set_frame_rate(rate);
        for rpm in [20.0, 100.4, -210.3, 330.0] {
            let worst = drive(&[(rpm, 10_000)]).worst_off_deg(1_000.0);
            assert!(worst < 6.0, "{rate:?}, {rpm}: {worst}");
        }
    }
}

#[test]
fn steps_begin_at_multiples_of_their_length_and_stay_on_the_line() {
    let course = Course {
        from_ms: 1_020.0,
        until_ms: 1_400.0,
        angle_deg: 10.0,
        rate_deg_per_s: -600.0,
    };
    let (stepped, steps) = course.in_steps(50.0);
    assert!((stepped.from_ms - 1_000.0).abs() < 1e-9);
    assert!((stepped.until_ms - 1_400.0).abs() < 1e-9);
    assert!((steps - 8.0).abs() < 1e-9);
    assert!((stepped.angle_at(1_020.0) - 10.0).abs() < 1e-9);
    // A wheel that stands has one step.
    let (_, steps) = Course::standing(5.0, 999.0).in_steps(100.0);
    assert!((steps - 1.0).abs() < 1e-9);
}

#[test]
fn the_drawn_wheel_stands_where_the_wheel_stands() {
    let drawn = drive(&[(100.0, 1_500), (50.0, 60), (20.0, 60), (0.0, 1_000)]);
    let (_, angle, truth) = *drawn.frames.last().unwrap();
    assert!((angle - truth).abs() < 0.05, "{angle} {truth}");
}

#[test]
fn a_wheel_that_slows_down_is_never_turned_back() {
    let slower: Vec<_> = (0..60).map(|n| (f64::from(120 - n * 2), 20)).collect();
    let drawn = drive_posted(&slower, POSTED_EVERY_STOPPING_MS);
    for pair in drawn.frames.windows(2) {
        assert!(pair[1].1 <= pair[0].1 + 0.01, "{pair:?}");
    }
}

#[test]
fn without_reports_the_wheel_stops_by_itself() {
    let heading = Heading {
        way: Way::Turn,
        angle_deg: 10.0,
        rate_deg_per_s: -600.0,
        known_until_ms: 1_400.0,
    };
    let course = Course::begun(heading, 1_000.0);
    assert!((course.angle_at(1_400.0) + 230.0).abs() < 1e-9);
    let moved = course.angle_at(9_999.0) - course.angle_at(1_400.0);
    assert!(moved.abs() < f64::EPSILON);
}

#[test]
fn another_place_is_not_wound_to() {
    let heading = |angle_deg| Heading {
        way: Way::Turn,
        angle_deg,
        rate_deg_per_s: 0.0,
        known_until_ms: 500.0,
    };
    let course = Course::begun(heading(0.0), 0.0);
    let next = course.corrected(heading(100.0), 10.0).unwrap();
    assert!((next.angle_at(10.0) - 100.0).abs() < f64::EPSILON);
    assert_eq!(course.corrected(heading(0.01), 600.0), None);
}

/// The page was hidden, or another motor was chosen: the wheel jumps to its angle.
#[test]
fn a_way_that_nobody_saw_is_not_drawn() {
    let heading = |way, angle_deg| Heading {
        way,
        angle_deg,
        rate_deg_per_s: 0.0,
        known_until_ms: 500.0,
    };
    let course = Course::next(None, heading(Way::Jump, 0.0), 0.0);
    let next = Course::next(course, heading(Way::Jump, 80.0), 10.0).unwrap();
    assert!((next.angle_at(10.0) - 80.0).abs() < f64::EPSILON);
}

/// Disconnected at speed: the wheel stays as the browser drew it last.
#[test]
fn a_wheel_of_which_nothing_is_known_stays_as_it_is_drawn() {
    let turning = Heading {
        way: Way::Jump,
        angle_deg: 0.0,
        rate_deg_per_s: -1_200.0,
        known_until_ms: 500.0,
    };
    let course = Course::next(None, turning, 0.0);
    let unknown = Heading {
        way: Way::Stay,
        angle_deg: 0.0,
        rate_deg_per_s: 0.0,
        known_until_ms: 40.0,
    };
    let next = Course::next(course, unknown, 40.0).unwrap();
    assert!((next.angle_at(90.0) + 48.0).abs() < 1e-9);
    assert_eq!(Course::next(Some(next), unknown, 90.0), None);
}

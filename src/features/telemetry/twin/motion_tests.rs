//! The estimator against a wheel with a known true angle.

use super::*;

/// A simulated wheel and the reports of its motor.
struct Wheel {
    speed_rpm: f64,
    start_deg: f64,
}

impl Wheel {
    /// The true reported angle, unwrapped: it falls at positive speed.
    fn angle(&self, ms: f64) -> f64 {
        self.start_deg - 6.0 * self.speed_rpm * ms / 1_000.0
    }

    fn fine(&self, ms: f64) -> ReportedAngle {
        let raw = (self.angle(ms).rem_euclid(360.0) * 32_767.0 / 360.0).floor();
        ReportedAngle {
            degrees: raw * 360.0 / 32_767.0,
            quality: AngleQuality::Fine,
        }
    }

    /// The upper byte of the 15-bit angle; the host reads it as 360/255 degrees a step.
    fn coarse(&self, ms: f64) -> ReportedAngle {
        let raw = (self.angle(ms).rem_euclid(360.0) * 256.0 / 360.0).floor();
        ReportedAngle {
            degrees: raw * 360.0 / 255.0,
            quality: AngleQuality::Coarse,
        }
    }
}

fn fine(degrees: f64) -> ReportedAngle {
    ReportedAngle {
        degrees,
        quality: AngleQuality::Fine,
    }
}

/// A small jitter, -1 to 1, equal in every run, as timers and clocks have.
fn wobble(step: u32) -> f64 {
    (f64::from(step.wrapping_mul(2_654_435_761) >> 16) / 32_768.0) - 1.0
}

/// Draws ten seconds of 60 Hz frames. Reports reach the page `late_ms` after their measurement. Returns the greatest
/// error in degrees after the first second; every frame must go in the right direction.
fn worst_error(
    wheel: &Wheel,
    period_ms: f64,
    late_ms: f64,
    report: impl Fn(f64) -> ReportedAngle,
) -> f64 {
    let mut estimator = Estimator::default();
    let (mut measured_ms, mut reports) = (0.0, 0_u32);
    let mut last: Option<Pose> = None;
    let mut worst: f64 = 0.0;
    for frame in 0..600_u32 {
        let now = f64::from(frame) * 1_000.0 / 60.0;
        while measured_ms + late_ms <= now {
            estimator.report(
                measured_ms,
                Some(report(measured_ms)),
                wheel.speed_rpm.round(),
            );
            reports += 1;
            measured_ms = f64::from(reports) * period_ms + wobble(reports);
        }
        let pose = estimator.frame(now);
        if now < 100.0 {
            continue;
        }
        assert!(pose.fresh, "at {now} ms");
        if let Some(last) = last {
            let moved = pose.heading.angle_deg - last.heading.angle_deg;
            assert!(
                moved * wheel.speed_rpm < 0.0,
                "moved {moved} degrees at {now} ms at {} rpm",
                wheel.speed_rpm
            );
        }
        last = Some(pose);
        if now > 1_000.0 {
            let error = nearest(0.0, pose.heading.angle_deg - wheel.angle(now));
            worst = worst.max(error.abs());
        }
    }
    worst
}

#[test]
fn fine_reports_at_50_hz_are_followed_within_a_degree() {
    for speed_rpm in [100.0, -100.0, 330.0, -330.0, 7.0, 99.6, -200.4] {
        let wheel = Wheel {
            speed_rpm,
            start_deg: 66.9,
        };
        let worst = worst_error(&wheel, 20.0, 8.0, |ms| wheel.fine(ms));
        assert!(worst < 1.0, "{worst} degrees off at {speed_rpm} rpm");
    }
}

#[test]
fn coarse_reports_at_10_hz_are_followed_within_three_degrees() {
    for speed_rpm in [100.0, -100.0, 330.0, -330.0, 12.0] {
        let wheel = Wheel {
            speed_rpm,
            start_deg: 200.0,
        };
        let worst = worst_error(&wheel, 100.0, 8.0, |ms| wheel.coarse(ms));
        assert!(worst < 3.0, "{worst} degrees off at {speed_rpm} rpm");
    }
}

/// Drive and query replies are mixed: the coarse ones must not make the wheel jitter.
#[test]
fn coarse_reports_between_fine_ones_do_no_harm() {
    for speed_rpm in [100.0, -330.0] {
        let wheel = Wheel {
            speed_rpm,
            start_deg: 1.0,
        };
        let mixed = |ms: f64| {
            if (ms / 20.0).round() % 5.0 == 0.0 {
                wheel.coarse(ms)
            } else {
                wheel.fine(ms)
            }
        };
        let worst = worst_error(&wheel, 20.0, 3.0, mixed);
        assert!(worst < 1.0, "{worst} degrees off at {speed_rpm} rpm");
    }
}

/// A quarter of a second without a report is most of a turn at 200 rpm; the speed tells which turn it is.
#[test]
fn a_gap_costs_no_turn() {
    let wheel = Wheel {
        speed_rpm: 200.0,
        start_deg: 0.0,
    };
    let mut estimator = Estimator::default();
    for ms in [0.0, 20.0, 40.0, 290.0, 310.0, 760.0, 780.0] {
        estimator.report(ms, Some(wheel.fine(ms)), 200.0);
    }
    let turned = -estimator.frame(780.0).heading.angle_deg / 360.0;
    assert!((turned - 2.6).abs() < 0.01, "{turned}");
}

#[test]
fn a_report_without_an_angle_goes_on_by_speed() {
    let mut estimator = Estimator::default();
    estimator.report(0.0, None, 100.0);
    assert!(
        !estimator.frame(0.0).fresh,
        "no angle has been reported yet"
    );
    estimator.report(10.0, Some(fine(90.0)), 100.0);
    estimator.report(110.0, None, 100.0);
    assert!((estimator.frame(110.0).heading.angle_deg - 30.0).abs() < 1e-9);
}

#[test]
fn stale_reports_spin_nothing() {
    let mut estimator = Estimator::default();
    estimator.report(0.0, Some(fine(180.0)), 100.0);
    let at_the_end = estimator.frame(FRESH_MS);
    assert!(at_the_end.fresh);
    let later = estimator.frame(FRESH_MS + 1.0);
    assert!(!later.fresh && later.settled);
    assert!((later.heading.angle_deg - at_the_end.heading.angle_deg).abs() < 1e-9);
    let much_later = estimator.frame(60_000.0);
    assert!(!much_later.fresh && much_later.settled);
    assert!((much_later.heading.angle_deg - later.heading.angle_deg).abs() < 1e-9);
}

/// If the drawn wheel is ahead of the reports, it waits and does not turn back.
#[test]
fn an_error_melts_without_a_step_back() {
    let mut estimator = Estimator::default();
    estimator.report(0.0, Some(fine(200.0)), -60.0);
    let mut last = estimator.frame(0.0).heading.angle_deg;
    for frame in 1..=60_u32 {
        let now = f64::from(frame) * 1_000.0 / 60.0;
        // From 100 ms on the true wheel is 30 degrees behind what was expected.
        let behind = if now < 100.0 { 0.0 } else { 30.0 };
        let truth = 200.0 + 0.36 * now - behind;
        estimator.report(now, Some(fine(truth.rem_euclid(360.0))), -60.0);
        let pose = estimator.frame(now);
        let moved = pose.heading.angle_deg - last;
        assert!(
            (2.9..=6.1).contains(&moved),
            "{moved} degrees in frame {frame}"
        );
        last = pose.heading.angle_deg;
    }
    let truth = 200.0 + 360.0 - 30.0;
    assert!(nearest(0.0, last - truth).abs() < 0.5, "{last}");
}

#[test]
fn an_error_of_more_than_a_quarter_turn_is_taken_at_once() {
    let mut estimator = Estimator::default();
    estimator.report(0.0, Some(fine(10.0)), 0.0);
    estimator.frame(0.0);
    estimator.report(20.0, Some(fine(130.0)), 0.0);
    assert!((estimator.frame(20.0).heading.angle_deg - 130.0).abs() < 1e-9);
}

#[test]
fn a_standing_wheel_eases_and_then_rests() {
    let mut estimator = Estimator::default();
    estimator.report(0.0, Some(fine(10.0)), 0.0);
    estimator.frame(0.0);
    estimator.report(10.0, Some(fine(20.0)), 0.0);
    let first = estimator.frame(17.0);
    assert!(
        first.heading.angle_deg > 10.0 && first.heading.angle_deg < 12.0,
        "{first:?}"
    );
    assert!(!first.settled);
    let mut last = first;
    for frame in 2..=120_u32 {
        let now = f64::from(frame) * 1_000.0 / 60.0;
        estimator.report(now, Some(fine(20.0)), 0.0);
        last = estimator.frame(now);
    }
    assert!(
        last.settled && (last.heading.angle_deg - 20.0).abs() < 0.05,
        "{last:?}"
    );
}

/// The page was hidden: the wheel jumps to the present angle.
#[test]
fn a_page_that_comes_back_shows_the_truth_at_once() {
    let wheel = Wheel {
        speed_rpm: 40.0,
        start_deg: 0.0,
    };
    let mut estimator = Estimator::default();
    estimator.report(0.0, Some(wheel.fine(0.0)), 40.0);
    estimator.frame(0.0);
    for step in 1..=500 {
        let ms = f64::from(step) * 20.0;
        estimator.report(ms, Some(wheel.fine(ms)), 40.0);
    }
    let pose = estimator.frame(10_000.0);
    assert!((pose.heading.angle_deg - wheel.angle(10_000.0)).abs() < 0.1);
}

#[test]
fn late_and_mad_reports_change_nothing() {
    let mut estimator = Estimator::default();
    estimator.report(100.0, Some(fine(90.0)), 10.0);
    let before = estimator.clone();
    estimator.report(80.0, Some(fine(10.0)), 300.0);
    estimator.report(f64::NAN, Some(fine(10.0)), 300.0);
    estimator.report(120.0, Some(fine(10.0)), f64::INFINITY);
    assert_eq!(estimator, before);
    estimator.report(100.0, Some(fine(f64::NAN)), 10.0);
    assert_eq!(estimator, before);
}

/// After the clock goes back by more than a second, the estimator restarts.
#[test]
fn another_clock_starts_again() {
    let mut estimator = Estimator::default();
    estimator.report(500_000.0, Some(fine(90.0)), 10.0);
    estimator.report(1_000.0, Some(fine(45.0)), 0.0);
    let pose = estimator.frame(1_000.0);
    assert!(pose.fresh && (pose.heading.angle_deg - 45.0).abs() < 1e-9);
}

#[test]
fn clearing_keeps_the_wheel_where_it_is() {
    let mut estimator = Estimator::default();
    estimator.report(0.0, Some(fine(300.0)), -60.0);
    estimator.frame(0.0);
    estimator.report(250.0, Some(fine(30.0)), -60.0);
    estimator.frame(250.0);
    estimator.clear();
    let pose = estimator.frame(300.0);
    assert!(
        !pose.fresh && (pose.heading.angle_deg - 30.0).abs() < 1e-9,
        "{pose:?}"
    );
}

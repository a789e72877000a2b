use std::f64::consts::PI;

use motorlink_protocol::MotorId;

use super::*;

const MS: u64 = 1_000;
const RADIUS: f64 = 50.0;
const TRACK: f64 = 300.0;

/// A vehicle with two or more wheels: 0, 2, .. on the left and 1, 3, .. on the right.
fn odometer(wheels: u8) -> Odometer {
    let wheel = |number: u8| Wheel {
        id: MotorId::new(number).unwrap(),
        is_right: number.is_multiple_of(2),
        name: String::new(),
    };
    let vehicle = Vehicle::new((1..=wheels).map(wheel).collect()).unwrap();
    Odometer::new(&vehicle, Geometry::new(50, 300).unwrap())
}

#[allow(
    clippy::cast_precision_loss,
    reason = "a few seconds in microseconds are exact"
)]
/// The replies of a wheel at a constant speed, in the wheel's own direction.
fn reports(rpm: f64, from_us: u64, to_us: u64, every_us: u64) -> impl Iterator<Item = Report> {
    (from_us..=to_us)
        .step_by(usize::try_from(every_us).unwrap())
        .map(move |at_us| Report {
            at_us,
            angle: Some(((-6.0 * rpm * at_us as f64 / 1e6).rem_euclid(360.0), 0.0)),
            rpm: rpm.round(),
            is_cut_off: false,
        })
}

/// Drives for a time; forward is positive on both sides.
fn drive(left_rpm: f64, right_rpm: f64, to_us: u64) -> Odometer {
    let mut odometer = odometer(2);
    for report in reports(left_rpm, 0, to_us, 20 * MS) {
        odometer.report(0, report);
    }
    // Mounted mirrored.
    for report in reports(-right_rpm, 0, to_us, 20 * MS) {
        odometer.report(1, report);
    }
    odometer.advance_from_zero();
    odometer
}

impl Odometer {
    /// Counts from the first reply on.
    fn advance_from_zero(&mut self) -> Vec<Link> {
        self.counted_us = Some(0);
        let mut links = Vec::new();
        self.advance(|step| links.push(step.link));
        links
    }
}

#[track_caller]
fn assert_pose(odometer: &Odometer, x: f64, y: f64, heading_deg: f64) {
    let pose = odometer.pose();
    let near = |a: f64, b: f64| (a - b).abs() < 1e-6 * b.abs().max(1.0);
    assert!(
        near(pose.x, x) && near(pose.y, y) && near(pose.heading_deg, heading_deg),
        "{pose:?} instead of {x} {y} {heading_deg}"
    );
}

#[test]
fn straight_ahead_is_the_circumference_for_each_turn() {
    // 60 rpm for 10 s are ten turns.
    let odometer = drive(60.0, 60.0, 10_000 * MS);
    assert_pose(&odometer, 0.0, 10.0 * 2.0 * PI * RADIUS, 0.0);
    assert!((odometer.driven_mm() - 10.0 * 2.0 * PI * RADIUS).abs() < 1e-6);
    assert_pose(
        &drive(-60.0, -60.0, 1_000 * MS),
        0.0,
        -2.0 * PI * RADIUS,
        0.0,
    );
}

/// Ten seconds at 100 rpm with random angles.
#[test]
fn a_vehicle_whose_angles_are_random_goes_by_its_speeds() {
    let mut odometer = odometer(2);
    let mut seed = 1_u32;
    for (place, sign) in [(0, 1.0), (1, -1.0)] {
        for report in reports(sign * 100.0, 0, 10_000 * MS, 20 * MS) {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let angle = f64::from(seed) / f64::from(u32::MAX) * 360.0;
            let angle = Some((angle, 0.0));
            odometer.report(place, Report { angle, ..report });
        }
    }
    odometer.advance_from_zero();
    let driven = odometer.driven_mm();
    assert!((driven / 5_236.0 - 1.0).abs() < 0.02, "{driven} mm");
    assert_eq!(odometer.misfit(), Some(0));
    assert_eq!(drive(100.0, 100.0, 10_000 * MS).misfit(), None);
}

#[test]
fn wheels_against_each_other_turn_on_the_spot_clockwise_where_the_left_goes_ahead() {
    // Each wheel rolls a quarter of the circle with the track as its diameter.
    let turns = (PI * TRACK / 4.0) / (2.0 * PI * RADIUS);
    let odometer = drive(60.0 * turns, -60.0 * turns, 1_000 * MS);
    assert_pose(&odometer, 0.0, 0.0, 90.0);
    assert!(odometer.driven_mm().abs() < 1e-6, "the middle stays");
}

/// The left wheel on a radius of 650 mm, the right one on 350 mm: a quarter circle to the right about (500, 0).
#[test]
fn a_curve_is_an_exact_arc() {
    let rpm = |radius: f64| (PI / 2.0 * radius) / (2.0 * PI * RADIUS) / 2.0 * 60.0;
    let odometer = drive(rpm(650.0), rpm(350.0), 2_000 * MS);
    assert_pose(&odometer, 500.0, 500.0, 90.0);
    assert!((odometer.driven_mm() - PI / 2.0 * 500.0).abs() < 1e-6);
    // A whole circle, the other way round, ends where it began.
    let circle = drive(2.0 * rpm(350.0), 2.0 * rpm(650.0), 4_000 * MS);
    assert_pose(&circle, 0.0, 0.0, -360.0);
}

#[test]
fn an_arc_of_any_angle_ends_where_one_in_many_pieces_ends() {
    for (left, right) in [(100.0, 99.999), (100.0, 40.0), (30.0, -200.0), (0.0, 150.0)] {
        let whole = Pose::default().moved(left, right, TRACK);
        let mut pieces = Pose::default();
        for _ in 0..1_000 {
            pieces = pieces.moved(left / 1e3, right / 1e3, TRACK);
        }
        let off = (whole.x - pieces.x).abs() + (whole.y - pieces.y).abs();
        assert!(off < 1e-6, "{left} {right}: {whole:?} {pieces:?}");
    }
}

#[test]
fn wheels_of_one_side_count_by_their_mean() {
    let mut odometer = odometer(4);
    for (place, rpm) in [(0, 58.0), (2, 62.0), (1, -60.0), (3, -60.0)] {
        for report in reports(rpm, 0, 1_000 * MS, 20 * MS) {
            odometer.report(place, report);
        }
    }
    let links = odometer.advance_from_zero();
    assert_pose(&odometer, 0.0, 2.0 * PI * RADIUS, 0.0);
    assert!(links.iter().all(|link| *link == Link::Known));
}

/// A wheel in the middle of a gap is left out as long as another one of its side is known.
#[test]
fn a_side_goes_by_the_wheels_that_are_known_best() {
    let mut odometer = odometer(4);
    for place in [0, 1, 3] {
        let rpm = if place == 0 { 60.0 } else { -60.0 };
        for report in reports(rpm, 0, 2_000 * MS, 20 * MS) {
            odometer.report(place, report);
        }
    }
    // Wheel 2 says that it stands, twice, a gap apart.
    for report in reports(0.0, 0, 2_000 * MS, 500 * MS) {
        odometer.report(2, report);
    }
    let links = odometer.advance_from_zero();
    assert_pose(&odometer, 0.0, 2.0 * 2.0 * PI * RADIUS, 0.0);
    assert!(links.iter().all(|link| *link == Link::Known));
}

#[test]
fn lost_replies_are_bridged_and_marked() {
    let mut odometer = odometer(2);
    for report in reports(60.0, 0, 2_000 * MS, 20 * MS) {
        odometer.report(0, report);
    }
    let kept = |report: &Report| !(600 * MS + 1..1_200 * MS).contains(&report.at_us);
    for report in reports(-60.0, 0, 2_000 * MS, 20 * MS).filter(kept) {
        odometer.report(1, report);
    }
    let links = odometer.advance_from_zero();
    assert_pose(&odometer, 0.0, 2.0 * 2.0 * PI * RADIUS, 0.0);
    let bridged = links.iter().filter(|link| **link == Link::Bridged).count();
    assert_eq!(bridged, 30, "600 ms in ticks of 20 ms");
    assert!(!links.contains(&Link::Unknown));
}

#[test]
fn where_a_side_is_unknown_the_vehicle_stays_and_the_gap_is_marked() {
    let mut odometer = odometer(2);
    for report in reports(60.0, 0, 6_000 * MS, 20 * MS) {
        odometer.report(0, report);
    }
    let kept = |report: &Report| !(2_000 * MS + 1..4_000 * MS).contains(&report.at_us);
    for report in reports(-60.0, 0, 6_000 * MS, 20 * MS).filter(kept) {
        odometer.report(1, report);
    }
    let links = odometer.advance_from_zero();
    assert_pose(&odometer, 0.0, 4.0 * 2.0 * PI * RADIUS, 0.0);
    let unknown = links.iter().filter(|link| **link == Link::Unknown).count();
    assert_eq!(unknown, 100, "two seconds in ticks of 20 ms");
}

/// Neither an old start nor the wait for a silent wheel holds up the others.
#[test]
fn a_wheel_that_never_reports_is_waited_for_a_second() {
    let mut odometer = odometer(2);
    for report in reports(60.0, 0, 5_000 * MS, 20 * MS) {
        odometer.report(0, report);
    }
    let links = odometer.advance_from_zero();
    assert_eq!(links.len(), 200, "up to a second before the newest reply");
    assert!(links.iter().all(|link| *link == Link::Unknown));
    assert_eq!(odometer.pose(), Pose::default());
}

#[test]
fn counting_begins_with_the_first_replies_of_all_wheels() {
    let mut odometer = odometer(2);
    let mut steps = 0;
    for at in 0..50 {
        for (place, rpm) in [(0, 60.0), (1, -60.0)] {
            for report in reports(
                rpm,
                9_000 * MS + at * 20 * MS,
                9_000 * MS + at * 20 * MS,
                MS,
            ) {
                odometer.report(place, report);
            }
        }
        odometer.advance(|Step { link, .. }| {
            assert_eq!(link, Link::Known);
            steps += 1;
        });
    }
    assert_eq!(steps, 49);
    assert_pose(&odometer, 0.0, 0.98 * 2.0 * PI * RADIUS, 0.0);
}

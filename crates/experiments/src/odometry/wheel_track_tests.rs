use super::*;

const MS: u64 = 1_000;

/// A reply of a drive frame at this angle.
fn fine(at_us: u64, degrees: f64, rpm: f64) -> Report {
    Report {
        at_us,
        angle: Some((degrees.rem_euclid(360.0), 0.0)),
        rpm,
        is_cut_off: false,
    }
}

fn track(reports: impl IntoIterator<Item = Report>) -> WheelTrack {
    let mut track = WheelTrack::default();
    for report in reports {
        track.report(report);
    }
    track
}

#[track_caller]
fn assert_way(track: &WheelTrack, from_us: u64, to_us: u64, turns: f64, link: Link) {
    let (way, known) = track.turns_between(from_us, to_us).expect("a way");
    assert!((way - turns).abs() < 1e-9, "{way} instead of {turns} turns");
    assert_eq!(known, link);
}

/// The reported speed is rounded to 1 rpm; the angle is not.
#[test]
fn the_angle_tells_the_way_and_the_speed_only_the_turn() {
    // 100.5 rpm make the angle fall by 12.06 degrees in 20 ms.
    let reports = (0..=500_u32).map(|n| fine(u64::from(n) * 20 * MS, -12.06 * f64::from(n), 100.0));
    assert_way(&track(reports), 0, 10_000 * MS, 16.75, Link::Known);
}

#[test]
fn a_wheel_that_turns_back_has_gone_nowhere() {
    let there = (0..=10_u32).map(|n| fine(u64::from(n) * 20 * MS, -12.0 * f64::from(n), 100.0));
    let back = (1..=10_u32).map(|n| {
        fine(
            u64::from(10 + n) * 20 * MS,
            -120.0 + 12.0 * f64::from(n),
            -100.0,
        )
    });
    assert_way(&track(there.chain(back)), 0, 400 * MS, 0.0, Link::Known);
}

#[test]
fn a_coarse_angle_does_not_move_a_wheel_that_stands_or_shift_one_that_turns() {
    let coarse = |at_us, degrees: f64, rpm| {
        let step = 360.0 / 255.0;
        Report {
            angle: Some(((degrees.rem_euclid(360.0) / step).floor() * step, step)),
            ..fine(at_us, degrees, rpm)
        }
    };
    let standing = (0..20).map(|n| coarse(n * 100 * MS, 77.0, 0.0));
    assert_way(&track(standing), 0, 1_900 * MS, 0.0, Link::Known);
    let turning = (0..=50_u32).map(|n| coarse(u64::from(n) * 20 * MS, -12.0 * f64::from(n), 100.0));
    let (way, _) = track(turning).turns_between(0, 1_000 * MS).unwrap();
    assert!((way - 600.0 / 360.0).abs() < 2.0 / 255.0, "{way}");
}

#[test]
fn a_gap_is_bridged_by_the_reported_speeds_and_says_so() {
    // Half a second without a reply, 60 rpm before and 120 rpm after it.
    let track = track([
        fine(0, 0.0, 60.0),
        fine(20 * MS, -7.2, 60.0),
        fine(520 * MS, 123.0, 120.0),
        fine(540 * MS, 108.6, 120.0),
    ]);
    assert_way(&track, 0, 20 * MS, 0.02, Link::Known);
    assert_way(&track, 20 * MS, 520 * MS, 0.75, Link::Bridged);
    assert_way(&track, 520 * MS, 540 * MS, 0.04, Link::Known);
    // Half of the gap is half of the way.
    assert_way(&track, 20 * MS, 270 * MS, 0.375, Link::Bridged);
}

#[test]
fn over_a_long_gap_nothing_is_invented() {
    let mut track = track([fine(0, 0.0, 100.0), fine(1_001 * MS, 200.0, 100.0)]);
    assert_eq!(track.turns_between(0, 1_001 * MS), None);
    assert_eq!(track.turns_between(500 * MS, 520 * MS), None);
    // From there on it is known again, by the angle after the gap.
    track.report(fine(1_021 * MS, 188.0, 100.0));
    assert_way(&track, 1_001 * MS, 1_021 * MS, 12.0 / 360.0, Link::Known);
    assert_eq!(track.turns_between(1_000 * MS, 1_021 * MS), None);
}

#[test]
fn another_connection_is_a_gap_however_short() {
    let after = Report {
        is_cut_off: true,
        ..fine(20 * MS, 0.0, 100.0)
    };
    let track = track([fine(0, 0.0, 100.0), after]);
    assert_eq!(track.turns_between(0, 20 * MS), None);
}

#[test]
fn what_is_not_reported_yet_is_unknown_and_old_replies_are_skipped() {
    let mut track = track([fine(0, 0.0, 100.0), fine(20 * MS, -12.0, 100.0)]);
    assert_eq!(track.turns_between(0, 40 * MS), None);
    let before = track.clone();
    track.report(fine(20 * MS, 90.0, -100.0));
    track.report(fine(5 * MS, 90.0, -100.0));
    assert_eq!(track, before);
}

#[test]
fn what_was_counted_is_forgotten_and_the_rest_stays() {
    let mut track =
        track((0..=100_u32).map(|n| fine(u64::from(n) * 20 * MS, -12.0 * f64::from(n), 100.0)));
    track.forget_before(1_990 * MS);
    assert_eq!(track.knots.len(), 2);
    assert_way(&track, 1_990 * MS, 2_000 * MS, 1.0 / 60.0, Link::Known);
}

/// The replies of ten seconds at 100 rpm, with these angles.
fn at_100_rpm(every_us: u64, mut angle: impl FnMut() -> f64) -> WheelTrack {
    let times = (0..=10_000 * MS).step_by(usize::try_from(every_us).unwrap());
    track(times.map(|at_us| fine(at_us, angle(), 100.0)))
}

/// `DDTRobot/motor-driver-examples#1`: a motor whose angle stays.
#[test]
fn an_angle_that_stays_or_jumps_leaves_the_way_to_the_speed() {
    for every_us in [5 * MS, 20 * MS, 100 * MS] {
        let mut seed = 7_u32;
        let noise = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(seed) / f64::from(u32::MAX) * 360.0
        };
        let tracks = [at_100_rpm(every_us, || 41.1), at_100_rpm(every_us, noise)];
        for track in tracks {
            let (way, link) = track.turns_between(0, 10_000 * MS).unwrap();
            assert!((way / (1_000.0 / 60.0) - 1.0).abs() < 0.02, "{way} turns");
            assert_eq!(link, Link::Bridged);
            assert!(track.angle_misfits());
        }
    }
}

#[test]
fn an_angle_that_follows_again_for_a_turn_tells_the_way_again() {
    let angle = |n: u32| -12.06 * f64::from(n);
    let stays = (0..100_u32).map(|n| fine(u64::from(n) * 20 * MS, 30.0, 100.0));
    let follows = (100..=200_u32).map(|n| fine(u64::from(n) * 20 * MS, angle(n), 100.0));
    let track = track(stays.chain(follows));
    assert!(!track.angle_misfits());
    assert_way(&track, 3_000 * MS, 4_000 * MS, 1.675, Link::Known);
}

/// A wheel to 200 rpm and back within 0.2 s each, whose reported speed lags by 30 ms.
#[test]
fn a_speed_that_lags_does_not_make_the_angle_misfit() {
    let (mut rpm, mut lagging, mut degrees) = (0.0_f64, 0.0, 0.0_f64);
    let mut track = WheelTrack::default();
    track.report(fine(0, degrees, 0.0));
    for n in 1..2_000_u64 {
        let to = if n % 200 < 100 { 200.0 } else { -200.0 };
        rpm = limited(to, rpm - 5.0, rpm + 5.0);
        lagging += (rpm - lagging) * 5.0 / 30.0;
        degrees -= rpm * 6.0 * 0.005;
        track.report(fine(n * 5 * MS, degrees, lagging.round()));
        assert!(!track.angle_misfits(), "{} ms", n * 5);
    }
    let (way, _) = track.turns_between(0, 1_999 * 5 * MS).unwrap();
    assert!((way + degrees / 360.0).abs() < 1e-6, "{way}");
}

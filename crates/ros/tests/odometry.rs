//! The odometry against the true way of the virtual wheels.

use std::{
    f64::consts::{PI, TAU},
    sync::{Arc, Mutex},
    thread::sleep,
    time::{Duration, Instant},
};

use hiroz_msgs::nav_msgs::Odometry;

use crate::bench::{Asking, Bench};

const RADIUS_M: f64 = 0.05;
const TRACK_M: f64 = 0.3;

/// Where the robot truly is, from the angles of its virtual wheels.
#[derive(Default)]
struct Truth {
    angles: Option<[f64; 2]>,
    x: f64,
    y: f64,
    heading: f64,
    way: f64,
}

impl Truth {
    fn follow(&mut self, bench: &mut Bench) {
        let angles = [bench.motors.angle(1), bench.motors.angle(2)];
        let Some(before) = self.angles.replace(angles) else {
            return;
        };
        // Less than half a turn since.
        let turned = |index: usize| {
            let turned = angles[index] - before[index];
            (turned - 360.0 * (turned / 360.0).round()).to_radians() * RADIUS_M
        };
        // The angle of these motors falls at positive speed, and the right one is mounted mirrored.
        let (left, right) = (-turned(0), turned(1));
        let (ahead, turn) = (f64::midpoint(left, right), (right - left) / TRACK_M);
        let mean = self.heading + turn / 2.0;
        self.x += ahead * mean.cos();
        self.y += ahead * mean.sin();
        self.heading += turn;
        self.way += ahead.abs();
    }
}

/// Drives so far with turns, and returns how far off the odometry is: in m, in degrees, and the way in m.
fn drive(metres: f64) -> (f64, f64, f64) {
    let mut bench = Bench::start(&[]);
    let node = bench.node();
    let told = Arc::new(Mutex::new(None::<Odometry>));
    let newest = Arc::clone(&told);
    let _subscriber = node
        .create_sub::<Odometry>("odom")
        .build_with_callback(move |message| *newest.lock().unwrap() = Some(message))
        .unwrap();
    let asking = Asking::new(&node);
    bench
        .motors
        .until("odometry", |_| told.lock().unwrap().is_some());
    let mut truth = Truth::default();
    let began = Instant::now();
    let twists = [
        (0.9, 0.0),
        (0.7, 1.5),
        (0.9, -0.4),
        (0.0, -1.5),
        (0.5, 0.8),
        (-0.4, 0.3),
    ];
    while truth.way < metres {
        // Each for 2 s.
        let index = usize::try_from(began.elapsed().as_secs() / 2).unwrap() % twists.len();
        asking.ask(Some(twists[index]));
        truth.follow(&mut bench);
        sleep(Duration::from_millis(5));
        assert!(began.elapsed() < Duration::from_secs(60) + 4 * Duration::from_secs_f64(metres));
    }
    asking.ask(None);
    let until = Instant::now() + Duration::from_secs(2);
    while Instant::now() < until {
        truth.follow(&mut bench);
        sleep(Duration::from_millis(5));
    }
    assert!(bench.motors.stand());
    let odometry = told.lock().unwrap().clone().unwrap();
    let (place, direction) = (odometry.pose.pose.position, odometry.pose.pose.orientation);
    let off_m = (place.x - truth.x).hypot(place.y - truth.y);
    let heading = 2.0 * direction.z.atan2(direction.w);
    let off = (heading - truth.heading + PI).rem_euclid(TAU) - PI;
    (off_m, off.to_degrees().abs(), truth.way)
}

#[test]
fn the_odometry_is_true_after_100_m() {
    let (off_m, off_deg, way) = drive(100.0);
    println!(
        "odometry after {way:.1} m with turns: {off_m:.4} m off ({:.3} %), {off_deg:.3} degrees",
        100.0 * off_m / way
    );
    assert!(off_m < 0.01 * way && off_deg < 2.0);
}

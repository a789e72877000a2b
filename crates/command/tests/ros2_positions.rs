//! The positions that the plugin of `ros2_control` tells, against those of the virtual wheels themselves.

use std::{
    env, thread,
    time::{Duration, Instant},
};

use crate::{
    bench::Bench,
    control_socket::Served,
    controller::attempts,
    ros2_plugin::{Manager, programs},
};

/// How long the first angle may take after the activation.
const FIRST_ANGLE_MAX: Duration = Duration::from_secs(1);

/// `MOTORLINK_DRIVE_SECONDS=600 cargo test -p motorlink-command --test command positions_stay -- --nocapture` drives for ten
/// minutes.
#[test]
fn positions_stay_those_of_the_wheels() {
    attempts(compare_positions);
}

fn compare_positions() {
    let seconds = env::var("MOTORLINK_DRIVE_SECONDS").map_or(6, |text| text.parse().unwrap());
    let mut bench = Bench::new(&["--ids", "1,2"]);
    let served = Served::start(&bench);
    let mut manager = Manager::start(&programs().humble, &served.socket);
    manager.until("configured");
    manager.does("activate", "activate success");
    let joints = |manager: &mut Manager| {
        let state = manager.state();
        ["left/position", "right/position"].map(|name| state(name).to_degrees())
    };
    let mut before = joints(&mut manager);
    let began = Instant::now();
    // On a busy machine the first angle comes after the activation.
    while before.iter().any(|degrees| degrees.is_nan()) && began.elapsed() < FIRST_ANGLE_MAX {
        thread::sleep(Duration::from_millis(20));
        before = joints(&mut manager);
    }
    let mut wheels = Wheels::new(&mut bench);
    let speeds = ["10 10", "-6 -8", "15 -15", "0 3", "-12 12"];
    for (number, speeds) in speeds.iter().cycle().enumerate() {
        if number >= seconds {
            break;
        }
        manager.does(&format!("set {speeds}"), "set");
        wheels.follow(&mut bench, Duration::from_secs(1));
    }
    manager.does("set 0 0", "set");
    wheels.follow(&mut bench, Duration::from_millis(1_500));
    let after = joints(&mut manager);
    let turned = [0, 1].map(|wheel| after[wheel] - before[wheel]);
    let errors = [0, 1].map(|wheel| (turned[wheel] - wheels.turned[wheel]).abs());
    println!(
        "after {seconds} s and {turned:.1?} degrees, the positions differ by {errors:.3?} degrees"
    );
    assert!(
        turned.iter().all(|turned| turned.abs() > 90.0),
        "{turned:?}"
    );
    assert!(errors.iter().all(|error| *error <= 0.5), "{errors:?}");
    manager.does("shutdown", "shutdown success");
    served.end();
}

/// What the virtual wheels themselves have turned, in the directions of the joints, in degrees.
struct Wheels {
    angles: [f64; 2],
    turned: [f64; 2],
}

impl Wheels {
    fn new(bench: &mut Bench) -> Self {
        Self {
            angles: [1, 2].map(|id| bench.angle(id)),
            turned: [0.0, 0.0],
        }
    }

    fn follow(&mut self, bench: &mut Bench, time: Duration) {
        let began = Instant::now();
        let mut looked = began;
        while began.elapsed() < time {
            thread::sleep(Duration::from_millis(20));
            for (wheel, id) in [1, 2].into_iter().enumerate() {
                let angle = bench.angle(id);
                let moved = (angle - self.angles[wheel] + 540.0).rem_euclid(360.0) - 180.0;
                self.angles[wheel] = angle;
                // The angle falls at positive speed, and the right motor is mirrored.
                self.turned[wheel] += [-moved, moved][wheel];
            }
            // In half a turn, its direction is not known.
            assert!(
                looked.elapsed() < Duration::from_millis(180),
                "the machine is too slow"
            );
            looked = Instant::now();
        }
    }
}

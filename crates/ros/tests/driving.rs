//! What moves the wheels, and what stops them.

use std::{
    io::Read as _,
    io::Write as _,
    os::unix::net::UnixStream,
    thread::sleep,
    time::{Duration, Instant},
};

use hiroz::Builder as _;
use hiroz_msgs::{geometry_msgs::TwistStamped, std_msgs::Header};

use crate::bench::{Asking, Bench, RESTS, STOPS_WITHIN, call, twist_of};

const AHEAD: (f64, f64) = (0.4, 0.0);

fn assert_stops(bench: &mut Bench, within: Duration, what: &str) {
    let took = bench.motors.until(what, super::bench::Motors::stand);
    println!("{what}: stands after {} ms", took.as_millis());
    assert!(took < within, "{what}: {took:?}");
}

/// The wheels stand, and go on standing while somebody asks for more.
fn assert_stays(bench: &mut Bench, what: &str) {
    for _ in 0..40 {
        assert!(bench.motors.stand(), "{what}");
        sleep(Duration::from_millis(50));
    }
}

#[test]
fn cmd_vel_drives_and_its_end_stops() {
    let mut bench = Bench::start(&[]);
    let node = bench.node();
    let asking = Asking::new(&node);
    bench.drive(&asking, AHEAD, 70.0);
    asking.ask(None);
    assert_stops(&mut bench, STOPS_WITHIN, "commands cease");
    // A turn to the left: both motors turn backward.
    asking.ask(Some((0.0, 2.0)));
    bench.motors.until("a turn to the left", |motors| {
        motors.rpm(1) < -50.0 && motors.rpm(2) < -50.0
    });
    asking.ask(None);
    assert_stops(&mut bench, STOPS_WITHIN, "commands cease again");
}

#[test]
fn a_stamped_twist_drives_too() {
    let mut bench = Bench::start(&[]);
    let node = bench.node();
    let publisher = node.create_pub::<TwistStamped>("cmd_vel").build().unwrap();
    let message = TwistStamped {
        header: Header::default(),
        twist: twist_of(0.4, 0.0),
    };
    bench.motors.until("turning wheels", |motors| {
        publisher.publish(&message).unwrap();
        sleep(Duration::from_millis(40));
        motors.rpm(1) > 70.0
    });
    assert_stops(&mut bench, STOPS_WITHIN, "commands cease");
}

#[test]
fn an_emergency_stop_holds_until_a_reset_which_starts_nothing() {
    let mut bench = Bench::start(&[]);
    let node = bench.node();
    for service in ["hardware/e_stop_trigger", "hardware/e_stop_reset"] {
        let answer = call(&node, service);
        assert!(answer.success, "wheels that stand: {}", answer.message);
    }
    sleep(RESTS);
    let asking = Asking::new(&node);
    bench.drive(&asking, AHEAD, 70.0);
    let answer = call(&node, "hardware/e_stop_trigger");
    assert!(answer.success, "{}", answer.message);
    assert_stops(&mut bench, Duration::from_millis(100), "emergency stop");
    assert_stays(&mut bench, "somebody asks after an emergency stop");
    let answer = call(&node, "hardware/e_stop_reset");
    assert!(answer.success, "{}", answer.message);
    assert_stays(&mut bench, "somebody asks all the time over the reset");
    // Slow publishers do not rest between their messages.
    asking.every(1_000);
    assert_stays(&mut bench, "somebody asks once a second");
    asking.every(50);
    asking.ask(None);
    sleep(RESTS);
    bench.drive(&asking, AHEAD, 70.0);
}

#[test]
fn an_emergency_stop_that_motorlink_does_not_take_is_said() {
    let bench = Bench::start(&[]);
    let node = bench.node();
    bench.served.as_ref().unwrap().signal("STOP");
    let answer = call(&node, "hardware/e_stop_trigger");
    assert!(!answer.success, "{}", answer.message);
    assert!(
        answer.message.starts_with("NOT STOPPED") || answer.message.starts_with("NOT CONFIRMED"),
        "{}",
        answer.message
    );
}

#[test]
fn an_emergency_stop_needs_no_free_place_at_the_socket() {
    let mut bench = Bench::start(&[]);
    let node = bench.node();
    let asking = Asking::new(&node);
    bench.drive(&asking, AHEAD, 70.0);
    // Eight clients at most; this program is one of them.
    let clients = (0..8).map(|_| UnixStream::connect(bench.socket()).unwrap());
    let _clients: Vec<_> = clients.collect();
    sleep(Duration::from_millis(200));
    let answer = call(&node, "hardware/e_stop_trigger");
    assert!(answer.success, "{}", answer.message);
}

#[test]
fn what_a_person_stops_a_person_releases() {
    let mut bench = Bench::start(&[]);
    let node = bench.node();
    let asking = Asking::new(&node);
    bench.drive(&asking, AHEAD, 70.0);
    let say = |bench: &Bench, command: &str| {
        let mut stream = UnixStream::connect(bench.socket()).unwrap();
        writeln!(stream, "{command}").unwrap();
        stream.shutdown(std::net::Shutdown::Write).unwrap();
        stream.read_to_string(&mut String::new()).unwrap();
    };
    say(&bench, "stop");
    assert_stops(&mut bench, Duration::from_millis(700), "a person stops");
    asking.ask(None);
    sleep(RESTS);
    asking.ask(Some(AHEAD));
    assert_stays(&mut bench, "nobody has released the motors");
    say(&bench, "release");
    assert_stays(&mut bench, "somebody asks all the time over the release");
    asking.ask(None);
    sleep(RESTS);
    bench.drive(&asking, AHEAD, 70.0);
}

#[test]
fn a_publisher_that_is_gone_stops_the_wheels_and_a_new_router_brings_the_next() {
    let mut bench = Bench::start(&[]);
    let node = bench.node();
    let asking = Asking::new(&node);
    bench.drive(&asking, AHEAD, 70.0);
    // Peers go on without their router.
    bench.router = None;
    drop(asking);
    drop(node);
    assert_stops(&mut bench, STOPS_WITHIN, "router and publisher are gone");
    bench.start_router();
    let node = bench.node();
    let asking = Asking::new(&node);
    bench.drive(&asking, AHEAD, 70.0);
}

#[test]
fn a_killed_or_frozen_program_stops_the_wheels() {
    for signal in ["KILL", "STOP", "TERM"] {
        let mut bench = Bench::start(&[]);
        let node = bench.node();
        let asking = Asking::new(&node);
        bench.drive(&asking, AHEAD, 70.0);
        let frozen = Instant::now();
        bench.ros.as_ref().unwrap().signal(signal);
        assert_stops(&mut bench, Duration::from_millis(100 + 700), signal);
        if signal == "STOP" {
            // Much longer than a command counts.
            sleep(Duration::from_secs(2).saturating_sub(frozen.elapsed()));
            bench.ros.as_ref().unwrap().signal("CONT");
            assert_stays(&mut bench, "a program that goes on drives nothing");
        }
    }
}

#[test]
fn a_motorlink_that_starts_again_drives_nothing_by_itself() {
    let mut bench = Bench::start(&[]);
    let node = bench.node();
    let asking = Asking::new(&node);
    bench.drive(&asking, AHEAD, 70.0);
    // It stops the motors before it ends.
    bench.served.as_ref().unwrap().signal("TERM");
    assert_stops(&mut bench, Duration::from_secs(1), "motorlink ends");
    bench.served = None;
    bench.serve();
    sleep(RESTS);
    assert_stays(&mut bench, "somebody asks all the time");
    asking.ask(None);
    sleep(RESTS);
    bench.drive(&asking, AHEAD, 70.0);
}

//! What moves the robot, over virtual time.
#![cfg(test)]

use super::*;
use crate::{
    node::{attachment::Attachment, messages::Twist},
    rover::tests::{rover, twist},
};

const TIMEOUT: Duration = Duration::from_millis(500);

/// Time goes on in steps of 10 ms. motorlink starts at once, and stops within 200 ms.
struct Robot {
    start: Instant,
    now: Instant,
    number: i64,
    cmd_vel: CmdVel,
    drive: Drive,
    state: State,
    stops: u32,
    /// The speeds of the newest setpoints that move the motors.
    speeds: Vec<f32>,
}

impl Robot {
    fn new() -> Self {
        let now = Instant::now();
        let mut robot = Self {
            start: now,
            now,
            number: 0,
            cmd_vel: CmdVel::new(TIMEOUT, now),
            drive: Drive::new(now),
            state: State::default(),
            stops: 0,
            speeds: Vec::new(),
        };
        // How fast its messages are is known.
        robot.ask(twist(0.0, 0.0));
        robot.now += Duration::from_millis(600);
        robot.ask(twist(0.0, 0.0));
        robot.drive = Drive::new(robot.now);
        robot
    }

    fn ask(&mut self, twist: Twist) {
        self.number += 1;
        let since = self.now.duration_since(self.start).as_nanos();
        let attachment = Attachment {
            number: self.number,
            sent_ns: i64::try_from(since).unwrap(),
            sender: [1; 16],
        };
        self.cmd_vel.take(self.now, twist, attachment);
    }

    /// Goes on for `ms`, and asks for `twist` all the time if there is one.
    fn run(&mut self, ms: u64, twist: Option<Twist>) {
        for _ in 0..ms / 10 {
            self.now += Duration::from_millis(10);
            if let Some(twist) = twist {
                self.ask(twist);
            }
            self.state.challenge += 1;
            if self.state.drive == DriveState::Stopping {
                self.stops += 1;
                if self.stops == 20 {
                    self.state.drive = DriveState::Stands;
                }
            }
            let told = self
                .drive
                .step(self.now, Some(&self.state), &self.cmd_vel, &rover());
            match told {
                Some(FromClient::Arm(setpoints)) => {
                    assert!(setpoints.speeds.iter().all(|(_, speed)| *speed == 0.0));
                    self.state.arm = (setpoints.number, None);
                    self.state.ended = EndReason::None;
                    self.state.drive = DriveState::Driven;
                }
                Some(FromClient::Setpoints(setpoints)) => {
                    assert_eq!(setpoints.challenge, self.state.challenge);
                    self.speeds = setpoints.speeds.iter().map(|(_, speed)| *speed).collect();
                }
                Some(FromClient::Disarm) => self.end(EndReason::Disarmed),
                None => {}
            }
        }
    }

    fn end(&mut self, why: EndReason) {
        if self.state.ended == EndReason::None {
            self.state.ended = why;
        }
        self.state.drive = DriveState::Stopping;
        self.stops = 0;
        self.speeds.clear();
    }

    fn turns(&self) -> bool {
        self.state.drive == DriveState::Driven && self.speeds.iter().any(|speed| *speed != 0.0)
    }
}

#[test]
fn a_command_drives_and_its_end_stops() {
    let mut robot = Robot::new();
    robot.run(2_100, None);
    robot.run(100, Some(twist(0.5, 0.0)));
    assert_eq!(robot.speeds, [10.0, -10.0]);
    robot.run(490, None);
    assert!(robot.turns());
    robot.run(20, None);
    assert!(!robot.turns());
    assert_eq!(robot.drive.is_driving(), Err(Why::NotAsked));
    // It may go on as soon as it stands.
    robot.run(400, Some(twist(0.5, 0.0)));
    assert!(robot.turns());
}

#[test]
fn zero_arms_nothing() {
    let mut robot = Robot::new();
    robot.run(2_000, Some(twist(0.0, 0.0)));
    assert_eq!(robot.state.arm.0, 0);
}

#[test]
fn what_asks_already_at_the_start_drives_nothing() {
    let mut robot = Robot::new();
    robot.run(5_000, Some(twist(0.5, 0.0)));
    assert_eq!(robot.state.arm.0, 0);
    robot.run(2_000, None);
    robot.run(50, Some(twist(0.5, 0.0)));
    assert!(robot.turns());
}

#[test]
fn after_each_end_it_drives_only_when_nobody_has_asked_for_a_while() {
    type Ends = fn(&mut Robot);
    let ends: [(&str, Ends); 8] = [
        ("a freeze", |robot| {
            robot.now += Duration::from_secs(5);
            robot.end(EndReason::LeaseEnded);
        }),
        ("a freeze while it stops", |robot| {
            robot.run(510, None);
            robot.now += Duration::from_secs(5);
        }),
        ("no speed", |robot| {
            robot.drive.end(robot.now, Why::NoSpeed);
            robot.run(20, Some(twist(0.5, 0.0)));
        }),
        ("a fault", |robot| robot.end(EndReason::Fault)),
        ("a person", |robot| robot.end(EndReason::Stopped)),
        ("a page", |robot| robot.end(EndReason::Taken)),
        ("the connection", |robot| {
            robot.drive.disconnected(robot.now);
            robot.end(EndReason::LeaseEnded);
        }),
        ("emergency stop and reset", |robot| {
            robot.drive.e_stop();
            robot.run(300, Some(twist(0.5, 0.0)));
            assert!(!robot.turns());
            robot.drive.reset(robot.now);
        }),
    ];
    for (name, end) in ends {
        let mut robot = Robot::new();
        robot.run(2_100, None);
        robot.run(100, Some(twist(0.5, 0.0)));
        assert!(robot.turns(), "{name}");
        end(&mut robot);
        robot.run(5_000, Some(twist(0.5, 0.0)));
        assert!(!robot.turns(), "{name}");
        assert!(robot.drive.must_rest(), "{name}");
        robot.run(2_000, Some(twist(0.0, 0.0)));
        robot.run(50, Some(twist(0.5, 0.0)));
        assert!(robot.turns(), "{name}");
    }
}

#[test]
fn after_an_end_a_sender_whose_messages_were_lost_must_rest_again() {
    let mut robot = Robot::new();
    robot.run(2_100, None);
    robot.run(100, Some(twist(0.5, 0.0)));
    assert!(robot.turns());
    robot.end(EndReason::Fault);
    robot.run(300, Some(twist(0.5, 0.0)));
    // The network is gone for 3 s, and the sender goes on asking.
    robot.run(3_000, None);
    robot.number += 300;
    robot.run(1_000, Some(twist(0.5, 0.0)));
    assert!(!robot.turns());
    robot.run(2_100, None);
    robot.run(300, Some(twist(0.5, 0.0)));
    assert!(robot.turns());
}

#[test]
fn an_emergency_stop_stops_at_once_and_holds() {
    let mut robot = Robot::new();
    robot.run(2_100, None);
    robot.run(100, Some(twist(0.5, 0.0)));
    robot.drive.e_stop();
    robot.run(10, Some(twist(0.5, 0.0)));
    assert_eq!(robot.state.ended, EndReason::Disarmed);
    robot.run(1_000, None);
    robot.run(1_000, Some(twist(0.5, 0.0)));
    assert!(!robot.turns());
    assert_eq!(robot.drive.is_driving(), Err(Why::EStop));
}

#[test]
fn a_refusal_is_said_and_is_not_asked_again() {
    let mut robot = Robot::new();
    robot.run(2_100, None);
    robot.ask(twist(0.5, 0.0));
    let told = robot
        .drive
        .step(robot.now, Some(&robot.state), &robot.cmd_vel, &rover());
    assert!(matches!(told, Some(FromClient::Arm(_))));
    robot.state.arm = (1, Some(NotArmed::PageHasControl));
    robot.run(2_000, Some(twist(0.5, 0.0)));
    assert_eq!(robot.state.arm.0, 1);
    let why = Why::Refused(NotArmed::PageHasControl);
    assert_eq!(robot.drive.is_driving(), Err(why));
}

#[test]
fn a_start_that_takes_too_long_is_given_up() {
    let mut robot = Robot::new();
    robot.run(2_100, None);
    robot.run(10, Some(twist(0.5, 0.0)));
    robot.state.drive = DriveState::Starting;
    robot.run(4_900, Some(twist(0.5, 0.0)));
    assert_eq!(robot.state.ended, EndReason::None);
    robot.run(200, Some(twist(0.5, 0.0)));
    assert_eq!(robot.state.ended, EndReason::Disarmed);
    assert_eq!(robot.drive.is_driving(), Err(Why::NotInTime));
}

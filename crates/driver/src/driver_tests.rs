//! The driver on virtual motors in this process.

use motorlink_bus::{Consent, Event, StopReason};
use motorlink_protocol::{MotorId, Setpoint, SpeedTarget};

use super::*;
use crate::ports::Place;
use crate::virtual_line::VirtualLine;

const ID: MotorId = MotorId::FIRST;

fn open() -> Driver {
    let line = VirtualLine::of(Model::Ddsm115, [ID]);
    let mut options = Options::at(Place::Virtual(line));
    options.state_folder = None;
    Driver::open(options).unwrap()
}

fn start(driver: &Driver, rpm: i32) {
    driver.command(Command::Start {
        id: ID,
        setpoint: Setpoint::velocity(SpeedTarget::new(rpm).unwrap()),
        consent: Consent::None,
    });
}

/// Takes entries until the motor turns so fast.
fn until_speed(driver: &Driver, rpm: u16) {
    let until = std::time::Instant::now() + Duration::from_secs(5);
    while std::time::Instant::now() < until {
        let _: Next = driver.next(Duration::from_millis(20));
        let status = driver.status().unwrap();
        let speed = status.motors.first().and_then(|motor| motor.speed);
        if speed.is_some_and(|(_, speed)| speed.magnitude() >= rpm) {
            return;
        }
    }
    panic!("no {rpm} rpm within 5 s");
}

#[test]
fn a_driver_that_ends_has_stopped_its_motor_and_says_so() {
    let driver = open();
    start(&driver, 100);
    until_speed(&driver, 90);
    let ending = driver.end();
    let report = ending.last_stop.unwrap();
    assert_eq!(report.reason, StopReason::Disconnect);
    assert!(
        report.motors.iter().all(|motor| motor.confirmed),
        "{report:?}"
    );
    assert_eq!((ending.may_turn, ending.has_failed), (vec![], false));
}

#[test]
fn a_program_that_takes_no_entries_for_a_second_has_its_motor_stopped() {
    let driver = open();
    start(&driver, 100);
    until_speed(&driver, 90);
    thread::sleep(Duration::from_millis(2500));
    let status = driver.status().unwrap();
    assert!(status.is_halted);
    let speed = status.motors[0].speed.unwrap().1;
    assert_eq!(speed.magnitude(), 0);
    // It is told why once it takes entries again.
    loop {
        match driver.next(Duration::from_millis(10)) {
            Next::Entry(_, Entry::Event(Event::StopBegan(reason))) => {
                assert_eq!(reason, StopReason::PageSilent);
                break;
            }
            Next::Entry(..) => {}
            ended => panic!("{ended:?}"),
        }
    }
}

#[test]
fn a_driver_that_fails_stops_its_motor_first() {
    // The second one fails at every call.
    for failure in [Input::Fail, Input::FailRuns] {
        let driver = open();
        start(&driver, 100);
        until_speed(&driver, 90);
        driver.fail(failure);
        while driver.next(Duration::from_millis(100)) != Next::Ended {}
        let ending = driver.end();
        let report = ending.last_stop.unwrap();
        assert_eq!(report.reason, StopReason::LeftDriven);
        assert!(report.motors[0].confirmed);
        assert_eq!((ending.may_turn, ending.has_failed), (vec![], true));
    }
}

//! What persons stop and take over, on pages and by the text form.

use std::time::Duration;

use motorlink_bus::{Command, Consent, StopReason};
use motorlink_controller_messages::{DriveState, EndReason, NotArmed};
use motorlink_remote::Participant;

use super::world::{LOST, ONE, TWO, World, velocity};
use crate::messages::PageRequest;

fn start(rpm: i32) -> Command {
    Command::Drive {
        id: ONE,
        setpoint: velocity(rpm),
        consent: Consent::None,
    }
}

#[test]
fn a_page_that_takes_control_stops_the_drive_first() {
    let mut world = World::new();
    let page = world.join(Participant::Page);
    let controller = world.driving(&[ONE]);
    world.page(page, PageRequest::Take { by_force: false });
    for _ in 0..100 {
        world.page(page, PageRequest::Take { by_force: true });
        assert_eq!(world.given(), []);
        world.pass(10);
        world.set(controller, &[(ONE, 0.0)]);
    }
    world.page(page, PageRequest::Take { by_force: true });
    assert_eq!(world.given(), [LOST]);
    let expected = (DriveState::Stopping, EndReason::Taken);
    assert_eq!(world.ended(controller), expected);
}

#[test]
fn a_stop_of_a_person_ends_the_drive_until_an_arm_that_knows_of_it() {
    let all = Command::StopAll(StopReason::Operator);
    for (by_page, stop, needs_release) in [
        (true, all, true),
        (true, Command::Stop(TWO), false),
        (false, all, true),
    ] {
        let mut world = World::new();
        let page = world.join(Participant::Page);
        let controller = world.driving(&[ONE, TWO]);
        let old = world.order(controller, &[(ONE, 0.0), (TWO, 0.0)]);
        if by_page {
            world.page_commands(page, Duration::ZERO, stop);
        } else {
            world.operation.stop(world.now, None, [stop]);
        }
        assert_eq!(world.given(), [stop]);
        let expected = (DriveState::Stopping, EndReason::Stopped);
        assert_eq!(world.ended(controller), expected);
        world.set(controller, &[(ONE, 5.0), (TWO, 5.0)]);
        if needs_release {
            let why = Some(NotArmed::StoppedByPerson);
            assert_eq!(world.arm(controller, &[ONE, TWO]), why);
            world.operation.release();
        }
        assert_eq!(world.arm_by(controller, old), Some(NotArmed::Late));
        assert_eq!(world.given(), []);
        world.pass(10);
        assert_eq!(world.arm(controller, &[ONE, TWO]), None);
    }
}

#[test]
fn a_stop_of_another_motor_ends_no_drive() {
    let mut world = World::new();
    let page = world.join(Participant::Page);
    let controller = world.driving(&[ONE]);
    for stop in [Command::Stop(TWO), Command::StopRaw] {
        world.page_commands(page, Duration::ZERO, stop);
        assert_eq!(world.given(), [stop]);
    }
    assert_eq!(world.report(controller).drive, DriveState::Driven);
}

#[test]
fn a_command_of_a_page_that_may_not_drive_is_a_stop_or_nothing() {
    let mut world = World::new();
    let page = world.join(Participant::Page);
    let controller = world.driving(&[ONE]);
    for (command, given) in [
        (start(50), vec![]),
        (Command::Release, vec![]),
        (Command::StopAll(StopReason::PageGone), vec![]),
        (start(0), vec![Command::Stop(ONE)]),
    ] {
        world.page_commands(page, Duration::ZERO, command);
        assert_eq!(world.given(), given, "{command:?}");
    }
    let expected = (DriveState::Stopping, EndReason::Stopped);
    assert_eq!(world.ended(controller), expected);
}

#[test]
fn a_late_command_of_the_page_with_control_is_a_stop_or_nothing() {
    let mut world = World::new();
    let page = world.join(Participant::Page);
    world.page(page, PageRequest::Take { by_force: false });
    for (age_ms, command, given) in [
        (10, start(50), vec![start(50)]),
        (5_000, start(50), vec![]),
        (5_000, start(0), vec![Command::Stop(ONE)]),
    ] {
        world.page_commands(page, Duration::from_millis(age_ms), command);
        assert_eq!(world.given(), given, "{command:?} after {age_ms} ms");
    }
}

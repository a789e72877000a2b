//! Scenarios of pages and controllers that drive, over virtual time.

mod persons;
mod world;

use std::time::Duration;

use motorlink_bus::{BusSettings, Command, GroupSetpoints, Limits};
use motorlink_controller_messages::{DriveState, EndReason, FromClient, Holder, NotArmed};
use motorlink_protocol::{MotorId, Setpoint};
use motorlink_remote::Participant;

use self::world::{Does, LOST, ONE, TWO, World, velocity};
use crate::messages::PageRequest;

/// The speeds that the bus is given.
fn adjusted(commands: &[Command]) -> Vec<Vec<Setpoint>> {
    let group = |command: &Command| match command {
        Command::AdjustGroup { setpoints, .. } => Some(group_of(setpoints)),
        _ => None,
    };
    commands.iter().filter_map(group).collect()
}

fn group_of(setpoints: &GroupSetpoints) -> Vec<Setpoint> {
    setpoints.entries().map(|(_, setpoint)| setpoint).collect()
}

#[test]
fn an_arm_starts_motors_at_zero_and_setpoints_move_them_when_all_are_driven() {
    let mut world = World::new();
    let controller = world.join(Participant::Controller);
    assert_eq!(world.ended(controller), (DriveState::None, EndReason::None));
    assert_eq!(world.arm(controller, &[ONE, TWO]), None);
    let given = world.given();
    assert_eq!(given[0], Command::Release);
    let Command::StartGroup { setpoints, .. } = given[1] else {
        panic!("{given:?}");
    };
    assert_eq!(group_of(&setpoints), [velocity(0); 2]);
    for does in [Does::Waits, Does::Drives(0)] {
        world.bus(&[(ONE, Does::Drives(0)), (TWO, does)]);
        world.set(controller, &[(ONE, 10.0), (TWO, -10.0)]);
    }
    assert_eq!(adjusted(&world.given()), [[velocity(95), velocity(-95)]]);
    // What the bus has is not given again, and what it does not have is.
    world.bus(&[(ONE, Does::Drives(95)), (TWO, Does::Drives(-95))]);
    world.set(controller, &[(ONE, 10.0), (TWO, -10.0)]);
    assert_eq!(world.given(), []);
    world.bus(&[(ONE, Does::Drives(95)), (TWO, Does::Drives(0))]);
    world.set(controller, &[(ONE, 10.0), (TWO, -10.0)]);
    assert_eq!(adjusted(&world.given()).len(), 1);
}

#[test]
fn speeds_are_limited_as_the_newest_page_with_control_has_set_and_by_the_model() {
    for (set, rpm) in [(None, Limits::default().speed_rpm()), (Some(40), 40)] {
        let mut world = World::new();
        let page = world.join(Participant::Page);
        if let Some(rpm) = set {
            world.page(page, PageRequest::Take { by_force: false });
            let settings = BusSettings {
                limits: Limits::new(rpm, 5_000, 60).unwrap(),
                ..BusSettings::default()
            };
            world.page_commands(page, Duration::ZERO, Command::Configure(settings));
            world.page(page, PageRequest::GiveUp);
        }
        let controller = world.driving(&[ONE]);
        world.set(controller, &[(ONE, -1e9)]);
        let expected = velocity(-i32::from(rpm));
        assert_eq!(adjusted(&world.given()), [[expected]]);
    }
}

#[test]
fn setpoints_that_do_not_know_of_a_stop_or_of_the_end_of_the_lease_move_nothing() {
    let mut world = World::new();
    let page = world.join(Participant::Page);
    let controller = world.driving(&[ONE]);
    let old = FromClient::Setpoints(world.order(controller, &[(ONE, 5.0)]));
    world.page_commands(page, Duration::ZERO, Command::Stop(TWO));
    world.given();
    world.operation.controller_asks(world.now, controller, &old);
    assert_eq!(world.given(), []);
    world.pass(10);
    world.set(controller, &[(ONE, 5.0)]);
    assert_eq!(adjusted(&world.given()).len(), 1);
    // Nobody has looked at the lease yet.
    world.pass(100);
    world.now = world.now + Duration::from_millis(1);
    world.set(controller, &[(ONE, 6.0)]);
    assert_eq!(world.given(), []);
}

#[test]
fn an_arm_after_a_lease_that_has_just_ended_stops_first_what_it_drove() {
    let mut world = World::new();
    let first = world.driving(&[ONE]);
    let second = world.join(Participant::Controller);
    world.pass(100);
    world.now = world.now + Duration::from_millis(1);
    assert_eq!(world.arm(second, &[TWO]), None);
    assert_eq!(world.given()[..2], [LOST, Command::Release]);
    let expected = (DriveState::Stopping, EndReason::LeaseEnded);
    assert_eq!(world.ended(first), expected);
    assert_eq!(world.report(second).drive, DriveState::Starting);
}

#[test]
fn a_drive_that_is_disarmed_ends_by_the_replies_of_its_motors() {
    let mut world = World::new();
    let controller = world.driving(&[ONE, TWO]);
    world.disarm(controller);
    assert_eq!(world.given(), [LOST]);
    for (two, state) in [
        (Does::Stops, DriveState::Stopping),
        (Does::MayTurn, DriveState::NotConfirmed),
        (Does::Stands, DriveState::Stands),
        // It has stood: what comes later is no part of this drive.
        (Does::Drives(50), DriveState::Stands),
    ] {
        world.bus(&[(ONE, Does::Stands), (TWO, two)]);
        assert_eq!(world.ended(controller), (state, EndReason::Disarmed));
    }
    assert_eq!(world.report(controller).holder, (Holder::Nobody, 0));
    assert_eq!(world.given(), []);
}

#[test]
fn a_motor_that_is_not_there_does_not_stand() {
    let mut world = World::new();
    let controller = world.driving(&[ONE, TWO]);
    world.disarm(controller);
    world.bus(&[(ONE, Does::Stands)]);
    let expected = (DriveState::NotConfirmed, EndReason::Disarmed);
    assert_eq!(world.ended(controller), expected);
}

#[test]
fn silence_of_100_ms_stops_the_motors_and_only_an_arm_starts_them() {
    let mut world = World::new();
    let controller = world.driving(&[ONE]);
    for _ in 0..50 {
        world.pass(10);
        world.set(controller, &[(ONE, 5.0)]);
    }
    assert!(!world.given().contains(&LOST));
    // The newest challenge was made at this moment.
    world.pass(100);
    assert_eq!(world.given(), []);
    world.pass(1);
    assert_eq!(world.given(), [LOST]);
    let expected = (DriveState::Stopping, EndReason::LeaseEnded);
    assert_eq!(world.ended(controller), expected);
    world.bus(&[(ONE, Does::Drives(48))]);
    world.set(controller, &[(ONE, 5.0)]);
    world.pass(10);
    assert_eq!(world.given(), []);
    assert_eq!(world.arm(controller, &[ONE]), None);
    assert_eq!(world.given().len(), 2);
}

#[test]
fn a_controller_that_goes_stops_what_it_drives_and_a_watcher_stops_nothing() {
    let mut world = World::new();
    let controller = world.driving(&[ONE]);
    let watchers = [Participant::Controller, Participant::Page].map(|kind| world.join(kind));
    for watcher in watchers {
        world.operation.leave(watcher);
    }
    assert_eq!(world.given(), []);
    let last = world.operation.leave(controller).unwrap();
    assert_eq!(last.ended, EndReason::LeaseEnded);
    assert_eq!(last.holder, (Holder::Nobody, 0));
    assert_eq!(world.given(), [LOST]);
}

#[test]
fn one_drives_at_most() {
    let mut world = World::new();
    let page = world.join(Participant::Page);
    let controller = world.driving(&[ONE]);
    let second = world.join(Participant::Controller);
    assert_eq!(world.arm(second, &[TWO]), Some(NotArmed::OtherHasControl));
    assert_eq!(world.arm(controller, &[ONE]), Some(NotArmed::StillDriven));
    world.set(second, &[(ONE, 10.0)]);
    world.disarm(second);
    assert_eq!(world.given(), []);
    assert_eq!(world.report(controller).holder.0, Holder::You);
    assert_eq!(world.report(second).holder.0, Holder::OtherClient);
    world.disarm(controller);
    world.page(page, PageRequest::Take { by_force: false });
    assert_eq!(world.arm(second, &[TWO]), Some(NotArmed::PageHasControl));
    assert_eq!(world.report(second).holder, (Holder::Page, page.0));
}

#[test]
fn a_motor_that_the_bus_no_longer_drives_ends_the_drive_and_the_others_are_stopped() {
    for (of, told, why) in [
        (Some(ONE), EndReason::Fault, EndReason::Fault),
        (None, EndReason::PortLost, EndReason::PortLost),
        // Another motor is no reason.
        (Some(TWO), EndReason::Silent, EndReason::ServerStopped),
    ] {
        let mut world = World::new();
        let three = MotorId::new(3).unwrap();
        let controller = world.driving(&[ONE, three]);
        world.operation.may_end(of, told);
        // The first event tells it.
        world.operation.may_end(of, EndReason::Limit);
        world.bus(&[(ONE, Does::Stops), (three, Does::Drives(0))]);
        assert_eq!(world.ended(controller), (DriveState::Stopping, why));
        assert_eq!(world.given(), [Command::Stop(three)]);
        world.set(controller, &[(ONE, 5.0), (three, 5.0)]);
        assert_eq!(world.given(), []);
    }
}

#[test]
fn a_status_that_shows_the_motors_driven_withdraws_the_reason() {
    let mut world = World::new();
    let controller = world.driving(&[ONE]);
    world.operation.may_end(None, EndReason::NotStarted);
    world.bus(&[(ONE, Does::Drives(0))]);
    world.bus(&[(ONE, Does::Stands)]);
    let expected = (DriveState::Stands, EndReason::ServerStopped);
    assert_eq!(world.ended(controller), expected);
}

#[test]
fn a_status_from_before_an_arm_or_an_end_shows_nothing_of_it() {
    let mut world = World::new();
    let controller = world.join(Participant::Controller);
    let before_arm = world.operation.changes();
    world.arm(controller, &[ONE]);
    world.bus_since(before_arm, &[(ONE, Does::Stands)]);
    assert_eq!(world.report(controller).drive, DriveState::Starting);
    let before_end = world.operation.changes();
    world.disarm(controller);
    world.bus_since(before_end, &[(ONE, Does::Stands)]);
    assert_eq!(world.report(controller).drive, DriveState::Stopping);
}

#[test]
fn setpoints_that_are_no_numbers_or_for_other_motors_end_drive_and_control() {
    for (speeds, why) in [
        (vec![(ONE, f32::NAN), (TWO, 0.0)], EndReason::NotFinite),
        (vec![(ONE, 0.0), (TWO, f32::INFINITY)], EndReason::NotFinite),
        (vec![(TWO, 0.0), (ONE, 0.0)], EndReason::OtherMotors),
        (vec![(ONE, 0.0)], EndReason::OtherMotors),
    ] {
        let mut world = World::new();
        let controller = world.driving(&[ONE, TWO]);
        world.set(controller, &speeds);
        assert_eq!(world.given(), [LOST]);
        assert_eq!(world.ended(controller), (DriveState::Stopping, why));
        assert_eq!(world.report(controller).holder.0, Holder::Nobody);
    }
}

#[test]
fn setpoints_without_a_number_left_end_drive_and_control() {
    let mut world = World::new();
    let controller = world.driving(&[ONE]);
    let entry = world.operation.controllers.get_mut(&controller).unwrap();
    entry.sequence = u32::MAX - 1;
    world.set(controller, &[(ONE, 5.0)]);
    assert_eq!(adjusted(&world.given()).len(), 1);
    world.set(controller, &[(ONE, 6.0)]);
    assert_eq!(world.given(), [LOST]);
}

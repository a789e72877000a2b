//! What a motor of each model receives and reports.

use std::time::Duration;

use crate::line::{Line, ONE, SEPARATE, ms, rpm};
use motorlink_protocol::{
    AssignableId, Frame, MotorId, Setpoint,
    family::{Fault, Mode, ModeReading, Model, Reading, Request},
};
use motorlink_simulator::{MotorConfig, World, WorldConfig};

#[test]
fn a_ddsm400_ignores_drive_frames_until_it_is_enabled_and_switched() {
    let mut line = Line::of(Model::Ddsm400);
    line.drive_for(rpm(50), ms(300));
    assert_eq!(line.mode().byte, ModeReading::DISABLED);
    line.switch(Mode::Velocity);
    line.drive_for(rpm(50), ms(300));
    let answer = line.ask(Request::Enable { id: ONE, on: true });
    assert!(matches!(answer, Some(Reading::Mode(reading)) if reading.byte == 8));
    line.drive_for(rpm(50), ms(300));
    assert!(line.motor().speed_rpm().abs() < 0.01 && line.motor().active_mode().is_none());
    line.switch(Mode::Velocity);
    assert_eq!(line.mode().byte, 2);
    line.drive_for(rpm(50), ms(800));
    assert!((line.motor().speed_rpm() - 50.0).abs() < 3.0);
    let motor = line.world.motor_mut(ONE).unwrap();
    motor.power(false);
    motor.power(true);
    assert_eq!(line.motor().active_mode(), None);
}

#[test]
fn speed_current_and_temperature_come_with_a_drive_reply_and_turns_with_a_query() {
    for model in SEPARATE {
        let mut line = Line::ready(model);
        let before = line.odometry();
        assert_eq!(before.turns, 0);
        line.drive_for(rpm(90), ms(3_000));
        let reading = line.drive(rpm(90));
        let speed = reading.speed(model, Mode::Velocity).unwrap();
        assert!((880..=920).contains(&speed.tenths()), "{model}: {speed}");
        assert!((28..=40).contains(&reading.temperature.degrees()));
        let after = line.odometry();
        // Three seconds at a turn and a half, less the start.
        assert!((3..=5).contains(&after.turns), "{model}: {}", after.turns);
    }
}

/// Published: the turns are reset at power-up.
#[test]
fn turns_are_counted_from_power_up() {
    let mut line = Line::ready(Model::Ddsm210);
    line.drive_for(rpm(-120), ms(2_000));
    assert!(line.odometry().turns < -2);
    line.drive_for(Setpoint::Brake, ms(600));
    let motor = line.world.motor_mut(ONE).unwrap();
    motor.power(false);
    motor.power(true);
    assert_eq!(line.odometry().turns, 0);
    assert_eq!(line.mode().byte, 2);
}

#[test]
fn reserved_bytes_do_not_matter() {
    for model in SEPARATE {
        let mut line = Line::ready(model);
        for frame in [
            Frame::with_crc([1, 0x64, 0, 100, 5, 6, 0, 0, 7]),
            Frame::with_crc([1, 0x74, 1, 2, 3, 4, 5, 6, 7]),
            Frame::with_crc([1, 0x75, 1, 2, 3, 4, 5, 6, 7]),
            Frame::with_crc([1, 0xA0, 2, 1, 1, 1, 1, 1, 1]),
        ] {
            assert_eq!(line.send(frame).len(), 10, "{model}: {frame}");
        }
    }
}

#[test]
fn either_published_set_id_frame_is_obeyed_after_five() {
    let to = MotorId::new(7).unwrap();
    let crc = Request::SetId {
        id: AssignableId::new(to).unwrap(),
    };
    // Published: `new 64 00 ..`, and `new 65 00 ..` of a DDSM400.
    for (model, answer) in [
        (Model::Ddsm210, "07 64 00 00 00 00 00 00 00 A3"),
        (Model::Ddsm400, "07 65 00 00 00 00 00 00 00 E0"),
    ] {
        let answer: Frame = answer.parse().unwrap();
        for frame in [
            crc.frame(model).unwrap(),
            crc.frame(Model::Ddsm115).unwrap(),
        ] {
            let mut line = Line::of(model);
            for count in 1..=5 {
                assert_eq!(line.motor().id(), ONE, "{count}");
                let answered = line.send(frame);
                if count < 5 {
                    assert_eq!(answered, []);
                } else {
                    assert!(line.world.motor(to).is_some(), "{model}: {frame}");
                    assert_eq!(answered, answer.bytes());
                    break;
                }
            }
        }
    }
}

#[test]
fn a_motor_at_another_baud_hears_nothing_and_at_its_own_again() {
    for model in Model::ALL {
        let mut line = Line::of(model);
        let query = Request::Query { id: ONE };
        for (baud, answers) in [(9_600, false), (model.spec().baud, true)] {
            line.world.set_baud(line.now, baud);
            assert_eq!(line.ask(query).is_some(), answers, "{model} at {baud}");
            line.wait(ms(50));
        }
    }
}

/// At 38400 baud a frame takes 2.6 ms, and a reply comes after its 600 us.
#[test]
fn an_exchange_takes_the_time_of_the_baud() {
    for (model, micros) in [
        (Model::Ddsm210, 868 + 600 + 868),
        (Model::Ddsm400, 2_604 + 600 + 2_604),
    ] {
        let mut line = Line::of(model);
        let frame = Request::Query { id: ONE }.frame(model).unwrap();
        line.world.transmit(line.now, frame.bytes());
        let before = line.now + Duration::from_micros(micros - 1);
        assert!(line.world.receive(before).is_none(), "{model}");
        let chunk = line.world.receive(line.now + Duration::from_micros(micros));
        assert_eq!(chunk.unwrap().bytes.len(), 10, "{model}");
    }
}

#[test]
fn a_disabled_ddsm400_coasts_until_it_is_enabled_and_switched_again() {
    let mut line = Line::ready(Model::Ddsm400);
    line.drive_for(rpm(90), ms(1_000));
    line.ask(Request::Enable { id: ONE, on: false });
    assert_eq!(line.mode().byte, ModeReading::DISABLED);
    line.drive_for(rpm(90), ms(100));
    assert_eq!(line.motor().obeyed(), None);
    assert_eq!(line.motor().torque_nm().to_bits(), 0);
}

fn with_fault(model: Model, fault: Fault) -> Line {
    let motor = MotorConfig {
        fault: Some(fault),
        ..MotorConfig::of(model, ONE)
    };
    let mut line = Line::of(model);
    line.world = World::new(WorldConfig {
        motors: vec![motor],
        ..WorldConfig::of(model, [])
    });
    line
}

#[test]
fn a_motor_with_a_constant_fault_reports_it_and_obeys_no_drive_frame() {
    for model in Model::ALL {
        for fault in model.spec().faults.iter().copied() {
            let mut line = with_fault(model, fault);
            if model.spec().needs_enable {
                line.ask(Request::Enable { id: ONE, on: true });
                line.switch(Mode::Velocity);
            }
            line.drive_for(rpm(50), ms(300));
            let faults = match line.ask(Request::Query { id: ONE }) {
                Some(Reading::Odometry(odometry)) => odometry.faults,
                Some(Reading::Combined(reply)) => {
                    motorlink_protocol::family::Faults::of(model, reply.faults.byte())
                }
                other => panic!("{model}: {other:?}"),
            };
            assert!(faults.contains(fault), "{model}: {fault:?}");
            assert_eq!(faults.iter().count(), 1, "{model}: {fault:?}");
            assert!(line.motor().speed_rpm().abs() < 0.01, "{model}: {fault:?}");
            line.world.motor_mut(ONE).unwrap().power(false);
            assert_eq!(line.motor().fault_byte(), 0, "without power");
        }
    }
}

#[test]
fn a_motor_does_not_report_a_fault_that_its_model_does_not_have() {
    let line = with_fault(Model::Ddsm210, Fault::Stall);
    assert_eq!(line.motor().fault_byte(), 0);
}

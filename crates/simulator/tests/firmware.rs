//! What the controller does with frames: modes, silence, brake, IDs, and the two reply layouts.

use crate::fixture;
use crate::fixture::{
    Fixture, LAYOUTS, ONE, angle, current, fine_degrees, id, ms, query_detail, speed, us,
};
use motorlink_protocol::{
    AssignableId, Drive, Faults, Frame, Layout, Mode, Position, Request, Setpoint, family::Model,
};
use motorlink_simulator::{MotorConfig, WhenSilent, WorldConfig};

fn fixture_of(when_silent: WhenSilent) -> Fixture {
    Fixture::new(WorldConfig {
        motors: vec![MotorConfig {
            when_silent,
            ..MotorConfig::default()
        }],
        ..WorldConfig::default()
    })
}

/// Captures: `C8 64 ..` is answered with mode 2 after power-up.
#[test]
fn a_motor_wakes_up_in_the_velocity_loop() {
    let mut fixture = Fixture::with_one_motor();
    let reply = fixture.ask(Request::IdQuery).expect("one motor answers");
    assert_eq!((reply.id, reply.mode), (ONE, Mode::Velocity));
    assert_eq!(reply.faults, Faults::NONE);
}

/// motor.md: bytes 6 and 7 have two meanings, told apart only by what was asked.
#[test]
fn both_layouts_tell_the_same_angle() {
    let mut fixture = Fixture::new(WorldConfig {
        motors: vec![MotorConfig {
            angle_deg: 264.2,
            ambient_c: 30.0,
            ..MotorConfig::default()
        }],
        ..WorldConfig::default()
    });
    let (temperature, coarse) = query_detail(&fixture.query());
    assert_eq!(temperature, 30);
    // The captured pair: byte 187 = 264.0 degrees and raw 24049 = 264.2 degrees.
    assert!((coarse - 264.0).abs() < 0.8, "{coarse}");
    let reply = fixture.drive(speed(0)).expect("an answer");
    assert!(
        (fine_degrees(&reply) - 264.2).abs() < 0.1,
        "{}",
        fine_degrees(&reply)
    );
}

#[test]
fn a_stuck_angle_is_that_of_drive_replies_only() {
    let mut fixture = Fixture::new(WorldConfig {
        motors: vec![MotorConfig {
            angle_deg: 200.0,
            drive_angle_stuck: Some(Position::from_raw(0x1234)),
            ..MotorConfig::default()
        }],
        ..WorldConfig::default()
    });
    let reply = fixture.drive(speed(0)).expect("an answer");
    assert!((fine_degrees(&reply) - 51.2).abs() < 0.1);
    let (_, coarse) = query_detail(&fixture.query());
    assert!((coarse - 200.0).abs() < 0.8, "{coarse}");
}

#[test]
fn a_stuck_speed_is_reported_while_the_wheel_turns() {
    let mut fixture = Fixture::new(WorldConfig {
        motors: vec![MotorConfig {
            speed_stuck_rpm: Some(0.0),
            ..MotorConfig::default()
        }],
        ..WorldConfig::default()
    });
    fixture.drive_watching(speed(100), ms(1_000), |_, _| {});
    assert_eq!(fixture.query().speed.unwrap().rpm(), 0);
    assert!(fixture.world.motor(ONE).unwrap().speed_rpm() > 90.0);
}

#[test]
fn the_fine_angle_comes_in_whole_encoder_counts() {
    let mut fixture = Fixture::with_one_motor();
    fixture.drive_watching(speed(10), ms(1000), |_, motor| {
        let counts = motor.angle_deg() / 360.0 * 4096.0;
        assert!((counts - counts.round()).abs() < 1e-3, "{counts}");
    });
}

/// motor.md: every drive frame is answered; a mode switch and set ID are not.
#[test]
fn what_is_answered_and_what_is_not() {
    let mut fixture = Fixture::with_one_motor();
    let drive = Request::drive(ONE, speed(0));
    let query = Request::Query { id: ONE };
    for (request, layout) in [drive, query].into_iter().zip(LAYOUTS) {
        assert_eq!(request.reply_layout(), Some(layout));
        assert!(fixture.ask(request).is_some(), "{request:?}");
    }
    let switch = Request::SwitchMode {
        id: ONE,
        mode: Mode::Current,
    };
    let set_id = Request::SetId {
        id: AssignableId::new(id(7)).unwrap(),
    };
    for silent in [switch, set_id, Request::Query { id: id(2) }] {
        assert_eq!(fixture.send(silent.frame()), [], "{silent:?}");
    }
}

#[test]
fn a_request_with_a_wrong_crc_is_ignored() {
    let mut fixture = Fixture::with_one_motor();
    let mut bytes = *Request::drive(ONE, speed(100)).frame().bytes();
    bytes[9] ^= 1;
    assert_eq!(fixture.send(Frame::new(bytes)), []);
    assert!(!fixture.motor().is_driven());
}

/// The article's `m0601_operations.py` sends the acceleration in byte 4, and drives with it.
#[test]
fn a_drive_frame_with_values_in_reserved_bytes_is_answered_and_obeyed() {
    for (reserved, value) in [(4, 1), (5, 0xFF), (8, 0x80)] {
        let mut fixture = Fixture::with_one_motor();
        let mut body = [0x01, 0x64, 0x00, 0x64, 0, 0, 0, 0, 0];
        body[reserved] = value;
        let frame = Frame::with_crc(body);
        for _ in 0..50 {
            assert_eq!(fixture.send(frame).len(), 10, "{frame}");
        }
        let rpm = fixture.motor().speed_rpm();
        assert!(rpm > 50.0, "{frame}: {rpm} rpm");
    }
}

#[test]
fn queries_and_mode_switches_with_values_in_reserved_bytes_are_understood() {
    let mut fixture = Fixture::with_one_motor();
    let query = Frame::with_crc([0x01, 0x74, 1, 2, 3, 4, 5, 6, 7]);
    assert_eq!(fixture.send(query).len(), 10);
    let switch = Frame::new([0x01, 0xA0, 0, 0, 9, 0, 0, 0, 0, 1]);
    assert_eq!(fixture.send(switch), []);
    assert_eq!(fixture.motor().mode(), Mode::Current);
}

/// They change every motor's flash: only what the maker prints is taken for one.
#[test]
fn a_set_id_frame_with_values_in_reserved_bytes_changes_nothing() {
    let mut fixture = Fixture::with_one_motor();
    for _ in 0..5 {
        let frame = Frame::new([0xAA, 0x55, 0x53, 7, 0, 1, 0, 0, 0, 0]);
        assert_eq!(fixture.send(frame), []);
    }
    assert_eq!(fixture.motor().id(), ONE);
}

/// motor.md, "When frames cease": DDSM115 and DDSM210 keep their last command, and of the others it is assumed.
#[test]
fn without_drive_frames_every_model_keeps_its_speed() {
    for model in Model::ALL {
        assert_eq!(MotorConfig::of(model, ONE).when_silent, WhenSilent::Keep);
    }
    let mut fixture = Fixture::with_one_motor();
    fixture.drive_for(speed(100), ms(1000));
    fixture.wait(ms(60_000));
    assert!(fixture.motor().is_driven());
    let rpm = fixture.motor().speed_rpm();
    assert!((97.0..103.0).contains(&rpm), "{rpm} rpm");
}

#[test]
fn without_drive_frames_a_motor_that_keeps_its_command_keeps_a_current_and_an_angle() {
    let mut fixture = Fixture::with_one_motor();
    fixture.switch(Mode::Current);
    fixture.drive(current(0.3));
    fixture.wait(ms(2_000));
    let rpm = fixture.motor().speed_rpm();
    assert!(rpm > 150.0, "{rpm} rpm");
    let mut fixture = Fixture::with_one_motor();
    fixture.switch(Mode::Position);
    fixture.drive(angle(170.0));
    fixture.wait(ms(3_000));
    let degrees = fixture.motor().angle_deg();
    assert!((169.0..171.0).contains(&degrees), "{degrees} degrees");
    fixture.motor_mut().set_push_nm(0.3);
    fixture.wait(ms(3_000));
    let degrees = fixture.motor().angle_deg();
    assert!(
        (169.0..171.0).contains(&degrees),
        "pushed to {degrees} degrees"
    );
}

#[test]
fn what_a_motor_keeps_ends_with_its_power_and_with_its_loop() {
    let mut fixture = Fixture::with_one_motor();
    fixture.drive_for(speed(100), ms(1000));
    fixture.switch(Mode::Current);
    assert_eq!(fixture.motor().obeyed(), None);
    fixture.switch(Mode::Velocity);
    fixture.drive_for(speed(100), ms(1000));
    fixture.motor_mut().power(false);
    fixture.motor_mut().power(true);
    assert_eq!(fixture.motor().obeyed(), None);
}

#[test]
fn without_drive_frames_the_wheel_of_firmware_that_coasts_coasts() {
    let mut fixture = fixture_of(WhenSilent::CoastAfter(WhenSilent::AFTER));
    fixture.drive_for(speed(100), ms(1000));
    assert!(fixture.motor().is_driven());
    fixture.wait(ms(200));
    assert!(!fixture.motor().is_driven());
    assert_eq!(fixture.motor().torque_nm().to_bits(), 0);
    fixture.wait(ms(2000));
    let rpm = fixture.motor().speed_rpm();
    assert!((50.0..95.0).contains(&rpm), "it coasts at {rpm} rpm");
}

#[test]
fn without_drive_frames_the_wheel_of_firmware_that_brakes_is_braked_until_the_next() {
    let mut fixture = fixture_of(WhenSilent::BrakeAfter(WhenSilent::AFTER));
    fixture.switch(Mode::Current);
    fixture.drive_for(current(0.1), ms(500));
    assert!(fixture.motor().speed_rpm() > 50.0);
    fixture.wait(ms(600));
    assert!(!fixture.motor().is_driven());
    let rpm = fixture.motor().speed_rpm();
    assert!(rpm.abs() < 1.0, "{rpm} rpm");
    fixture.motor_mut().set_push_nm(0.3);
    fixture.wait(ms(2_000));
    let torque_nm = fixture.motor().torque_nm();
    assert!(
        torque_nm < -0.2,
        "the windings are shorted: {torque_nm} N.m"
    );
    fixture.motor_mut().set_push_nm(0.0);
    fixture.drive_for(current(0.1), ms(500));
    assert!(fixture.motor().is_driven());
}

#[test]
fn queries_alone_do_not_keep_a_motor_driven_that_coasts() {
    let mut fixture = fixture_of(WhenSilent::CoastAfter(WhenSilent::AFTER));
    fixture.drive_for(speed(100), ms(1000));
    for _ in 0..30 {
        fixture.query();
    }
    assert!(!fixture.motor().is_driven());
}

/// Not known of any motor (motor.md); firmware that keeps a speed is assumed to keep a brake.
#[test]
fn without_frames_a_brake_holds_or_lets_go_by_firmware() {
    let rpm_after = |when_silent| {
        let mut fixture = fixture_of(when_silent);
        fixture.drive_for(speed(120), ms(1500));
        fixture.drive_for(Setpoint::Brake, ms(20));
        assert!(!fixture.motor().is_driven());
        fixture.wait(ms(1000));
        fixture.motor().speed_rpm()
    };
    for when_silent in WhenSilent::ALL {
        let rpm = rpm_after(when_silent);
        let coasts = matches!(when_silent, WhenSilent::CoastAfter(_));
        let expected = if coasts { 2.0..20.0 } else { -0.1..0.1 };
        assert!(expected.contains(&rpm), "{when_silent:?}: {rpm} rpm");
    }
}

/// motor.md: 0xFF brakes, any other value does nothing.
#[test]
fn only_ff_brakes() {
    let mut fixture = Fixture::with_one_motor();
    let request = Request::Drive {
        id: ONE,
        drive: Drive {
            brake: 0xFE,
            ..speed(100).into()
        },
    };
    for _ in 0..100 {
        fixture.ask(request).expect("an answer");
    }
    assert!((fixture.motor().speed_rpm() - 100.0).abs() < 1.0);
}

#[test]
fn a_reversal_goes_through_zero_to_the_other_side() {
    let mut fixture = Fixture::with_one_motor();
    fixture.drive_for(speed(100), ms(1000));
    let time = fixture.drive_until(speed(-100), ms(2000), |motor| motor.speed_rpm() < -90.0);
    let time = time.expect("it gets there");
    assert!((ms(400)..ms(700)).contains(&time), "{time:?}");
    assert!((fixture.motor().speed_rpm() + 100.0).abs() < 1.0);
}

/// motor.md: switching into the position loop needs under 10 rpm and is silently refused above.
#[test]
fn the_position_loop_is_refused_at_10_rpm() {
    let mut fixture = Fixture::with_one_motor();
    fixture.drive_for(speed(12), ms(1000));
    fixture.switch(Mode::Position);
    assert_eq!(fixture.motor().mode(), Mode::Velocity);
    assert_eq!(fixture.query().mode, Mode::Velocity);
    fixture.drive_for(speed(8), ms(1000));
    fixture.switch(Mode::Position);
    assert_eq!(fixture.query().mode, Mode::Position);
}

#[test]
fn the_other_loops_may_be_entered_at_any_speed() {
    let mut fixture = Fixture::with_one_motor();
    fixture.drive_for(speed(100), ms(1000));
    fixture.switch(Mode::Current);
    assert_eq!(fixture.motor().mode(), Mode::Current);
    // The old 100 would have meant 0.024 A: a switch drops it and the wheel coasts.
    assert_eq!(fixture.motor().torque_nm().to_bits(), 0);
}

#[test]
fn how_many_switch_frames_it_takes_can_be_set() {
    let mut fixture = Fixture::new(WorldConfig {
        motors: vec![MotorConfig {
            mode_switch_frames: 3,
            ..MotorConfig::default()
        }],
        ..WorldConfig::default()
    });
    let switch = Request::SwitchMode {
        id: ONE,
        mode: Mode::Current,
    };
    for frames in 1..=3 {
        assert_eq!(
            fixture.motor().mode(),
            Mode::Velocity,
            "before frame {frames}"
        );
        fixture.send(switch.frame());
        fixture
            .drive(speed(0))
            .expect("driving on in between is allowed");
    }
    assert_eq!(fixture.motor().mode(), Mode::Current);
}

/// motor.md: zero current means coasting.
#[test]
fn in_the_current_loop_zero_coasts() {
    let mut fixture = Fixture::with_one_motor();
    fixture.switch(Mode::Current);
    fixture.drive_for(current(0.3), ms(1000));
    let before = fixture.motor().speed_rpm();
    assert!(before > 150.0, "{before}");
    fixture.drive_for(current(0.0), ms(1000));
    let rpm = fixture.motor().speed_rpm();
    assert!(rpm > before * 0.75, "{rpm} after {before}");
}

#[test]
fn a_negative_current_turns_the_other_way() {
    let mut fixture = Fixture::with_one_motor();
    fixture.switch(Mode::Current);
    fixture.drive_for(current(-0.3), ms(1000));
    assert!(fixture.motor().speed_rpm() < -150.0);
}

/// motor.md: a move goes where it is sent; about a second is what real units take for half a turn.
#[test]
fn the_position_loop_goes_the_shortest_way_and_stays() {
    let mut fixture = Fixture::with_one_motor();
    fixture.switch(Mode::Position);
    for target in [90.0, 350.0, 170.0, 10.0, 0.5, 180.0] {
        let start = fixture.motor().angle_deg();
        let way = fixture::turn_between(start, target).abs();
        let (mut travelled, mut before) = (0.0_f32, start);
        fixture.drive_watching(angle(target), ms(1200), |_, motor| {
            travelled += fixture::turn_between(before, motor.angle_deg()).abs();
            before = motor.angle_deg();
        });
        let off = fixture::turn_between(fixture.motor().angle_deg(), target);
        assert!(off.abs() < 1.0, "{off} degrees off {target}");
        assert!(
            travelled < way + 4.0,
            "{travelled} degrees travelled for {way}"
        );
        assert!(fixture.motor().speed_rpm().abs() < 1.0);
    }
}

#[test]
fn the_position_loop_holds_against_a_push() {
    let mut fixture = Fixture::with_one_motor();
    fixture.switch(Mode::Position);
    fixture.drive_for(angle(90.0), ms(1500));
    fixture.motor_mut().set_push_nm(0.5);
    fixture.drive_for(angle(90.0), ms(1000));
    let off = fixture::turn_between(fixture.motor().angle_deg(), 90.0);
    assert!(off.abs() < 1.0, "{off} degrees off");
    assert!(
        (fixture.motor().current_a() + 0.667).abs() < 0.02,
        "{}",
        fixture.motor().current_a()
    );
}

/// motor.md: up to 500 frames a second.
#[test]
fn more_than_500_frames_a_second_are_not_taken() {
    let mut fixture = Fixture::new(WorldConfig {
        turnaround: us(20),
        ..WorldConfig::default()
    });
    let query = Request::Query { id: ONE }.frame();
    let mut answers = 0;
    // 1.8 ms each: 555 a second.
    for _ in 0..1110 {
        fixture.world.transmit(fixture.now, query.bytes());
        fixture.now = fixture.now + us(1800);
        answers += usize::from(fixture.world.receive(fixture.now).is_some());
    }
    assert!((990..=1015).contains(&answers), "{answers} in 2 s");
}

#[test]
fn a_muted_motor_obeys_in_silence() {
    let mut fixture = Fixture::with_one_motor();
    fixture.motor_mut().mute(true);
    assert!(fixture.drive(speed(100)).is_none());
    fixture.drive_for(speed(100), ms(1000));
    assert!(fixture.motor().speed_rpm() > 90.0);
    fixture.motor_mut().mute(false);
    assert!(fixture.drive(speed(100)).is_some());
}

#[test]
fn without_power_a_motor_is_silent_and_coasts() {
    let mut fixture = Fixture::with_one_motor();
    fixture.switch(Mode::Current);
    fixture.drive_for(current(0.3), ms(500));
    fixture.motor_mut().power(false);
    assert!(fixture.drive(current(0.3)).is_none());
    let before = fixture.motor().speed_rpm();
    fixture.wait(ms(500));
    assert!(fixture.motor().speed_rpm() < before);
    fixture.motor_mut().power(true);
    assert_eq!(fixture.query().mode, Mode::Velocity);
}

#[test]
fn the_layout_follows_the_request_and_not_the_mode() {
    let mut fixture = Fixture::with_one_motor();
    for mode in Mode::ALL {
        fixture.switch(mode);
        let reply = fixture.query();
        assert_eq!(reply.mode, mode);
        assert_eq!(query_detail(&reply).0, 28);
        let zero = Request::Drive {
            id: ONE,
            drive: Setpoint::Brake.into(),
        };
        assert_eq!(zero.reply_layout(), Some(Layout::Drive));
        let reply = fixture.ask(zero).expect("an answer");
        assert!(fine_degrees(&reply) < 1.0, "{reply:?}");
    }
}

#[test]
fn a_free_wheel_runs_as_far_as_its_momentum_was_said_to_carry_it() {
    for rpm in [3, 40, 200] {
        let mut fixture = fixture_of(WhenSilent::CoastAfter(WhenSilent::AFTER));
        fixture.drive_for(speed(rpm), ms(3_000));
        fixture.wait(ms(101));
        assert_eq!(fixture.motor().obeyed(), None);
        let from = fixture.motor().turns();
        let said = fixture.motor().coasting_deg();
        fixture.wait(ms(30_000));
        assert_eq!(fixture.motor().coasting_deg().to_bits(), 0);
        let ran = (fixture.motor().turns() - from) * 360.0;
        let tolerance = 0.5 + said * 0.001;
        assert!((ran - said).abs() < tolerance, "{ran} for {said} degrees");
    }
}

#[test]
fn the_last_drive_frame_is_known_by_whether_it_is_obeyed() {
    let mut fixture = fixture_of(WhenSilent::CoastAfter(WhenSilent::AFTER));
    fixture.drive(speed(7));
    let (received, drive) = fixture.motor().obeyed().expect("it was heard");
    assert_eq!(drive.signed(), 7);
    fixture.wait(ms(150));
    assert_eq!(fixture.motor().obeyed(), None, "it coasts");
    assert_eq!(fixture.motor().last_drive(), Some((received, drive)));
}

/// One report says that `C8 64` with a value drives every motor.
#[test]
fn a_drive_frame_to_all_is_obeyed_only_where_a_motor_is_said_to() {
    for obeys_all in [false, true] {
        let mut fixture = Fixture::new(WorldConfig {
            motors: vec![MotorConfig {
                obeys_all,
                ..MotorConfig::default()
            }],
            ..WorldConfig::default()
        });
        fixture.ask(Request::drive(id(0xC8), speed(50)));
        assert_eq!(fixture.motor().is_driven(), obeys_all);
    }
}

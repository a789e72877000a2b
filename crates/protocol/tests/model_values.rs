//! What each model is, by its data sheet, and the values that it takes and reports.

use motorlink_protocol::{
    Acceleration, CurrentTarget, Drive, MotorId, PositionTarget, Setpoint, SpeedTarget,
    family::{
        Fault, Faults, FrameSet, Mode, Model, NotOfModel, OpenLoopTarget, Request, Speed, Wiring,
    },
};

/// The table of models: line, baud, frames, and the range of the velocity loop.
#[test]
fn models_have_the_published_line_frames_and_range() {
    let separate = |reply_offset| FrameSet::Separate { reply_offset };
    for (model, wiring, baud, frames, units, rpm, needs_enable) in [
        (
            Model::Ddsm115,
            Wiring::Rs485,
            115_200,
            FrameSet::Combined,
            1,
            330,
            false,
        ),
        (
            Model::Ddsm315,
            Wiring::Rs485,
            115_200,
            FrameSet::Combined,
            1,
            315,
            false,
        ),
        (
            Model::Ddsm210,
            Wiring::TtlUart,
            115_200,
            separate(0),
            10,
            210,
            false,
        ),
        (
            Model::Ddsm400,
            Wiring::SingleWire,
            38_400,
            separate(1),
            10,
            380,
            true,
        ),
    ] {
        let spec = model.spec();
        assert_eq!(
            (spec.wiring, spec.baud, spec.frames),
            (wiring, baud, frames)
        );
        assert_eq!((spec.speed_units_per_rpm, spec.speed_rpm_max), (units, rpm));
        assert_eq!((spec.needs_enable, spec.set_id_frames), (needs_enable, 5));
        assert!(!model.uncertain().is_empty(), "{model}");
        assert_eq!(model.has_separate_frames(), frames != FrameSet::Combined);
    }
}

/// The data sheets: speed and current without load, rated speed, the temperature that trips; and the time of a unit of
/// acceleration.
#[test]
fn models_have_the_published_nominal_figures() {
    for (model, figures, microseconds) in [
        (Model::Ddsm115, (200, Some(250), Some(115), Some(80)), 3_600),
        (Model::Ddsm315, (315, None, None, None), 3_600),
        (Model::Ddsm210, (210, Some(150), Some(98), Some(80)), 1_000),
        (Model::Ddsm400, (400, None, Some(100), None), 1_000),
    ] {
        let spec = model.spec();
        let nominal = spec.nominal;
        assert_eq!(
            (
                nominal.no_load_rpm,
                nominal.no_load_ma,
                nominal.rated_rpm,
                nominal.trips_at_c
            ),
            figures,
            "{model}"
        );
        assert_eq!(spec.acceleration_us_per_rpm, microseconds, "{model}");
    }
}

/// A stop in the frames of one is a stop of the other too.
#[test]
fn only_models_with_the_same_frames_and_baud_are_alike() {
    for model in Model::ALL {
        for other in Model::ALL {
            let pair = [Model::Ddsm115, Model::Ddsm315];
            let alike = model == other || pair.contains(&model) && pair.contains(&other);
            assert_eq!(model.is_like(other), alike, "{model} {other}");
        }
    }
}

/// A frame takes 868 us at 115200 baud and 2.6 ms at 38400.
#[test]
fn airtimes_are_those_of_the_baud() {
    let micros = |model: Model| model.frame_airtime().as_micros();
    assert_eq!(Model::ALL.map(micros), [868, 868, 868, 2_604]);
}

#[test]
fn loops_are_those_of_the_model() {
    for (model, bytes) in [
        (Model::Ddsm115, &[1, 2, 3][..]),
        (Model::Ddsm315, &[1, 2, 3]),
        (Model::Ddsm210, &[0, 2, 3]),
        (Model::Ddsm400, &[0, 1, 2, 3]),
    ] {
        for byte in 0..=255 {
            let mode = model.mode_of(byte);
            assert_eq!(mode.map(Mode::byte), bytes.contains(&byte).then_some(byte));
            assert!(mode.is_none_or(|mode| model.has(mode)));
        }
    }
    assert_eq!(Mode::OpenLoop.to_string(), "open loop");
}

#[test]
fn models_have_unlike_names_and_are_found_by_each() {
    for model in Model::ALL {
        let spec = model.spec();
        for name in [spec.name, spec.maker_name, spec.key] {
            assert_eq!(name.parse(), Ok(model));
        }
        assert_eq!(model.to_string(), spec.name);
    }
    let error = "ddsm500".parse::<Model>().unwrap_err();
    let text = "no such model: use one of ddsm115, ddsm315, ddsm210, ddsm400";
    assert_eq!(error.to_string(), text);
}

#[test]
fn faults_have_the_names_of_the_model() {
    let byte = 0b0110_1011;
    for (model, text) in [
        (
            Model::Ddsm115,
            "sensor, bus overcurrent, stall, unknown bits 0x60",
        ),
        (
            Model::Ddsm315,
            "sensor, bus overcurrent, stall, unknown bits 0x60",
        ),
        (Model::Ddsm210, "overcurrent, unknown bits 0x69"),
        (
            Model::Ddsm400,
            "sensor, overcurrent, stall, disconnected, over- or undervoltage",
        ),
    ] {
        let faults = Faults::of(model, byte);
        assert_eq!(faults.to_string(), text);
        assert_eq!(format!("{faults:?}"), format!("{text} (0x6B)"));
        assert_eq!(Faults::of(model, 0).to_string(), "OK");
        assert!(faults.any_named() && !Faults::of(model, 0x80).any_named());
        assert!(!faults.is_none() && Faults::of(model, 0).is_none());
        assert!(Faults::of(model, 0x10).contains(Fault::OverTemperature));
    }
    assert!(!Faults::of(Model::Ddsm210, 0x08).any_named());
    assert!(Faults::of(Model::Ddsm400, 0x08).contains(Fault::Stall));
    assert!(!Faults::of(Model::Ddsm400, 0x02).contains(Fault::BusOvercurrent));
    assert_eq!(
        Faults::of(Model::Ddsm115, 4).to_string(),
        "phase overcurrent"
    );
}

#[test]
fn a_setpoint_is_in_the_units_of_its_model() {
    let amps = |amps| Setpoint::Current(CurrentTarget::from_amps(amps));
    let rpm = |rpm| Setpoint::velocity(SpeedTarget::new(rpm).unwrap());
    let open = Setpoint::OpenLoop(OpenLoopTarget::new(-32_767).unwrap());
    let angle = Setpoint::Position(PositionTarget::new(32_767).unwrap());
    for (model, raw_100_rpm, raw_2_amps, raw_5_amps) in [
        (Model::Ddsm115, 100, 8_192, 20_479),
        (Model::Ddsm315, 100, 8_192, 20_479),
        (Model::Ddsm210, 1_000, 8_192, 20_479),
        (Model::Ddsm400, 1_000, 16_384, 32_767),
    ] {
        let value = |setpoint: Setpoint| setpoint.drive(model).signed();
        assert_eq!(
            [rpm(100), rpm(-100)].map(value),
            [raw_100_rpm, -raw_100_rpm]
        );
        for (amps_of, raw) in [(2.0, raw_2_amps), (5.0, raw_5_amps)] {
            assert_eq!(value(amps(amps_of)), raw, "{model}");
            assert_eq!(value(amps(-amps_of)), -raw, "{model}");
        }
        assert_eq!([open, angle].map(value), [-32_767, 32_767]);
        let brake = Setpoint::Brake.drive(model);
        assert_eq!((brake.signed(), brake.brake), (0, Drive::BRAKE));
        let gentle = Setpoint::Velocity {
            speed: SpeedTarget::new(1).unwrap(),
            acceleration: Acceleration::new(9),
        };
        assert_eq!(gentle.drive(model).acceleration.byte(), 9);
    }
}

/// The factor of ten between the models: the same number on the wire.
#[test]
fn the_same_raw_speed_is_ten_times_slower_in_tenths() {
    assert_eq!(Model::Ddsm115.speed_of_raw(100).to_string(), "+100 rpm");
    assert_eq!(Model::Ddsm210.speed_of_raw(100).to_string(), "+10 rpm");
    assert_eq!(Model::Ddsm400.speed_of_raw(-105).to_string(), "−10.5 rpm");
    assert_eq!(Model::Ddsm400.speed_of_raw(-105).tenths(), -105);
    for (tenths, of_115, of_210) in [(14, 1, 14), (15, 2, 15), (-14, -1, -14), (-15, -2, -15)] {
        let speed = Speed::from_tenths(tenths);
        assert_eq!(Model::Ddsm115.raw_of_speed(speed), of_115);
        assert_eq!(Model::Ddsm210.raw_of_speed(speed), of_210);
    }
    let limits = [i32::MIN, i32::MAX].map(Speed::from_tenths);
    assert_eq!(
        limits.map(|speed| Model::Ddsm210.raw_of_speed(speed)),
        [i16::MIN, i16::MAX]
    );
    assert_eq!(
        limits.map(|speed| Model::Ddsm115.raw_of_speed(speed)),
        [i16::MIN, i16::MAX]
    );
    assert_eq!(
        [9, -10, 19].map(|it| Speed::from_tenths(it).magnitude()),
        [0, 1, 1]
    );
    assert_eq!(Speed::from_tenths(-5).to_string(), "−0.5 rpm");
    assert_eq!(Speed::from_tenths(0).to_string(), "+0 rpm");
}

#[test]
fn a_refusal_says_what_to_do() {
    let (model, mode) = (Model::Ddsm210, Mode::Current);
    for (refusal, text) in [
        (
            NotOfModel::Mode { model, mode },
            "A DDSM210 has no current loop. Choose another loop.",
        ),
        (
            Request::Enable {
                id: MotorId::FIRST,
                on: true,
            }
            .frame(model)
            .unwrap_err(),
            "A DDSM210 has no enabling. Choose another frame.",
        ),
    ] {
        assert_eq!(refusal.to_string(), text);
    }
}

#[test]
fn open_loop_targets_have_the_range_of_the_wire() {
    assert!(OpenLoopTarget::new(-32_768).is_err());
    for (raw, text) in [(4_096, "+12.5 %"), (-32_767, "−100.0 %"), (17, "+0.1 %")] {
        assert_eq!(OpenLoopTarget::new(raw).unwrap().to_string(), text);
    }
    assert_eq!(OpenLoopTarget::new(5).unwrap().reversed().raw(), -5);
    assert_eq!(OpenLoopTarget::ZERO.raw(), 0);
    for (wire, raw) in [(-32_768, -32_767), (-32_767, -32_767), (5, 5)] {
        assert_eq!(OpenLoopTarget::nearest(wire).raw(), raw);
    }
}

#[test]
fn currents_are_in_the_scale_of_the_model_and_a_disputed_one_stays_raw() {
    let raw = 16_384;
    for (model, text, milliamps, certain) in [
        (Model::Ddsm115, "+4.000 A", 8_000, true),
        (Model::Ddsm315, "+4.000 A", 8_000, true),
        (Model::Ddsm210, "raw +16384", 8_000, false),
        (Model::Ddsm400, "+2.000 A", 4_000, true),
    ] {
        let current = model.current_of_raw(raw);
        assert_eq!(current.to_string(), text);
        assert_eq!(format!("{current:?}"), text);
        assert_eq!(current.scale().milliamps(), milliamps);
        assert_eq!(current.scale().is_certain(), certain);
        assert_eq!(current.raw(), raw);
    }
    assert_eq!(Model::Ddsm210.current_of_raw(-3).to_string(), "raw −3");
    let ampere = Model::Ddsm400.current_of_amps(1.0);
    assert_eq!((ampere.raw(), ampere.scaled().whole), (8_192, 1));
    for amps in [1.0, -2.5] {
        let current = Model::Ddsm400.current_of_amps(amps);
        assert!((current.amps() - amps).abs() < 0.000_1);
    }
    assert_eq!(Model::Ddsm400.current_of_amps(-9.0).raw(), i16::MIN);
    assert_eq!(Model::Ddsm400.current_of_amps(f32::NAN).raw(), 0);
}

//! What each model is, by its data sheet, and the values that it takes and reports.

use motorlink_protocol::{
    Acceleration, MotorId, PositionTarget,
    family::{
        Fault, Faults, FrameSet, Mode, Model, NotOfModel, OpenLoopTarget, Request, Setpoint, Speed,
        Wiring,
    },
};

fn value(model: Model, setpoint: Setpoint) -> i16 {
    setpoint.drive(model).unwrap().signed()
}

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
fn a_speed_is_in_the_unit_and_the_range_of_its_model() {
    for (model, tenths_max, raw_max) in [
        (Model::Ddsm115, 3_300, 330),
        (Model::Ddsm315, 3_150, 315),
        (Model::Ddsm210, 2_100, 2_100),
        (Model::Ddsm400, 3_800, 3_800),
    ] {
        for sign in [1, -1] {
            let most = Setpoint::velocity(model.speed(sign * tenths_max).unwrap());
            assert_eq!(i32::from(value(model, most)), sign * raw_max, "{model}");
            assert!(model.speed(sign * (tenths_max + 1)).is_err());
            let clamped = model.speed_clamped(sign * i32::MAX);
            assert_eq!(i32::from(clamped.tenths()), sign * tenths_max);
        }
        assert_eq!(model.speed_clamped(7), model.speed(7).unwrap());
    }
    let error = Model::Ddsm210.speed(2_101).unwrap_err().to_string();
    assert_eq!(
        error,
        "speed in tenths of an rpm must be -2100 to 2100, not 2101"
    );
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
    let target = Model::Ddsm210.speed(-5).unwrap();
    assert_eq!(target.to_string(), "−0.5 rpm");
    assert_eq!(target.reversed().to_string(), "+0.5 rpm");
}

#[test]
fn a_setpoint_of_another_model_is_refused() {
    for model in Model::ALL {
        let rpm_max = model.spec().speed_rpm_max;
        let faster = Model::Ddsm400.speed_clamped(i32::from(rpm_max) * 10 + 1);
        let refused = Setpoint::velocity(faster).drive(model);
        if model == Model::Ddsm400 {
            assert!(refused.is_ok());
        } else {
            assert_eq!(refused, Err(NotOfModel::Speed { model, rpm_max }));
        }
        let open = Setpoint::OpenLoop(OpenLoopTarget::new(-1).unwrap());
        assert_eq!(open.drive(model).is_ok(), model.has(Mode::OpenLoop));
        let current = Setpoint::Current(model.current(1).unwrap());
        assert_eq!(current.drive(model).is_ok(), model.has(Mode::Current));
    }
    let of_115 = Setpoint::Current(Model::Ddsm115.current(1).unwrap());
    let model = Model::Ddsm400;
    assert_eq!(of_115.drive(model), Err(NotOfModel::CurrentScale { model }));
    assert!(of_115.drive(Model::Ddsm315).is_ok());
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
            NotOfModel::Speed {
                model,
                rpm_max: 210,
            },
            "A DDSM210 takes at most 210 rpm. Ask for less.",
        ),
        (
            NotOfModel::CurrentScale { model },
            "The current is in the scale of another model than DDSM210. Set it again.",
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
fn drive_values_have_the_range_of_the_wire() {
    let model = Model::Ddsm400;
    let full = Setpoint::Position(PositionTarget::new(32_767).unwrap());
    let open = Setpoint::OpenLoop(OpenLoopTarget::new(-32_767).unwrap());
    let current = Setpoint::Current(model.current(-32_767).unwrap().reversed());
    assert_eq!(
        [full, open, current].map(|it| value(model, it)),
        [32_767, -32_767, 32_767]
    );
    assert!(model.current(-32_768).is_err() && OpenLoopTarget::new(-32_768).is_err());
    assert_eq!(OpenLoopTarget::new(4_096).unwrap().to_string(), "+12.5 %");
    assert_eq!(
        OpenLoopTarget::new(-32_767).unwrap().to_string(),
        "−100.0 %"
    );
    assert_eq!(OpenLoopTarget::new(5).unwrap().reversed().raw(), -5);
    assert_eq!(OpenLoopTarget::ZERO.raw(), 0);
    let gentle = Setpoint::Velocity {
        speed: model.speed(10).unwrap(),
        acceleration: Acceleration::new(9),
    };
    assert_eq!(gentle.drive(model).unwrap().acceleration.byte(), 9);
    let texts = [gentle, Setpoint::Brake, full, open, current].map(|it| it.to_string());
    assert_eq!(
        texts,
        ["+1 rpm", "brake", "360.00°", "−100.0 %", "+4.000 A"]
    );
    let of_each = [gentle, Setpoint::Brake, full, open, current].map(Setpoint::mode);
    let loops = [
        Mode::Velocity,
        Mode::Velocity,
        Mode::Position,
        Mode::OpenLoop,
        Mode::Current,
    ];
    assert_eq!(of_each, loops);
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
    assert!((ampere.amps() - 1.0).abs() < 0.000_1);
    assert_eq!(Model::Ddsm400.current_of_amps(-9.0).raw(), i16::MIN);
    assert_eq!(Model::Ddsm400.current_of_amps(f32::NAN).raw(), 0);
    let target = Model::Ddsm400.current(8_192).unwrap();
    assert_eq!(
        (target.raw(), target.to_string().as_str()),
        (8_192, "+1.000 A")
    );
    assert!((target.amps() - 1.0).abs() < 0.000_1);
    assert_eq!(target.scale(), ampere.scale());
}

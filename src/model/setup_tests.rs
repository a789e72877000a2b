//! A setup as a file: round trips, and every kind of invalid file.

use motorlink_messages::{
    bus::{Limits, Ramp},
    experiments::{analysis::WhenSilent, vehicle::Geometry},
    protocol::MotorId,
};
use proptest::{collection::btree_map, option, prelude::*, sample::select};

use super::*;
use crate::model::{
    names_and_sides::{NAME_MAX, NameAndSide, Side},
    scan_texts::tests::id,
};

const ROVER: &str = r#"{
  "motorlink_setup": 1,
  "model": "ddsm210",
  "detect_model": false,
  "command_rate_hz": 200,
  "keep_driving_while_hidden": false,
  "ramp_rpm_per_s": 300,
  "speed_limit_rpm": 120,
  "current_limit_ma": 1500,
  "temperature_limit_c": 60,
  "vehicle": { "wheel_radius_mm": 60, "track_width_mm": 420 },
  "motors": [
    { "id": 1, "name": "Front \"left\"", "side": "left", "drives_together": true, "when_frames_cease": "keeps" },
    { "id": 254, "name": "", "side": "none", "drives_together": false }
  ]
}
"#;

fn rover() -> Setup {
    let mut names = NamesAndSides::default();
    names.change(id(1), |member| {
        member.set_name("Front \"left\"");
        member.side = Side::Left;
        member.drives = true;
        member.when_silent = Some(WhenSilent::Keeps);
    });
    names.change(id(254), |_| {});
    Setup {
        model: Some(Model::Ddsm210),
        detect_model: Some(false),
        rate: CommandRate::new(200).ok(),
        keep_driving: Some(false),
        ramp: Some(300),
        speed_limit: Some(120),
        current_limit: Some(1_500),
        temperature_limit: Some(60),
        geometry: Geometry::new(60, 420),
        names: Some(names),
    }
}

/// The text of the error for this file.
fn refused(file: &str) -> String {
    match Setup::from_json(file.as_bytes()) {
        Ok(setup) => panic!("{file} was read as {setup:?}"),
        Err(error) => error.to_string(),
    }
}

/// A file with these fields behind the version.
fn with(fields: &str) -> String {
    format!("{{\"motorlink_setup\": 1, {fields}}}")
}

#[test]
fn a_setup_is_written_a_line_a_motor_and_read_as_the_same() {
    assert_eq!(rover().to_json(), ROVER);
    assert_eq!(Setup::from_json(ROVER.as_bytes()), Ok(rover()));
}

/// Files of the page that knew one model by two names.
#[test]
fn the_makers_name_is_read_as_the_model() {
    let old = Setup::from_json(with("\"model\": \"m0601\"").as_bytes()).unwrap();
    assert_eq!(old.model, Some(Model::Ddsm115));
}

#[test]
fn what_is_left_out_is_left_as_it_is() {
    let nothing = Setup::from_json(b"{\"motorlink_setup\": 1}");
    assert_eq!(nothing, Ok(Setup::default()));
    let nobody = Setup {
        names: Some(NamesAndSides::default()),
        ..Setup::default()
    };
    assert_eq!(Setup::from_json(nobody.to_json().as_bytes()), Ok(nobody));
    let bare = Setup::from_json(with("\"motors\": [{\"id\": 7}]").as_bytes());
    let names = bare.unwrap().names.unwrap();
    assert_eq!(names.member(id(7)), Some(&NameAndSide::default()));
}

#[test]
fn a_mark_of_an_editor_and_other_orders_are_read() {
    let file = "\u{FEFF}{\"motors\":[{\"side\":\"left\",\"id\":2},{\"id\":1}],\r\n\t\"motorlink_setup\":1}";
    let names = Setup::from_json(file.as_bytes()).unwrap().names.unwrap();
    let ids: Vec<u8> = names.members().map(|(id, _)| id.get()).collect();
    assert_eq!(ids, [1, 2]);
}

#[test]
fn a_value_that_does_not_fit_is_refused_with_its_place_and_what_is_allowed() {
    const MODEL: &str = "model: expected \"ddsm115\", \"ddsm315\", \"ddsm210\" or \"ddsm400\".";
    const RATE: &str = "command_rate_hz: expected a whole number from 1 to 500.";
    const DETECT: &str = "detect_model: expected true or false.";
    const KEEP: &str = "keep_driving_while_hidden: expected true or false.";
    const SPEED: &str = "speed_limit_rpm: expected a whole number from 1 to 380.";
    const CURRENT: &str = "current_limit_ma: expected a whole number from 100 to 8000.";
    const TEMPERATURE: &str = "temperature_limit_c: expected a whole number from 30 to 80.";
    const RAMP: &str = "ramp_rpm_per_s: expected a whole number from 0 to 10000.";
    for (field, refusal) in [
        ("\"model\": \"ddsm120\"", MODEL),
        ("\"model\": 1", MODEL),
        ("\"model\": null", MODEL),
        ("\"detect_model\": \"yes\"", DETECT),
        ("\"command_rate_hz\": 0", RATE),
        ("\"command_rate_hz\": 501", RATE),
        ("\"command_rate_hz\": -1", RATE),
        ("\"command_rate_hz\": 50.0", RATE),
        ("\"command_rate_hz\": 5e1", RATE),
        ("\"command_rate_hz\": \"50\"", RATE),
        ("\"command_rate_hz\": 99999999999999999999", RATE),
        ("\"keep_driving_while_hidden\": \"yes\"", KEEP),
        ("\"keep_driving_while_hidden\": 1", KEEP),
        ("\"ramp_rpm_per_s\": 10001", RAMP),
        ("\"ramp_rpm_per_s\": -0", RAMP),
        ("\"speed_limit_rpm\": 381", SPEED),
        ("\"current_limit_ma\": 2.7", CURRENT),
        ("\"temperature_limit_c\": 29", TEMPERATURE),
        (
            "\"vehicle\": { \"wheel_radius_mm\": 9, \"track_width_mm\": 300 }",
            "vehicle.wheel_radius_mm: expected a whole number from 10 to 500.",
        ),
        (
            "\"vehicle\": { \"wheel_radius_mm\": 51 }",
            "vehicle.track_width_mm: missing; expected a whole number from 50 to 3000.",
        ),
        ("\"motors\": {}", "motors: expected a list of motors."),
        ("\"motors\": [1]", "motors[0]: expected a JSON object."),
        (
            "\"speed_max_rpm\": 100",
            "speed_max_rpm: unknown field; known fields: motorlink_setup, model, detect_model, command_rate_hz, keep_driving_while_hidden, ramp_rpm_per_s, speed_limit_rpm, current_limit_ma, temperature_limit_c, vehicle, motors.",
        ),
        (
            "\"model\": \"m0601\", \"m\\u006fdel\": \"m0601\"",
            "model: duplicate field.",
        ),
        (
            "\"motorlink_setup\": 1",
            "motorlink_setup: duplicate field.",
        ),
    ] {
        assert_eq!(refused(&with(field)), refusal, "{field}");
    }
}

#[test]
fn a_motor_that_does_not_fit_is_refused_with_its_place_and_what_is_allowed() {
    const ID: &str = "id: expected a whole number from 1 to 254.";
    const NAME: &str = "name: expected text of at most 16 characters, no control characters.";
    const SIDE: &str = "side: expected \"none\", \"left\" or \"right\".";
    for (fields, refusal) in [
        ("\"id\": 0", ID),
        ("\"id\": 255", ID),
        ("\"id\": 257", ID),
        ("\"id\": \"1\"", ID),
        (
            "\"name\": \"x\"",
            "id: missing; expected a whole number from 1 to 254.",
        ),
        ("\"id\": 1", "id: duplicate ID."),
        ("\"id\": 3, \"name\": \"12345678901234567\"", NAME),
        ("\"id\": 3, \"name\": \"a\\nb\"", NAME),
        ("\"id\": 3, \"name\": \"\\u0000\"", NAME),
        ("\"id\": 3, \"name\": \"\\u009b\"", NAME),
        ("\"id\": 3, \"name\": null", NAME),
        ("\"id\": 3, \"side\": \"Left\"", SIDE),
        ("\"id\": 3, \"side\": true", SIDE),
        (
            "\"id\": 3, \"drives_together\": \"no\"",
            "drives_together: expected true or false.",
        ),
        (
            "\"id\": 3, \"when_frames_cease\": \"stops\"",
            "when_frames_cease: expected \"keeps\", \"coasts\" or \"brakes\".",
        ),
        (
            "\"id\": 3, \"side\": \"left\", \"side\": \"right\"",
            "side: duplicate field.",
        ),
        (
            "\"id\": 3, \"colour\\n\": 1",
            "colour: unknown field; known fields: id, name, side, drives_together, when_frames_cease.",
        ),
        (
            "\"id\": 3, \"a_name_that_goes_on_and_on_and_on_and_on\": 1",
            "a_name_that_goes_on_and_on_and_o: unknown field; known fields: id, name, side, drives_together, when_frames_cease.",
        ),
    ] {
        let file = with(&format!("\"motors\": [{{\"id\": 1}}, {{{fields}}}]"));
        assert_eq!(refused(&file), format!("motors[1].{refusal}"), "{fields}");
    }
}

#[test]
fn a_file_of_another_version_is_refused_whatever_else_is_in_it() {
    let allowed = "expected 1 (the supported version).";
    for version in ["2", "0", "\"1\"", "1.0", "true"] {
        let file = format!("{{\"new\": [], \"motorlink_setup\": {version}}}");
        assert_eq!(refused(&file), format!("motorlink_setup: {allowed}"));
    }
    let missing = format!("motorlink_setup: missing; {allowed}");
    assert_eq!(refused("{}"), missing);
    assert_eq!(refused("{\"package\": \"x\"}"), missing);
    for none in ["[]", "1", "null", "\"motorlink_setup\""] {
        assert_eq!(refused(none), "The file: expected a JSON object.");
    }
}

#[test]
fn what_is_no_json_is_refused_with_line_and_column() {
    for (file, line, column) in [
        ("", 1, 1),
        ("{", 1, 2),
        ("time,elapsed_s\n", 1, 2),
        ("{\n  \"motorlink_setup\": 1,\n}", 3, 1),
        ("{\"motorlink_setup\": 1} {", 1, 24),
        ("{\"motorlink_setup\": 01}", 1, 22),
        ("{\"motorlink_setup\": 1 // one\n}", 1, 23),
        ("{\"\u{e4}\u{1f6de}\": x}", 1, 8),
        ("{\"a\": \"\n\"}", 1, 8),
        ("{\"a\": \"\\ud800\"}", 1, 14),
        ("{'a': 1}", 1, 2),
    ] {
        let place = SetupError::NoJson { line, column };
        assert_eq!(Setup::from_json(file.as_bytes()), Err(place), "{file:?}");
    }
    let no_text = Setup::from_json(b"{\n \"\xff\"}");
    assert_eq!(no_text, Err(SetupError::NoJson { line: 2, column: 3 }));
    let deep = Setup::from_json("[".repeat(SETUP_BYTES_MAX).as_bytes());
    assert!(matches!(deep, Err(SetupError::NoJson { line: 1, .. })));
}

#[test]
fn the_longest_setup_fits_and_a_larger_file_is_not_even_read() {
    let mut names = NamesAndSides::default();
    for id in MotorId::all() {
        names.change(id, |member| {
            member.set_name(&"\u{1f6de}".repeat(NAME_MAX));
            member.side = Side::Right;
        });
    }
    let all = Setup {
        names: Some(names),
        ..rover()
    };
    let file = all.to_json();
    assert!(file.len() < SETUP_BYTES_MAX * 6 / 10, "{}", file.len());
    assert_eq!(Setup::from_json(file.as_bytes()), Ok(all));
    let file = " ".repeat(SETUP_BYTES_MAX + 1);
    assert_eq!(refused(&file), "File too large: a setup has at most 64 KB.");
}

#[test]
fn the_ranges_that_are_told_are_those_that_hold() {
    let (least, most) = (CommandRate::MIN, CommandRate::MAX);
    assert_eq!(NAME_MAX, 16);
    for (field, value) in [
        ("command_rate_hz", least),
        ("command_rate_hz", most),
        ("ramp_rpm_per_s", 0),
        ("ramp_rpm_per_s", Ramp::MAX),
        ("speed_limit_rpm", Limits::SPEED_RPM.0),
        ("speed_limit_rpm", Limits::SPEED_RPM.1),
        ("current_limit_ma", Limits::CURRENT_MA.0),
        ("current_limit_ma", Limits::CURRENT_MA.1),
        ("temperature_limit_c", Limits::TEMPERATURE_C.0),
        ("temperature_limit_c", Limits::TEMPERATURE_C.1),
    ] {
        let file = with(&format!("\"{field}\": {value}"));
        assert!(Setup::from_json(file.as_bytes()).is_ok(), "{file}");
    }
}

pub(crate) fn any_setup() -> impl Strategy<Value = Setup> {
    let name = "[\\PC]{0,16}".prop_map(|name| name.trim().to_owned());
    let member = (name, select(Side::ALL.to_vec()), any::<bool>());
    (
        (
            option::of(select(Model::ALL.to_vec())),
            option::of(any::<bool>()),
        ),
        option::of(1_u16..=500),
        option::of(any::<bool>()),
        option::of(0..=Ramp::MAX),
        (
            option::of(1_u16..=380),
            option::of(100_u16..=8_000),
            option::of(30_u16..=80),
        ),
        option::of((10_i32..=500, 50_i32..=3_000)),
        option::of(btree_map(1_u8..=254, member, 0..30)),
    )
        .prop_map(
            |(model, hertz, keep_driving, ramp, limits, geometry, members)| Setup {
                model: model.0,
                detect_model: model.1,
                rate: hertz.and_then(|hertz| CommandRate::new(hertz).ok()),
                keep_driving,
                ramp,
                speed_limit: limits.0,
                current_limit: limits.1,
                temperature_limit: limits.2,
                geometry: geometry.and_then(|(radius, track)| Geometry::new(radius, track)),
                names: members.map(|members| {
                    let mut names = NamesAndSides::default();
                    for (number, (name, side, drives)) in members {
                        names.change(id(number), |member| {
                            member.set_name(&name);
                            member.side = side;
                            member.drives = drives;
                            member.when_silent = drives.then_some(WhenSilent::Coasts);
                        });
                    }
                    names
                }),
            },
        )
}

proptest! {
    #[test]
    fn any_setup_comes_back_as_it_was(setup in any_setup()) {
        prop_assert_eq!(Setup::from_json(setup.to_json().as_bytes()), Ok(setup));
    }

    #[test]
    fn no_file_is_taken_by_halves(
        place in 0..ROVER.len(),
        cut in 0_usize..8,
        put in prop::collection::vec(any::<u8>(), 0..4),
    ) {
        let mut file = ROVER.as_bytes().to_vec();
        let end = (place + cut).min(file.len());
        file.splice(place..end, put);
        match Setup::from_json(&file) {
            // An imported setup can be exported again.
            Ok(setup) => {
                let again = Setup::from_json(setup.to_json().as_bytes()).unwrap();
                prop_assert_eq!(again.to_json(), setup.to_json());
            }
            Err(error) => prop_assert!(error.to_string().ends_with('.')),
        }
    }

    #[test]
    fn no_bytes_at_all_make_the_reader_panic(file in prop::collection::vec(any::<u8>(), 0..200)) {
        prop_assert!(Setup::from_json(&file).is_err());
    }
}

//! The JSON of a state.
#![cfg(test)]

use super::*;
use crate::{
    rover::tests::rover,
    telemetry::tests::{motor, state},
};

/// A valid state. `docs/fleet.md` shows its shape.
pub(in crate::fleet) fn json(session: &str) -> String {
    format!(
        concat!(
            r#"{{"format":1,"session":"{}","number":7,"level":"ok","#,
            r#""drive":{{"is":"stopped","why":"page_has_control","must_rest":false}},"#,
            r#""control":{{"by":"page","number":3}},"#,
            r#""link":{{"connected":true,"port_open":true}},"page":"http://rover.local:8055/","#,
            r#""motors":[{{"id":1,"joint":"left_wheel_joint","activity":"idle","#,
            r#""faults":0,"rpm":99.8,"current_a":0.31,"#,
            r#""temperature_c":28.0,"reply_age_ms":4}}]}}"#
        ),
        session
    )
}

fn sources<'a>(state: Option<&'a State>, rover: &'a Rover, age_us: u32) -> Sources<'a> {
    Sources {
        state,
        age_us,
        rover,
        drive: DriveStatus::of(state, Err(Why::NotAsked), false),
    }
}

#[test]
fn a_state_is_written_as_it_was_read() {
    let state = RobotState::read(json("a1").as_bytes()).unwrap();
    assert_eq!(String::from_utf8(state.write()).unwrap(), json("a1"));
    assert_eq!(state.driven_by(), "page 3");
    assert_eq!(state.hottest(), Some(28.0));
    assert_eq!(state.worst_motor(), None);
    let silent = json("a1").replacen(r#""faults":0"#, r#""silent":true"#, 1);
    let worst = |text: &str| RobotState::read(text.as_bytes()).unwrap().worst_motor();
    assert_eq!(worst(&silent), Some((1, MotorStatus::Silent)));
    let cut_off = silent.replace(r#""connected":true"#, r#""connected":false"#);
    assert_eq!(worst(&cut_off), None);
    assert_eq!(state.drive().to_string(), "stopped: a page has control");
}

/// Also of a robot that says it is fine.
#[test]
fn the_level_is_no_better_than_what_the_state_shows() {
    for (part, shows, level) in [
        (r#""faults":0"#, r#""faults":16"#, Level::Error),
        (r#""faults":0"#, r#""silent":true,"faults":0"#, Level::Error),
        (
            r#""faults":0"#,
            r#""turns_unasked":true,"faults":0"#,
            Level::Warning,
        ),
        (
            r#""must_rest":false"#,
            r#""must_rest":true"#,
            Level::Warning,
        ),
        ("stopped", "not_confirmed", Level::Error),
        (r#""level":"ok""#, r#""level":"error""#, Level::Error),
    ] {
        let text = json("a1").replacen(part, shows, 1);
        assert_eq!(
            RobotState::read(text.as_bytes()).unwrap().level,
            level,
            "{text}"
        );
    }
}

#[test]
fn a_word_of_a_later_version_is_not_known() {
    let later = json("a1")
        .replace("page_has_control", "later_reason")
        .replace(r#""idle""#, r#""later_activity""#)
        .replace(r#""number":7"#, r#""number":7,"later":1"#);
    let state = RobotState::read(later.as_bytes()).unwrap();
    assert_eq!((state.drive.why, state.motors[0].activity), (None, None));
    assert_eq!(state.level, Level::Ok, "the motor has replied");
}

/// The page of `motorlink serve --fleet` has a text for each word that a state may have.
#[test]
fn the_page_knows_every_word() {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../remote-server/src/fleet/words.json"
    );
    let words: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
    let phases = [
        Phase::Drives,
        Phase::DrivenByOther,
        Phase::Starting,
        Phase::Stopping,
        Phase::Stopped,
        Phase::NotConfirmed,
    ];
    for phase in phases {
        let word = serde_json::to_value(phase).unwrap();
        assert!(words["en"][word.as_str().unwrap()].is_string(), "{word}");
    }
    for word in crate::fleet::words::all_whys() {
        assert!(words["en"][word].is_string(), "{word}");
    }
}

#[test]
fn what_is_not_known_is_absent() {
    let rover = rover();
    let motors = vec![Motor {
        velocity: Some((f32::NAN, 0)),
        temperature: Some((28.04, 9_000_000)),
        ..motor(1)
    }];
    let newest = state(motors);
    let write = |state, age_us| {
        let made = RobotState::new("a1", 1, None, sources(state, &rover, age_us));
        assert_eq!(RobotState::read(&made.write()).as_ref(), Some(&made));
        String::from_utf8(made.write()).unwrap()
    };
    assert_eq!(
        write(Some(&newest), 10_000),
        concat!(
            r#"{"format":1,"session":"a1","number":1,"level":"error","#,
            r#""drive":{"is":"stopped","why":"not_asked","must_rest":false},"#,
            r#""control":{"by":"nobody"},"link":{"connected":true,"port_open":true},"#,
            r#""motors":[{"id":1,"joint":"wheel_1_joint","activity":"idle","faults":0,"#,
            r#""current_a":0.5,"temperature_c":28.0,"reply_age_ms":14},"#,
            r#"{"id":2,"joint":"wheel_2_joint"}]}"#
        )
    );
    let old = write(Some(&newest), 2_000_000);
    assert!(
        !old.contains("current_a") && !old.contains("temperature_c"),
        "{old}"
    );
    assert_eq!(
        write(None, 0),
        concat!(
            r#"{"format":1,"session":"a1","number":1,"level":"error","#,
            r#""drive":{"is":"not_confirmed","why":"no_connection","must_rest":false},"#,
            r#""link":{"connected":false},"#,
            r#""motors":[{"id":1,"joint":"wheel_1_joint"},{"id":2,"joint":"wheel_2_joint"}]}"#
        )
    );
}

#[test]
fn a_speed_has_the_sign_of_the_wheel_and_every_reason_its_word() {
    let (rover, newest) = (rover(), state(vec![motor(1), motor(2)]));
    let made = RobotState::new("a1", 1, None, sources(Some(&newest), &rover, 0));
    let rpm: Vec<_> = made.motors.iter().map(|motor| motor.rpm).collect();
    assert_eq!(rpm, [Some(9.5), Some(-9.5)]);
    assert_eq!(made.level, Level::Ok);
    for number in 1..=13 {
        let reason = motorlink_controller_messages::EndReason::of_number(number).unwrap();
        let drive = DriveStatus::of(Some(&newest), Err(Why::Ended(reason)), true);
        let sources = Sources {
            drive,
            ..sources(Some(&newest), &rover, 0)
        };
        let made = RobotState::new("a1", 1, None, sources);
        assert_eq!(made.level, Level::Warning);
        assert_eq!(RobotState::read(&made.write()), Some(made));
    }
}

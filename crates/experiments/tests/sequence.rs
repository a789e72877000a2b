//! Sequences as files and as plans: what is read, what is refused, and where.

use motorlink_experiments::{
    plan::{Fleet, Plan},
    sequence::{
        Action, End, Move, Problem, Quantity, Selection, Sequence, Step, Template, from_csv,
        schema, text_of,
    },
};
use motorlink_protocol::MotorId;

fn id(address: u8) -> MotorId {
    MotorId::new(address).unwrap()
}

fn fleet() -> Fleet {
    Fleet {
        groups: vec![("left".to_owned(), vec![id(1), id(9)])],
        ..Fleet::of([id(1), id(2)])
    }
}

fn with_steps(steps: &str) -> String {
    format!(r#"{{ "motorlink_sequence": 1, "steps": [{steps}] }}"#)
}

/// Reads and checks; gives the refusal.
fn refused(text: &str) -> String {
    let read = Sequence::from_json(text).and_then(|sequence| Plan::new(&sequence, &fleet()));
    read.expect_err("refused").to_string()
}

#[test]
fn what_does_not_fit_is_refused_at_its_place() {
    let table = [
        (
            r#"{ "rpm": 400, "for_s": 1 }"#,
            "steps[3].rpm: 400 is above 330",
        ),
        (
            r#"{ "rpm": -331, "for_s": 1 }"#,
            "steps[3].rpm: -331 is below -330",
        ),
        (
            r#"{ "amps": 7, "motor": 2, "for_s": 1 }"#,
            "steps[3].amps: 7 is above 6.1",
        ),
        (
            r#"{ "rpm": 1, "for_s": -2 }"#,
            "steps[3].for_s: -2 is below 0",
        ),
        (
            r#"{ "rpm": 1, "motor": 7, "for_s": 1 }"#,
            "steps[3].motor: no motor 7 here; scan for it, or use another",
        ),
        (
            r#"{ "rpm": 1, "motor": 0, "for_s": 1 }"#,
            "steps[3].motor: expected an ID from 1 to 254",
        ),
        (
            r#"{ "rpm": 1, "group": "right", "for_s": 1 }"#,
            "steps[3].group: no group of this name; use \"motor\" or a group",
        ),
        (
            r#"{ "repeat": null, "steps": [{ "rpm": 1, "for_s": 1 }] }"#,
            "steps[3].repeat: a loop without end; give the number of passes, 1 or more",
        ),
        (
            r#"{ "steps": [{ "rpm": 1, "for_s": 1 }] }"#,
            "steps[3].repeat: a loop without end; give the number of passes, 1 or more",
        ),
        (
            r#"{ "repeat": 0, "steps": [{ "rpm": 1, "for_s": 1 }] }"#,
            "steps[3].repeat: a loop without end; give the number of passes, 1 or more",
        ),
        (
            r#"{ "repeat": 10001, "steps": [{ "rpm": 1, "for_s": 1 }] }"#,
            "steps[3].repeat: 10001 is above 10000",
        ),
        (
            r#"{ "repeat": 2, "steps": [{ "rpm": 1, "for_s": 0 }] }"#,
            "steps[3].steps: a loop whose steps take no time",
        ),
        (
            r#"{ "repeat": 2, "steps": [{ "rpm": 900, "for_s": 1 }] }"#,
            "steps[3].steps[0].rpm: 900 is above 330",
        ),
        (r#"{ "rpm": 1 }"#, "steps[3].for_s: is missing"),
        (
            r#"{ "rpm": 1, "for_s": 1, "rmp": 2 }"#,
            "steps[3].rmp: unknown field; check its spelling",
        ),
        (
            r#"{ "rpm": 1, "for_s": 1, "rpm": 2 }"#,
            "steps[3].rpm: appears twice; keep one",
        ),
        (
            r#"{ "rpm": "fast", "for_s": 1 }"#,
            "steps[3].rpm: expected a number",
        ),
        (
            r#"{ "rpm": 1e999, "for_s": 1 }"#,
            "steps[3].rpm: expected a number",
        ),
        (
            r#"{ "for_s": 1 }"#,
            "steps[3]: expected one of rpm, amps, degrees, brake",
        ),
    ];
    refuses_each(&table);
}

/// Each step behind three good ones.
fn refuses_each(table: &[(&str, &str)]) {
    let good = r#"{ "rpm": 50, "for_s": 1 }"#;
    for (step, expected) in table {
        let text = with_steps(&format!("{good}, {good}, {good}, {step}"));
        assert_eq!(refused(&text), *expected, "{step}");
    }
}

#[test]
fn shapes_conditions_and_loops_that_do_not_fit_are_refused_at_their_place() {
    let table = [
        (
            r#"{ "rpm": 300, "shape": "sine", "amplitude": 50, "hz": 1, "for_s": 1 }"#,
            "steps[3].amplitude: 350 is above 330",
        ),
        (
            r#"{ "rpm": 0, "shape": "sine", "amplitude": 50, "hz": 400, "for_s": 1 }"#,
            "steps[3].hz: 400 is above 50",
        ),
        (
            r#"{ "rpm": 0, "shape": "ramp", "until": { "rpm_below": 1 }, "within_s": 1 }"#,
            "steps[3].until: cannot be used with a ramp or chirp, which ends after its time",
        ),
        (
            r#"{ "rpm": 0, "until": { "celsius_above": 400 }, "within_s": 1 }"#,
            "steps[3].until.celsius_above: 400 is above 80",
        ),
        (
            r#"{ "amps": 1, "for_s": 1 }"#,
            "steps[3]: motor 1 is driven in the velocity loop before; one run keeps each motor in one loop",
        ),
        (
            r#"{ "rpm": 1, "for_s": 86401 }"#,
            "steps[3].for_s: 86401 is above 86400",
        ),
        (
            r#"{ "repeat": 9000, "steps": [{ "rpm": 1, "for_s": 60 }] }"#,
            "steps: the run could take longer than 24 hours",
        ),
    ];
    refuses_each(&table);
}

#[test]
fn a_file_of_nothing_but_brackets_is_refused() {
    assert!(refused(&"[".repeat(1_000_000)).starts_with("not JSON"));
}

#[test]
fn another_version_and_what_is_no_sequence_are_refused() {
    assert_eq!(
        refused(r#"{ "motorlink_sequence": 2, "what_is_new": 1 }"#),
        "motorlink_sequence: written by a newer version; update this page to read it"
    );
    let no_sequence = "motorlink_sequence: not a sequence: \"motorlink_sequence\" must be 1";
    assert_eq!(refused(r#"{ "steps": [] }"#), no_sequence);
    assert_eq!(refused(r#"{ "motorlink_sequence": 0.5 }"#), no_sequence);
    assert_eq!(
        refused(r#"{ "motorlink_sequence": 1 }"#),
        "steps: is missing"
    );
    assert_eq!(refused(&with_steps("")), "steps: no steps; add one");
    assert_eq!(refused("{\n  rpm"), "not JSON at line 2, column 3");
}

#[test]
fn a_hundred_thousand_steps_are_refused() {
    let step = r#"{ "rpm": 1, "for_s": 0.01 },"#;
    let text = with_steps(step.repeat(100_000).trim_end_matches(','));
    assert_eq!(refused(&text), "steps: more than 10000 steps");
    // As a table that a page has built, without a file.
    let sequence = Sequence {
        steps: vec![Step::hold(Selection::All, Quantity::Rpm, 1.0, 0.01); 100_000],
        ..Sequence::default()
    };
    let error = Plan::new(&sequence, &fleet()).unwrap_err();
    assert_eq!(error.problem, Problem::TooManySteps { max: 10_000 });
}

#[test]
fn loops_in_loops_have_a_depth() {
    let mut inner = r#"{ "rpm": 1, "for_s": 1 }"#.to_owned();
    for _ in 0..5 {
        inner = format!(r#"{{ "repeat": 2, "steps": [{inner}] }}"#);
    }
    assert_eq!(
        refused(&with_steps(&inner)),
        "steps[0].steps[0].steps[0].steps[0].steps[0].steps: repeats are nested deeper than 4"
    );
}

#[test]
fn every_template_is_a_plan_and_comes_back_from_its_file() {
    for template in Template::ALL {
        let sequence = template.sequence();
        let plan = Plan::new(&sequence, &fleet()).unwrap_or_else(|error| {
            panic!("{}: {error}", template.name());
        });
        assert_eq!(plan.motors().len(), 2);
        let back = Sequence::from_json(&sequence.to_json()).unwrap();
        assert_eq!(back, sequence, "{}", template.name());
    }
}

#[test]
fn the_published_schema_is_that_of_the_program() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../docs/sequence.schema.json"
    );
    let file = std::fs::read_to_string(path).unwrap_or_default();
    if std::env::var_os("UPDATE_SCHEMA").is_some() {
        std::fs::write(path, schema()).unwrap();
        return;
    }
    assert_eq!(file, schema(), "run this test with UPDATE_SCHEMA=1");
    nojson::RawJson::parse(&file).expect("JSON");
}

#[test]
fn a_group_is_its_motors_that_are_here() {
    let text = with_steps(r#"{ "rpm": 1, "group": "left", "for_s": 1 }"#);
    let plan = Plan::new(&Sequence::from_json(&text).unwrap(), &fleet()).unwrap();
    let motors: Vec<MotorId> = plan.motors().iter().map(|motor| motor.id).collect();
    assert_eq!(motors, [id(1)]);
}

#[test]
fn a_csv_becomes_steps_that_last_until_the_next_row() {
    let text = "time_s,1 rpm,2 rpm\r\n0,0,0\r\n0.5,100,-100\r\n\r\n2.5,,0\r\n";
    let sequence = from_csv(text, &[]).unwrap();
    let hold =
        |motor, rpm, for_s| Step::hold(Selection::Motor(id(motor)), Quantity::Rpm, rpm, for_s);
    assert_eq!(
        sequence.steps,
        [
            hold(1, 0.0, 0.0),
            hold(2, 0.0, 0.5),
            hold(1, 100.0, 0.0),
            hold(2, -100.0, 2.0),
            hold(2, 0.0, 0.0),
        ]
    );
    assert!(Plan::new(&sequence, &fleet()).is_ok());
}

#[test]
fn a_csv_of_a_german_spreadsheet_is_read() {
    let sequence = from_csv("\u{FEFF}time_s;amps\n0;\"0,5\"\n1,5;0\n", &[]).unwrap();
    let hold = |amps, for_s| Step::hold(Selection::All, Quantity::Amps, amps, for_s);
    assert_eq!(sequence.steps, [hold(0.5, 1.5), hold(0.0, 0.0)]);
}

#[test]
fn a_csv_that_does_not_fit_is_refused_at_line_and_column() {
    let table = [
        ("time_s,rpm\n-1,0\n", "line 2, column 1: -1 is below 0"),
        (
            "time_s,rpm\n0,0\n0,1\n",
            "line 3, column 1: times must rise from row to row",
        ),
        (
            "time_s,rpm\n0,fast\n",
            "line 2, column 2: expected a number",
        ),
        (
            "time_s,rpm\n0,4000\n",
            "line 2, column 2: 4000 is above 380",
        ),
        ("time_s,degrees\n0,-1\n", "line 2, column 2: -1 is below 0"),
        (
            "time_s,rpm\n0,1,2\n",
            "line 2, column 3: unknown field; check its spelling",
        ),
        (
            "time_s,speed\n0,1\n",
            "line 1, column 2: expected time_s first, then columns such as rpm or \"1 rpm\"",
        ),
        (
            "",
            "line 1, column 1: expected time_s first, then columns such as rpm or \"1 rpm\"",
        ),
    ];
    for (text, expected) in table {
        assert_eq!(from_csv(text, &[]).unwrap_err().to_string(), expected);
    }
}

#[test]
fn a_csv_with_two_columns_for_one_motor_is_refused_at_the_second() {
    for head in [
        "1 rpm,1 rpm",
        "rpm,1 rpm",
        "1 rpm,rpm",
        "rpm,amps",
        "1 rpm,1 amps",
    ] {
        let error = from_csv(&format!("time_s,{head}\n0,1,2\n"), &[]).unwrap_err();
        let expected = "line 1, column 3: appears twice; keep one";
        assert_eq!(error.to_string(), expected, "{head}");
    }
}

#[test]
fn spreadsheets_in_many_forms_give_one_sequence() {
    let expected = from_csv("time,1 rpm,2 rpm\n0,0,0\n0.5,100,-100\n2.5,0,0\n", &[]).unwrap();
    let german = "time_s;1 rpm;2 rpm\r\n0;0;0\r\n0,5;100;-100\r\n2,5;0;0\r\n";
    let tabs = german.replace(';', "\t");
    let marked = format!("\u{FEFF}sep=;\r\n{german}");
    let points = german.replace(',', ".");
    let named = format!("sep=|\n{}", points.replace(';', "|"));
    for text in [german, &tabs, &marked, &points, &named] {
        assert_eq!(from_csv(text, &[]).unwrap(), expected, "{text}");
    }
    let utf_16 = |unit: fn(u16) -> [u8; 2]| {
        let marked = format!("\u{FEFF}{tabs}");
        marked.encode_utf16().flat_map(unit).collect::<Vec<u8>>()
    };
    for bytes in [utf_16(u16::to_le_bytes), utf_16(u16::to_be_bytes)] {
        assert_eq!(from_csv(&text_of(&bytes).unwrap(), &[]).unwrap(), expected);
    }
    let without_mark = &utf_16(u16::to_le_bytes)[2..];
    for bytes in [without_mark, b"time_s;rpm\n0;\xE4\n"] {
        let error = text_of(bytes).unwrap_err();
        assert_eq!(
            error.to_string(),
            "not text in UTF-8; save the file as CSV UTF-8"
        );
    }
}

#[test]
fn a_number_that_may_have_a_mark_for_thousands_is_never_read_as_another_one() {
    let refused = [
        "time_s;amps\n0;1.000\n",
        "time_s;amps\n0;1.5\n0,5;0\n",
        "time_s;amps\n0;1.000,5\n",
        "time_s\tamps\n0\t1.000\n",
        "time_s\tamps\n0\t-1,000\n",
        "time_s,amps\n0,\"1,000\"\n",
        "sep=;\ntime_s;amps\n0;1.000\n",
    ];
    for text in refused {
        let error = from_csv(text, &[]).unwrap_err();
        assert_eq!(error.problem, Problem::ThousandsMark, "{text}");
    }
    let read = [
        ("time_s,amps\n0,1.000\n", 1.0),
        ("time_s;amps\n0;0.125\n", 0.125),
        ("time_s;amps\n0;1,125\n", 1.125),
        ("time_s;amps\n0;-2.5\n", -2.5),
    ];
    for (text, amps) in read {
        let hold = Step::hold(Selection::All, Quantity::Amps, amps, 0.0);
        assert_eq!(from_csv(text, &[]).unwrap().steps, [hold], "{text}");
    }
}

#[test]
fn the_csv_of_a_run_is_read_as_the_setpoints_that_were_sent() {
    let head =
        "time,motor,speed_rpm,current_a,angle_deg,temperature_c,setpoint,setpoint_unit,step\n";
    let rows = "0.001000,1,0,0.000,1.00,,,,\n\
                0.005000,1,0,0.010,1.00,,50,rpm,0\n\
                0.006000,2,0,0.010,1.00,,-0,brake,0\n\
                0.505000,1,49,0.100,,31,50,rpm,0\n\
                1.005000,1,50,0.100,9.00,,0,rpm,1\n\
                2.005000,1,0,0.100,9.00,,0,rpm,1\n";
    let sequence = from_csv(&format!("{head}{rows}"), &[]).unwrap();
    let moves: Vec<(Selection, f64, f64)> = sequence
        .steps
        .iter()
        .map(|step| match step {
            Step::Move(Move {
                selection,
                action: Action::Follow { shape, .. },
                end: End::After(seconds),
            }) => (selection.clone(), shape.range(0.0).1, *seconds),
            Step::Move(Move {
                selection,
                action: Action::Brake,
                end: End::After(seconds),
            }) => (selection.clone(), f64::NAN, *seconds),
            other => panic!("{other:?}"),
        })
        .collect();
    let [first, brake, last] = &moves[..] else {
        panic!("{moves:?}");
    };
    let near = |one: f64, other: f64| (one - other).abs() < 1e-9;
    assert!(first.0 == Selection::Motor(id(1)) && near(first.1, 50.0) && near(first.2, 0.001));
    assert!(brake.0 == Selection::Motor(id(2)) && brake.1.is_nan() && near(brake.2, 0.999));
    assert!(last.0 == Selection::Motor(id(1)) && near(last.1, 0.0) && near(last.2, 1.0));
    let raw = format!("{head}0,1,,,,,5,raw,0\n");
    let error = from_csv(&raw, &[]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "line 2, column 8: expected rpm, A, deg or brake"
    );
}

/// Rows of the file that `crates/recorder/tests/csv_files.rs` compares with what the recorder writes.
#[test]
fn the_file_for_plotting_of_a_recording_is_read_with_mirrored_motors_turned() {
    let text = "\
time,motor_1_unmirrored_speed_rpm,motor_1_unmirrored_current_a,motor_1_unmirrored_position_deg,motor_1_temperature_c,motor_1_mode,motor_1_fault_code,motor_1_unmirrored_setpoint,motor_1_setpoint_mode,\
motor_7_unmirrored_speed_rpm,motor_7_unmirrored_current_a,motor_7_unmirrored_position_deg,motor_7_temperature_c,motor_7_mode,motor_7_fault_code,motor_7_unmirrored_setpoint,motor_7_setpoint_mode\r
0.000000,,,,,,,,,100,0.002,125.6,33,2,0,,\r
0.004000,,,,,,,,,100,0.002,125.6,33,2,0,-100,2\r
0.020000,-100,-0.250,66.96,,1,8,-0.250,1,,,,,,,,\r
0.030000,,,,,,,,,100,0.002,125.6,33,2,0,-100,2\r
1.529000,,,,,,,,,100,0.002,,,2,0,,\r
";
    let hold = |id: u8, quantity, value, for_s| {
        let motor = Selection::Motor(MotorId::new(id).unwrap());
        Step::hold(motor, quantity, value, for_s)
    };
    let read = |mirrored: &[MotorId]| {
        let mut steps = from_csv(text, mirrored).unwrap().steps;
        for step in &mut steps {
            let Step::Move(Move {
                end: End::After(time),
                ..
            }) = step
            else {
                panic!("no time");
            };
            *time = (*time * 1e6).round() / 1e6;
        }
        steps
    };
    let first = hold(1, Quantity::Amps, -0.25, 1.509);
    let seventh = |rpm| hold(7, Quantity::Rpm, rpm, 0.016);
    assert_eq!(read(&[]), [seventh(-100.0), first.clone()]);
    let seven = MotorId::new(7).unwrap();
    assert_eq!(read(&[seven]), [seventh(100.0), first]);
    let of_before = from_csv(&text.replace("_unmirrored", ""), &[]).unwrap();
    assert_eq!(of_before.steps.len(), 2, "columns without a sign");
    let open_loop = text.replacen(",-100,2", ",-100,0", 1);
    let error = from_csv(&open_loop, &[]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "line 3, column 17: expected the loop of the setpoint: 1, 2 or 3"
    );
}

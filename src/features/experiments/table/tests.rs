use motorlink_messages::{
    experiments::{
        plan::{Fleet, Plan},
        sequence::{Sequence, Template},
    },
    protocol::MotorId,
};

use super::{reading::places, *};

fn sequence(rows: &[Row]) -> Sequence {
    Sequence {
        steps: steps(rows).unwrap(),
        ..Sequence::default()
    }
}

#[test]
fn every_template_survives_the_table_and_a_file() {
    for template in Template::ALL {
        let asked = template.sequence();
        let rows = rows(&asked);
        assert_eq!(steps(&rows).unwrap(), asked.steps, "{template:?}");
        assert_eq!(places(&rows).len(), rows.len());
        let read = Sequence::from_json(&asked.to_json()).unwrap();
        assert_eq!(read, asked);
    }
}

#[test]
fn an_error_is_found_in_its_row_and_column() {
    let text = r#"{ "motorlink_sequence": 1, "steps": [
        { "rpm": 10, "for_s": 1 },
        { "repeat": 2, "steps": [
            { "rpm": 10, "for_s": 1 },
            { "rpm": 10, "until": { "degrees": 20, "tolerance": 1 }, "within_s": 5 } ] },
        { "rpm": 10, "shape": "sine", "amplitude": 5, "hz": 1, "for_s": 1 } ] }"#;
    let of_file = rows(&Sequence::from_json(text).unwrap());
    assert_eq!(of_file.len(), 6);
    for (row, column, typed) in [
        (0, Column::Value, "400"),
        (0, Column::Seconds, "-1"),
        (0, Column::Motors, "9"),
        (1, Column::Passes, "0"),
        (1, Column::Passes, "x"),
        (2, Column::Value, "five"),
        (3, Column::Bound, "400"),
        (3, Column::Tolerance, "0"),
        (5, Column::Amplitude, "400"),
        (5, Column::Hz, "0"),
        (5, Column::Acceleration, "256"),
    ] {
        let mut rows = of_file.clone();
        rows[row].set(column, typed);
        let fleet = Fleet::of([MotorId::FIRST]);
        let checked = steps(&rows).and_then(|steps| {
            let sequence = Sequence {
                steps,
                ..Sequence::default()
            };
            Plan::new(&sequence, &fleet)
        });
        let error = checked.unwrap_err();
        let found = find(&rows, &error.place);
        assert!(
            found == Some((row, column))
                || (found == Some((row, Column::Value)) && column == Column::Amplitude),
            "{typed} in {row} {column:?}: {error} at {found:?}"
        );
    }
}

#[test]
fn a_block_is_a_step_or_a_repeat_with_its_steps() {
    let rows = rows(&Template::Endurance.sequence());
    assert_eq!(block_end(&rows, 0), rows.len() - 1);
    assert_eq!(block_end(&rows, 1), 1);
    // Without its end a repeat goes on to the last row.
    let open = &rows[..rows.len() - 1];
    assert_eq!(steps(open).unwrap(), steps(&rows).unwrap());
    assert_eq!(block_end(open, 0), open.len() - 1);
    assert!(!sequence(&rows).steps.is_empty());
}

#[test]
fn an_empty_limit_is_none_and_a_decimal_comma_is_read() {
    let texts = [String::new(), "2,5".to_owned(), " 60 ".to_owned()];
    let limits = limits(&texts).unwrap();
    assert_eq!((limits.rpm, limits.amps), (None, Some(2.5)));
    assert_eq!(limits.celsius, Some(60.0));
    let wrong = ["fast".to_owned(), String::new(), String::new()];
    let error = super::limits(&wrong).unwrap_err();
    assert_eq!(error.place, "limits.rpm");
}

#[test]
fn ten_thousand_steps_are_read_and_checked() {
    let rows = vec![Row::new_step(); 10_000];
    let plan = Plan::new(&sequence(&rows), &Fleet::of([MotorId::FIRST])).unwrap();
    assert!((plan.longest_s() - 20_000.0).abs() < 1e-6);
}

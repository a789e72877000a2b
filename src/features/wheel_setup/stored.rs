//! The progress as text: the step, then one line per wheel.
//!
//! ```text
//! id 1
//! 1   left   yes  no  Front left
//! 2   right  no   no  Front right
//! ```
//!
//! The columns are separated by tabs: ID, side, whether the motor has the ID, whether the wheel is checked, name. If a
//! text has any other form, the setup starts at the first step.

use std::fmt::Write;

use crate::{
    features::wheel_setup::{
        state::{Setup, Step},
        wheel::{WHEELS_MAX, Wheel, problem},
    },
    model::{
        local_storage::{remember, remembered},
        names_and_sides::{NameAndSide, Side},
    },
};

/// The storage key.
const STORED_AS: &str = "wheel-setup";

/// The progress as text.
pub(crate) fn to_text(setup: &Setup) -> String {
    let mut text = match setup.step {
        Step::Wheels => "wheels\n".to_owned(),
        Step::Id(place) => format!("id {place}\n"),
        Step::Label(place) => format!("label {place}\n"),
        Step::Check => "check\n".to_owned(),
        Step::Spin => "spin\n".to_owned(),
        Step::Done => "done\n".to_owned(),
    };
    let yes = |is: bool| if is { "yes" } else { "no" };
    for wheel in &setup.wheels {
        let (id, side, name) = (wheel.id, wheel.side.key(), &wheel.name);
        let (has_id, is_checked) = (yes(wheel.has_id), yes(wheel.is_checked));
        let _ = writeln!(text, "{id}\t{side}\t{has_id}\t{is_checked}\t{name}");
    }
    text
}

/// Reads the progress from a text of [`to_text`]; `None` for any other text.
pub(crate) fn from_text(text: &str) -> Option<Setup> {
    let mut lines = text.lines();
    let step = lines.next()?;
    let wheels: Vec<Wheel> = lines.map(wheel).collect::<Option<_>>()?;
    let place = |number: &str| {
        let place: usize = number.parse().ok()?;
        (place < wheels.len()).then_some(place)
    };
    let step = match step.split_once(' ') {
        Some(("id", number)) => Step::Id(place(number)?),
        Some(("label", number)) => Step::Label(place(number)?),
        Some(_) => return None,
        None => match step {
            "wheels" => Step::Wheels,
            "check" => Step::Check,
            "spin" => Step::Spin,
            "done" => Step::Done,
            _ => return None,
        },
    };
    let is_bounded = wheels.len() <= WHEELS_MAX;
    let is_valid = step == Step::Wheels || problem(&wheels).is_none();
    (is_bounded && is_valid).then(|| Setup::at(step, wheels))
}

fn wheel(line: &str) -> Option<Wheel> {
    let mut parts = line.splitn(5, '\t');
    let id: u8 = parts.next()?.parse().ok()?;
    let side = Side::from_key(parts.next()?)?;
    let mut yes = || match parts.next()? {
        "yes" => Some(true),
        "no" => Some(false),
        _ => None,
    };
    let (has_id, is_checked) = (yes()?, yes()?);
    let name = parts.next()?;
    NameAndSide::is_name(name).then(|| Wheel {
        has_id,
        is_checked,
        ..Wheel::new(name, side, id.into())
    })
}

/// Loads the stored progress. If it is missing or invalid, the setup starts at the first step.
pub(crate) fn load() -> Setup {
    let stored = remembered(STORED_AS);
    stored.and_then(|text| from_text(&text)).unwrap_or_default()
}

/// Stores the progress in this browser.
pub(crate) fn save(setup: &Setup) {
    remember(STORED_AS, &to_text(setup));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::wheel_setup::wheel::Layout;

    #[test]
    fn every_step_is_restored() {
        let mut wheels = Layout::Four.wheels();
        wheels[0].has_id = true;
        wheels[2].is_checked = true;
        wheels[3].name = "Größe <b>".to_owned();
        for step in [
            Step::Wheels,
            Step::Id(0),
            Step::Id(3),
            Step::Label(2),
            Step::Check,
            Step::Spin,
            Step::Done,
        ] {
            let setup = Setup::at(step, wheels.clone());
            assert_eq!(from_text(&to_text(&setup)), Some(setup));
        }
    }

    #[test]
    fn unfinished_wheels_are_restored_in_the_first_step() {
        let mut wheels = Layout::Two.wheels();
        wheels[0].name.clear();
        wheels[1].id = 0;
        let setup = Setup::at(Step::Wheels, wheels.clone());
        assert_eq!(from_text(&to_text(&setup)), Some(setup));
        // In any other step they are invalid.
        assert_eq!(from_text(&to_text(&Setup::at(Step::Check, wheels))), None);
    }

    #[test]
    fn invalid_data_is_refused() {
        let good = to_text(&Setup::at(Step::Id(1), Layout::Two.wheels()));
        assert!(from_text(&good).is_some());
        let many = format!("wheels\n{}", "1\tleft\tno\tno\tx\n".repeat(17));
        for text in [
            "",
            "\u{0}",
            "id\n",
            "id 0\n",
            "check\n",
            &many,
            &good.replace("id 1", "id 2"),
            &good.replace("id 1", "id -1"),
            &good.replace("id 1", "jump 1"),
            &good.replace("\tleft", "\tup"),
            &good.replace("1\tleft", "256\tleft"),
            &good.replace("1\tleft", "200\tleft"),
            &good.replace("2\tright", "1\tright"),
            &good.replace("\tno\tno", "\tno"),
            &good.replace("\tno\tno", "\tperhaps\tno"),
            &good.replace("Left wheel", "A name with too many characters"),
            &format!("{good}\n"),
        ] {
            assert_eq!(from_text(text), None, "{text:?}");
        }
    }
}

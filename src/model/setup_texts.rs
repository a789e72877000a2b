//! The texts about imports of a setup.

use crate::model::setup::{Setup, SetupError};
use motorlink_i18n::tr;

/// The result of a successful import.
pub(crate) fn of_taken(setup: &Setup) -> String {
    let mut taken = String::new();
    let mut tell = |is_there: bool, what: &str| {
        if is_there {
            taken.push_str(if taken.is_empty() { "" } else { ", " });
            taken.push_str(what);
        }
    };
    tell(
        setup.model.is_some() || setup.detect_model.is_some(),
        tr!("model"),
    );
    tell(setup.rate.is_some(), tr!("command rate"));
    tell(
        setup.keep_driving.is_some(),
        tr!("keep driving while hidden"),
    );
    tell(setup.ramp.is_some(), tr!("ramp"));
    let limits = [
        setup.speed_limit,
        setup.current_limit,
        setup.temperature_limit,
    ];
    tell(limits.iter().any(Option::is_some), tr!("limits"));
    tell(setup.geometry.is_some(), tr!("measures of the vehicle"));
    match setup.names.as_ref().map(|names| names.members().count()) {
        Some(1) => tell(true, tr!("1 motor")),
        Some(motors) => tell(true, &tr!("{motors} motors", motors)),
        None => {}
    }
    if taken.is_empty() {
        tr!("The file contains no settings. Nothing was changed.").to_owned()
    } else {
        tr!("Imported: {taken}.", taken)
    }
}

/// Why nothing was imported.
pub(crate) fn of_misfit(error: &SetupError) -> String {
    of_refusal(&error.to_string())
}

/// The same for a reason outside of the file.
pub(crate) fn of_refusal(reason: &str) -> String {
    tr!("Nothing was changed. {reason}", reason)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_file(file: &str) -> String {
        let read = Setup::from_json(file.as_bytes());
        read.map_or_else(|error| of_misfit(&error), |setup| of_taken(&setup))
    }

    #[test]
    fn what_was_taken_is_named() {
        let all = r#"{"motorlink_setup": 1, "model": "m0601", "detect_model": true, "command_rate_hz": 50,
            "keep_driving_while_hidden": true, "ramp_rpm_per_s": 0, "speed_limit_rpm": 100, "motors": [{"id": 1}]}"#;
        assert_eq!(
            of_file(all),
            "Imported: model, command rate, keep driving while hidden, ramp, limits, 1 motor."
        );
        let nobody = r#"{"motorlink_setup": 1, "motors": []}"#;
        assert_eq!(of_file(nobody), "Imported: 0 motors.");
        assert!(of_file(r#"{"motorlink_setup": 1}"#).contains("no settings"));
    }

    #[test]
    fn a_refusal_says_that_nothing_was_changed_and_where_it_does_not_fit() {
        assert_eq!(
            of_file(r#"{"motorlink_setup": 1, "motors": [{"id": 1, "side": "up"}]}"#),
            "Nothing was changed. motors[0].side: expected \"none\", \"left\" or \"right\"."
        );
        assert_eq!(
            of_file("{\n  \"motorlink_setup\" 1}"),
            "Nothing was changed. Invalid JSON at line 2, column 21."
        );
    }
}

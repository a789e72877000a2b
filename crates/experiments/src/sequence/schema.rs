//! The JSON Schema of the file, with the limits that the program applies.

use super::{
    AMPS_MAX, CELSIUS_MAX, DEGREES_MAX, HZ_MAX, HZ_MIN, NAME_MAX, PASSES_MAX, RUN_MAX, STEPS_MAX,
};
use crate::plan::RPM_MAX;

/// The schema, with placeholders for the limits.
const TEMPLATE: &str = include_str!("schema.template");

/// The schema as a file, as `docs/sequence.schema.json` has it.
#[must_use]
pub fn schema() -> String {
    let number = |name: &str, min: f64, max: f64| {
        format!("\"{name}\": {{ \"type\": \"number\", \"minimum\": {min}, \"maximum\": {max} }}")
    };
    let setpoints = [
        number("rpm", -RPM_MAX, RPM_MAX),
        number("amps", -AMPS_MAX, AMPS_MAX),
        number("degrees", 0.0, DEGREES_MAX),
        number("amplitude", 0.0, DEGREES_MAX),
        number("hz", HZ_MIN, HZ_MAX),
        number("to_hz", HZ_MIN, HZ_MAX),
        number("within_s", 0.0, RUN_MAX.as_secs_f64()),
    ];
    let setpoints = setpoints.join(",\n        ");
    let limits = [
        number("rpm", 1.0, RPM_MAX),
        number("amps", 0.1, AMPS_MAX),
        number("celsius", 30.0, CELSIUS_MAX),
    ];
    let limits = limits.join(",\n        ");
    let conditions = [
        number("rpm_above", 0.0, RPM_MAX),
        number("rpm_below", 0.0, RPM_MAX),
        number("celsius_above", 0.0, CELSIUS_MAX),
        number("celsius_below", 0.0, CELSIUS_MAX),
        number("degrees", 0.0, DEGREES_MAX),
        number("tolerance", 0.1, 180.0),
    ];
    let conditions = conditions.join(",\n        ");
    let values = [
        ("@limits@", limits),
        ("@conditions@", conditions),
        ("@setpoints@", setpoints),
        ("\"@name_max@\"", NAME_MAX.to_string()),
        ("\"@steps_max@\"", STEPS_MAX.to_string()),
        ("\"@passes_max@\"", PASSES_MAX.to_string()),
        ("\"@run_max_s@\"", RUN_MAX.as_secs().to_string()),
    ];
    let filled = |text: String, (name, value): &(&str, String)| text.replace(name, value);
    values.iter().fold(TEMPLATE.to_owned(), filled)
}

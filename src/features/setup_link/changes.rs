//! What a setup would change, one line per setting.

use motorlink_i18n::tr;
use motorlink_messages::{experiments::vehicle::Geometry, protocol::MotorId};

use crate::{
    model::{
        names_and_sides::{NameAndSide, NamesAndSides},
        setup::Setup,
    },
    ui::format,
};

/// The settings that would change, with their present and their new value. Higher limits and what is less safe come
/// first and say so.
pub(crate) fn changes(now: &Setup, new: &Setup) -> Vec<String> {
    let mut raised = Vec::new();
    let mut others = Vec::new();
    let mut limit = |what: &str, from: Option<u16>, to: Option<u16>, words: fn(u16) -> String| {
        let (Some(from), Some(to)) = (from, to) else {
            return;
        };
        let change = line(what, &words(from), &words(to));
        if to > from {
            raised.push(tr!("{change} (higher limit)", change));
        } else if to < from {
            others.push(change);
        }
    };
    limit(
        tr!("Speed limit"),
        now.speed_limit,
        new.speed_limit,
        |value| format!("{value} {}", format::rpm()),
    );
    limit(
        tr!("Current limit"),
        now.current_limit,
        new.current_limit,
        |value| format!("{} A", format::milliamps(value)),
    );
    limit(
        tr!("Temperature limit"),
        now.temperature_limit,
        new.temperature_limit,
        |value| format!("{value} °C"),
    );
    let model = |setup: &Setup| setup.model.map(|model| model.spec().name.to_owned());
    let hertz = |setup: &Setup| setup.rate.map(|rate| format!("{} Hz", rate.hertz()));
    if let (Some(from), Some(to)) = (now.ramp, new.ramp)
        && from != to
    {
        let change = line(tr!("Ramp"), &ramp(from), &ramp(to));
        // Without a ramp, the target is reached at once.
        let is_faster = from != 0 && (to == 0 || to > from);
        if is_faster {
            raised.push(less_safe(&change));
        } else {
            others.push(change);
        }
    }
    let measure = |setup: &Setup, which: fn([i32; 2]) -> i32| {
        let measures = setup.geometry.map(Geometry::entered);
        measures.map(|measures| format!("{} mm", which(measures)))
    };
    let radius = |setup| measure(setup, |[radius, _]| radius);
    let track = |setup| measure(setup, |[_, track]| track);
    let yes = |value: Option<bool>| value.map(|yes| yes_or_no(yes).to_owned());
    for (what, from, to) in [
        (tr!("Model"), model(now), model(new)),
        (
            tr!("Detect the model"),
            yes(now.detect_model),
            yes(new.detect_model),
        ),
        (tr!("Command rate"), hertz(now), hertz(new)),
        (tr!("Wheel radius"), radius(now), radius(new)),
        (tr!("Track width"), track(now), track(new)),
    ] {
        if let (Some(from), Some(to)) = (from, to)
            && from != to
        {
            others.push(line(what, &from, &to));
        }
    }
    if let (Some(from), Some(to)) = (now.keep_driving, new.keep_driving)
        && from != to
    {
        let what = tr!("Keep driving while hidden");
        let (from, to) = (yes_or_no(from), yes_or_no(to));
        let change = line(what, from, to);
        if new.keep_driving == Some(true) {
            raised.push(less_safe(&change));
        } else {
            others.push(change);
        }
    }
    if let (Some(from), Some(to)) = (&now.names, &new.names) {
        // All of them are replaced: a motor that the setup does not name loses its name and side.
        for id in MotorId::all() {
            let (from, to) = (of_motor(from, id), of_motor(to, id));
            if from != to {
                others.push(line(&tr!("Motor {id}", id), &from, &to));
            }
        }
    }
    raised.extend(others);
    raised
}

fn less_safe(change: &str) -> String {
    tr!("{change} (less safe)", change)
}

fn yes_or_no(yes: bool) -> &'static str {
    if yes { tr!("yes") } else { tr!("no") }
}

/// `300 rpm/s`
fn ramp(rpm_per_s: u16) -> String {
    if rpm_per_s == 0 {
        return tr!("no ramp").to_owned();
    }
    format!("{rpm_per_s} {}/s", format::rpm())
}

/// `Ramp: no ramp → 300 rpm/s`
fn line(what: &str, from: &str, to: &str) -> String {
    format!("{what}: {from} → {to}")
}

/// `Port, left, in the group`
fn of_motor(names: &NamesAndSides, id: MotorId) -> String {
    let none = NameAndSide::default();
    let member = names.member(id).unwrap_or(&none);
    let group = if member.drives {
        tr!("in the group")
    } else {
        ""
    };
    let parts = [member.name().trim(), member.side.words(), group];
    let parts: Vec<&str> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    parts.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOW: &str = r#"{"motorlink_setup": 1, "model": "ddsm115", "detect_model": true,
        "command_rate_hz": 50, "keep_driving_while_hidden": true, "ramp_rpm_per_s": 0,
        "vehicle": {"wheel_radius_mm": 51, "track_width_mm": 300}, "speed_limit_rpm": 100, "current_limit_ma": 2700, "temperature_limit_c": 60,
        "motors": [{"id": 1, "name": "Port", "side": "left", "drives_together": true},
        {"id": 5, "name": "Old"}]}"#;

    fn of(new: &str) -> Vec<String> {
        let read = |file: &str| Setup::from_json(file.as_bytes()).unwrap();
        changes(&read(NOW), &read(new))
    }

    #[test]
    fn what_stays_is_not_listed() {
        assert!(of(NOW).is_empty());
        assert!(of(r#"{"motorlink_setup": 1}"#).is_empty());
        assert!(of(r#"{"motorlink_setup": 1, "speed_limit_rpm": 100}"#).is_empty());
    }

    #[test]
    fn a_raised_limit_comes_first_and_says_so() {
        let new = r#"{"motorlink_setup": 1, "model": "ddsm400", "speed_limit_rpm": 60,
            "current_limit_ma": 8000, "temperature_limit_c": 80}"#;
        assert_eq!(
            of(new),
            [
                "Current limit: 2.7 A → 8.0 A (higher limit)",
                "Temperature limit: 60 °C → 80 °C (higher limit)",
                "Speed limit: 100 rpm → 60 rpm",
                "Model: DDSM115 → DDSM400",
            ]
        );
    }

    #[test]
    fn what_is_less_safe_comes_first_and_says_so() {
        let now = NOW
            .replace("\"ramp_rpm_per_s\": 0", "\"ramp_rpm_per_s\": 300")
            .replace("hidden\": true", "hidden\": false");
        let of = |ramp: &str| {
            let new = format!(
                r#"{{"motorlink_setup": 1, "command_rate_hz": 100, "ramp_rpm_per_s": {ramp},
                "keep_driving_while_hidden": true}}"#
            );
            let read = |file: &str| Setup::from_json(file.as_bytes()).unwrap();
            changes(&read(&now), &read(&new))
        };
        let (hidden, rate) = (
            "Keep driving while hidden: no → yes (less safe)",
            "Command rate: 50 Hz → 100 Hz",
        );
        let removed = "Ramp: 300 rpm/s → no ramp (less safe)";
        assert_eq!(of("0"), [removed, hidden, rate]);
        let faster = "Ramp: 300 rpm/s → 400 rpm/s (less safe)";
        assert_eq!(of("400"), [faster, hidden, rate]);
        assert_eq!(of("200")[0], hidden);
        assert!(of("200").contains(&"Ramp: 300 rpm/s → 200 rpm/s".to_owned()));
    }

    #[test]
    fn each_motor_says_what_it_was_and_becomes() {
        let new = r#"{"motorlink_setup": 1, "detect_model": false, "command_rate_hz": 500,
            "keep_driving_while_hidden": false, "ramp_rpm_per_s": 300,
            "motors": [{"id": 2, "name": "<b>", "side": "right", "drives_together": true},
            {"id": 1, "name": "Port", "side": "left"}]}"#;
        assert_eq!(
            of(new),
            [
                "Ramp: no ramp → 300 rpm/s",
                "Detect the model: yes → no",
                "Command rate: 50 Hz → 500 Hz",
                "Keep driving while hidden: yes → no",
                "Motor 0x01: Port, left, in the group → Port, left",
                "Motor 0x02: no side → <b>, right, in the group",
                "Motor 0x05: Old, no side → no side",
            ]
        );
    }
}

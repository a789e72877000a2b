//! Which names and sides apply on which line.
//!
//! A virtual line with more than one motor has names and sides of its own: those that a person has entered for a real
//! vehicle stay as they are, and are back when that line is closed. One virtual motor shares the names of the
//! real line, as it always did.

use std::fmt::Write;

use motorlink_i18n::tr;
use motorlink_messages::{VirtualLine, VirtualMotors, protocol::family::Fault};

use crate::model::names_and_sides::NamesAndSides;

/// The line whose names and sides apply: a virtual one that has its own, or else the real one.
pub(crate) fn own(line: Option<VirtualLine>) -> Option<VirtualLine> {
    line.filter(|line| line.motors != VirtualMotors::One)
}

/// What this browser has stored for the line. A virtual line starts with the names and sides of its motors.
pub(crate) fn load(line: Option<VirtualLine>) -> NamesAndSides {
    let line = own(line);
    NamesAndSides::load(&stored_as(line))
        .unwrap_or_else(|| line.map(of_virtual).unwrap_or_default())
}

/// Stores the names and sides of the line in this browser.
pub(crate) fn save(names: &NamesAndSides, line: Option<VirtualLine>) {
    names.save(&stored_as(own(line)));
}

/// The storage key: of the real line, from the first versions, `fleet`; of a virtual one `fleet.23`.
fn stored_as(line: Option<VirtualLine>) -> String {
    let number = line.map(|line| format!(".{}", u8::from(line)));
    ["fleet", &number.unwrap_or_default()].concat()
}

/// The names and sides that a virtual line starts with. The wheels of a vehicle are a group.
fn of_virtual(line: VirtualLine) -> NamesAndSides {
    let names = match line.motors {
        VirtualMotors::Two => vec![tr!("Left wheel"), tr!("Right wheel")],
        VirtualMotors::Four => vec![
            tr!("Front left"),
            tr!("Front right"),
            tr!("Rear left"),
            tr!("Rear right"),
        ],
        VirtualMotors::One | VirtualMotors::Eight | VirtualMotors::Faults => {
            line.faults().iter().copied().map(name_of_fault).collect()
        }
    };
    // As a text, which is read anyway: a third of the code.
    let mut text = String::new();
    for (id, name) in (1..).zip(names) {
        let drives_and_side = match line.motors {
            VirtualMotors::Faults => "no\tnone",
            _ if id % 2 == 1 => "yes\tleft",
            _ => "yes\tright",
        };
        let _ = writeln!(text, "{id}\t{drives_and_side}\t{name}");
    }
    NamesAndSides::from_text(&text)
}

/// A name that fits a chip of the motor strip.
fn name_of_fault(fault: Fault) -> &'static str {
    match fault {
        Fault::Sensor => tr!("Sensor"),
        Fault::BusOvercurrent => tr!("Bus overcurrent"),
        Fault::PhaseOvercurrent => tr!("Phase current"),
        Fault::Overcurrent => tr!("Overcurrent"),
        Fault::Stall => tr!("Stall"),
        Fault::OverTemperature => tr!("Over-temperature"),
        Fault::Disconnected => tr!("Disconnected"),
        Fault::Voltage => tr!("Voltage"),
    }
}

#[cfg(test)]
mod tests {
    use motorlink_messages::protocol::family::Model;

    use super::*;
    use crate::model::names_and_sides::{NAME_MAX, NameAndSide, Side};

    fn line(motors: VirtualMotors, model: Model) -> VirtualLine {
        VirtualLine { motors, model }
    }

    #[test]
    fn the_wheels_of_a_rover_have_names_and_sides_and_drive_together() {
        let names = of_virtual(line(VirtualMotors::Four, Model::Ddsm400));
        let shown: Vec<_> = names
            .members()
            .map(|(id, member)| (id.get(), member.name(), member.side))
            .collect();
        assert_eq!(
            shown,
            [
                (1, "Front left", Side::Left),
                (2, "Front right", Side::Right),
                (3, "Rear left", Side::Left),
                (4, "Rear right", Side::Right),
            ]
        );
        assert_eq!(names.group_members().len(), 4);
        let two = of_virtual(line(VirtualMotors::Two, Model::Ddsm115));
        assert_eq!(two.group_members().len(), 2);
    }

    #[test]
    fn every_fault_names_its_motor_in_full() {
        for model in Model::ALL {
            let names = of_virtual(line(VirtualMotors::Faults, model));
            assert_eq!(names.members().count(), model.spec().faults.len());
            for fault in model.spec().faults {
                assert!(
                    NameAndSide::is_name(name_of_fault(*fault)),
                    "{fault:?}: {NAME_MAX} at most"
                );
            }
            assert!(names.group_members().is_empty());
        }
    }

    #[test]
    fn only_a_virtual_line_of_several_motors_has_names_of_its_own() {
        let one = line(VirtualMotors::One, Model::Ddsm400);
        assert_eq!(stored_as(own(None)), "fleet");
        assert_eq!(stored_as(own(Some(one))), "fleet");
        let mut keys: Vec<_> = [
            (VirtualMotors::Two, Model::Ddsm115),
            (VirtualMotors::Four, Model::Ddsm115),
            (VirtualMotors::Eight, Model::Ddsm115),
            (VirtualMotors::Faults, Model::Ddsm115),
            (VirtualMotors::Faults, Model::Ddsm400),
        ]
        .map(|(motors, model)| stored_as(own(Some(line(motors, model)))))
        .into();
        keys.push(stored_as(None));
        let all = keys.len();
        keys.sort();
        keys.dedup();
        assert_eq!(keys.len(), all);
    }
}

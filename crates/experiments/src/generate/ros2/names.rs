//! Names of links from the names of motors.

use std::collections::BTreeSet;

use crate::vehicle::{Vehicle, Wheel};

/// A name for each wheel, in the order of the vehicle. Each is different, and has small letters, digits and `_`.
pub(super) fn of_wheels(vehicle: &Vehicle) -> Vec<String> {
    // The other links and joints of the robot.
    let mut taken = BTreeSet::from(["base", "base_link", "base_footprint"].map(str::to_owned));
    let mut counted = [0_usize; 2];
    let name = |wheel: &Wheel| {
        let side = if wheel.is_right { "right" } else { "left" };
        let count = counted.get_mut(usize::from(wheel.is_right));
        let number = count.map_or(0, |count| {
            *count += 1;
            *count
        });
        let mut name = plain(&wheel.name);
        if name.is_empty() {
            name = if vehicle.side(wheel.is_right).count() == 1 {
                format!("{side}_wheel")
            } else {
                format!("{side}_wheel_{number}")
            };
        }
        while !taken.insert(name.clone()) {
            name = format!("{name}_{}", wheel.id.get());
        }
        name
    };
    vehicle.wheels().iter().map(name).collect()
}

/// `Front left` becomes `front_left`. A name in another script has no letter that is left.
fn plain(name: &str) -> String {
    let words = name.split(|character: char| !character.is_ascii_alphanumeric());
    let words: Vec<_> = words.filter(|word| !word.is_empty()).collect();
    let name = words.join("_").to_ascii_lowercase();
    // A name of ROS does not begin with a digit.
    if name.starts_with(|first: char| first.is_ascii_digit()) {
        format!("wheel_{name}")
    } else {
        name
    }
}

#[cfg(test)]
mod tests {
    use motorlink_protocol::MotorId;

    use super::*;

    fn named(names: &[&str]) -> Vec<String> {
        let wheels = (1..).zip(names).map(|(number, name)| Wheel {
            id: MotorId::new(number).unwrap(),
            is_right: number % 2 == 0,
            name: (*name).to_owned(),
        });
        of_wheels(&Vehicle::new(wheels.collect()).unwrap())
    }

    #[test]
    fn wheels_are_called_as_on_the_page_or_by_side_and_place() {
        assert_eq!(named(&["", ""]), ["left_wheel", "right_wheel"]);
        assert_eq!(
            named(&["Front left", "前右", "", "3 <b>"]),
            ["front_left", "right_wheel_1", "left_wheel_2", "wheel_3_b"]
        );
    }

    #[test]
    fn no_name_is_used_twice() {
        assert_eq!(
            named(&["left wheel", "Left Wheel!", "base-link", "base"]),
            ["left_wheel", "left_wheel_2", "base_link_3", "base_4"]
        );
    }
}

//! The wheels of a rover, as the user enters them.

use motorlink_i18n::tr;
use motorlink_messages::{
    bus::GroupSetpoints,
    protocol::{AssignableId, MotorId},
};

use crate::model::{
    names_and_sides::{NameAndSide, NamesAndSides, Side},
    tool_entry::{NO_NEW_ID, assignable},
};

/// The largest number of wheels: they drive as one group.
pub(crate) const WHEELS_MAX: usize = GroupSetpoints::MAX;

/// A wheel and its progress.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Wheel {
    /// As typed; see [`problem`].
    pub(crate) name: String,
    pub(crate) side: Side,
    /// As typed; [`NO_NEW_ID`] if the text is not an ID.
    pub(crate) id: i32,
    /// Whether a scan found its motor alone on the bus, with this ID.
    pub(crate) has_id: bool,
    /// Whether the user has seen this wheel turn, and turn forward.
    pub(crate) is_checked: bool,
}

impl Wheel {
    pub(crate) fn new(name: &str, side: Side, id: i32) -> Self {
        Self {
            name: name.to_owned(),
            side,
            id,
            has_id: false,
            is_checked: false,
        }
    }

    /// The ID of its motor; `None` if no valid ID is entered.
    pub(crate) fn assigned(&self) -> Option<AssignableId> {
        assignable(self.id)
    }

    /// The same ID, as the address of the motor.
    pub(crate) fn motor(&self) -> Option<MotorId> {
        self.assigned().map(AssignableId::id)
    }

    /// Changes the side, because the wheel turned backwards. It must be checked again.
    pub(crate) fn change_side(&mut self) {
        self.side = match self.side {
            Side::Right => Side::Left,
            Side::None | Side::Left => Side::Right,
        };
        self.is_checked = false;
    }
}

/// A set of wheels to start from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Layout {
    Two,
    Four,
    Six,
}

impl Layout {
    /// The names, sides and IDs of the virtual rovers.
    pub(crate) fn wheels(self) -> Vec<Wheel> {
        let names = match self {
            Self::Two => vec![tr!("Left wheel"), tr!("Right wheel")],
            Self::Four => vec![
                tr!("Front left"),
                tr!("Front right"),
                tr!("Rear left"),
                tr!("Rear right"),
            ],
            Self::Six => vec![
                tr!("Front left"),
                tr!("Front right"),
                tr!("Middle left"),
                tr!("Middle right"),
                tr!("Rear left"),
                tr!("Rear right"),
            ],
        };
        let sides = [Side::Left, Side::Right].into_iter().cycle();
        let wheels = (1..).zip(names).zip(sides);
        wheels
            .map(|((id, name), side)| Wheel::new(name, side, id))
            .collect()
    }
}

/// The lowest ID that no wheel has.
pub(crate) fn free_id(wheels: &[Wheel]) -> i32 {
    let is_free = |id: &i32| wheels.iter().all(|wheel| wheel.id != *id);
    let all = 1..=i32::from(MotorId::LAST.get());
    let mut free = all.filter(|id| assignable(*id).is_some()).filter(is_free);
    free.next().unwrap_or(NO_NEW_ID)
}

/// Why the entered wheels are not valid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Problem {
    NoWheels,
    TooMany,
    /// The name of the wheel in this row, from 0, is missing or too long.
    Name(usize),
    SameName(String),
    /// The ID of the wheel in this row, from 0, is missing, or no valid ID of a motor.
    Id(usize),
    SameId(MotorId),
}

/// The first problem of these wheels, from the top; `None` if they are valid.
pub(crate) fn problem(wheels: &[Wheel]) -> Option<Problem> {
    if wheels.is_empty() {
        return Some(Problem::NoWheels);
    }
    if wheels.len() > WHEELS_MAX {
        return Some(Problem::TooMany);
    }
    wheels.iter().enumerate().find_map(|(place, wheel)| {
        let before = || wheels.iter().take(place);
        let name = wheel.name.trim();
        if name.is_empty() || !NameAndSide::is_name(&wheel.name) {
            return Some(Problem::Name(place));
        }
        if before().any(|other| other.name.trim() == name) {
            return Some(Problem::SameName(name.to_owned()));
        }
        let Some(id) = wheel.motor() else {
            return Some(Problem::Id(place));
        };
        before()
            .any(|other| other.id == wheel.id)
            .then_some(Problem::SameId(id))
    })
}

/// These names and sides, with those of the wheels added. The wheels become the group.
pub(crate) fn with_wheels(names: &NamesAndSides, wheels: &[Wheel]) -> NamesAndSides {
    let mut names = names.clone();
    for (id, _) in names.group_members() {
        names.change(id, |member| member.drives = false);
    }
    for wheel in wheels {
        if let Some(id) = wheel.motor() {
            names.change(id, |member| {
                member.set_name(wheel.name.trim());
                member.side = wheel.side;
                member.drives = true;
            });
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{names_and_sides::tests::rover, scan_texts::tests::id};

    #[test]
    fn each_layout_is_valid_and_four_wheels_are_those_of_the_virtual_rover() {
        for (layout, count) in [(Layout::Two, 2), (Layout::Four, 4), (Layout::Six, 6)] {
            assert_eq!(layout.wheels().len(), count);
            assert_eq!(problem(&layout.wheels()), None);
        }
        let four: Vec<_> = Layout::Four
            .wheels()
            .into_iter()
            .map(|wheel| (wheel.id, wheel.name, wheel.side))
            .collect();
        assert_eq!(four[0], (1, "Front left".to_owned(), Side::Left));
        assert_eq!(four[3], (4, "Rear right".to_owned(), Side::Right));
    }

    #[test]
    fn the_first_problem_is_named() {
        let changed = |change: fn(&mut Vec<Wheel>)| {
            let mut wheels = Layout::Four.wheels();
            change(&mut wheels);
            problem(&wheels)
        };
        assert_eq!(changed(Vec::clear), Some(Problem::NoWheels));
        assert_eq!(
            changed(|wheels| wheels[1].name = " ".to_owned()),
            Some(Problem::Name(1))
        );
        assert_eq!(
            changed(|wheels| wheels[2].name = "Front left ".to_owned()),
            Some(Problem::SameName("Front left".to_owned()))
        );
        for wrong in [0, 200, 255, -1] {
            let mut wheels = Layout::Two.wheels();
            wheels[1].id = wrong;
            assert_eq!(problem(&wheels), Some(Problem::Id(1)), "{wrong}");
        }
        assert_eq!(
            changed(|wheels| wheels[3].id = 1),
            Some(Problem::SameId(id(1)))
        );
        let many = (1..=17).map(|id| Wheel::new(&id.to_string(), Side::None, id));
        assert_eq!(problem(&many.collect::<Vec<_>>()), Some(Problem::TooMany));
    }

    #[test]
    fn the_next_wheel_gets_the_lowest_free_id() {
        let mut wheels = Layout::Four.wheels();
        assert_eq!(free_id(&wheels), 5);
        wheels.remove(1);
        assert_eq!(free_id(&wheels), 2);
    }

    #[test]
    fn the_wheels_become_the_group_and_other_motors_keep_their_names() {
        let mut names = rover();
        names.change(id(9), |member| {
            member.set_name("Arm");
            member.drives = true;
        });
        let mut wheels = Layout::Two.wheels();
        wheels[1].id = 7;
        let names = with_wheels(&names, &wheels);
        assert_eq!(
            names.group_members(),
            [(id(1), Side::Left), (id(7), Side::Right)]
        );
        assert_eq!(names.member(id(7)).unwrap().name(), "Right wheel");
        assert_eq!(names.member(id(9)).unwrap().name(), "Arm");
        assert_eq!(names.side(id(2)), Side::Right);
    }
}

//! The names and sides of the motors and which of them drive together, stored by the browser for each ID.

use std::fmt::Write;

use motorlink_i18n::tr;
use motorlink_messages::{experiments::analysis::WhenSilent, protocol::MotorId};
use strum::IntoStaticStr;

use crate::model::{
    local_storage::{remember, remembered},
    mirror::Mirror,
};

/// The characters that fit into a chip of the motor strip.
pub(crate) const NAME_MAX: usize = 16;

/// On which side of a vehicle a motor sits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, IntoStaticStr)]
#[strum(serialize_all = "snake_case", const_into_str)]
pub(crate) enum Side {
    /// Not set.
    #[default]
    None,
    /// It turns forward at what it counts as positive speeds.
    Left,
    /// It is mounted mirrored: it turns forward at what it counts as negative speeds.
    Right,
}

impl Side {
    pub(crate) const ALL: [Self; 3] = [Self::None, Self::Left, Self::Right];

    /// The stored value.
    pub(crate) const fn key(self) -> &'static str {
        self.into_str()
    }

    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::None => tr!("no side"),
            Self::Left => tr!("left"),
            Self::Right => tr!("right"),
        }
    }

    pub(crate) fn from_key(key: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|side| side.key() == key)
    }

    /// The sign of speed and current of a motor on this side.
    pub(crate) const fn mirror(self) -> Mirror {
        match self {
            Self::None | Self::Left => Mirror::Straight,
            Self::Right => Mirror::Mirrored,
        }
    }
}

/// The stored settings of one motor.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct NameAndSide {
    /// At most [`NAME_MAX`] characters, none of them a control character.
    name: String,
    pub(crate) side: Side,
    /// Whether it is in the group.
    pub(crate) drives: bool,
    /// What it was measured to do when frames cease.
    pub(crate) when_silent: Option<WhenSilent>,
}

impl NameAndSide {
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Whether this is a valid name.
    pub(crate) fn is_name(text: &str) -> bool {
        text.chars().nth(NAME_MAX).is_none() && !text.chars().any(char::is_control)
    }

    /// Makes a valid name of the typed text.
    pub(crate) fn set_name(&mut self, typed: &str) {
        let characters = typed.chars().filter(|character| !character.is_control());
        self.name = characters.take(NAME_MAX).collect();
    }
}

/// The motors of the group, with their sides.
pub(crate) type GroupMembers = Vec<(MotorId, Side)>;

/// The stored settings of all motors, in the order of IDs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct NamesAndSides(Vec<(MotorId, NameAndSide)>);

impl NamesAndSides {
    /// Every motor with stored settings.
    pub(crate) fn members(&self) -> impl Iterator<Item = &(MotorId, NameAndSide)> {
        self.0.iter()
    }

    /// The stored settings of this motor.
    pub(crate) fn member(&self, id: MotorId) -> Option<&NameAndSide> {
        let mut members = self.0.iter();
        members.find(|(other, _)| *other == id).map(|(_, it)| it)
    }

    /// Its name; empty if it has none.
    pub(crate) fn name(&self, id: MotorId) -> &str {
        self.member(id).map_or("", |member| member.name().trim())
    }

    /// Its ID and name: `0x01 · Front left`.
    pub(crate) fn named(&self, id: MotorId) -> String {
        match self.name(id) {
            "" => id.to_string(),
            name => format!("{id} · {name}"),
        }
    }

    /// The sign of this motor's speed and current.
    pub(crate) fn mirror(&self, id: MotorId) -> Mirror {
        self.side(id).mirror()
    }

    /// Its side.
    pub(crate) fn side(&self, id: MotorId) -> Side {
        let side = self.member(id).map(|member| member.side);
        side.unwrap_or_default()
    }

    pub(crate) fn change(&mut self, id: MotorId, change: impl FnOnce(&mut NameAndSide)) {
        let place = self.0.partition_point(|(other, _)| *other < id);
        if self.0.get(place).is_none_or(|(other, _)| *other != id) {
            self.0.insert(place, (id, NameAndSide::default()));
        }
        if let Some((_, member)) = self.0.get_mut(place) {
            change(member);
        }
    }

    /// The motors that are selected for the group, with their sides.
    pub(crate) fn group_members(&self) -> GroupMembers {
        let driving = self.0.iter().filter(|(_, member)| member.drives);
        driving.map(|(id, member)| (*id, member.side)).collect()
    }

    /// One line per motor: `7 yes left Front left keeps`, with tabs between.
    fn to_text(&self) -> String {
        let mut text = String::new();
        for (id, member) in &self.0 {
            let drives = if member.drives { "yes" } else { "no" };
            let (side, name) = (member.side.key(), member.name.trim());
            let when_silent = member.when_silent.map_or("", WhenSilent::key);
            let id = id.get();
            let _ = writeln!(text, "{id}\t{drives}\t{side}\t{name}\t{when_silent}");
        }
        text
    }

    /// Malformed lines are skipped.
    pub(crate) fn from_text(text: &str) -> Self {
        let mut names = Self::default();
        for line in text.lines() {
            let mut parts = line.split('\t');
            let id = parts.next().and_then(|id| id.parse().ok());
            let drives = parts.next();
            let side = parts.next().and_then(Side::from_key);
            let (Some(id), Some(drives), Some(side)) = (id, drives, side) else {
                continue;
            };
            names.change(id, |member| {
                member.drives = drives == "yes";
                member.side = side;
                member.set_name(parts.next().unwrap_or_default());
                member.when_silent = parts.next().and_then(WhenSilent::from_key);
            });
        }
        names
    }

    /// Loads what this browser has stored under this key.
    pub(crate) fn load(key: &str) -> Option<Self> {
        remembered(key).map(|text| Self::from_text(&text))
    }

    /// Stores it in this browser.
    pub(crate) fn save(&self, key: &str) {
        remember(key, &self.to_text());
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::model::scan_texts::tests::id;

    pub(crate) fn rover() -> NamesAndSides {
        let mut names = NamesAndSides::default();
        for (number, side) in [(2, Side::Right), (1, Side::Left)] {
            names.change(id(number), |member| {
                member.side = side;
                member.drives = true;
            });
        }
        names
    }

    #[test]
    fn what_is_remembered_comes_back() {
        let mut names = rover();
        names.change(id(7), |member| member.set_name("<b>\"Front\" & left</b>"));
        names.change(id(1), |member| {
            member.when_silent = Some(WhenSilent::Keeps);
        });
        assert_eq!(names.member(id(7)).unwrap().name(), "<b>\"Front\" & lef");
        assert_eq!(NamesAndSides::from_text(&names.to_text()), names);
        assert_eq!(NamesAndSides::from_text(""), NamesAndSides::default());
        let garbage = "\u{0}\n255\tyes\tleft\tx\n1\n2\tyes\tup\tx\n\t\t\t";
        assert_eq!(NamesAndSides::from_text(garbage), NamesAndSides::default());
    }

    #[test]
    fn a_name_has_no_lines_and_an_end() {
        let mut member = NameAndSide::default();
        member.set_name("a\tb\nc");
        assert_eq!(member.name(), "abc");
        member.set_name(&"ä".repeat(40));
        assert_eq!(member.name().chars().count(), NAME_MAX);
    }
}

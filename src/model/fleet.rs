//! The names and sides of the motors and which of them drive together, stored by the browser for each ID.

use motorlink_i18n::tr;
use std::fmt::Write;

use motorlink_messages::{
    bus::{GroupError, GroupSetpoints},
    protocol::{MotorId, Setpoint, SpeedTarget},
};

use crate::{
    model::{
        mirror::Mirror,
        preferences::{remember, remembered},
    },
    ui::escape::escaped,
};

/// The characters that fit into a chip of the motor strip.
pub(crate) const NAME_MAX: usize = 16;

/// The storage key.
const STORED_AS: &str = "fleet";

/// On which side of a vehicle a motor sits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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
        match self {
            Self::None => "none",
            Self::Left => "left",
            Self::Right => "right",
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

    /// The speed of this side's wheels, in rpm of the motor: + is counter-clockwise, seen from its face.
    const fn rpm(self, wheels: Wheels) -> i32 {
        match self {
            Self::None | Self::Left => wheels.left,
            Self::Right => -wheels.right,
        }
    }
}

/// The stored settings of one motor.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Member {
    /// At most [`NAME_MAX`] characters, none of them a control character.
    name: String,
    pub(crate) side: Side,
    /// Whether it is in the group.
    pub(crate) drives: bool,
}

impl Member {
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
pub(crate) struct Fleet(Vec<(MotorId, Member)>);

impl Fleet {
    /// Every motor with stored settings.
    pub(crate) fn members(&self) -> impl Iterator<Item = &(MotorId, Member)> {
        self.0.iter()
    }

    /// The stored settings of this motor.
    pub(crate) fn member(&self, id: MotorId) -> Option<&Member> {
        let mut members = self.0.iter();
        members.find(|(other, _)| *other == id).map(|(_, it)| it)
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

    pub(crate) fn change(&mut self, id: MotorId, change: impl FnOnce(&mut Member)) {
        let place = self.0.partition_point(|(other, _)| *other < id);
        if self.0.get(place).is_none_or(|(other, _)| *other != id) {
            self.0.insert(place, (id, Member::default()));
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

    /// One line per motor: `7 yes left Front left`, with tabs between.
    fn to_text(&self) -> String {
        let mut text = String::new();
        for (id, member) in &self.0 {
            let drives = if member.drives { "yes" } else { "no" };
            let (side, name) = (member.side.key(), member.name.trim());
            let _ = writeln!(text, "{}\t{drives}\t{side}\t{name}", id.get());
        }
        text
    }

    /// Malformed lines are skipped.
    fn from_text(text: &str) -> Self {
        let mut fleet = Self::default();
        for line in text.lines() {
            let mut parts = line.splitn(4, '\t');
            let id = parts.next().and_then(|id| id.parse().ok());
            let drives = parts.next();
            let side = parts.next().and_then(Side::from_key);
            let (Some(id), Some(drives), Some(side)) = (id, drives, side) else {
                continue;
            };
            fleet.change(id, |member| {
                member.drives = drives == "yes";
                member.side = side;
                member.set_name(parts.next().unwrap_or_default());
            });
        }
        fleet
    }

    /// Loads what this browser has stored.
    pub(crate) fn load() -> Self {
        remembered(STORED_AS).map_or_else(Self::default, |text| Self::from_text(&text))
    }

    /// Stores it in this browser.
    pub(crate) fn save(&self) {
        remember(STORED_AS, &self.to_text());
    }
}

/// The setpoints for these speeds of the vehicle's wheels.
pub(crate) fn group_setpoints(
    members: &[(MotorId, Side)],
    wheels: Wheels,
) -> Result<GroupSetpoints, GroupError> {
    let part = |(id, side): &(MotorId, Side)| {
        let speed = SpeedTarget::clamped(side.rpm(wheels));
        (*id, Setpoint::velocity(speed))
    };
    let setpoints: Vec<_> = members.iter().map(part).collect();
    GroupSetpoints::new(&setpoints)
}

/// The rows of the panel `Drive together` as HTML: the motors that have answered, and the selected ones that
/// have not.
pub(crate) fn rows_html(found: &[MotorId], fleet: &Fleet) -> String {
    let mut html = String::new();
    for id in listed(found, fleet) {
        let member = fleet.member(id).cloned().unwrap_or_default();
        let number = id.get();
        let checked = if member.drives { " checked" } else { "" };
        let _ = write!(
            html,
            "<li class=\"fleet-row\"><label class=\"check\"><input type=\"checkbox\" \
             id=\"drive-{number}\" aria-label=\"{}\"{checked}><b>{id}</b></label>\
             <input type=\"text\" class=\"fleet-name\" id=\"name-{number}\" \
             aria-label=\"{}\" placeholder=\"{}\" maxlength=\"{NAME_MAX}\" \
             autocomplete=\"off\" spellcheck=\"false\" value=\"{}\">\
             <select class=\"select fleet-side\" id=\"side-{number}\" aria-label=\"{}\">",
            tr!("Drive {id}", id),
            tr!("Name of {id}", id),
            tr!("Name"),
            escaped(member.name()),
            tr!("Side of {id}", id)
        );
        for side in Side::ALL {
            let selected = if side == member.side { " selected" } else { "" };
            let words = match side {
                Side::None => tr!("no side"),
                Side::Left => tr!("left"),
                Side::Right => tr!("right"),
            };
            let key = side.key();
            let _ = write!(html, "<option value=\"{key}\"{selected}>{words}</option>");
        }
        html.push_str("</select></li>");
    }
    if html.is_empty() {
        let words = tr!("No motors found yet. Connect to see them here.");
        let _ = write!(html, "<li class=\"quiet\">{words}</li>");
    }
    html
}

/// The motors with a row.
pub(crate) fn listed(found: &[MotorId], fleet: &Fleet) -> Vec<MotorId> {
    let mut ids = found.to_vec();
    ids.extend(fleet.group_members().into_iter().map(|(id, _)| id));
    ids.sort_unstable();
    ids.dedup();
    ids
}

/// Speeds of a vehicle's sides in rpm; + is forward on both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Wheels {
    pub(crate) left: i32,
    pub(crate) right: i32,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::scan_texts::tests::id;

    fn rover() -> Fleet {
        let mut fleet = Fleet::default();
        for (number, side) in [(2, Side::Right), (1, Side::Left)] {
            fleet.change(id(number), |member| {
                member.side = side;
                member.drives = true;
            });
        }
        fleet
    }

    fn speeds(members: &[(MotorId, Side)], left: i32, right: i32) -> Vec<(u8, i16)> {
        let setpoints = group_setpoints(members, Wheels { left, right }).unwrap();
        let speed = |(id, setpoint): (MotorId, Setpoint)| match setpoint {
            Setpoint::Velocity { speed, .. } => (id.get(), speed.rpm()),
            other => panic!("{other:?}"),
        };
        setpoints.entries().map(speed).collect()
    }

    #[test]
    fn the_right_wheel_is_mirrored() {
        let members = rover().group_members();
        assert_eq!(members, [(id(1), Side::Left), (id(2), Side::Right)]);
        assert_eq!(speeds(&members, 100, 100), [(1, 100), (2, -100)], "forward");
        assert_eq!(speeds(&members, 50, -50), [(1, 50), (2, 50)], "on the spot");
        assert_eq!(speeds(&[(id(3), Side::None)], -20, -20), [(3, -20)]);
        assert_eq!(speeds(&members, 999, 999), [(1, 330), (2, -330)]);
        let wheels = Wheels { left: 1, right: 1 };
        assert_eq!(group_setpoints(&[], wheels), Err(GroupError::Empty));
    }

    #[test]
    fn what_is_remembered_comes_back() {
        let mut fleet = rover();
        fleet.change(id(7), |member| member.set_name("<b>\"Front\" & left</b>"));
        assert_eq!(fleet.member(id(7)).unwrap().name(), "<b>\"Front\" & lef");
        assert_eq!(Fleet::from_text(&fleet.to_text()), fleet);
        assert_eq!(Fleet::from_text(""), Fleet::default());
        let garbage = "\u{0}\n255\tyes\tleft\tx\n1\n2\tyes\tup\tx\n\t\t\t";
        assert_eq!(Fleet::from_text(garbage), Fleet::default());
    }

    #[test]
    fn a_name_has_no_lines_and_an_end() {
        let mut member = Member::default();
        member.set_name("a\tb\nc");
        assert_eq!(member.name(), "abc");
        member.set_name(&"ä".repeat(40));
        assert_eq!(member.name().chars().count(), NAME_MAX);
    }

    #[test]
    fn a_motor_that_is_to_drive_has_a_row_though_it_does_not_answer() {
        assert_eq!(listed(&[id(3)], &rover()), [id(1), id(2), id(3)]);
        assert!(rows_html(&[], &Fleet::default()).contains("Connect to see them here"));
    }

    #[test]
    fn a_row_shows_what_is_remembered_and_no_tag_of_a_person() {
        let mut fleet = rover();
        fleet.change(id(2), |member| member.set_name("\"><script>"));
        let html = rows_html(&[id(3)], &fleet);
        assert!(
            html.contains("value=\"&quot;&gt;&lt;script&gt;\""),
            "{html}"
        );
        assert!(!html.contains("<script"), "{html}");
        assert_eq!(html.matches(" checked").count(), 2);
        assert_eq!(html.matches(" selected").count(), 3);
        assert!(html.contains("<option value=\"right\" selected>"), "{html}");
    }
}

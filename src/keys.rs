//! Which key does what.

use motorlink_messages::protocol::Mode;

/// Where the keyboard's focus is when a key goes down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Focus {
    /// Nowhere, or on something that takes neither letters nor Space, such as a slider or a tab.
    Free,
    /// On something that Space presses: a button, a checkbox, a link.
    Button,
    /// On something that one types into or picks from by letters.
    Text,
}

/// What a key asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Act {
    /// Stop all motors.
    StopAll,
    /// Drive forward at the preset.
    Forward,
    /// Drive backward at the preset.
    Backward,
    /// Stop this motor.
    Stop,
    /// Brake this motor and hold the brake.
    Brake,
    /// Drive at this many rpm.
    Preset(i32),
    /// Switch the motor's loop.
    Switch(Mode),
    /// Open the help.
    Help,
}

impl Act {
    /// Whether a wheel may start by it, or a motor change its loop.
    pub(crate) const fn drives(self) -> bool {
        match self {
            Self::Forward | Self::Backward | Self::Preset(_) | Self::Switch(_) => true,
            Self::StopAll | Self::Stop | Self::Brake | Self::Help => false,
        }
    }
}

/// What a key asks for here, with `modified` where Ctrl, Alt or Meta is down.
pub(crate) fn act(key: &str, modified: bool, focus: Focus) -> Option<Act> {
    // Whatever has the focus and whatever else is pressed in haste.
    if key == "Escape" {
        return Some(Act::StopAll);
    }
    if focus == Focus::Text {
        return None;
    }
    if key == " " {
        return (focus == Focus::Free).then_some(Act::StopAll);
    }
    // Ctrl+C copies, Ctrl+F finds.
    if modified {
        return None;
    }
    Some(match key {
        "f" | "F" => Act::Forward,
        "b" | "B" => Act::Backward,
        "s" | "S" => Act::Stop,
        "k" | "K" => Act::Brake,
        "1" => Act::Preset(50),
        "2" => Act::Preset(100),
        "3" => Act::Preset(150),
        "4" => Act::Preset(200),
        "5" => Act::Preset(250),
        "v" | "V" => Act::Switch(Mode::Velocity),
        "c" | "C" => Act::Switch(Mode::Current),
        "p" | "P" => Act::Switch(Mode::Position),
        "?" => Act::Help,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escape_stops_wherever_the_focus_is() {
        for focus in [Focus::Free, Focus::Button, Focus::Text] {
            for modified in [false, true] {
                assert_eq!(act("Escape", modified, focus), Some(Act::StopAll));
            }
        }
    }

    #[test]
    fn space_stops_unless_something_else_takes_it() {
        assert_eq!(act(" ", false, Focus::Free), Some(Act::StopAll));
        assert_eq!(act(" ", true, Focus::Free), Some(Act::StopAll));
        assert_eq!(act(" ", false, Focus::Button), None);
        assert_eq!(act(" ", false, Focus::Text), None);
    }

    #[test]
    fn letters_and_digits_do_nothing_in_a_field_or_with_a_modifier() {
        for key in ["f", "B", "s", "k", "1", "5", "v", "c", "p", "?"] {
            assert!(act(key, false, Focus::Free).is_some(), "{key}");
            assert!(act(key, false, Focus::Button).is_some(), "{key}");
            assert_eq!(act(key, false, Focus::Text), None, "{key}");
            assert_eq!(act(key, true, Focus::Free), None, "{key}");
        }
    }

    /// Somebody who types a frame beside the textbox drives nothing.
    #[test]
    fn every_key_that_is_a_hex_digit_drives() {
        for digit in "0123456789abcdefABCDEF".chars() {
            let act = act(&digit.to_string(), false, Focus::Free);
            assert!(act.is_none_or(Act::drives), "{digit}");
        }
        for key in ["s", "k", "?", " ", "Escape"] {
            let act = act(key, false, Focus::Free).unwrap();
            assert!(!act.drives(), "{key}");
        }
    }

    #[test]
    fn digits_are_speeds() {
        let speeds = ["1", "2", "3", "4", "5"].map(|key| act(key, false, Focus::Free));
        let wanted = [50, 100, 150, 200, 250].map(|rpm| Some(Act::Preset(rpm)));
        assert_eq!(speeds, wanted);
        assert_eq!(act("6", false, Focus::Free), None);
    }
}

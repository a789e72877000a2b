//! The functions of the keys.

use motorlink_messages::protocol::Mode;

/// Where the keyboard's focus is when a key goes down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Focus {
    /// Nowhere, or on something that takes neither letters nor Space, such as a slider or a tab.
    Free,
    /// On something that Space presses: a button, a checkbox, a link.
    Button,
    /// On a list, open or closed: Space opens it and letters pick from it.
    List,
    /// On a field for a number.
    Number,
    /// On something that one types a text into.
    Text,
}

/// A key that stops all motors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StopKey {
    /// While anything is driven; at any time if Space does not act on the focused element.
    Space,
    /// Unless it is known that nothing moves: then it closes what is open.
    Escape,
}

impl StopKey {
    /// By the `key` of its event.
    pub(crate) fn of(key: &str) -> Option<Self> {
        match key {
            " " => Some(Self::Space),
            "Escape" => Some(Self::Escape),
            _ => None,
        }
    }
}

/// The state when a stop key is pressed or released.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Scene {
    /// Where the focus is.
    pub(crate) focus: Focus,
    /// Whether anything is driven or still moves.
    pub(crate) driven: bool,
    /// Whether it is known that nothing moves. A motor that does not answer may.
    pub(crate) at_rest: bool,
    /// Whether the worker has reported "Stop all motors".
    pub(crate) halted: bool,
}

/// What to do with the event of a stop key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reaction {
    /// All motors are stopped, and the focused control does not get the key.
    Stop,
    /// The focused control does not get the key.
    Take,
    /// The innermost open thing is closed; if nothing is open, the focused control gets the key.
    Close,
    /// The focused control gets the key.
    Pass,
}

/// The stop keys, each from press to release.
///
/// A browser presses a focused button when Space is released. So a release is handled like its press: a key
/// that stopped a wheel presses nothing, although the wheel stands still by then.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct StopKeys {
    space: Press,
    escape: Press,
}

/// How the press of a key was handled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Press {
    /// The key is up, or the page did not get its press.
    #[default]
    Unheard,
    /// The focused control got it.
    Passed,
    /// It stopped the motors.
    Taken,
}

impl StopKeys {
    /// The key goes down, or repeats.
    pub(crate) fn down(&mut self, key: StopKey, repeat: bool, scene: Scene) -> Reaction {
        let press = self.press(key);
        let stops = match key {
            StopKey::Escape => !scene.at_rest,
            StopKey::Space => match scene.focus {
                Focus::Free => true,
                Focus::Button | Focus::List | Focus::Number => scene.driven,
                Focus::Text => false,
            },
        };
        if stops {
            *press = Press::Taken;
            // A held key is one press, if the page got the first event.
            return if repeat && scene.halted {
                Reaction::Take
            } else {
                Reaction::Stop
            };
        }
        if key == StopKey::Escape {
            // One press closes one thing, and a press that stopped closes nothing.
            if repeat {
                return Reaction::Take;
            }
            *press = Press::Passed;
            return Reaction::Close;
        }
        // A repeated key whose press the page did not get was pressed for something else.
        if repeat && *press != Press::Passed && scene.focus != Focus::Text {
            *press = Press::Taken;
            return Reaction::Take;
        }
        *press = Press::Passed;
        Reaction::Pass
    }

    /// The key is released. If the page did not get the press, it stops now: an open list of the browser does
    /// not pass on the press of Escape.
    pub(crate) fn up(&mut self, key: StopKey, scene: Scene) -> Reaction {
        let text = key == StopKey::Space && scene.focus == Focus::Text;
        match std::mem::take(self.press(key)) {
            Press::Taken => Reaction::Take,
            Press::Unheard | Press::Passed if scene.driven && !text => Reaction::Stop,
            Press::Unheard | Press::Passed => Reaction::Pass,
        }
    }

    const fn press(&mut self, key: StopKey) -> &mut Press {
        match key {
            StopKey::Space => &mut self.space,
            StopKey::Escape => &mut self.escape,
        }
    }
}

/// The function of a key other than a stop key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum KeyAction {
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
    /// Show the tab of a loop.
    Show(Mode),
    /// Open the help.
    Help,
}

impl KeyAction {
    /// Whether it may start a wheel, or leaves a tool.
    pub(crate) const fn drives(self) -> bool {
        match self {
            Self::Forward | Self::Backward | Self::Preset(_) | Self::Show(_) => true,
            Self::Stop | Self::Brake | Self::Help => false,
        }
    }
}

/// The function of a key at this focus; `modified` if Ctrl, Alt or Meta is down.
pub(crate) fn key_action(key: &str, modified: bool, focus: Focus) -> Option<KeyAction> {
    // Ctrl+C copies, Ctrl+F finds.
    if modified || matches!(focus, Focus::List | Focus::Number | Focus::Text) {
        return None;
    }
    Some(match key {
        "f" | "F" => KeyAction::Forward,
        "b" | "B" => KeyAction::Backward,
        "s" | "S" => KeyAction::Stop,
        "k" | "K" => KeyAction::Brake,
        "1" => KeyAction::Preset(50),
        "2" => KeyAction::Preset(100),
        "3" => KeyAction::Preset(150),
        "4" => KeyAction::Preset(200),
        "5" => KeyAction::Preset(250),
        "v" | "V" => KeyAction::Show(Mode::Velocity),
        "c" | "C" => KeyAction::Show(Mode::Current),
        "p" | "P" => KeyAction::Show(Mode::Position),
        "?" => KeyAction::Help,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const EVERYWHERE: [Focus; 5] = [
        Focus::Free,
        Focus::Button,
        Focus::List,
        Focus::Number,
        Focus::Text,
    ];

    fn scene(focus: Focus, driven: bool) -> Scene {
        Scene {
            focus,
            driven,
            at_rest: !driven,
            halted: false,
        }
    }

    #[test]
    fn escape_stops_wherever_the_focus_is_unless_nothing_moves() {
        for focus in EVERYWHERE {
            let unknown = Scene {
                at_rest: false,
                ..scene(focus, false)
            };
            for scene in [scene(focus, true), unknown] {
                let mut keys = StopKeys::default();
                assert_eq!(keys.down(StopKey::Escape, false, scene), Reaction::Stop);
                assert_eq!(keys.up(StopKey::Escape, scene), Reaction::Take);
            }
        }
    }

    #[test]
    fn escape_at_a_standstill_closes_one_thing_a_press() {
        for focus in EVERYWHERE {
            let mut keys = StopKeys::default();
            let (standing, turning) = (scene(focus, false), scene(focus, true));
            assert_eq!(keys.down(StopKey::Escape, false, standing), Reaction::Close);
            assert_eq!(keys.down(StopKey::Escape, true, standing), Reaction::Take);
            assert_eq!(keys.up(StopKey::Escape, standing), Reaction::Pass);
            // A wheel that starts while the key is down is stopped, and that press closes nothing more.
            assert_eq!(keys.down(StopKey::Escape, false, standing), Reaction::Close);
            assert_eq!(keys.down(StopKey::Escape, true, turning), Reaction::Stop);
            assert_eq!(keys.down(StopKey::Escape, true, standing), Reaction::Take);
            assert_eq!(keys.up(StopKey::Escape, standing), Reaction::Take);
        }
    }

    #[test]
    fn space_while_driven_stops_everywhere_but_in_a_text_field() {
        for focus in EVERYWHERE {
            let mut keys = StopKeys::default();
            let scene = scene(focus, true);
            let (down, up) = if focus == Focus::Text {
                (Reaction::Pass, Reaction::Pass)
            } else {
                (Reaction::Stop, Reaction::Take)
            };
            assert_eq!(keys.down(StopKey::Space, false, scene), down, "{focus:?}");
            assert_eq!(keys.up(StopKey::Space, scene), up, "{focus:?}");
        }
    }

    #[test]
    fn space_at_a_standstill_is_left_to_the_focused_control() {
        for focus in [Focus::Button, Focus::List, Focus::Number, Focus::Text] {
            let mut keys = StopKeys::default();
            let scene = scene(focus, false);
            assert_eq!(keys.down(StopKey::Space, false, scene), Reaction::Pass);
            assert_eq!(keys.down(StopKey::Space, true, scene), Reaction::Pass);
            assert_eq!(keys.up(StopKey::Space, scene), Reaction::Pass);
        }
        let mut keys = StopKeys::default();
        let nowhere = scene(Focus::Free, false);
        assert_eq!(keys.down(StopKey::Space, false, nowhere), Reaction::Stop);
    }

    /// The button would be pressed by the release, and drive.
    #[test]
    fn the_release_of_a_space_that_stopped_presses_nothing_though_the_wheel_stands() {
        let mut keys = StopKeys::default();
        let (turning, standing) = (scene(Focus::Button, true), scene(Focus::Button, false));
        assert_eq!(keys.down(StopKey::Space, false, turning), Reaction::Stop);
        assert_eq!(keys.down(StopKey::Space, true, standing), Reaction::Take);
        assert_eq!(keys.up(StopKey::Space, standing), Reaction::Take);
        // The next press is one of its own.
        assert_eq!(keys.down(StopKey::Space, false, standing), Reaction::Pass);
    }

    #[test]
    fn a_space_that_is_held_while_a_wheel_starts_stops_it_and_presses_nothing() {
        let mut keys = StopKeys::default();
        let (turning, standing) = (scene(Focus::Button, true), scene(Focus::Button, false));
        assert_eq!(keys.down(StopKey::Space, false, standing), Reaction::Pass);
        assert_eq!(keys.up(StopKey::Space, turning), Reaction::Stop);
        assert_eq!(keys.down(StopKey::Space, false, standing), Reaction::Pass);
        assert_eq!(keys.down(StopKey::Space, true, turning), Reaction::Stop);
        assert_eq!(keys.up(StopKey::Space, standing), Reaction::Take);
    }

    #[test]
    fn a_key_held_down_stops_once_it_was_heard() {
        let mut keys = StopKeys::default();
        let told = Scene {
            halted: true,
            ..scene(Focus::Free, true)
        };
        let untold = scene(Focus::Free, true);
        assert_eq!(keys.down(StopKey::Escape, false, untold), Reaction::Stop);
        assert_eq!(keys.down(StopKey::Escape, true, untold), Reaction::Stop);
        assert_eq!(keys.down(StopKey::Escape, true, told), Reaction::Take);
        assert_eq!(keys.down(StopKey::Escape, false, told), Reaction::Stop);
    }

    #[test]
    fn a_release_whose_press_was_not_heard_stops_what_is_driven() {
        let up = |key, focus, driven| StopKeys::default().up(key, scene(focus, driven));
        for focus in EVERYWHERE {
            assert_eq!(up(StopKey::Escape, focus, true), Reaction::Stop);
            assert_eq!(up(StopKey::Escape, focus, false), Reaction::Pass);
        }
        assert_eq!(up(StopKey::Space, Focus::List, true), Reaction::Stop);
        assert_eq!(up(StopKey::Space, Focus::Text, true), Reaction::Pass);
    }

    #[test]
    fn letters_and_digits_do_nothing_in_a_field_or_with_a_modifier() {
        for key in ["f", "B", "s", "k", "1", "5", "v", "c", "p", "?"] {
            assert!(key_action(key, false, Focus::Free).is_some(), "{key}");
            assert!(key_action(key, false, Focus::Button).is_some(), "{key}");
            assert_eq!(key_action(key, false, Focus::Number), None, "{key}");
            assert_eq!(key_action(key, false, Focus::Text), None, "{key}");
            assert_eq!(key_action(key, false, Focus::List), None, "{key}");
            assert_eq!(key_action(key, true, Focus::Free), None, "{key}");
        }
    }

    /// Somebody who types a frame beside the textbox drives nothing.
    #[test]
    fn every_key_that_is_a_hex_digit_drives() {
        for digit in "0123456789abcdefABCDEF".chars() {
            let action = key_action(&digit.to_string(), false, Focus::Free);
            assert!(action.is_none_or(KeyAction::drives), "{digit}");
        }
        for key in ["s", "k", "?"] {
            let action = key_action(key, false, Focus::Free).unwrap();
            assert!(!action.drives(), "{key}");
        }
    }

    #[test]
    fn digits_are_speeds() {
        let speeds = ["1", "2", "3", "4", "5"].map(|key| key_action(key, false, Focus::Free));
        let wanted = [50, 100, 150, 200, 250].map(|rpm| Some(KeyAction::Preset(rpm)));
        assert_eq!(speeds, wanted);
        assert_eq!(key_action("6", false, Focus::Free), None);
    }
}

//! What a key of `control` asks for, and how long a held key drives.

use std::time::{Duration, Instant};

use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};

use super::arguments::Loop;

/// A terminal repeats a held key after half a second at the latest, and then some 30 times a second.
const FIRST_REPEAT_MAX: Duration = Duration::from_millis(700);
/// Five missed repeats.
const REPEAT_MAX: Duration = Duration::from_millis(180);

/// What a key asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asked {
    /// Drive in the chosen loop.
    Drive(Drive),
    /// Change the setpoint by so many steps, if the motor is driven.
    Nudge(i8),
    /// Drive in this loop from now on. It starts nothing.
    Choose(Loop),
    /// Brake, and keep braking.
    Brake,
    /// Stop the selected motors.
    Stop,
    /// Stop all motors; none drives before Release.
    StopAll,
    /// Allow driving again.
    Release,
    /// Select the next motor, or the one before.
    Select(i8),
    /// Drive all motors together, or the selected one.
    Group,
    /// Stop everything and leave.
    Quit,
}

/// A key that drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drive {
    Forward,
    Backward,
    /// One of the keys 1 to 5.
    Preset(u8),
}

/// What this key asks for.
pub fn asked(key: KeyEvent) -> Option<Asked> {
    if key.kind == KeyEventKind::Release {
        return None;
    }
    if key.modifiers.contains(KeyModifiers::CONTROL) {
        return (key.code == KeyCode::Char('c')).then_some(Asked::Quit);
    }
    Some(match key.code {
        KeyCode::Char(' ') | KeyCode::Esc => Asked::StopAll,
        KeyCode::Left => Asked::Nudge(-1),
        KeyCode::Right => Asked::Nudge(1),
        KeyCode::Up | KeyCode::BackTab => Asked::Select(-1),
        KeyCode::Down | KeyCode::Tab => Asked::Select(1),
        KeyCode::Char(letter) => match letter.to_ascii_lowercase() {
            'f' => Asked::Drive(Drive::Forward),
            'b' => Asked::Drive(Drive::Backward),
            digit @ '1'..='5' => {
                Asked::Drive(Drive::Preset(u8::try_from(digit.to_digit(10)?).ok()?))
            }
            'v' => Asked::Choose(Loop::Velocity),
            'c' => Asked::Choose(Loop::Current),
            'p' => Asked::Choose(Loop::Position),
            's' => Asked::Stop,
            'k' => Asked::Brake,
            'r' => Asked::Release,
            'g' => Asked::Group,
            'q' => Asked::Quit,
            _ => return None,
        },
        _ => return None,
    })
}

/// A key that drives for as long as it is held.
///
/// Most terminals report no release. A held key repeats, so a repeat that does not come is a release.
#[derive(Clone, Copy, Debug, Default)]
pub struct Held {
    key: Option<(KeyCode, Instant)>,
}

impl Held {
    /// A key that drives was pressed, or repeats. Returns whether it was pressed: a repeat must not start again what was
    /// stopped meanwhile.
    pub fn press(&mut self, code: KeyCode, now: Instant) -> bool {
        let repeats = self
            .key
            .is_some_and(|(held, until)| held == code && now <= until);
        let lasts = if repeats {
            REPEAT_MAX
        } else {
            FIRST_REPEAT_MAX
        };
        self.key = Some((code, now + lasts));
        !repeats
    }

    /// A terminal that reports releases has reported one.
    pub fn release(&mut self, code: KeyCode, now: Instant) {
        if self.key.is_some_and(|(held, _)| held == code) {
            self.key = Some((code, now));
        }
    }

    /// Nothing is held any more, as after a stop.
    pub const fn clear(&mut self) {
        self.key = None;
    }

    /// Whether the key was let go by now. Says so once.
    pub fn is_let_go(&mut self, now: Instant) -> bool {
        let is_over = self.key.is_some_and(|(_, until)| now >= until);
        if is_over {
            self.key = None;
        }
        is_over
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(code: KeyCode) -> KeyEvent {
        KeyEvent::new(code, KeyModifiers::NONE)
    }

    #[test]
    fn the_keys_are_those_of_the_page() {
        let drive = |drive| Some(Asked::Drive(drive));
        assert_eq!(asked(key(KeyCode::Char('F'))), drive(Drive::Forward));
        assert_eq!(asked(key(KeyCode::Char('b'))), drive(Drive::Backward));
        assert_eq!(asked(key(KeyCode::Char('5'))), drive(Drive::Preset(5)));
        let current = Some(Asked::Choose(Loop::Current));
        assert_eq!(asked(key(KeyCode::Char('c'))), current);
        assert_eq!(asked(key(KeyCode::Char(' '))), Some(Asked::StopAll));
        assert_eq!(asked(key(KeyCode::Esc)), Some(Asked::StopAll));
        assert_eq!(asked(key(KeyCode::Char('6'))), None);
        let interrupt = KeyEvent::new(KeyCode::Char('c'), KeyModifiers::CONTROL);
        assert_eq!(asked(interrupt), Some(Asked::Quit));
    }

    #[test]
    fn a_held_key_drives_until_its_repeats_cease() {
        let mut held = Held::default();
        let begun = Instant::now();
        let at = |ms| begun + Duration::from_millis(ms);
        let code = KeyCode::Char('f');
        assert!(held.press(code, begun));
        assert!(!held.is_let_go(at(600)), "before the first repeat");
        for ms in (600..2_000).step_by(33) {
            assert!(!held.is_let_go(at(ms)), "{ms}");
            assert!(!held.press(code, at(ms)), "a repeat");
        }
        assert!(held.is_let_go(at(2_200)));
        assert!(!held.is_let_go(at(2_300)), "said once");
    }

    #[test]
    fn a_tap_and_a_reported_release_end_the_drive() {
        let mut held = Held::default();
        let begun = Instant::now();
        held.press(KeyCode::Char('f'), begun);
        assert!(held.is_let_go(begun + FIRST_REPEAT_MAX));
        held.press(KeyCode::Char('f'), begun);
        held.release(KeyCode::Char('f'), begun);
        assert!(held.is_let_go(begun));
    }
}

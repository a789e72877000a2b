//! What a key asks of a replay.

use motorlink_messages::sessions::PlaySpeed;
use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};

/// What an arrow jumps.
const JUMP_US: i64 = 5_000_000;

pub const HELP: &str =
    "Space pause  ←/→ 5 s back, further  ↑/↓ faster, slower  Home start  End end  Q quit";

/// What a key asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asked {
    /// Pause, or play on.
    PlayOrPause,
    /// Jump by so many microseconds.
    Jump(i64),
    /// Go to the start.
    Start,
    /// Go to the end.
    End,
    Faster,
    Slower,
    Quit,
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
        KeyCode::Char(' ') => Asked::PlayOrPause,
        KeyCode::Left => Asked::Jump(-JUMP_US),
        KeyCode::Right => Asked::Jump(JUMP_US),
        KeyCode::Home => Asked::Start,
        KeyCode::End => Asked::End,
        KeyCode::Up | KeyCode::Char('+' | '=') => Asked::Faster,
        KeyCode::Down | KeyCode::Char('-') => Asked::Slower,
        KeyCode::Esc | KeyCode::Char('q' | 'Q') => Asked::Quit,
        _ => return None,
    })
}

/// The next speed above this one.
pub fn faster(than: PlaySpeed) -> PlaySpeed {
    let mut speeds = PlaySpeed::CHOICES.into_iter();
    let next = speeds.find(|speed| *speed > than.per_mille());
    next.map_or(than, PlaySpeed::from_per_mille)
}

/// The next speed below this one.
pub fn slower(than: PlaySpeed) -> PlaySpeed {
    let mut speeds = PlaySpeed::CHOICES.into_iter().rev();
    let next = speeds.find(|speed| *speed < than.per_mille());
    next.map_or(than, PlaySpeed::from_per_mille)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_step_between_a_tenth_and_a_hundred() {
        let speed = PlaySpeed::from_per_mille;
        assert_eq!(faster(speed(1_000)), speed(10_000));
        assert_eq!(faster(speed(1_500)), speed(10_000));
        assert_eq!(slower(speed(1_500)), speed(1_000));
        assert_eq!(slower(speed(100)), speed(100));
        assert_eq!(faster(speed(100_000)), speed(100_000));
    }

    #[test]
    fn plus_and_minus_are_the_arrows() {
        let key = |code| asked(KeyEvent::new(code, KeyModifiers::NONE));
        assert_eq!(key(KeyCode::Char('+')), key(KeyCode::Up));
        assert_eq!(key(KeyCode::Char('-')), key(KeyCode::Down));
        assert_eq!(key(KeyCode::Char('x')), None);
    }
}

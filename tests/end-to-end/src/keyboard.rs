//! Keys, as a keyboard with a US layout sends them.

use anyhow::{Result, bail};
use serde_json::{Value, json};

/// The description of a key for the browser.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Key {
    /// The value of `KeyboardEvent.key`.
    name: String,
    /// The value of `KeyboardEvent.code`.
    code: String,
    /// The value of `KeyboardEvent.keyCode`.
    number: u32,
    text: Option<String>,
    /// The bits of the protocol: 1 is Alt, 8 is Shift.
    modifiers: u8,
}

impl Key {
    /// The key named as in `KeyboardEvent.key`: `Escape`, `ArrowUp`, a letter, a digit or a sign;
    /// `Alt+1` is a key with Alt.
    ///
    /// # Errors
    ///
    /// When there is no such key here.
    pub fn named(name: &str) -> Result<Self> {
        if let Some(name) = name.strip_prefix("Alt+") {
            return Ok(Self {
                text: None,
                modifiers: 1,
                ..Self::named(name)?
            });
        }
        let mut characters = name.chars();
        if let (Some(character), None) = (characters.next(), characters.next()) {
            return Self::typing(character);
        }
        let (number, text) = match name {
            "Backspace" => (8, None),
            "Tab" => (9, None),
            "Enter" => (13, Some("\r")),
            "Escape" => (27, None),
            "PageUp" => (33, None),
            "PageDown" => (34, None),
            "End" => (35, None),
            "Home" => (36, None),
            "ArrowLeft" => (37, None),
            "ArrowUp" => (38, None),
            "ArrowRight" => (39, None),
            "ArrowDown" => (40, None),
            "Delete" => (46, None),
            _ => bail!("no key {name:?}: add it to keyboard.rs"),
        };
        Ok(Self::new(
            name,
            name.to_owned(),
            number,
            text.map(str::to_owned),
            false,
        ))
    }

    /// The key that types a character.
    fn typing(character: char) -> Result<Self> {
        let (code, shift) = match character {
            ' ' => ("Space".to_owned(), false),
            '0'..='9' => (format!("Digit{character}"), false),
            'a'..='z' => (format!("Key{}", character.to_ascii_uppercase()), false),
            'A'..='Z' => (format!("Key{character}"), true),
            '-' => ("Minus".to_owned(), false),
            '+' => ("Equal".to_owned(), true),
            '.' => ("Period".to_owned(), false),
            ',' => ("Comma".to_owned(), false),
            '/' => ("Slash".to_owned(), false),
            '?' => ("Slash".to_owned(), true),
            _ => bail!("no key types {character:?}: add it to keyboard.rs"),
        };
        let number = match character {
            '-' => 189,
            '+' => 187,
            '.' => 190,
            ',' => 188,
            '/' | '?' => 191,
            other => u32::from(other.to_ascii_uppercase()),
        };
        let text = character.to_string();
        Ok(Self::new(&text, code, number, Some(text.clone()), shift))
    }

    fn new(name: &str, code: String, number: u32, text: Option<String>, shift: bool) -> Self {
        Self {
            name: name.to_owned(),
            code,
            number,
            text,
            modifiers: if shift { 8 } else { 0 },
        }
    }

    /// Parameters of `Input.dispatchKeyEvent` for pressing it.
    pub fn down(&self) -> Value {
        self.event(
            if self.text.is_some() {
                "keyDown"
            } else {
                "rawKeyDown"
            },
            self.text.as_deref(),
        )
    }

    /// Parameters of `Input.dispatchKeyEvent` for releasing it.
    pub fn up(&self) -> Value {
        self.event("keyUp", None)
    }

    fn event(&self, kind: &str, text: Option<&str>) -> Value {
        json!({
            "type": kind,
            "key": self.name,
            "code": self.code,
            "windowsVirtualKeyCode": self.number,
            "modifiers": self.modifiers,
            "text": text.unwrap_or_default(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_say_what_a_keyboard_says() {
        let space = Key::named(" ").unwrap();
        assert_eq!((space.code.as_str(), space.number), ("Space", 32));
        let help = Key::named("?").unwrap();
        assert_eq!((help.code.as_str(), help.modifiers), ("Slash", 8));
        let letter = Key::named("f").unwrap();
        assert_eq!((letter.code.as_str(), letter.number), ("KeyF", 70));
        assert_eq!(Key::named("Escape").unwrap().down()["type"], "rawKeyDown");
        assert_eq!(letter.down()["text"], "f");
        let place = Key::named("Alt+1").unwrap();
        assert_eq!((place.code.as_str(), place.modifiers), ("Digit1", 1));
        assert_eq!(place.down()["type"], "rawKeyDown");
        assert!(Key::named("Hyper").is_err());
    }
}

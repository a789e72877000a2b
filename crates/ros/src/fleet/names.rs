//! The name of a robot, the keys below it, and what may stand in a state.
//!
//! | key | what |
//! |---|---|
//! | `motorlink/ROBOT/state` | the state, 10 a second |
//! | `motorlink/@alive/ROBOT/SESSION` | the liveliness token of the robot's Zenoh session |
//! | `motorlink/ROBOT/sessions` | answers the list of session files |
//! | `motorlink/ROBOT/sessions/FILE?from=BYTE` | answers a piece of a file |
//!
//! The tokens are not below `motorlink/ROBOT`: a client of Zenoh would compare each state with the tokens of all robots.

use std::{fmt, str::FromStr};

use anyhow::bail;

/// A name is a part of a key.
const NAME_MAX: usize = 64;
/// An address of a page.
const URL_MAX: usize = 256;
/// The end of the name of a session file.
const ENDING: &str = ".mcap";
/// What all robots publish.
pub const ALL_STATES: &str = "motorlink/*/state";
/// The tokens of all robots.
pub const ALL_TOKENS: &str = "motorlink/@alive/*/*";

/// The name of a robot: letters, digits, `_` and `-`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct RobotName(String);

impl RobotName {
    /// That of `--robot`, else of the namespace, else of this computer.
    ///
    /// # Errors
    ///
    /// When `--robot` is no name.
    pub fn choose(asked: Option<&str>, namespace: &str) -> anyhow::Result<Self> {
        if let Some(asked) = asked {
            return asked.parse();
        }
        let namespace = valid(namespace.trim_matches('/'));
        let host = || valid(&rustix::system::uname().nodename().to_string_lossy());
        let name = namespace.or_else(host);
        Ok(Self(name.unwrap_or_else(|| "robot".to_owned())))
    }

    /// Of its states.
    #[must_use]
    pub fn state_key(&self) -> String {
        format!("motorlink/{self}/state")
    }

    /// Of its token in this Zenoh session.
    #[must_use]
    pub fn token_key(&self, session: &str) -> String {
        format!("motorlink/@alive/{self}/{session}")
    }

    /// Of the list of its session files. They are below it.
    #[must_use]
    pub fn sessions_key(&self) -> String {
        format!("motorlink/{self}/sessions")
    }
}

impl FromStr for RobotName {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if valid(text).as_deref() != Some(text) {
            bail!("{text:?} is no name of a robot: 1 to {NAME_MAX} of a-z A-Z 0-9 _ -");
        }
        Ok(Self(text.to_owned()))
    }
}

impl fmt::Display for RobotName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// The name that is next to the text; `None` if nothing of it is left.
fn valid(text: &str) -> Option<String> {
    let plain = |char: char| match char {
        'a'..='z' | 'A'..='Z' | '0'..='9' | '_' | '-' => char,
        _ => '-',
    };
    let name: String = text.chars().take(NAME_MAX).map(plain).collect();
    name.contains(|char| char != '-').then_some(name)
}

/// The robot whose states have this key.
#[must_use]
pub fn of_state(key: &str) -> Option<RobotName> {
    let name = key.strip_prefix("motorlink/")?.strip_suffix("/state")?;
    name.parse().ok()
}

/// The robot and the Zenoh session of a token.
#[must_use]
pub fn of_token(key: &str) -> Option<(RobotName, &str)> {
    let (name, session) = key.strip_prefix("motorlink/@alive/")?.split_once('/')?;
    let name = name.parse().ok()?;
    is_session(session).then_some((name, session))
}

/// Whether it is the ID of a Zenoh session.
#[must_use]
pub fn is_session(text: &str) -> bool {
    let is_hex = |byte: u8| matches!(byte, b'0'..=b'9' | b'a'..=b'f');
    (1..=32).contains(&text.len()) && text.bytes().all(is_hex)
}

/// The address of a page that a person may open.
///
/// # Errors
///
/// When it is not one of http or https, in plain ASCII, and when it has the token: everybody in the network reads it.
pub fn page_url(text: &str) -> Result<String, String> {
    let rest = ["http://", "https://"]
        .iter()
        .find_map(|scheme| text.strip_prefix(scheme));
    // A user before the host looks like another host.
    let is_plain = |byte: u8| byte.is_ascii_graphic() && !br#""'<>\`@{}|^"#.contains(&byte);
    let is_url = rest.is_some_and(|rest| {
        rest.starts_with(|char: char| char.is_ascii_alphanumeric() || char == '[')
            && rest.bytes().all(is_plain)
    });
    if text.contains("token=") {
        return Err("leave the token out: everybody in the network reads the address".to_owned());
    }
    if is_url && text.len() <= URL_MAX {
        Ok(text.to_owned())
    } else {
        Err("an address is as http://rover.local:8055/".to_owned())
    }
}

/// Whether it is the name of a session file, in the folder itself: as in `motorlink serve`.
#[must_use]
pub fn is_file(name: &str) -> bool {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_' | b'.');
    name.len() <= 255
        && name.ends_with(ENDING)
        && !name.starts_with('.')
        && name.bytes().all(is_plain)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_comes_from_the_flag_the_namespace_or_the_computer() {
        let name = |asked: Option<&str>, namespace: &str| {
            RobotName::choose(asked, namespace).map(|name| name.to_string())
        };
        assert_eq!(name(Some("Rover_1-a"), "/x").unwrap(), "Rover_1-a");
        assert_eq!(name(None, "/site/rover1/").unwrap(), "site-rover1");
        assert!(!name(None, "").unwrap().is_empty());
        for wrong in ["", "a b", "a/b", "*", "ü", "-", "\x1b[2J", &"a".repeat(65)] {
            assert!(name(Some(wrong), "").is_err(), "{wrong:?}");
        }
    }

    #[test]
    fn keys_that_are_none_of_a_robot_are_refused() {
        let name = of_state("motorlink/rover-1/state").unwrap();
        assert_eq!(name.state_key(), "motorlink/rover-1/state");
        let token = name.token_key("a1");
        assert_eq!(of_token(&token), Some((name, "a1")));
        for wrong in [
            "motorlink/a b/state",
            "other/a/state",
            "motorlink/state",
            "motorlink/a/b/state",
        ] {
            assert!(of_state(wrong).is_none(), "{wrong}");
        }
    }

    #[test]
    fn only_addresses_of_http_are_pages() {
        for url in ["http://rover.local:8055/", "https://[::1]/?a=b#c"] {
            assert_eq!(page_url(url).unwrap(), url);
        }
        for url in [
            "javascript:alert(1)",
            "http://",
            "http:///x",
            "http://a b",
            "http://a\x1b[2J",
            "http://good.example@evil.example/",
            "file:///etc/passwd",
            "http://a/\"onclick=",
            "http://ü.example/",
            "http://rover.local:8017/?token=0123",
        ] {
            assert!(page_url(url).is_err(), "{url:?}");
        }
    }

    #[test]
    fn only_sessions_in_the_folder_itself_are_files() {
        assert!(is_file("motorlink-log-000012-20261127-193300.mcap"));
        for name in ["token", ".mcap", "../a.mcap", "a/b.mcap", "a\\b.mcap", "**"] {
            assert!(!is_file(name), "{name}");
        }
    }
}

//! What crosses between the group `Remote` of a page and the worker that connects the page to a server, on a message port
//! of their own. Each message is a text, which takes less code in the page than an encoded one.

/// What a person asks of the link to the server.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RemoteRequest {
    /// Connect to the server. Nothing else is asked for.
    Watch,
    /// Take control, or ask the page that has it.
    Ask,
    /// Take control from another page. The motors are stopped first.
    TakeByForce,
    /// Give up control. The motors are stopped.
    GiveUp,
}

impl RemoteRequest {
    /// All.
    pub const ALL: [Self; 4] = [Self::Watch, Self::Ask, Self::TakeByForce, Self::GiveUp];

    /// As it crosses. It is also the value of its button.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Watch => "watch",
            Self::Ask => "ask",
            Self::TakeByForce => "take",
            Self::GiveUp => "give-up",
        }
    }

    /// The request with this text.
    #[must_use]
    pub fn of(text: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|request| request.text() == text)
    }
}

/// Who drives. It crosses as its letter, and behind it the other page, if there is one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WhoDrives {
    /// The page is not connected to the server, and does not try to be.
    Off,
    /// The page tries to connect. It tries again until the user disconnects.
    Connecting,
    /// The server has another version than this page: the page must be loaded again.
    OtherVersion,
    /// Nobody.
    Free,
    /// This page.
    Mine,
    /// This page, and another one asks for control.
    MineAndAsked,
    /// Another page.
    Others,
    /// Another page, and this one asks for control.
    OthersAndAsked,
}

impl WhoDrives {
    /// All, and their letters: a capital if a page asks for control.
    const LETTERS: [(Self, char); 8] = [
        (Self::Off, 'o'),
        (Self::Connecting, 'c'),
        (Self::OtherVersion, 'v'),
        (Self::Free, 'f'),
        (Self::Mine, 'm'),
        (Self::MineAndAsked, 'M'),
        (Self::Others, 'x'),
        (Self::OthersAndAsked, 'X'),
    ];

    /// The text that crosses. `viewer` is the operator, or the page that asks for control.
    #[must_use]
    pub fn text(self, viewer: &str) -> String {
        let letter = Self::LETTERS.iter().find(|(control, _)| *control == self);
        let mut text: String = letter.map(|(_, letter)| *letter).into_iter().collect();
        text.push_str(viewer);
        text
    }

    /// What crossed, and the other page.
    #[must_use]
    pub fn of(text: &str) -> Option<(Self, &str)> {
        let found = Self::LETTERS.iter();
        let mut found = found.filter_map(|(control, letter)| {
            let viewer = text.strip_prefix(*letter)?;
            Some((*control, viewer))
        });
        found.next()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_cross_and_come_back() {
        for request in RemoteRequest::ALL {
            assert_eq!(RemoteRequest::of(request.text()), Some(request));
        }
        for (control, _) in WhoDrives::LETTERS {
            let viewer = "3 (192.168.1.20)";
            let text = control.text(viewer);
            assert_eq!(WhoDrives::of(&text), Some((control, viewer)));
        }
        assert_eq!(RemoteRequest::of(""), None);
        assert_eq!(WhoDrives::of(""), None);
    }
}

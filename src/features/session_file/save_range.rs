//! The choice of how much is saved.

/// How much of what is kept is saved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum SaveRange {
    #[default]
    Everything,
    TenMinutes,
}

impl SaveRange {
    pub(super) const ALL: [Self; 2] = [Self::Everything, Self::TenMinutes];

    pub(super) const fn key(self) -> &'static str {
        match self {
            Self::Everything => "everything",
            Self::TenMinutes => "ten-minutes",
        }
    }

    /// The seconds up to the newest record; `None` for everything.
    pub(super) const fn last_s(self) -> Option<u32> {
        match self {
            Self::Everything => None,
            Self::TenMinutes => Some(600),
        }
    }
}

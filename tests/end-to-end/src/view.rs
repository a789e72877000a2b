//! How a page is looked at, for screenshots.

/// The colours that a person's system asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scheme {
    /// Dark on light.
    Light,
    /// Light on dark.
    Dark,
}

impl Scheme {
    /// As `prefers-color-scheme` says it.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Light => "light",
            Self::Dark => "dark",
        }
    }
}

/// A window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct View {
    /// CSS pixels.
    pub width: u32,
    /// CSS pixels.
    pub height: u32,
    /// Colours asked for.
    pub scheme: Scheme,
}

impl View {
    /// A desktop's window.
    pub const DESKTOP: Self = Self {
        width: 1440,
        height: 900,
        scheme: Scheme::Light,
    };
    /// A tablet's, or half a desktop's.
    pub const TABLET: Self = Self {
        width: 1024,
        height: 768,
        scheme: Scheme::Light,
    };
    /// A phone's.
    pub const PHONE: Self = Self {
        width: 390,
        height: 844,
        scheme: Scheme::Light,
    };

    /// The same window in the dark.
    #[must_use]
    pub fn dark(self) -> Self {
        Self {
            scheme: Scheme::Dark,
            ..self
        }
    }
}

//! Views of a page for screenshots.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};

use crate::cdp::at;
use crate::page::Page;

/// The colour scheme of the user's system.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scheme {
    /// Dark on light.
    Light,
    /// Light on dark.
    Dark,
    /// Bright on black.
    Contrast,
}

impl Scheme {
    /// Its name in files and texts.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Light => "light",
            Self::Dark => "dark",
            Self::Contrast => "contrast",
        }
    }

    /// Its values of `prefers-color-scheme` and `prefers-contrast`.
    fn wishes(self) -> [&'static str; 2] {
        match self {
            Self::Light => ["light", "no-preference"],
            Self::Dark => ["dark", "no-preference"],
            Self::Contrast => ["dark", "more"],
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
    /// Colour scheme.
    pub scheme: Scheme,
}

impl View {
    /// The window of a desktop.
    pub const DESKTOP: Self = Self {
        width: 1440,
        height: 900,
        scheme: Scheme::Light,
    };
    /// The window of a tablet, or half a desktop.
    pub const TABLET: Self = Self {
        width: 1024,
        height: 768,
        scheme: Scheme::Light,
    };
    /// The window of a phone.
    pub const PHONE: Self = Self {
        width: 390,
        height: 844,
        scheme: Scheme::Light,
    };

    /// A window of this size in CSS pixels.
    #[must_use]
    pub const fn window(width: u32, height: u32) -> Self {
        Self {
            width,
            height,
            scheme: Scheme::Light,
        }
    }

    /// Whether the page shows one screen at a time with a tab bar, as the style sheet decides.
    #[must_use]
    pub const fn is_phone(self) -> bool {
        self.width < 860 || self.height < 500
    }

    /// The same window in other colours.
    #[must_use]
    pub fn with(self, scheme: Scheme) -> Self {
        Self { scheme, ..self }
    }

    /// The same window in the dark.
    #[must_use]
    pub fn dark(self) -> Self {
        self.with(Scheme::Dark)
    }
}

impl Page {
    /// Shows the page in a window of this size and colour scheme from now on.
    ///
    /// # Errors
    ///
    /// When Chromium does not answer.
    pub fn look(&self, view: View) -> Result<()> {
        let metrics = json!({
            "width": view.width,
            "height": view.height,
            "deviceScaleFactor": 1,
            "mobile": false,
        });
        self.session
            .call("Emulation.setDeviceMetricsOverride", metrics)?;
        let [scheme, contrast] = view.scheme.wishes();
        let features = json!([
            { "name": "prefers-color-scheme", "value": scheme },
            { "name": "prefers-contrast", "value": contrast },
        ]);
        self.session.call(
            "Emulation.setEmulatedMedia",
            json!({ "features": features }),
        )?;
        Ok(())
    }

    /// Texts in the window that are cut, beside it, or drawn over each other.
    ///
    /// # Errors
    ///
    /// When Chromium does not answer.
    pub fn unreadable(&self) -> Result<Vec<String>> {
        let found = self.evaluate(include_str!("unreadable.js"))?;
        let texts = found.as_array().context("no list of texts")?.iter();
        Ok(texts.filter_map(Value::as_str).map(str::to_owned).collect())
    }

    /// Lets the person want less motion, in a light page.
    ///
    /// # Errors
    ///
    /// When Chromium does not answer.
    pub fn want_less_motion(&self) -> Result<()> {
        let features = json!([{ "name": "prefers-reduced-motion", "value": "reduce" }]);
        self.session
            .call(
                "Emulation.setEmulatedMedia",
                json!({ "features": features }),
            )
            .map(drop)
    }

    /// Gives the page's device a touch screen instead of a mouse.
    ///
    /// # Errors
    ///
    /// When Chromium does not answer.
    pub fn touch(&self) -> Result<()> {
        let fingers = json!({ "enabled": true, "maxTouchPoints": 5 });
        self.session
            .call("Emulation.setTouchEmulationEnabled", fingers)
            .map(drop)
    }

    /// Gives it its mouse back.
    ///
    /// # Errors
    ///
    /// When Chromium does not answer.
    pub fn untouch(&self) -> Result<()> {
        self.session
            .call(
                "Emulation.setTouchEmulationEnabled",
                json!({ "enabled": false }),
            )
            .map(drop)
    }

    /// Saves the visible part as a PNG file.
    ///
    /// # Errors
    ///
    /// When it cannot be taken or written.
    pub fn screenshot(&self, file: &Path) -> Result<()> {
        save(&self.picture(json!({ "format": "png" }))?, file)
    }

    /// Saves the visible part as a WebP file, a quarter of the size.
    ///
    /// # Errors
    ///
    /// When it cannot be taken or written.
    pub fn screenshot_webp(&self, file: &Path) -> Result<()> {
        save(&self.picture_webp(80)?, file)
    }

    /// The visible part as a WebP picture.
    pub(crate) fn picture_webp(&self, quality: u8) -> Result<Vec<u8>> {
        self.picture(json!({ "format": "webp", "quality": quality }))
    }

    fn picture(&self, format: Value) -> Result<Vec<u8>> {
        let taken = self.session.call("Page.captureScreenshot", format)?;
        let picture = at(&taken, "/data").as_str().context("no picture")?;
        Ok(BASE64_STANDARD.decode(picture)?)
    }
}

fn save(picture: &[u8], file: &Path) -> Result<()> {
    fs::write(file, picture).with_context(|| format!("cannot write {}", file.display()))
}

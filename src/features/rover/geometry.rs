//! The measures of the vehicle that odometry needs. A person enters them once, and the browser stores them.

use motorlink_i18n::tr;

use crate::{
    model::preferences::{remember, remembered},
    ui::entry::{Entry, Typed, whole},
};

/// The storage key.
const STORED_AS: &str = "rover";

/// Wheel radii in mm: half and ten times that of the smallest and the largest wheel in use, with room.
const RADIUS_MM: (u16, u16) = (10, 500);
/// Track widths in mm, from a toy to a car.
const TRACK_MM: (u16, u16) = (50, 3_000);

/// Both measures, in their ranges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Geometry {
    radius_mm: u16,
    track_mm: u16,
}

impl Default for Geometry {
    /// The wheel of an M0601 or DDSM115 has a diameter of 102 mm; the track is that of a small rover.
    fn default() -> Self {
        Self {
            radius_mm: 51,
            track_mm: 300,
        }
    }
}

impl Geometry {
    /// `None` for a measure that is out of its range.
    pub(crate) fn new(radius_mm: i32, track_mm: i32) -> Option<Self> {
        let within = |value: i32, (least, most): (u16, u16)| {
            let value = u16::try_from(value).ok()?;
            (least..=most).contains(&value).then_some(value)
        };
        Some(Self {
            radius_mm: within(radius_mm, RADIUS_MM)?,
            track_mm: within(track_mm, TRACK_MM)?,
        })
    }

    /// From the axle to the ground, in mm.
    pub(crate) fn radius_mm(self) -> f64 {
        self.radius_mm.into()
    }

    /// Between the middles of the left and the right wheels, in mm.
    pub(crate) fn track_mm(self) -> f64 {
        self.track_mm.into()
    }

    /// Both, for the fields.
    pub(crate) fn entered(self) -> [i32; 2] {
        [self.radius_mm.into(), self.track_mm.into()]
    }

    /// `51 300`: radius and track in mm.
    fn to_text(self) -> String {
        format!("{} {}", self.radius_mm, self.track_mm)
    }

    fn from_text(text: &str) -> Option<Self> {
        let (radius, track) = text.split_once(' ')?;
        Self::new(radius.parse().ok()?, track.parse().ok()?)
    }

    /// Loads what this browser has stored, or the defaults.
    pub(crate) fn load() -> Self {
        let stored = remembered(STORED_AS);
        stored
            .and_then(|text| Self::from_text(&text))
            .unwrap_or_default()
    }

    /// Stores it in this browser.
    pub(crate) fn save(self) {
        remember(STORED_AS, &self.to_text());
    }
}

/// Field `Wheel radius`.
pub(crate) const RADIUS: Entry = Entry {
    min: RADIUS_MM.0 as i32,
    max: RADIUS_MM.1 as i32,
    read: millimetres,
    show: |mm| mm.to_string(),
    scale: 1.0,
    step: 1.0,
    page: 10.0,
};

/// Field `Track width`.
pub(crate) const TRACK: Entry = Entry {
    min: TRACK_MM.0 as i32,
    max: TRACK_MM.1 as i32,
    read: millimetres,
    show: |mm| mm.to_string(),
    scale: 1.0,
    step: 5.0,
    page: 50.0,
};

fn millimetres(text: &str, least: i32, most: i32) -> Typed {
    whole(text, |mm| {
        let fits = (least..=most).contains(&mm);
        fits.then_some(mm)
            .ok_or_else(|| tr!("Enter {least} to {most} mm.", least, most))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_stored_is_loaded_and_garbage_is_not() {
        let geometry = Geometry::new(60, 420).unwrap();
        assert_eq!(Geometry::from_text(&geometry.to_text()), Some(geometry));
        for text in [
            "", "51", "51 ", "9 300", "51 49", "51 3001", "-51 300", "51 300 1",
        ] {
            assert_eq!(Geometry::from_text(text), None, "{text:?}");
        }
        let default = Geometry::default();
        assert_eq!(Geometry::from_text(&default.to_text()), Some(default));
    }

    fn typed(entry: &Entry, text: &str) -> Typed {
        (entry.read)(text, entry.min, entry.max)
    }

    #[test]
    fn a_measure_out_of_range_is_refused_with_the_range() {
        assert_eq!(typed(&RADIUS, "51"), Typed::Value(51));
        let wrong = Typed::Wrong("Enter 10 to 500 mm.".to_owned());
        assert_eq!(typed(&RADIUS, "501"), wrong);
        assert_eq!(typed(&TRACK, "3000"), Typed::Value(3_000));
        let wrong = Typed::Wrong("Enter 50 to 3000 mm.".to_owned());
        assert_eq!(typed(&TRACK, "0"), wrong);
    }
}

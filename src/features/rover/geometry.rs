//! The fields of the measures of the vehicle that odometry needs.

use motorlink_i18n::tr;
use motorlink_messages::experiments::vehicle::{RADIUS_MM, TRACK_MM};

use crate::ui::entry::{Entry, Typed, whole};

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

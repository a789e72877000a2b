//! Shapes of the twin as SVG path data: pure functions of numbers.
//!
//! One unit of the drawing is one millimetre of the wheel, whose axle is the origin. Bearings are degrees clockwise
//! from straight up, the direction of a rotation in SVG.

use std::fmt::Write;

use crate::ui::mathematics::limited;

/// A point of the drawing in millimetres; y grows downwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// To the right of the axle.
    pub x: f64,
    /// Below the axle.
    pub y: f64,
}

/// Path data, to the hundredth of a millimetre: `3.25 -4.00`.
impl std::fmt::Display for Point {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:.2} {:.2}", self.x, self.y)
    }
}

/// The point at a bearing and a distance from the axle.
#[must_use]
pub fn polar(bearing_deg: f64, radius: f64) -> Point {
    let (sin, cos) = crate::ui::mathematics::sin_cos(bearing_deg);
    Point {
        x: radius * sin,
        y: -radius * cos,
    }
}

/// An arc about the axle from one bearing to another, either way round and less than a full turn.
#[must_use]
pub fn arc(radius: f64, from_deg: f64, to_deg: f64) -> String {
    format!(
        "M{}{}",
        polar(from_deg, radius),
        arc_on(radius, from_deg, to_deg)
    )
}

/// The same arc without its start, to continue an existing path.
fn arc_on(radius: f64, from_deg: f64, to_deg: f64) -> String {
    let large = i32::from((to_deg - from_deg).abs() > 180.0);
    let clockwise = i32::from(to_deg > from_deg);
    format!(
        "A{radius:.2} {radius:.2} 0 {large} {clockwise} {}",
        polar(to_deg, radius)
    )
}

/// A ring about the axle, to be filled by the even-odd rule.
#[must_use]
pub fn annulus(inner: f64, outer: f64) -> String {
    [circle(0.0, 0.0, outer), circle(0.0, 0.0, inner)].concat()
}

/// A circle as path data, so that one element can contain many.
#[must_use]
pub fn circle(bearing_deg: f64, distance: f64, radius: f64) -> String {
    let centre = polar(bearing_deg, distance);
    format!(
        "M{:.2} {:.2}a{radius:.2} {radius:.2} 0 1 1 {:.2} 0a{radius:.2} {radius:.2} 0 1 1 {:.2} 0Z",
        centre.x - radius,
        centre.y,
        2.0 * radius,
        -2.0 * radius
    )
}

/// `count` bearings evenly around the turn, starting at `offset_deg`.
pub fn bearings(count: u16, offset_deg: f64) -> impl Iterator<Item = f64> {
    let pitch_deg = 360.0 / f64::from(count.max(1));
    (0..count).map(move |place| offset_deg + f64::from(place) * pitch_deg)
}

/// A ring of `count` round holes.
#[must_use]
pub fn holes(count: u16, offset_deg: f64, distance: f64, radius: f64) -> String {
    bearings(count, offset_deg)
        .map(|bearing| circle(bearing, distance, radius))
        .collect()
}

/// A piece of a ring, `width_deg` wide about a bearing.
#[must_use]
pub fn sector(bearing_deg: f64, width_deg: f64, inner: f64, outer: f64) -> String {
    let (from, to) = (bearing_deg - width_deg / 2.0, bearing_deg + width_deg / 2.0);
    format!(
        "{}L{}{}Z",
        arc(outer, from, to),
        polar(to, inner),
        arc_on(inner, to, from)
    )
}

/// Radial lines at the given bearings, for a scale or for knurling.
pub fn spokes(bearings_deg: impl Iterator<Item = f64>, inner: f64, outer: f64) -> String {
    let mut path = String::new();
    for bearing in bearings_deg {
        let (from, to) = (polar(bearing, inner), polar(bearing, outer));
        // Writing to a string cannot fail.
        let _ = write!(path, "M{from}L{to}");
    }
    path
}

/// One block of a directional tread: it leans forward towards its tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TreadBlock {
    /// Inner end on the shoulder, in millimetres from the axle.
    pub inner: f64,
    /// Outer end on the running surface.
    pub outer: f64,
    /// Width at the inner end, in degrees.
    pub root_deg: f64,
    /// Width at the outer end, in degrees.
    pub tip_deg: f64,
    /// How far the outer end is clockwise of the inner one, in degrees.
    pub lean_deg: f64,
}

impl TreadBlock {
    /// The outline of the block that begins at a bearing: two curves between two arcs.
    #[must_use]
    pub fn outline(self, bearing_deg: f64) -> String {
        let edge = |side: f64| {
            let root = bearing_deg + side * self.root_deg / 2.0;
            let tip = bearing_deg + self.lean_deg + side * self.tip_deg / 2.0;
            // The curve leaves the shoulder radially and then bends forward, like a moulded rib. The factor 0.66 is
            // chosen by eye.
            let bend = polar(root, self.inner + (self.outer - self.inner) * 0.66);
            (root, bend, tip)
        };
        let (root_left, bend_left, tip_left) = edge(-1.0);
        let (root_right, bend_right, tip_right) = edge(1.0);
        let mut path = format!("M{}", polar(root_left, self.inner));
        // Writing to a string cannot fail.
        let _ = write!(path, "Q{bend_left} {}", polar(tip_left, self.outer));
        path.push_str(&arc_on(self.outer, tip_left, tip_right));
        let _ = write!(path, "Q{bend_right} {}", polar(root_right, self.inner));
        path.push_str(&arc_on(self.inner, root_right, root_left));
        path.push('Z');
        path
    }

    /// The outlines of `count` blocks around the turn.
    #[must_use]
    pub fn ring(self, count: u16, offset_deg: f64) -> String {
        bearings(count, offset_deg)
            .map(|bearing| self.outline(bearing))
            .collect()
    }
}

/// A D-shaped shaft with a flat of this length at its upper side.
#[must_use]
pub fn d_shaft(radius: f64, flat: f64) -> String {
    let half_deg = limited(flat / 2.0 / radius, -1.0, 1.0).asin().to_degrees();
    arc(radius, half_deg, 360.0 - half_deg) + "Z"
}

/// A hexagon about a point, as the socket of a screw; `radius` is the distance of its corners.
#[must_use]
pub fn hexagon(bearing_deg: f64, distance: f64, radius: f64) -> String {
    let centre = polar(bearing_deg, distance);
    let mut path = String::new();
    for (place, corner) in bearings(6, bearing_deg).enumerate() {
        let offset = polar(corner, radius);
        let at = Point {
            x: centre.x + offset.x,
            y: centre.y + offset.y,
        };
        let _ = write!(path, "{}{at}", if place == 0 { 'M' } else { 'L' });
    }
    path.push('Z');
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: Point, x: f64, y: f64) -> bool {
        (a.x - x).abs() < 1e-9 && (a.y - y).abs() < 1e-9
    }

    #[test]
    fn bearings_run_clockwise_from_straight_up() {
        assert!(near(polar(0.0, 10.0), 0.0, -10.0));
        assert!(near(polar(90.0, 10.0), 10.0, 0.0));
        assert!(near(polar(180.0, 10.0), 0.0, 10.0));
        assert!(near(polar(-90.0, 10.0), -10.0, 0.0));
    }

    #[test]
    fn an_arc_takes_the_way_it_is_told() {
        assert_eq!(
            arc(10.0, 0.0, 90.0),
            "M0.00 -10.00A10.00 10.00 0 0 1 10.00 -0.00"
        );
        assert_eq!(
            arc(10.0, 150.0, -150.0),
            "M5.00 8.66A10.00 10.00 0 1 0 -5.00 8.66"
        );
    }

    #[test]
    fn a_ring_has_as_many_pieces_as_asked() {
        let blocks = TreadBlock {
            inner: 44.0,
            outer: 51.0,
            root_deg: 3.0,
            tip_deg: 6.0,
            lean_deg: 7.0,
        };
        assert_eq!(blocks.ring(30, 0.0).matches('Z').count(), 30);
        assert_eq!(holes(18, 10.0, 33.0, 1.5).matches('Z').count(), 18);
        assert_eq!(bearings(0, 0.0).count(), 0);
    }

    /// The tread is directional: its tips lie clockwise of its roots.
    #[test]
    fn a_tread_block_leans_forward() {
        let upright = TreadBlock {
            inner: 44.0,
            outer: 51.0,
            root_deg: 2.0,
            tip_deg: 2.0,
            lean_deg: 0.0,
        };
        let leaning = TreadBlock {
            lean_deg: 8.0,
            ..upright
        };
        assert!(
            upright
                .outline(0.0)
                .contains(&polar(-1.0, 51.0).to_string())
        );
        assert!(leaning.outline(0.0).contains(&polar(7.0, 51.0).to_string()));
        assert!(
            leaning
                .outline(0.0)
                .starts_with(&format!("M{}", polar(-1.0, 44.0)))
        );
    }

    /// Round of 15.2 mm, flat of 8 mm: both ends of the flat lie on the round, 8 mm apart.
    #[test]
    fn the_shaft_has_its_flat_on_top() {
        let path = d_shaft(7.6, 8.0);
        assert!(path.starts_with("M4.00 -6.46A7.60 7.60 0 1 1 -4.00 -6.46"));
        assert!(path.ends_with('Z'));
    }

    #[test]
    fn a_hexagon_has_six_corners_about_its_centre() {
        let path = hexagon(90.0, 17.5, 1.2);
        assert_eq!(path.matches('L').count(), 5);
        assert!(path.starts_with("M18.70 "), "{path}");
    }

    #[test]
    fn a_sector_is_closed_and_as_wide_as_asked() {
        let path = sector(0.0, 60.0, 10.0, 20.0);
        assert!(path.starts_with(&format!("M{}", polar(-30.0, 20.0))));
        assert!(path.contains(&format!("L{}", polar(30.0, 10.0))));
        assert!(path.ends_with('Z'));
    }
}

//! The path that the vehicle has driven, in a bounded number of points.

use std::fmt::Write;

use motorlink_messages::experiments::odometry::{Link, Pose};

/// Above this number every other point is left out: 400 points are as fine as a screen shows them.
const POINTS_MAX: usize = 400;
/// The distance of points in mm, at first: the path of a small vehicle looks round.
const STEP_MM: f64 = 10.0;

/// A point of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Point {
    x: f64,
    y: f64,
    /// How the way from the point before is known.
    link: Link,
}

/// The path.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Path {
    points: Vec<Point>,
    step_mm: f64,
    /// The worst link since the last point.
    since: Link,
    /// The last link.
    link: Link,
    end: Pose,
    gaps: u32,
}

impl Default for Path {
    fn default() -> Self {
        Self {
            points: vec![Point {
                x: 0.0,
                y: 0.0,
                link: Link::Known,
            }],
            step_mm: STEP_MM,
            since: Link::Known,
            // Nothing was known before, so the path does not begin with a gap.
            link: Link::Unknown,
            end: Pose::default(),
            gaps: 0,
        }
    }
}

impl Path {
    /// The vehicle has moved to this pose.
    pub(crate) fn extend(&mut self, pose: Pose, link: Link) {
        if link == Link::Unknown {
            if self.link == Link::Unknown {
                return;
            }
            self.gaps += 1;
        }
        let is_over = self.link == Link::Unknown && self.gaps > 0;
        self.since = self.since.min(link);
        (self.end, self.link) = (pose, link);
        let far = self.points.last().is_none_or(|last| {
            let (x, y) = (pose.x - last.x, pose.y - last.y);
            x * x + y * y >= self.step_mm * self.step_mm
        });
        if far || is_over {
            self.points.push(Point {
                x: pose.x,
                y: pose.y,
                link: self.since,
            });
            self.since = Link::Known;
            if self.points.len() > POINTS_MAX {
                self.thin_out();
            }
        }
    }

    /// Leaves out every other point. What was not known stays so.
    fn thin_out(&mut self) {
        let mut kept = Vec::with_capacity(self.points.len() / 2 + 1);
        let mut left_out = Link::Known;
        for (place, point) in self.points.iter().enumerate() {
            if place % 2 == 0 {
                let link = point.link.min(left_out);
                kept.push(Point { link, ..*point });
                left_out = Link::Known;
            } else {
                left_out = point.link;
            }
        }
        self.since = self.since.min(left_out);
        self.points = kept;
        self.step_mm *= 2.0;
    }

    /// Number of times that the motion became unknown.
    pub(crate) const fn gaps(&self) -> u32 {
        self.gaps
    }

    /// The lines of the path as data for SVG, in mm, with `y` growing backwards: those known by replies, those
    /// bridged, and the ends of gaps as lines without length.
    pub(crate) fn lines(&self) -> [String; 3] {
        let [mut known, mut bridged, mut gaps] = [const { String::new() }; 3];
        let end = Point {
            x: self.end.x,
            y: self.end.y,
            link: self.since,
        };
        let is_ahead = |last: &Point| {
            *last
                != Point {
                    link: last.link,
                    ..end
                }
        };
        let end = Some(&end).filter(|_| self.points.last().is_none_or(is_ahead));
        let mut before: Option<Point> = None;
        let mut drawn = Link::Unknown;
        for point in self.points.iter().chain(end) {
            if let Some(before) = before {
                let line = match point.link {
                    Link::Known => &mut known,
                    Link::Bridged => &mut bridged,
                    Link::Unknown => &mut gaps,
                };
                let from = if point.link == Link::Unknown {
                    point
                } else {
                    &before
                };
                // Writing to a string cannot fail.
                if drawn != point.link || point.link == Link::Unknown {
                    let _ = write!(line, "M{:.0} {:.0}", from.x, 0.0 - from.y);
                }
                let _ = write!(line, "L{:.0} {:.0}", point.x, 0.0 - point.y);
                drawn = point.link;
            }
            before = Some(*point);
        }
        [known, bridged, gaps]
    }

    /// Left, top, right and bottom of all points and the start, in the coordinates of [`lines`](Self::lines).
    pub(crate) fn bounds(&self) -> [f64; 4] {
        let (x, y) = (self.end.x, 0.0 - self.end.y);
        let mut bounds = [x, y, x, y];
        for Point { x, y, .. } in &self.points {
            let [left, top, right, bottom] = bounds;
            bounds = [
                left.min(*x),
                top.min(0.0 - y),
                right.max(*x),
                bottom.max(0.0 - y),
            ];
        }
        bounds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64) -> Pose {
        Pose {
            x,
            y,
            heading_deg: 0.0,
        }
    }

    fn driven(path: &mut Path, from_mm: u32, to_mm: u32, link: Link) {
        for mm in from_mm..=to_mm {
            path.extend(at(0.0, f64::from(mm)), link);
        }
    }

    fn bounds_mm(path: &Path) -> [String; 4] {
        path.bounds().map(|bound| format!("{bound:.0}"))
    }

    #[test]
    fn the_path_is_drawn_ahead_and_reaches_the_vehicle() {
        let mut path = Path::default();
        driven(&mut path, 1, 25, Link::Known);
        let [known, bridged, gaps] = path.lines();
        assert_eq!(known, "M0 0L0 -10L0 -20L0 -25");
        assert!(bridged.is_empty() && gaps.is_empty());
        assert_eq!(bounds_mm(&path), ["0", "-25", "0", "0"]);
    }

    #[test]
    fn the_number_of_points_is_bounded_and_the_ends_stay() {
        let mut path = Path::default();
        driven(&mut path, 1, 100_000, Link::Known);
        assert!(path.points.len() <= POINTS_MAX + 1, "{}", path.points.len());
        assert!(path.points.len() > POINTS_MAX / 3);
        let [known, ..] = path.lines();
        assert!(known.starts_with("M0 0L"), "{known}");
        assert!(known.ends_with("L0 -100000"), "{known}");
        assert_eq!(bounds_mm(&path), ["0", "-100000", "0", "0"]);
    }

    #[test]
    fn a_gap_is_marked_once_and_stays_when_points_are_left_out() {
        let mut path = Path::default();
        driven(&mut path, 1, 50, Link::Known);
        for _ in 0..100 {
            path.extend(at(0.0, 50.0), Link::Unknown);
        }
        driven(&mut path, 50, 80, Link::Bridged);
        let [known, bridged, gaps] = path.lines();
        assert_eq!(known, "M0 0L0 -10L0 -20L0 -30L0 -40L0 -50");
        assert_eq!(gaps, "M0 -50L0 -50");
        assert_eq!(bridged, "M0 -50L0 -60L0 -70L0 -80");
        assert_eq!(path.gaps(), 1);
        driven(&mut path, 81, 20_000, Link::Known);
        assert_eq!(path.lines()[2].matches('M').count(), 1);
        assert_eq!(path.gaps(), 1);
    }

    #[test]
    fn a_path_does_not_begin_with_a_gap() {
        let mut path = Path::default();
        path.extend(at(0.0, 0.0), Link::Unknown);
        driven(&mut path, 1, 15, Link::Known);
        assert_eq!(path.gaps(), 0);
        assert!(path.lines()[2].is_empty(), "{:?}", path.lines());
    }
}

//! Splits a line so that a canvas draws it cheaply: steep parts as vertical bars, the rest as paths.
//!
//! A noisy trace is a zigzag of a thousand steep strokes side by side. As one antialiased path it takes a browser
//! without a graphics card 150 ms to draw (measured). As bars of whole pixels, which look the same, it takes a few
//! milliseconds.

/// A point in subpixels.
pub(crate) type Pixel = (i32, i32);

/// A vertical bar through the middle of a pixel column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Bar {
    /// The middle of the column.
    pub(crate) x: i32,
    pub(crate) top: i32,
    pub(crate) bottom: i32,
}

/// A line in parts that are cheap to draw. Together they cover the line.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Strokes {
    pub(crate) bars: Vec<Bar>,
    pub(crate) paths: Vec<Vec<Pixel>>,
    path: Vec<Pixel>,
}

/// A stroke whose slope exceeds this is drawn as bars.
const STEEP: i32 = 4;

/// Splits a line through these points, from left to right; `pixel` is the number of subpixels per pixel.
pub(crate) fn strokes(points: &[Pixel], pixel: i32) -> Strokes {
    let mut strokes = Strokes::default();
    strokes.path.extend(points.first());
    for pair in points.windows(2) {
        let &[from, to] = pair else { continue };
        let across = to.0 - from.0;
        if (to.1 - from.1).abs() >= STEEP * across.max(1) {
            strokes.end_path_at_bar(pixel);
            strokes.climb(from, to, pixel);
        }
        strokes.path.push(to);
    }
    strokes.end_path();
    strokes
}

impl Strokes {
    fn end_path(&mut self) {
        let path = std::mem::take(&mut self.path);
        // A single point is the end of a bar.
        if path.len() > 1 {
            self.paths.push(path);
        }
    }

    /// Ends the path before a bar. There is no path between adjacent bars.
    fn end_path_at_bar(&mut self, pixel: i32) {
        let after_bar = |x| self.bars.last().is_some_and(|bar| bar.x == x);
        match self.path.as_slice() {
            &[from, to] if to.0 - from.0 <= pixel && after_bar(from.0) => {
                self.path.clear();
                self.climb(from, to, pixel);
            }
            _ => self.end_path(),
        }
    }

    /// Draws a steep stroke as bars, one for its part in each column.
    fn climb(&mut self, from: Pixel, to: Pixel, pixel: i32) {
        let columns = (to.0 - from.0) / pixel.max(1);
        let height = to.1 - from.1;
        // Half a column at both ends, whole columns between.
        let at =
            |halves: i32| from.1 + height * halves.clamp(0, 2 * columns) / (2 * columns).max(1);
        if columns == 0 {
            self.bar(to.0, from.1, to.1);
            return;
        }
        for column in 0..=columns {
            let x = from.0 + column * pixel;
            self.bar(x, at(2 * column - 1), at(2 * column + 1));
        }
    }

    fn bar(&mut self, x: i32, from: i32, to: i32) {
        let (top, bottom) = (from.min(to), from.max(to));
        match self.bars.last_mut() {
            Some(last) if last.x == x => {
                last.top = last.top.min(top);
                last.bottom = last.bottom.max(bottom);
            }
            _ => self.bars.push(Bar { x, top, bottom }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PIXEL: i32 = 8;

    #[test]
    fn what_is_gentle_is_one_path() {
        let points = [(4, 100), (12, 102), (20, 110), (84, 110)];
        let Strokes { bars, paths, .. } = strokes(&points, PIXEL);
        assert!(bars.is_empty());
        assert_eq!(paths, [points]);
    }

    #[test]
    fn noise_is_one_bar_a_column() {
        // Least and greatest value of three columns, far apart.
        let points = [(4, 0), (4, 800), (12, 80), (12, 720), (20, 700), (20, 8)];
        let Strokes { bars, paths, .. } = strokes(&points, PIXEL);
        assert_eq!(paths, Vec::<Vec<Pixel>>::new());
        let bars: Vec<_> = bars
            .iter()
            .map(|bar| (bar.x, bar.top, bar.bottom))
            .collect();
        assert_eq!(bars, [(4, 0, 800), (12, 80, 720), (20, 8, 710)]);
    }

    /// A spike in a flat line gives a path, bars up and down, and a path.
    #[test]
    fn a_spike_interrupts_a_path() {
        let points = [(4, 400), (84, 400), (92, 0), (100, 400), (204, 400)];
        let Strokes { bars, paths, .. } = strokes(&points, PIXEL);
        assert_eq!(paths, [[(4, 400), (84, 400)], [(100, 400), (204, 400)]]);
        let bars: Vec<_> = bars
            .iter()
            .map(|bar| (bar.x, bar.top, bar.bottom))
            .collect();
        assert_eq!(bars, [(84, 200, 400), (92, 0, 200), (100, 200, 400)]);
    }

    /// For any line, every point is covered and adjacent parts touch.
    #[test]
    fn nothing_of_a_line_is_left_out() {
        let noise = |step: i32| (step.wrapping_mul(0x9E37_79B1_u32.cast_signed()) >> 20) % 300;
        for spread in [1, 7, 40, 300] {
            for apart in [1, 2, 5] {
                let point = |step: i32| (4 + step * apart * PIXEL, noise(step) % spread * PIXEL);
                let points: Vec<Pixel> = (0..200).map(point).collect();
                let Strokes { bars, paths, .. } = strokes(&points, PIXEL);
                for &(x, y) in &points {
                    let in_bar = |bar: &Bar| bar.x == x && (bar.top..=bar.bottom).contains(&y);
                    let in_path = paths.iter().any(|path| path.contains(&(x, y)));
                    assert!(in_path || bars.iter().any(in_bar), "{x} {y}");
                }
                for pair in bars.windows(2) {
                    if pair[1].x - pair[0].x == PIXEL && apart > 1 {
                        let touch = pair[0].top <= pair[1].bottom && pair[1].top <= pair[0].bottom;
                        assert!(touch, "{pair:?}");
                    }
                }
            }
        }
    }
}

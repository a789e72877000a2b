//! Linear least squares with a few unknowns.
//!
//! Rows are rotated into a triangle one by one (Givens rotations; Golub and Van Loan, Matrix Computations,
//! 5.2.5), so that no sum of squares is formed and no row is kept.

/// A diagonal element this small relative to its column means that the rows do not determine the unknowns.
const RANK_MIN: f64 = 1e-9;

/// Rows of `y = x[0] * unknown[0] + x[1] * unknown[1] + ..`.
#[derive(Clone, Debug)]
pub(super) struct LeastSquares<const N: usize> {
    triangle: [[f64; N]; N],
    right: [f64; N],
    /// Sum of the squares of the residuals.
    squares: f64,
    rows: u32,
}

/// The unknowns and their errors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit<const N: usize> {
    pub(super) unknowns: [f64; N],
    /// Standard error of each unknown.
    pub(super) errors: [f64; N],
    /// Sum of the squares of the residuals.
    pub(super) squares: f64,
    /// Degrees of freedom: rows minus unknowns.
    pub(super) freedom: f64,
    /// The inverse of the triangle.
    inverse: [[f64; N]; N],
}

#[allow(
    clippy::indexing_slicing,
    reason = "every index runs below N, the length of each array"
)]
impl<const N: usize> Fit<N> {
    /// How much each unknown changes with the right side of this row: its column of the pseudo-inverse.
    pub(super) fn influence(&self, row: &[f64; N]) -> [f64; N] {
        let turned: [f64; N] =
            std::array::from_fn(|k| (0..=k).map(|at| self.inverse[at][k] * row[at]).sum());
        std::array::from_fn(|at| (at..N).map(|k| self.inverse[at][k] * turned[k]).sum())
    }
}

#[allow(
    clippy::indexing_slicing,
    clippy::needless_range_loop,
    reason = "every index runs below N, the length of each array; iterators over three arrays hide the algorithm"
)]
impl<const N: usize> LeastSquares<N> {
    pub(super) const fn new() -> Self {
        Self {
            triangle: [[0.0; N]; N],
            right: [0.0; N],
            squares: 0.0,
            rows: 0,
        }
    }

    /// Adds a row.
    pub(super) fn add(&mut self, mut row: [f64; N], mut y: f64) {
        for at in 0..N {
            let long = self.triangle[at][at].hypot(row[at]);
            if long == 0.0 {
                continue;
            }
            let (cos, sin) = (self.triangle[at][at] / long, row[at] / long);
            for column in at..N {
                let (above, below) = (self.triangle[at][column], row[column]);
                self.triangle[at][column] = cos * above + sin * below;
                row[column] = cos * below - sin * above;
            }
            let above = self.right[at];
            self.right[at] = cos * above + sin * y;
            y = cos * y - sin * above;
        }
        self.squares += y * y;
        self.rows += 1;
    }

    /// The unknowns; `None` if there are not more rows than unknowns, or if the rows do not determine them.
    pub(super) fn solve(&self) -> Option<Fit<N>> {
        let unknown_count = u32::try_from(N).ok()?;
        let freedom = f64::from(self.rows.checked_sub(unknown_count)?);
        if freedom < 1.0 {
            return None;
        }
        let mut inverse = [[0.0; N]; N];
        for at in (0..N).rev() {
            let column = (0..=at).map(|row| self.triangle[row][at].abs());
            let largest = column.fold(0.0, f64::max);
            let diagonal = self.triangle[at][at];
            if diagonal.abs() <= RANK_MIN * largest || !diagonal.is_finite() {
                return None;
            }
            inverse[at][at] = 1.0 / diagonal;
            for column in at + 1..N {
                let sum: f64 = (at + 1..=column)
                    .map(|k| self.triangle[at][k] * inverse[k][column])
                    .sum();
                inverse[at][column] = -sum / diagonal;
            }
        }
        let variance = self.squares / freedom;
        let mut unknowns = [0.0; N];
        let mut errors = [0.0; N];
        for at in 0..N {
            unknowns[at] = (at..N).map(|k| inverse[at][k] * self.right[k]).sum();
            let spread: f64 = (at..N).map(|k| inverse[at][k] * inverse[at][k]).sum();
            errors[at] = (variance * spread).sqrt();
        }
        Some(Fit {
            unknowns,
            errors,
            squares: self.squares,
            freedom,
            inverse,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Anscombe's first set (1973): intercept 3.0001, slope 0.5001, with standard errors 1.1247 and 0.1179.
    #[test]
    fn a_published_regression_comes_out_with_its_standard_errors() {
        let x = [10.0, 8.0, 13.0, 9.0, 11.0, 14.0, 6.0, 4.0, 12.0, 7.0, 5.0];
        let y = [
            8.04, 6.95, 7.58, 8.81, 8.33, 9.96, 7.24, 4.26, 10.84, 4.82, 5.68,
        ];
        let mut rows = LeastSquares::new();
        for (x, y) in x.into_iter().zip(y) {
            rows.add([1.0, x], y);
        }
        let fit = rows.solve().unwrap();
        let expected = [3.0001, 0.5001, 1.1247, 0.1179];
        let found = [fit.unknowns, fit.errors].concat();
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs() < 5e-5, "{found} {expected}");
        }
        assert!((fit.freedom - 9.0).abs() < 1e-12);
        // The unknowns are the right sides times the pseudo-inverse.
        let slope = x
            .into_iter()
            .zip(y)
            .map(|(x, y)| fit.influence(&[1.0, x])[1] * y);
        assert!((slope.sum::<f64>() - fit.unknowns[1]).abs() < 1e-9);
    }

    #[test]
    fn rows_that_say_the_same_determine_nothing() {
        let mut rows = LeastSquares::new();
        for x in 0..9 {
            rows.add([1.0, 2.0], f64::from(x));
        }
        assert!(rows.solve().is_none());
        assert!(LeastSquares::<2>::new().solve().is_none());
    }
}

//! Decimation loses no peak, and a scrolling trace does not shimmer.

use super::*;

const SECOND: u64 = 1_000_000;

/// The lines of these values.
fn lines(grid: Grid, values: impl IntoIterator<Item = (u64, f32)>) -> Vec<Vec<Dot>> {
    let mut lines = Lines::new(grid);
    for (at_us, value) in values {
        lines.to(at_us, value);
    }
    lines.finish()
}

fn line(grid: Grid, values: impl IntoIterator<Item = (u64, f32)>) -> Vec<Dot> {
    let mut lines = lines(grid, values);
    assert_eq!(lines.len(), 1);
    lines.remove(0)
}

/// A wave with noise, 500 times a second, equal in every run.
#[allow(clippy::cast_precision_loss, reason = "the steps of a minute are few")]
fn wave(step: u32) -> f32 {
    let noise = (step.wrapping_mul(2_654_435_761) >> 24) as f32 / 256.0;
    (step as f32 / 700.0).sin() + noise
}

/// One minute at 500 Hz with a single outlier. At every width of the graph and every position of the outlier, it is
/// in the line, in the column of its time.
#[test]
fn a_spike_of_one_sample_is_seen_at_every_width() {
    let samples = 30_000_u32;
    let mut places = [0, 1, 2, 299, 15_000, 29_998, 29_999].to_vec();
    places.extend((1..40_u32).map(|step| step * 9_973 % samples));
    for width in 50..=3_000 {
        let grid = Grid::new(60 * SECOND, 100 * SECOND - 1, width);
        let column = samples / width + 2;
        for &place in &places {
            for spike in [40.0_f32, -40.0] {
                let at = |step: u32| 40 * SECOND + u64::from(step) * 2_000;
                let value = |step| if step == place { spike } else { wave(step) };
                // Samples further away are in other columns.
                let near = place.saturating_sub(column)..(place + column).min(samples);
                let dots = line(grid, near.map(|step| (at(step), value(step))));
                let x = grid.place(at(place)).floor() + 0.5;
                // Columns of whole microseconds can be a few samples too short in total.
                if x < 0.0 {
                    continue;
                }
                assert!(
                    dots.contains(&(x, f64::from(spike))),
                    "{width} columns, spike at {place}"
                );
            }
        }
    }
}

#[test]
fn a_column_keeps_its_least_and_greatest_in_the_order_of_time() {
    let grid = Grid::new(10, 99, 2);
    assert_eq!(grid.column_us, 5);
    let rising = [(90, 3.0), (91, 1.0), (92, 2.0), (93, 9.0), (94, 4.0)];
    let falling = [(95, 5.0), (96, 8.0), (97, 6.0), (98, 0.0), (99, 7.0)];
    let dots = line(grid, rising.into_iter().chain(falling));
    assert_eq!(dots, [(0.5, 1.0), (0.5, 9.0), (1.5, 8.0), (1.5, 0.0)]);
}

/// After seven columns the same replies give the same line, shifted by seven columns to the left.
#[test]
fn a_trace_that_scrolls_keeps_its_shape() {
    let at = |step: u32| 10 * SECOND + u64::from(step) * 2_000 + u64::from(step % 5) * 37;
    let values = || (0..20_000_u32).map(|step| (at(step), wave(step)));
    let grid = Grid::new(20 * SECOND, 40 * SECOND, 611);
    let later = Grid::new(20 * SECOND, 40 * SECOND + 7 * grid.column_us, 611);
    // Positions are multiples of one half, which a float holds exactly.
    let inside = |dots: Vec<Dot>, from: f64, to: f64, shift: f64| -> Vec<(u64, u64)> {
        let dots = dots.into_iter().filter(|(x, _)| (from..to).contains(x));
        dots.map(|(x, y)| ((x + shift).to_bits(), y.to_bits()))
            .collect()
    };
    let before = inside(line(grid, values()), 10.0, 600.0, 0.0);
    let after = inside(line(later, values()), 3.0, 593.0, 7.0);
    assert!(before.len() > 1_000);
    assert_eq!(before, after);
}

#[test]
fn the_last_column_holds_the_right_edge_and_moments_have_places() {
    let grid = Grid::new(60 * SECOND, 123_456_789, 600);
    assert_eq!(grid.column_us, 100_000);
    assert_eq!((grid.left_us(), grid.right_us()), (63_500_000, 123_500_000));
    for (at_us, place) in [(63_500_000, 0.0), (63_550_000, 0.5), (123_500_000, 600.0)] {
        assert!((grid.place(at_us) - place).abs() < 1e-9);
        assert_eq!(grid.moment_us(place), at_us);
    }
    assert_eq!(Grid::new(60 * SECOND, 123_499_999, 600), grid);
    let next = Grid::new(60 * SECOND, 123_500_000, 600);
    assert_eq!(next.right_us() - grid.right_us(), grid.column_us);
}

/// In the first seconds of a page most of the view lies before zero of the worker's clock.
#[test]
fn a_view_may_begin_before_time_does() {
    let grid = Grid::new(60 * SECOND, 5 * SECOND, 600);
    assert_eq!(grid.left_us(), 0);
    assert!((grid.place(0) - 549.0).abs() < 1e-9);
    let dots = line(grid, [(0, 1.0), (SECOND, 2.0)]);
    assert_eq!(dots, [(549.5, 1.0), (559.5, 2.0)]);
}

#[test]
fn lines_end_at_the_edges_where_they_cross_them() {
    let grid = Grid::new(100, 199, 10);
    let dots = line(
        grid,
        [(85, 0.0), (105, 20.0), (115, 20.0), (195, 20.0), (215, 0.0)],
    );
    // The first dot is 1.5 columns before the view and 2 before the second, so three quarters are cut off.
    assert_eq!(dots.first(), Some(&(0.0, 15.0)));
    assert_eq!(dots.last(), Some(&(10.0, 15.0)));
    let across = line(grid, [(50, 0.0), (250, 20.0)]);
    assert_eq!((across[0].0, across[1].0, across.len()), (0.0, 10.0, 2));
    assert!(lines(grid, [(50, 1.0), (60, 2.0)]).is_empty());
    assert!(lines(grid, [(250, 1.0)]).is_empty());
}

#[test]
fn a_value_that_stays_takes_two_dots() {
    let grid = Grid::new(1_000, 999, 100);
    let dots = line(grid, (0..100).map(|step| (step * 10, 5.0)));
    assert_eq!(dots, [(0.5, 5.0), (99.5, 5.0)]);
}

#[test]
fn a_cut_is_not_bridged_and_a_lone_value_is_seen() {
    let grid = Grid::new(100, 99, 100);
    let mut lines = Lines::new(grid);
    lines.cut();
    lines.to(10, 1.0);
    lines.cut();
    lines.to(20, 2.0);
    lines.to(21, 3.0);
    lines.cut();
    lines.to(22, 2.0);
    lines.to(23, 2.5);
    let lines = lines.finish();
    assert_eq!(lines[0], [(10.0, 1.0), (11.0, 1.0)]);
    assert_eq!(lines[1], [(20.5, 2.0), (21.5, 3.0)]);
    assert_eq!(lines[2], [(22.5, 2.0), (23.5, 2.5)]);
}

#[test]
fn a_column_of_several_values_has_their_mean_and_their_spread() {
    let grid = Grid::new(10, 99, 2);
    let mut lines = Lines::averaged(grid);
    for (at_us, value) in [
        (82, 9.0),
        (83, 1.0),
        (90, 1.0),
        (91, 4.0),
        (92, 1.0),
        (96, 5.0),
    ] {
        lines.to(at_us, value);
    }
    let (lines, spreads) = lines.finish_with_spreads();
    let [line] = lines.as_slice() else {
        panic!("{lines:?}")
    };
    assert_eq!(line[line.len() - 2..], [(0.5, 2.0), (1.5, 5.0)]);
    assert_eq!(spreads, [(0.5, 1.0, 4.0)], "in view, and of several values");
}

#[test]
fn the_range_is_from_the_least_to_the_greatest_value() {
    let lines = [vec![(0.0, 3.0)], vec![(1.0, -7.5), (2.0, 1.0)]];
    assert_eq!(range(&lines, &[(3.0, 0.0, 9.0)]), Some((-7.5, 9.0)));
    assert_eq!(range(&[], &[]), None);
}

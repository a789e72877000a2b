//! Positions of the labels at the ends of lines, without overlap.

/// The heights of labels, in the order of `wanted`: as near to the wanted heights as possible, at least `gap` apart,
/// between `top` and `bottom`. If there is not enough room, the gap shrinks.
pub(crate) fn spread(wanted: &[f64], gap: f64, top: f64, bottom: f64) -> Vec<f64> {
    let mut order: Vec<usize> = Vec::new();
    // There are few labels: the sort of the standard library would add more code than this module has.
    for (label, y) in wanted.iter().enumerate() {
        let is_below = |other: &usize| wanted.get(*other).is_some_and(|other| other > y);
        let place = order.iter().position(is_below).unwrap_or(order.len());
        order.insert(place, label);
    }
    let between = f64::from(u32::try_from(order.len()).unwrap_or(u32::MAX)) - 1.0;
    let gap = gap.min((bottom - top).max(0.0) / between.max(1.0));
    let mut placed = wanted.to_vec();
    // First down as far as the label above needs, then up as far as the bottom needs.
    let mut least = top;
    for label in &order {
        if let Some(y) = placed.get_mut(*label) {
            *y = y.max(least);
            least = *y + gap;
        }
    }
    let mut greatest = bottom;
    for label in order.iter().rev() {
        if let Some(y) = placed.get_mut(*label) {
            *y = y.min(greatest);
            greatest = *y - gap;
        }
    }
    placed
}

#[cfg(test)]
mod tests {
    use super::*;

    fn placed(wanted: &[f64]) -> Vec<i32> {
        let placed = spread(wanted, 10.0, 0.0, 100.0);
        #[allow(clippy::cast_possible_truncation, reason = "small whole numbers")]
        placed.into_iter().map(|y| y.round() as i32).collect()
    }

    #[test]
    fn labels_with_room_stay_where_they_belong() {
        assert_eq!(placed(&[50.0, 20.0, 90.0]), [50, 20, 90]);
        assert!(placed(&[]).is_empty());
    }

    #[test]
    fn labels_side_by_side_go_one_below_the_other_and_stay_in_the_plot() {
        assert_eq!(placed(&[50.0, 50.0, 52.0]), [50, 60, 70]);
        assert_eq!(placed(&[99.0, 98.0]), [100, 90]);
        assert_eq!(placed(&[-5.0, 3.0, 120.0]), [0, 10, 100]);
    }

    #[test]
    fn too_many_move_together() {
        let placed = spread(&[30.0; 21], 10.0, 0.0, 100.0);
        assert!(
            placed
                .windows(2)
                .all(|pair| (pair[1] - pair[0] - 5.0).abs() < 1e-9)
        );
        assert_eq!((placed[0].round(), placed[20].round()), (0.0, 100.0));
    }
}

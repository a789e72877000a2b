//! The scale of a sparkline: symmetric, in steps that double.

/// It grows at once and shrinks with hysteresis, so that a value near a step does not make it jump.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Scale {
    /// The smallest distance from zero to either edge.
    smallest: i32,
    doublings: u32,
    doublings_max: u32,
}

impl Scale {
    pub(crate) const fn new(smallest: i32, doublings_max: u32) -> Self {
        Self {
            smallest,
            doublings: 0,
            doublings_max,
        }
    }

    /// Follows the largest magnitude that is drawn.
    pub(crate) fn fit(&mut self, peak: i32) {
        while peak > self.limit() && self.doublings < self.doublings_max {
            self.doublings += 1;
        }
        // Smaller only if a fifth of the smaller scale stays free.
        while self.doublings > 0 && peak < self.limit() / 2 / 5 * 4 {
            self.doublings -= 1;
        }
    }

    /// The value at either edge.
    pub(crate) const fn limit(self) -> i32 {
        self.smallest << self.doublings
    }

    /// The factor relative to the smallest scale.
    pub(crate) const fn multiple(self) -> u32 {
        1 << self.doublings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limits(scale: &mut Scale, peaks: &[i32]) -> Vec<i32> {
        let fitted = peaks.iter().map(|peak| {
            scale.fit(*peak);
            scale.limit()
        });
        fitted.collect()
    }

    #[test]
    fn a_scale_has_room_for_every_peak_in_steps_that_double() {
        let mut scale = Scale::new(25, 5);
        let peaks = [0, 25, 26, 100, 101, 330, 800];
        assert_eq!(limits(&mut scale, &peaks), [25, 25, 50, 100, 200, 400, 800]);
        assert_eq!(scale.multiple(), 32);
        assert_eq!(
            limits(&mut scale, &[32_767]),
            [800],
            "the greatest there is"
        );
    }

    #[test]
    fn a_value_that_dwells_at_a_step_does_not_have_the_scale_jump() {
        let mut scale = Scale::new(25, 5);
        let dwelling = [99, 101, 98, 103, 97, 100, 85, 102];
        let limits = limits(&mut scale, &dwelling);
        assert_eq!(limits, [100, 200, 200, 200, 200, 200, 200, 200]);
    }

    #[test]
    fn a_scale_shrinks_when_a_fifth_of_the_smaller_one_is_free() {
        let mut scale = Scale::new(25, 5);
        assert_eq!(limits(&mut scale, &[101, 80, 79]), [200, 200, 100]);
        assert_eq!(limits(&mut scale, &[0]), [25], "all steps at once");
    }
}

//! A table of measured values and their bounds.

use std::fmt::Display;
use std::fs;

use anyhow::{Context, Result};

/// A table being printed.
pub struct Table(Processor);

impl Table {
    /// Prints its header.
    ///
    /// # Errors
    ///
    /// When the machine does not report its load.
    pub fn begin() -> Result<Self> {
        println!("| figure | must | measured | reached |");
        println!("|---|---|---|---|");
        Ok(Self(Processor::now()?))
    }

    /// Prints how much processor time the host withheld from the machine (steal): it makes a virtual machine late in
    /// any case.
    ///
    /// # Errors
    ///
    /// As for [`Table::begin`].
    pub fn end(self) -> Result<()> {
        println!(
            "\ntime stolen by the host meanwhile: {:.1} %",
            self.0.stolen_until(&Processor::now()?)
        );
        Ok(())
    }
}

/// Prints one row.
pub fn row(figure: &str, must: &str, measured: impl Display, reached: bool) {
    println!(
        "| {figure} | {must} | {measured} | {} |",
        if reached { "yes" } else { "NO" }
    );
}

/// Prints one row of a figure that has no bound.
pub fn row_without_bound(figure: &str, measured: impl Display) {
    println!("| {figure} | | {measured} | |");
}

/// A quotient.
#[must_use]
#[allow(
    clippy::cast_precision_loss,
    reason = "counts, bytes and microseconds of minutes fit a double"
)]
pub fn ratio(dividend: u64, divisor: u64) -> f64 {
    dividend as f64 / divisor as f64
}

/// The percentile of sorted values: the smallest value that this percentage does not exceed; `None` for no values.
#[must_use]
pub fn percentile<T: Copy>(sorted: &[T], percent: usize) -> Option<T> {
    let place = (sorted.len() * percent).div_ceil(100).max(1) - 1;
    sorted.get(place).copied()
}

/// Microseconds as `12.3 ms`.
#[must_use]
pub fn ms(us: u64) -> String {
    format!("{:.1} ms", ratio(us, 1_000))
}

/// Processor times since the machine started, in ticks.
struct Processor {
    all: u64,
    stolen: u64,
}

impl Processor {
    /// From the first line of `/proc/stat`: user, nice, system, idle, iowait, irq, softirq, steal.
    fn now() -> Result<Self> {
        let text = fs::read_to_string("/proc/stat")?;
        let line = text.lines().next().context("/proc/stat is empty")?;
        let ticks: Vec<u64> = line
            .split_whitespace()
            .skip(1)
            .take(8)
            .filter_map(|tick| tick.parse().ok())
            .collect();
        let stolen = ticks.get(7).copied().unwrap_or(0);
        Ok(Self {
            all: ticks.iter().sum(),
            stolen,
        })
    }

    fn stolen_until(&self, later: &Self) -> f64 {
        ratio(
            100 * (later.stolen - self.stolen),
            (later.all - self.all).max(1),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_percentile_is_one_of_the_values() {
        let values: Vec<u32> = (1..=200).collect();
        for (percent, value) in [(0, 1), (50, 100), (99, 198), (100, 200)] {
            assert_eq!(percentile(&values, percent), Some(value));
        }
        assert_eq!(percentile(&[7], 50), Some(7));
        assert_eq!(percentile::<u32>(&[], 50), None);
    }
}

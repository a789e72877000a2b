//! What the graph's lines cost in computing: the least and the greatest value of every column of pixels.
//!
//! `cargo xtask bench` prints it. A frame of the screen has sixteen million nanoseconds, and of those the
//! graph is to have four.
#![allow(missing_docs, reason = "criterion makes an item without docs")]

#[cfg(not(target_arch = "wasm32"))]
mod natively {
    use std::hint::black_box;

    use criterion::{Criterion, criterion_group};
    use motorlink::graph::columns::{Grid, Lines};

    /// A minute of replies, 500 a second.
    const SPAN_US: u64 = 60_000_000;
    const EVERY_US: u64 = 2_000;
    const COLUMNS: u32 = 1_200;

    fn decimate(criterion: &mut Criterion) {
        let replies: Vec<(u64, f32)> = (0_u16..30_000)
            .map(|place| (u64::from(place) * EVERY_US, f32::from(place % 97)))
            .collect();
        let grid = Grid::new(SPAN_US, SPAN_US, COLUMNS);
        criterion.bench_function("decimate: 30,000 replies to 1,200 columns", |bencher| {
            bencher.iter(|| {
                let mut lines = Lines::new(black_box(grid));
                for (at_us, value) in &replies {
                    lines.to(*at_us, *value);
                }
                lines.finish()
            });
        });
    }

    criterion_group!(benches, decimate);
}

#[cfg(not(target_arch = "wasm32"))]
criterion::criterion_main!(natively::benches);

/// The page's other targets are built for the browser too.
#[cfg(target_arch = "wasm32")]
fn main() {}

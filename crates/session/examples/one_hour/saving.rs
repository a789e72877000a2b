//! Saves a full packet log as the page does: the recorder gives 2,000 entries at a time.

use std::time::{Duration, Instant};

use motorlink_messages::sessions::{Kept, KeptRecord, SaveRange};
use motorlink_recorder::{ENTRIES_MAX, Recorder, WallClock};
use motorlink_session::Writer;

use crate::{Line, Page, millis, row, seconds};

/// As in `crates/worker/src/recorder`.
const PART: u64 = 2_000;

/// Prints the figures of saving.
pub fn measure() {
    let mut recorder = Recorder::new(WallClock::new(0.0, 0));
    let entries = usize::try_from(ENTRIES_MAX).unwrap_or(usize::MAX);
    let mut page = Page::new();
    for event in Line::new().take(entries) {
        recorder.add_event(&event);
        if let Some(update) = page.add(&event) {
            recorder.add_state(update);
        }
    }
    let mut writer: Option<Writer> = None;
    let (mut lines, mut bytes) = (0_u64, 0);
    let (mut longest, mut took) = (Duration::ZERO, Duration::ZERO);
    loop {
        let began = Instant::now();
        let kept = if writer.is_none() {
            recorder.first_kept(SaveRange::Line, PART)
        } else {
            recorder.next_kept(PART)
        };
        longest = longest.max(began.elapsed());
        let Kept::Part {
            zero_us,
            records,
            is_last,
            ..
        } = kept
        else {
            break;
        };
        let writer = writer.get_or_insert_with(|| Writer::new(zero_us, &[("page", "bench")]));
        for record in records {
            match record {
                KeptRecord::Line(event) => {
                    writer.line(&event);
                    lines += 1;
                }
                KeptRecord::State { at, stored } => writer.state(at, &stored),
                KeptRecord::Message { .. } => {}
            }
        }
        bytes += writer.take().len();
        took += began.elapsed();
        if is_last {
            break;
        }
    }
    let began = Instant::now();
    bytes += writer.map_or(0, |writer| writer.finish().len());
    took += began.elapsed();
    let measured = format!("{}, {lines} entries, {} kB", seconds(took), bytes / 1_000);
    let limit = Duration::from_secs(10);
    row(
        "saving a full packet log, native",
        "under 10 s",
        &measured,
        took < limit,
    );
    row(
        "the longest answer of the recorder meanwhile, native",
        "at most 8 ms, its turn",
        &millis(longest),
        longest < Duration::from_millis(8),
    );
}

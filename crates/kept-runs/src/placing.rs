//! Where a run of a file goes among those that the browser keeps.

use motorlink_messages::experiments::kept::{Outcome, RunHeader};

use crate::bounds::{BYTES_MAX, RUNS_MAX};

/// What becomes of a run of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placing {
    /// It gets this number.
    Add(u32),
    /// It replaces the run of this number: of that, only the beginning is kept.
    Replace(u32),
    /// It is kept already.
    Known,
    /// There are too many runs or bytes.
    NoRoom,
}

impl Placing {
    /// Decides it for a run with a record of this many bytes. `numbers` are those of all kept runs, `kept` the headers that
    /// can be read; `now` is in seconds since 1970.
    #[must_use]
    pub fn of(run: &RunHeader, bytes: u32, kept: &[RunHeader], numbers: &[u32], now: u32) -> Self {
        // Its name may be another one by now.
        let is_same = |other: &&RunHeader| {
            (other.began_unix_ms - run.began_unix_ms).abs() < 1.0 && other.study == run.study
        };
        let same = kept.iter().find(is_same);
        // A run without an end may be going on. One that was cut off is that of a file.
        let is_beginning = |other: &RunHeader| {
            other.outcome == Outcome::PageClosed && matches!(run.outcome, Outcome::Ended(_))
        };
        if same.is_some_and(|other| !is_beginning(other)) {
            return Self::Known;
        }
        let stored: u64 = kept.iter().map(|run| u64::from(run.bytes)).sum();
        let freed = same.map_or(0, |other| u64::from(other.bytes));
        if stored - freed + u64::from(bytes) > BYTES_MAX
            || same.is_none() && numbers.len() >= RUNS_MAX
        {
            return Self::NoRoom;
        }
        if let Some(other) = same {
            return Self::Replace(other.number);
        }
        // Numbers are times: one of the future would be the newest run for ever. Two browsers may have given out the same.
        let mut number = run.number.min(now);
        while numbers.contains(&number) {
            number = number.wrapping_add(1);
        }
        Self::Add(number)
    }
}

#[cfg(test)]
mod tests {
    use motorlink_messages::{experiments::runner::End, protocol::Instant};

    use super::*;

    const NOW: u32 = 1_800_000_000;

    fn run(number: u32, bytes: u32, outcome: Outcome) -> RunHeader {
        RunHeader {
            outcome,
            ..crate::bounds::tests::run(number, bytes)
        }
    }

    fn ended() -> Outcome {
        Outcome::Ended(End::Finished { at: Instant::ZERO })
    }

    fn at(number: u32) -> RunHeader {
        RunHeader {
            began_unix_ms: f64::from(number) * 1_000.0,
            ..run(number, 10, ended())
        }
    }

    #[test]
    fn a_run_is_kept_once_and_gets_a_free_number() {
        let kept = [at(7), at(8)];
        let of = |run: &RunHeader, numbers: &[u32]| Placing::of(run, 10, &kept, numbers, NOW);
        assert_eq!(of(&at(8), &[7, 8]), Placing::Known);
        assert_eq!(of(&at(9), &[7, 8]), Placing::Add(9));
        let other = RunHeader {
            number: 7,
            ..at(100)
        };
        // 9 is a run of another version.
        assert_eq!(of(&other, &[7, 8, 9]), Placing::Add(10));
        assert_eq!(of(&at(u32::MAX), &[7, 8]), Placing::Add(NOW));
    }

    #[test]
    fn a_whole_run_replaces_its_beginning_and_nothing_else() {
        let part = RunHeader {
            outcome: Outcome::PageClosed,
            ..at(7)
        };
        let going_on = RunHeader {
            outcome: Outcome::Running,
            ..at(7)
        };
        let of = |run: &RunHeader, kept: &RunHeader| {
            Placing::of(run, 10, std::slice::from_ref(kept), &[7], NOW)
        };
        assert_eq!(of(&at(7), &part), Placing::Replace(7));
        assert_eq!(of(&part, &at(7)), Placing::Known);
        assert_eq!(of(&part, &part), Placing::Known);
        assert_eq!(of(&at(7), &going_on), Placing::Known);
    }

    #[test]
    fn there_is_room_for_so_many_runs_and_bytes() {
        let full = [run(1, 99_999_995, Outcome::PageClosed)];
        assert_eq!(Placing::of(&at(9), 10, &full, &[1], NOW), Placing::NoRoom);
        assert_eq!(Placing::of(&at(9), 5, &full, &[1], NOW), Placing::Add(9));
        let numbers: Vec<u32> = (1..=200).collect();
        assert_eq!(
            Placing::of(&at(900), 5, &[], &numbers, NOW),
            Placing::NoRoom
        );
        // In place of its beginning it needs no more runs, and frees its bytes.
        let whole = run(1, 5, ended());
        assert_eq!(
            Placing::of(&whole, 10, &full, &numbers, NOW),
            Placing::Replace(1)
        );
    }
}

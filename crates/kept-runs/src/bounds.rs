//! How many runs are kept.

use motorlink_messages::experiments::kept::RunHeader;

/// Maximal number of runs: more names are not found again in a list.
pub const RUNS_MAX: usize = 200;
/// Maximal size of all runs, in bytes. A run of a minute at 200 Hz has a quarter of a megabyte.
pub const BYTES_MAX: u64 = 100_000_000;

/// The numbers of the oldest runs that go, so that the others are within the bounds. `list` has the newest first. The
/// newest run always stays.
#[must_use]
pub fn too_many(list: &[RunHeader]) -> Vec<u32> {
    let mut bytes = 0;
    let outside = list.iter().enumerate().filter(|(place, run)| {
        bytes += u64::from(run.bytes);
        *place > 0 && (*place >= RUNS_MAX || bytes > BYTES_MAX)
    });
    outside.map(|(_, run)| run.number).collect()
}

#[cfg(test)]
pub(crate) mod tests {
    use motorlink_messages::experiments::kept::Outcome;

    use super::*;

    pub(crate) fn run(number: u32, bytes: u32) -> RunHeader {
        RunHeader {
            number,
            name: String::new(),
            study: String::new(),
            motors: Vec::new(),
            model: String::new(),
            setup: String::new(),
            page_version: String::new(),
            began_unix_ms: 0.0,
            began: None,
            request_hz: 200.0,
            outcome: Outcome::PageClosed,
            bytes,
        }
    }

    #[test]
    fn the_oldest_runs_go() {
        let few: Vec<_> = (0..200).rev().map(|number| run(number, 1)).collect();
        assert!(too_many(&few).is_empty());
        let many: Vec<_> = (0..202).rev().map(|number| run(number, 1)).collect();
        assert_eq!(too_many(&many), [1, 0]);
        let large = [run(3, 60_000_000), run(2, 30_000_000), run(1, 20_000_000)];
        assert_eq!(too_many(&large), [1]);
        assert!(too_many(&[run(1, u32::MAX)]).is_empty());
    }
}

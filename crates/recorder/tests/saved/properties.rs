//! Random sessions, and files that are cut anywhere.

use motorlink_messages::recorder::{Export, ToRecorder};
use proptest::prelude::*;

use super::fixture::{EPOCH_MS, LATER_MS, Page, restored};

/// A random step.
#[derive(Clone, Debug)]
enum Step {
    Drive(u64),
    Message,
    Clear,
    EndClear { undo: bool },
    Record(bool),
    Pass(u64),
}

fn steps() -> impl Strategy<Value = Vec<Step>> {
    let step = prop_oneof![
        6 => (1..400_u64).prop_map(Step::Drive),
        2 => Just(Step::Message),
        1 => Just(Step::Clear),
        1 => any::<bool>().prop_map(|undo| Step::EndClear { undo }),
        2 => any::<bool>().prop_map(Step::Record),
        3 => (1..600_u64).prop_map(Step::Pass),
    ];
    proptest::collection::vec(step, 1..30)
}

fn play(page: &mut Page, steps: &[Step]) {
    let mut n = 0;
    for step in steps {
        match step {
            Step::Drive(count) => {
                page.drive(n..n + count);
                n += count;
            }
            Step::Message => page.add_message(n, "said"),
            Step::Clear => page.handle(ToRecorder::Clear),
            Step::EndClear { undo } => page.handle(ToRecorder::EndClear { undo: *undo }),
            Step::Record(on) => page.handle(ToRecorder::Record(*on)),
            Step::Pass(millis) => page.pass(*millis),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn whatever_happened_comes_back(first in steps(), second in steps()) {
        let mut page = Page::opened(EPOCH_MS);
        play(&mut page, &first);
        let disk = page.crash();
        let mut page = restored(&disk, LATER_MS);
        play(&mut page, &second);
        let log = page.export(Export::Log);
        let recorded = page.recording().recorded;
        let telemetry = page.export(Export::Telemetry);
        let plot = page.export(Export::Plot);
        let disk = page.crash();
        let mut again = restored(&disk, LATER_MS + LATER_MS);
        prop_assert_eq!(again.export(Export::Log), log);
        prop_assert_eq!(again.recording().recorded, recorded);
        prop_assert_eq!(again.export(Export::Telemetry), telemetry);
        prop_assert_eq!(again.export(Export::Plot), plot);
    }

    #[test]
    fn a_torn_tail_costs_the_end_and_nothing_else(
        entries in 1_000..6_000_u64, cut in any::<prop::sample::Index>()
    ) {
        let mut page = Page::opened(EPOCH_MS);
        for start in (0..entries).step_by(100) {
            page.drive(start..start + 100);
            page.pass(260);
        }
        let whole = page.export(Export::Log);
        let mut disk = page.crash();
        let last = disk.last_entry().unwrap().into_mut();
        last.truncate(cut.index(last.len()));
        let log = restored(&disk, LATER_MS).export(Export::Log);
        prop_assert!(whole.starts_with(&log));
    }
}

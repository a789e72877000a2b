//! Damaged files: what is readable is replayed, and nothing hangs.

use std::time::Duration;

use motorlink_messages::sessions::ToReplay;
use motorlink_protocol::{Instant, family::Model};
use motorlink_session::{LookBack, Record, Writer, for_each_record, open};

use super::{
    driver::Replay,
    live::{ZERO_US, ms},
    random::{Dice, session},
};

/// Does everything that a page may ask for. Returns the number of records that were shown.
fn use_it(file: &[u8], dice: &mut Dice) -> Option<usize> {
    let mut replay = Replay::with(file, LookBack::default())?;
    replay.play(100_000);
    replay.run(ms(300));
    for _ in 0..3 {
        replay.ask(ToReplay::Seek {
            after_us: dice.below(8_000_000),
        });
        replay.ask(ToReplay::Step { forward: true });
        replay.ask(ToReplay::Step { forward: false });
    }
    replay.run(Duration::from_secs(2));
    Some(replay.last().1.motors.len())
}

#[test]
fn a_truncated_file_is_replayed_as_far_as_it_goes() {
    let (file, _) = session(Model::Ddsm115, 3, 8);
    let mut dice = Dice::new(7);
    let mut shown = 0;
    for _ in 0..60 {
        let len = usize::try_from(dice.below(file.len() as u64)).unwrap();
        shown += use_it(&file[..len], &mut dice).unwrap_or_default();
    }
    assert!(shown > 0);
}

#[test]
fn flipped_bits_neither_stop_nor_hang_a_replay() {
    let (file, _) = session(Model::Ddsm400, 5, 6);
    let mut dice = Dice::new(11);
    let mut shown = 0;
    for _ in 0..120 {
        let mut damaged = file.clone();
        for _ in 0..=dice.below(3) {
            let place = usize::try_from(dice.below(file.len() as u64)).unwrap();
            damaged[place] ^= 1 << dice.below(8);
        }
        shown += usize::from(use_it(&damaged, &mut dice).is_some());
    }
    assert!(shown > 60, "{shown}");
}

/// Records with impossible times, in a file that is whole otherwise.
#[test]
fn wrong_times_do_not_hang_it() {
    let (file, _) = session(Model::Ddsm115, 9, 6);
    let mut source = &file[..];
    let session = open(&mut source).unwrap().unwrap();
    let mut records: Vec<Record> = Vec::new();
    for_each_record(&mut source, &session, |record| records.push(record)).unwrap();
    let mut dice = Dice::new(13);
    for wrong in [0, 1, u64::MAX / 2_000, 3_600_000_000_000] {
        let mut records = records.clone();
        for _ in 0..3 {
            let place = usize::try_from(dice.below(records.len() as u64)).unwrap();
            records[place].at = Instant::from_micros(wrong);
        }
        let mut writer = Writer::new(ZERO_US, &[]);
        for record in &records {
            writer.record(record);
        }
        let shown = use_it(&writer.finish(), &mut dice);
        assert!(shown.is_some());
    }
}

#[test]
fn an_empty_session_begins_and_ends_at_once() {
    let file = Writer::new(ZERO_US, &[]).finish();
    let mut replay = Replay::of(&file);
    assert_eq!(replay.begun().1, 0);
    replay.play(1_000);
    assert!(!replay.last().0.plays);
    replay.ask(ToReplay::Seek { after_us: 5 });
    replay.ask(ToReplay::Step { forward: false });
    assert_eq!(replay.last().0.after_us, 0);
}

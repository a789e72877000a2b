//! A copy with bookmarks has them, and everything else of the file.

use std::collections::BTreeMap;

use motorlink_messages::sessions::Bookmark;
use motorlink_session::{
    BOOKMARK_TEXT_MAX, BOOKMARKS_MAX, EventKind, Overview, Record, What, copy, open, overview,
};
use proptest::prelude::*;

use crate::sample::{SETUP, file_of, read_file, records};

fn copied(file: &[u8], bookmarks: &[Bookmark]) -> Vec<u8> {
    let mut source = file;
    let session = open(&mut source).unwrap().unwrap();
    let (overview, _) = overview(&mut source, &session).unwrap();
    let mut out = Vec::new();
    copy(&mut source, &session, &overview, bookmarks, |bytes| {
        out.extend(bytes);
    })
    .unwrap();
    out
}

fn overview_of(file: &[u8]) -> Overview {
    let mut source = file;
    let session = open(&mut source).unwrap().unwrap();
    overview(&mut source, &session).unwrap().0
}

fn bookmark(after_us: u64, text: &str) -> Bookmark {
    let text = text.to_owned();
    Bookmark { after_us, text }
}

fn is_bookmark(record: &Record) -> bool {
    matches!(&record.what, What::Event(event) if event.kind == EventKind::Bookmark)
}

/// The bookmarks among the records of a file, and all other records.
fn divided(file: &[u8]) -> (Vec<Bookmark>, Vec<Record>) {
    let (records, problems) = read_file(file).unwrap();
    assert!(problems.is_empty(), "{problems}");
    let first = records[0].at;
    let (bookmarks, others): (Vec<_>, Vec<_>) = records.into_iter().partition(is_bookmark);
    let bookmarks = bookmarks.iter().map(|record| {
        let What::Event(event) = &record.what else {
            unreachable!("bookmarks are events")
        };
        let after = record.at.since(first).as_micros();
        bookmark(u64::try_from(after).unwrap(), &event.text)
    });
    (bookmarks.collect(), others)
}

/// The bookmarks that a page shows of a file.
fn listed(overview: &Overview) -> Vec<Bookmark> {
    let marks = overview.marks().iter();
    marks
        .filter(|mark| mark.kind == EventKind::Bookmark)
        .map(|mark| bookmark(u64::try_from(mark.after.as_micros()).unwrap(), &mark.text))
        .collect()
}

#[test]
fn a_copy_without_bookmarks_is_the_same_file() {
    let file = file_of(&records());
    assert!(copied(&file, &[]) == file);
}

#[test]
fn a_copy_of_a_copy_with_other_bookmarks_has_only_those() {
    let file = file_of(&records());
    let first = copied(&file, &[bookmark(5_000_000, "gravel starts here")]);
    let second = [bookmark(0, "begins"), bookmark(36_200_000, "ends")];
    let second_copy = copied(&first, &second);
    assert_eq!(
        divided(&second_copy),
        (second.to_vec(), read_file(&file).unwrap().0)
    );
    let third = copied(&second_copy, &[]);
    assert_eq!(divided(&third), divided(&file));
    assert_eq!(overview_of(&third), overview_of(&file));
}

#[test]
fn only_the_chunk_of_a_bookmark_is_written_anew() {
    let file = file_of(&records());
    let copy = copied(&file, &[bookmark(35_900_000, "near the end")]);
    let chunks = mcap::Summary::read(&file).unwrap().unwrap().chunk_indexes;
    let changed = chunks.iter().find(|chunk| {
        let from = chunks[0].message_start_time;
        chunk.message_end_time - from >= 35_900_000_000
    });
    let unchanged = usize::try_from(changed.unwrap().chunk_start_offset).unwrap();
    assert!(unchanged > 1_000 && copy[..unchanged] == file[..unchanged]);
}

/// The official crate checks every CRC and index.
#[test]
fn the_official_crate_reads_a_copy() {
    let bookmarks = [
        bookmark(7, "a"),
        bookmark(12_345_678, "b \"°\""),
        bookmark(36_200_000, "c"),
    ];
    let file = copied(&file_of(&records()), &bookmarks);
    let messages: Vec<_> = mcap::MessageStream::new(&file)
        .unwrap()
        .map(Result::unwrap)
        .collect();
    let summary = mcap::Summary::read(&file).unwrap().unwrap();
    let statistics = summary.stats.clone().unwrap();
    assert_eq!(statistics.message_count, messages.len() as u64);
    assert_eq!(statistics.attachment_count, 3);
    let mut indexed = 0;
    for chunk in &summary.chunk_indexes {
        for (channel, entries) in &summary.read_message_indexes(&file, chunk).unwrap() {
            for entry in entries {
                let found = summary.seek_message(&file, chunk, entry).unwrap();
                assert_eq!((&found.channel, found.log_time), (channel, entry.log_time));
                indexed += 1;
            }
        }
    }
    assert_eq!(indexed, messages.len());
    for index in &summary.attachment_indexes {
        let attachment = mcap::read::attachment(&file, index).unwrap();
        assert!(index.name != "setup.json" || attachment.data.as_ref() == SETUP.as_bytes());
    }
    let metadata = mcap::read::metadata(&file, &summary.metadata_indexes[0]).unwrap();
    assert_eq!(metadata.metadata["version"], "1");
}

/// A record of a later version of the container, an attachment of another program, and a channel of its own.
#[test]
fn what_this_version_does_not_know_is_copied() {
    let mut out = std::io::Cursor::new(Vec::new());
    let mut writer = mcap::WriteOptions::new()
        .chunk_size(Some(4_000))
        .compression(None)
        .create(&mut out)
        .unwrap();
    let file = file_of(&records());
    for message in mcap::MessageStream::new(&file).unwrap() {
        writer.write(&message.unwrap()).unwrap();
    }
    let channel = writer
        .add_channel(0, "/camera", "other", &BTreeMap::default())
        .unwrap();
    let header = mcap::records::MessageHeader {
        channel_id: channel,
        sequence: 9,
        log_time: 1,
        publish_time: 2,
    };
    writer
        .write_to_known_channel(&header, b"\x00picture")
        .unwrap();
    writer
        .attach(&mcap::Attachment {
            log_time: 3,
            create_time: 4,
            name: "run-7".to_owned(),
            media_type: "text/csv".to_owned(),
            data: b"1,2,3\r\n".as_slice().into(),
        })
        .unwrap();
    writer.finish().unwrap();
    drop(writer);
    let mut file = out.into_inner();
    // A record of an unknown kind at the very start moves everything behind it: the index is wrong, and is not used.
    let unknown: Vec<u8> = [&[0x93][..], &5_u64.to_le_bytes(), b"later"].concat();
    file.splice(8..8, unknown.iter().copied());
    file.truncate(file.len() - 8);
    let mut source = &file[..];
    let session = open(&mut source).unwrap().unwrap();
    let (overview, _) = overview(&mut source, &session).unwrap();
    let mut copy_of_it = Vec::new();
    let bookmarks = [bookmark(20_000_000, "here")];
    copy(&mut source, &session, &overview, &bookmarks, |bytes| {
        copy_of_it.extend(bytes);
    })
    .unwrap();
    assert_eq!(copy_of_it[8..8 + unknown.len()], unknown);
    let summary = mcap::Summary::read(&copy_of_it).unwrap().unwrap();
    let run = summary
        .attachment_indexes
        .iter()
        .find(|one| one.name == "run-7");
    let run = mcap::read::attachment(&copy_of_it, run.unwrap()).unwrap();
    assert_eq!(
        (run.log_time, run.create_time, run.data.as_ref()),
        (3, 4, &b"1,2,3\r\n"[..])
    );
    let camera = mcap::MessageStream::new(&copy_of_it)
        .unwrap()
        .map(Result::unwrap)
        .find(|message| message.channel.topic == "/camera");
    assert_eq!(camera.unwrap().data.as_ref(), b"\x00picture");
    let all = read_file(&file_of(&records())).unwrap().0;
    assert_eq!(divided(&copy_of_it), (bookmarks.to_vec(), all));
}

#[test]
fn bookmarks_have_bounds() {
    let text = "°".repeat(BOOKMARK_TEXT_MAX + 7);
    let bookmarks = vec![bookmark(1, &text); BOOKMARKS_MAX + 7];
    let (found, _) = divided(&copied(&file_of(&records()), &bookmarks));
    assert_eq!(found.len(), BOOKMARKS_MAX);
    assert_eq!(found[0].text.chars().count(), BOOKMARK_TEXT_MAX);
}

#[test]
fn the_clock_that_was_set_does_not_move_a_bookmark() {
    let mut all = records();
    let late = all.len() / 2;
    for record in &mut all[late..] {
        record.utc_ns -= 3_600_000_000_000;
    }
    let file = file_of(&all);
    let bookmarks = [bookmark(30_000_000, "behind the jump")];
    let copy = copied(&file, &bookmarks);
    assert_eq!(divided(&copy).0, bookmarks);
    let (records, _) = read_file(&copy).unwrap();
    let place = records.iter().position(is_bookmark).unwrap();
    let [before, after] = [&records[place - 1], &records[place + 1]];
    assert!(before.at <= records[place].at && records[place].at <= after.at);
    assert!(before.utc_ns <= records[place].utc_ns && records[place].utc_ns <= after.utc_ns);
}

/// Copies a damaged file, and checks that the copy has everything that was readable.
fn check_copy_of_damaged(damaged: &[u8], case: &str) {
    let Some((before, _)) = read_file(damaged) else {
        return;
    };
    let copy = copied(damaged, &[bookmark(3_000_000, "here")]);
    let (after, _) = read_file(&copy).unwrap();
    let (found, others): (Vec<_>, Vec<_>) = after.into_iter().partition(is_bookmark);
    assert_eq!(found.len(), 1, "{case}");
    let (copied, read) = (others.len(), before.len());
    assert!(others == before, "{case}: {copied} of {read}");
}

#[test]
fn a_damaged_file_is_copied_as_far_as_it_is_read() {
    let file = file_of(&records());
    let mut seed = 0x9E37_79B9_7F4A_7C15_u64;
    let mut random = |below: usize| {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        usize::try_from(seed % below as u64).unwrap()
    };
    for case in 0..2_000 {
        let mut damaged = file.clone();
        if case % 2 == 0 {
            let bit = random(file.len() * 8);
            damaged[bit / 8] ^= 1 << (bit % 8);
        } else {
            damaged.truncate(random(file.len()));
        }
        check_copy_of_damaged(&damaged, &format!("case {case}"));
    }
}

/// A wrong bit in the head of a record looks like the end of the data, or its length reaches into the next chunk.
#[test]
fn a_wrong_bit_in_the_head_of_a_record_costs_that_record() {
    let file = file_of(&records());
    let mut at = 8;
    let mut heads = 0;
    while at + 9 <= file.len() - 8 {
        for bit in 0..72 {
            let mut damaged = file.clone();
            damaged[at + bit / 8] ^= 1 << (bit % 8);
            check_copy_of_damaged(&damaged, &format!("byte {at}, bit {bit}"));
        }
        let length = file[at + 1..at + 9].try_into().unwrap();
        at += 9 + usize::try_from(u64::from_le_bytes(length)).unwrap();
        heads += 1;
    }
    assert!(heads > 30, "{heads}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_bookmarks_are_found_again(
        places in prop::collection::vec((0..36_200_000_u64, "\\PC{0,20}"), 0..20)
    ) {
        let mut bookmarks: Vec<_> = places.iter().map(|(at, text)| bookmark(*at, text)).collect();
        let file = file_of(&records());
        let copy = copied(&file, &bookmarks);
        bookmarks.sort_by_key(|bookmark| bookmark.after_us);
        let (found, others) = divided(&copy);
        prop_assert_eq!(&found, &bookmarks);
        prop_assert_eq!(others, read_file(&file).unwrap().0);
        prop_assert_eq!(listed(&overview_of(&copy)), bookmarks);
        prop_assert!(copied(&copy, &[]).len() == file.len());
    }
}

//! Files that are cut, damaged, or something else: what can be read is given, and never a panic, a hang or a huge
//! allocation.

use std::{collections::BTreeMap, convert::Infallible, ops::Range};

use motorlink_session::{NotASession, Problem, Record, Source, open};

use crate::sample::{file_of, read, read_file, records};

/// Whether these are some of those, in their order.
fn is_subsequence(some: &[Record], all: &[Record]) -> bool {
    let mut rest = all.iter();
    some.iter().all(|one| rest.any(|other| other == one))
}

#[test]
fn a_file_that_is_cut_anywhere_gives_every_whole_chunk() {
    let file = file_of(&records());
    let (all, _) = read_file(&file).unwrap();
    let mut before = 0;
    for length in 0..file.len() {
        match read_file(&file[..length]) {
            None => assert!(length < 8, "{length} bytes are enough to know a session"),
            Some((read, problems)) => {
                assert_eq!(read, all[..read.len()], "{length}");
                assert!(
                    read.len() >= before,
                    "{length}: more bytes give fewer records"
                );
                assert!(
                    !problems.is_empty(),
                    "{length}: nobody says that the end is missing"
                );
                before = read.len();
            }
        }
    }
    assert_eq!(before, all.len(), "without its index all of it is read");
}

#[test]
fn a_bit_that_flips_costs_its_chunk_at_most() {
    let file = file_of(&records());
    let (all, _) = read_file(&file).unwrap();
    let mut seed = 0x9E37_79B9_7F4A_7C15_u64;
    let mut whole = 0;
    for _ in 0..10_000 {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        let bit = usize::try_from(seed % (file.len() as u64 * 8)).unwrap();
        let mut damaged = file.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        let Some((read, problems)) = read_file(&damaged) else {
            assert!(
                bit < 64,
                "bit {bit}: only the first bytes say what a file is"
            );
            continue;
        };
        assert!(
            is_subsequence(&read, &all),
            "bit {bit}: something was invented"
        );
        if read.len() == all.len() {
            whole += 1;
        } else {
            assert!(
                !problems.is_empty(),
                "bit {bit}: nobody says what is missing"
            );
            assert!(
                read.len() * 2 > all.len(),
                "bit {bit}: only {} were read",
                read.len()
            );
        }
    }
    assert!(
        whole > 1_000,
        "damage of what is no record costs nothing: {whole}"
    );
}

#[test]
fn two_flips_are_never_a_panic() {
    let file = file_of(&records());
    let (all, _) = read_file(&file).unwrap();
    let mut seed = 7_u64;
    for _ in 0..2_000 {
        let mut damaged = file.clone();
        // One in the index, so that the file is read from its start.
        for (from, to) in [(file.len() - 400, file.len()), (8, file.len())] {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let place = from + usize::try_from(seed >> 33).unwrap() % (to - from);
            damaged[place] ^= 1 << (seed >> 60 & 7);
        }
        if let Some((read, problems)) = read_file(&damaged) {
            assert!(is_subsequence(&read, &all));
            assert!(read.len() == all.len() || !problems.is_empty());
        }
    }
}

/// A large file that exists only as a rule, and counts what is read of it.
struct Made<F> {
    len: u64,
    read: u64,
    byte: F,
}

impl<F: Fn(u64) -> u8> Source for Made<F> {
    type Error = Infallible;

    fn len(&self) -> u64 {
        self.len
    }

    fn read(&mut self, range: Range<u64>) -> Result<Vec<u8>, Infallible> {
        let range = range.start..range.end.min(self.len);
        self.read += range.end.saturating_sub(range.start);
        Ok(range.map(&self.byte).collect())
    }
}

fn made<F: Fn(u64) -> u8>(len: u64, byte: F) -> Made<F> {
    Made { len, read: 0, byte }
}

#[test]
fn four_gigabytes_of_something_else_are_refused_by_their_first_bytes() {
    let why = |first: &'static [u8]| {
        let byte = |at| {
            usize::try_from(at)
                .ok()
                .and_then(|at| first.get(at))
                .copied()
        };
        let mut source = made(4 << 30, move |at| byte(at).unwrap_or(0x55));
        let why = open(&mut source).unwrap().unwrap_err();
        assert!(source.read < 1_000);
        why
    };
    assert_eq!(why(b"PK\x03\x04"), NotASession::Zip);
    assert_eq!(why(b"\x89MCAP1\r\n"), NotASession::NewerContainer);
    assert_eq!(why(b"\x89PNG\r\n\x1A\n"), NotASession::Other);
    assert_eq!(why(b"time"), NotASession::Text);
    assert_eq!(open(&mut &[][..]).unwrap().unwrap_err(), NotASession::Empty);
}

#[test]
fn four_gigabytes_behind_the_right_first_bytes_are_not_read() {
    let mut source = made(4 << 30, |at| match at {
        0..8 => b"\x89MCAP0\r\n"[usize::try_from(at).unwrap()],
        _ => 0x55,
    });
    let session = open(&mut source).unwrap().unwrap();
    assert!(source.read < 1 << 20, "{}", source.read);
    assert_eq!(session.problems().times(Problem::RecordDamaged), 1);
    assert_eq!(session.problems().times(Problem::NoSession), 1);
}

#[test]
fn a_file_of_nothing_but_empty_records_ends() {
    let mut source = made(8 << 20, |at| match at {
        0..8 => b"\x89MCAP0\r\n"[usize::try_from(at).unwrap()],
        // Message indexes without content.
        _ => {
            if at % 9 == 8 {
                7
            } else {
                0
            }
        }
    });
    let session = open(&mut source).unwrap().unwrap();
    let (read, problems) = read(&mut source, &session);
    assert!(read.is_empty() && !problems.is_empty());
}

/// An index that names one chunk again and again must not have it read as often.
#[test]
fn a_chunk_that_the_index_names_many_times_is_read_once() {
    let file = file_of(&records());
    let (all, _) = read_file(&file).unwrap();
    let number = |at: usize| {
        usize::try_from(u64::from_le_bytes(file[at..at + 8].try_into().unwrap())).unwrap()
    };
    // The footer: a byte, its length, the start of the summary, the start of its offsets, the CRC. Then the magic bytes.
    let footer = file.len() - 8 - 29;
    let summary = number(footer + 9);
    let mut chunks = Vec::new();
    let mut at = summary;
    while at < footer {
        let end = at + 9 + number(at + 1);
        if file[at] == 0x08 {
            chunks.push(&file[at..end]);
        }
        at = end;
    }
    let mut hostile = file[..summary].to_vec();
    for _ in 0..1_000 {
        hostile.extend(chunks.iter().flat_map(|chunk| chunk.iter()));
    }
    hostile.extend(&file[footer..footer + 17]);
    // No offsets and no CRC.
    hostile.extend([0; 12]);
    hostile.extend(&file[file.len() - 8..]);
    let (read, problems) = read_file(&hostile).unwrap();
    assert_eq!(read, all);
    let named_again = u64::try_from(chunks.len() * 999).unwrap();
    assert!(named_again > 0);
    assert_eq!(problems.times(Problem::ChunkDamaged), named_again);
}

#[test]
fn garbage_of_any_kind_is_never_a_panic() {
    let mut seed = 3_u64;
    for length in 0..2_000_usize {
        let mut bytes = b"\x89MCAP0\r\n".to_vec();
        for _ in 0..length {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let [.., high] = seed.to_le_bytes();
            // Many small numbers: these are opcodes and lengths.
            bytes.push(if high & 1 == 0 { high >> 4 } else { high });
        }
        read_file(&bytes);
        read_file(&bytes[8..]);
    }
}

#[test]
fn a_file_of_a_newer_version_is_read_with_a_notice() {
    let mut file = file_of(&records());
    let name = file
        .windows(7)
        .position(|seven| seven == b"version")
        .unwrap();
    assert_eq!(file[name + 11], b'1');
    file[name + 11] = b'2';
    let (read, problems) = read_file(&file).unwrap();
    assert_eq!(
        problems.iter().collect::<Vec<_>>(),
        [(Problem::NewerVersion, 1)]
    );
    assert!(read.len() > records().len());
}

#[test]
fn a_file_of_another_program_opens_with_a_notice() {
    let mut out = std::io::Cursor::new(Vec::new());
    let mut writer = mcap::Writer::new(&mut out).unwrap();
    let channel = writer
        .add_channel(0, "/camera", "cdr", &BTreeMap::default())
        .unwrap();
    let header = mcap::records::MessageHeader {
        channel_id: channel,
        sequence: 0,
        log_time: 1,
        publish_time: 1,
    };
    writer.write_to_known_channel(&header, &[1, 2, 3]).unwrap();
    writer.finish().unwrap();
    drop(writer);
    let (read, problems) = read_file(&out.into_inner()).unwrap();
    assert!(read.is_empty());
    assert_eq!(problems.times(Problem::NoSession), 1);
}

#[test]
fn times_that_cannot_be_are_written_and_read() {
    let mut strange = records();
    strange[5].utc_ns = 0;
    strange[9].at = motorlink_protocol::Instant::from_micros(u64::MAX);
    strange[20].utc_ns = u64::MAX / 1_000 * 1_000;
    let (read, problems) = read_file(&file_of(&strange)).unwrap();
    assert!(problems.is_empty(), "{problems}");
    let kinds = |records: &[Record]| -> Vec<_> {
        records
            .iter()
            .filter_map(Record::line)
            .map(|line| line.kind)
            .collect()
    };
    assert_eq!(kinds(&read), kinds(&strange));
}

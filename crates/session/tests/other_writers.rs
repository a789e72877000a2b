//! Files of other writers and of a crash: without chunks, without an index, cut, with records that no version knows. Every
//! entry of them is read, and is in a copy.

use motorlink_messages::sessions::Bookmark;
use motorlink_session::{EventKind, Problem, Record, What, copy, open, overview};

use crate::sample::{file_of, read_file, records};

/// The sample, written by the official crate with these options, and with a record of another program in the middle.
fn written(options: mcap::WriteOptions) -> Vec<u8> {
    let file = file_of(&records());
    let mut out = std::io::Cursor::new(Vec::new());
    let options = options.compression(None).chunk_size(Some(4_000));
    let mut writer = options.create(&mut out).unwrap();
    for (number, message) in mcap::MessageStream::new(&file).unwrap().enumerate() {
        writer.write(&message.unwrap()).unwrap();
        if number == 100 {
            let place = mcap::write::PrivateRecordOptions::IncludeInChunks.into();
            writer
                .write_private_record(0x93, b"another program", place)
                .unwrap();
        }
    }
    writer.finish().unwrap();
    drop(writer);
    out.into_inner()
}

fn forms() -> [(&'static str, mcap::WriteOptions); 6] {
    let options = mcap::WriteOptions::new;
    [
        ("whole", options()),
        ("no chunks", options().use_chunks(false)),
        ("no index of chunks", options().emit_chunk_indexes(false)),
        (
            "no channels in the summary",
            options().repeat_channels(false),
        ),
        ("no summary", options().emit_summary_records(false)),
        (
            "no chunks and no summary",
            options().use_chunks(false).emit_summary_records(false),
        ),
    ]
}

fn copied(file: &[u8], bookmark: &Bookmark) -> Vec<u8> {
    let mut source = file;
    let session = open(&mut source).unwrap().unwrap();
    let (overview, _) = overview(&mut source, &session).unwrap();
    let mut out = Vec::new();
    let bookmarks = std::slice::from_ref(bookmark);
    copy(&mut source, &session, &overview, bookmarks, |bytes| {
        out.extend(bytes);
    })
    .unwrap();
    out
}

fn is_bookmark(record: &Record) -> bool {
    matches!(&record.what, What::Event(event) if event.kind == EventKind::Bookmark)
}

/// Copies a file with a bookmark, and checks that the copy has it, these records and an index.
fn check_copy(form: &str, file: &[u8], expected: &[Record]) {
    let bookmark = Bookmark {
        after_us: 12_000_000,
        text: "here".to_owned(),
    };
    let copy = copied(file, &bookmark);
    let (read, problems) = read_file(&copy).unwrap();
    assert!(problems.is_empty(), "{form}: {problems}");
    let (bookmarks, others): (Vec<_>, Vec<_>) = read.into_iter().partition(is_bookmark);
    assert_eq!(bookmarks.len(), 1, "{form}");
    assert!(others == expected, "{form}: {} records", others.len());
    let messages = mcap::MessageStream::new(&copy).unwrap();
    let messages = messages.map(Result::unwrap).count() as u64;
    let summary = mcap::Summary::read(&copy).unwrap().unwrap();
    let count = summary.stats.as_ref().unwrap().message_count;
    assert_eq!(count, messages, "{form}");
    let mut found = 0;
    // A file may be cut between its last chunk and the index of that.
    let has_index = |chunk: &&mcap::records::ChunkIndex| !chunk.message_index_offsets.is_empty();
    for chunk in summary.chunk_indexes.iter().filter(has_index) {
        let indexes = summary.read_message_indexes(&copy, chunk).unwrap();
        found += indexes.values().map(Vec::len).sum::<usize>();
    }
    if form.contains("no chunks") {
        assert_eq!(found as u64, messages, "{form}");
    }
}

#[test]
fn every_form_that_the_container_allows_is_read_and_copied() {
    let all = read_file(&file_of(&records())).unwrap().0;
    for (form, options) in forms() {
        let file = written(options);
        let (read, problems) = read_file(&file).unwrap();
        assert!(problems.is_empty(), "{form}: {problems}");
        assert!(read == all, "{form}: {} of {}", read.len(), all.len());
        check_copy(form, &file, &all);
    }
}

#[test]
fn a_file_that_is_cut_is_a_session_all_the_same() {
    let all = read_file(&file_of(&records())).unwrap().0;
    let cut_only = [(Problem::Cut, 1)];
    for (form, options) in forms() {
        let whole = written(options);
        // In the magic bytes of the end, in the summary, and in the data.
        for cut in [1, 30, whole.len() / 2] {
            let file = &whole[..whole.len() - cut];
            let (read, problems) = read_file(file).unwrap();
            let problems: Vec<_> = problems.iter().collect();
            assert_eq!(problems, cut_only, "{form}, {cut}");
            assert!(read == all[..read.len()], "{form}, {cut}");
            let least = if cut > 30 { all.len() / 3 } else { all.len() };
            assert!(read.len() >= least, "{form}, {cut}: {}", read.len());
            check_copy(form, file, &read);
        }
    }
    let file = file_of(&records());
    for cut in [1, 30, file.len() / 2] {
        let (read, problems) = read_file(&file[..file.len() - cut]).unwrap();
        assert_eq!(problems.iter().collect::<Vec<_>>(), cut_only, "{cut}");
        assert!(!read.is_empty());
    }
}

/// A chunk whose opcode is damaged looks like a record that this version does not know: its message indexes tell.
#[test]
fn a_chunk_that_looks_like_an_unknown_record_is_said_to_be_damaged() {
    let mut file = file_of(&records());
    let chunks = mcap::Summary::read(&file).unwrap().unwrap().chunk_indexes;
    let at = usize::try_from(chunks[1].chunk_start_offset).unwrap();
    file[at] ^= 0x80;
    file.truncate(file.len() - 8);
    let (read, problems) = read_file(&file).unwrap();
    assert_eq!(problems.times(Problem::ChunkDamaged), 1, "{problems}");
    let all = read_file(&file_of(&records())).unwrap().0;
    assert!(read.len() > all.len() / 2 && read.len() < all.len());
}

//! The runs of experiments in a session file.
#![cfg(test)]

mod sample;

use motorlink_messages::experiments::kept::RunHeader;
use motorlink_protocol::Instant;
use motorlink_session::{Event, EventKind, Problem, RunEvents, Session, Source, Writer, open};
use sample::{ZERO_US, file_of, records, run};

#[test]
fn a_run_comes_out_of_a_file_as_it_went_in() {
    let file = file_of(&records());
    let session = open(&mut &file[..]).unwrap().unwrap();
    let runs: Vec<_> = session.runs().collect();
    let [attached] = &runs[..] else {
        panic!("{runs:?}")
    };
    // No file system takes the other letters.
    assert_eq!(attached.name, "Kies-Sand- -4 kg- 试验");
    let name = &attached.attachment.name;
    assert_eq!(name, "run-1795266946 Kies-Sand- -4 kg- 试验.json");
    let range = session.attachment_range(name).unwrap();
    let mut bytes = Source::read(&mut &file[..], range).unwrap();
    let (header, record) = Session::run(&bytes).unwrap();
    let (expected, recorded) = run();
    // In a file, times count from the start.
    let is_started = |header: &RunHeader| header.began.is_some();
    assert!(is_started(&header) && is_started(&expected));
    assert_eq!(
        (
            header.number,
            &header.name,
            &header.motors,
            header.began_unix_ms
        ),
        (
            expected.number,
            &expected.name,
            &expected.motors,
            expected.began_unix_ms
        )
    );
    assert_eq!(record.samples().len(), recorded.samples().len());
    let rpm = |record: &[motorlink_messages::experiments::runner::Sample]| -> Vec<i16> {
        record.iter().map(|sample| sample.rpm).collect()
    };
    assert_eq!(rpm(record.samples()), rpm(recorded.samples()));
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    assert_eq!(Session::run(&bytes).err(), Some(Problem::AttachmentDamaged));
}

#[test]
fn what_is_no_run_is_not_read_as_one() {
    let mut writer = Writer::new(ZERO_US, &[]);
    writer.event(Instant::ZERO, &Event::new(EventKind::Notice, "something"));
    for name in ["run-x.json", "run-1.csv", "run.json", "setup.json"] {
        writer.attach(name, "application/json", b"{}");
    }
    writer.attach("run-7.json", "application/json", b"{\"motorlink_run\":2}");
    let file = writer.finish();
    let session = open(&mut &file[..]).unwrap().unwrap();
    let names: Vec<_> = session.runs().map(|run| run.attachment.name).collect();
    assert_eq!(names, ["run-7.json"]);
    let range = session.attachment_range("run-7.json").unwrap();
    let bytes = Source::read(&mut &file[..], range).unwrap();
    assert!(Session::run(&bytes).is_err(), "of a later version");
}

#[test]
fn only_runs_whose_events_are_in_the_session_belong_to_it() {
    let (header, _) = run();
    let began = header.began.unwrap();
    let event = Event::new(EventKind::Run, "Run began: Step response");
    let at_ms = |millis| Instant::from_millis(millis);
    let of = |at, zero_us, event: &Event| {
        let mut events = RunEvents::default();
        events.add(at, zero_us, event);
        events.have(&header)
    };
    assert!(of(began, ZERO_US, &event));
    let notice = Event::new(EventKind::Notice, "Run began");
    assert!(!of(began, ZERO_US, &notice));
    // After a restored session the monotonic clock is another one, and the wall clock the same within some time.
    assert!(of(at_ms(3_000), ZERO_US + 7_500_000, &event));
    assert!(
        !of(at_ms(3_000), ZERO_US + 10_000_000, &event),
        "another run"
    );
    // The wall clock was set by an hour.
    assert!(of(began, ZERO_US + 3_600_000_000, &event));
    assert!(!of(began, ZERO_US + 90_000_000_000, &event), "another day");
}

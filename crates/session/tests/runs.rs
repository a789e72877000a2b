//! The runs of experiments in a session file.

use crate::sample::{ZERO_US, file_of, records, run};
use motorlink_messages::experiments::{
    kept::{Outcome, RunHeader},
    runner::{End, Sample, SentSetpoint},
};
use motorlink_protocol::Instant;
use motorlink_session::{Event, EventKind, Problem, RunEvents, Session, Source, Writer, open};

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
    let (header, record) = Session::read_run(&bytes).unwrap();
    let (expected, recorded) = run();
    assert_eq!(
        (header.number, &header.name, &header.study, &header.motors),
        (
            expected.number,
            &expected.name,
            &expected.study,
            &expected.motors
        )
    );
    assert_eq!(
        (
            &header.model,
            &header.setup,
            header.began_unix_ms,
            header.request_hz
        ),
        (
            &expected.model,
            &expected.setup,
            expected.began_unix_ms,
            expected.request_hz
        )
    );
    // In a file, times count from the start.
    let began = expected.began.unwrap();
    let in_file = |at: Instant| Instant::ZERO + at.since(began);
    let samples: Vec<Sample> = recorded
        .samples()
        .iter()
        .map(|sample| Sample {
            at: in_file(sample.at),
            ..*sample
        })
        .collect();
    assert_eq!(record.samples(), samples);
    let sent: Vec<SentSetpoint> = recorded
        .sent_setpoints()
        .iter()
        .map(|sent| SentSetpoint {
            at: in_file(sent.at),
            ..*sent
        })
        .collect();
    assert_eq!(record.sent_setpoints(), sent);
    assert_eq!(record.marks().len(), recorded.marks().len());
    let at = Instant::from_millis(1_000);
    assert_eq!(header.outcome, Outcome::Ended(End::Finished { at }));
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    assert_eq!(
        Session::read_run(&bytes).err(),
        Some(Problem::AttachmentDamaged)
    );
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
    assert!(Session::read_run(&bytes).is_err(), "of a later version");
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
    // Of a run that began before, the end is enough. That is one second later here.
    let end = Event::new(EventKind::Run, "Run ended: Finished");
    assert!(of(at_ms(3_000), ZERO_US + 8_000_000, &end));
    assert!(
        !of(at_ms(3_000), ZERO_US + 5_500_000, &end),
        "of the run before"
    );
    // The wall clock was set by an hour.
    assert!(of(began, ZERO_US + 3_600_000_000, &event));
    assert!(!of(began, ZERO_US + 90_000_000_000, &event), "another day");
}

/// A file with this run.
fn read_again(header: &RunHeader) -> bool {
    let mut writer = Writer::new(ZERO_US, &[]);
    writer.attach_run(header, &run().1);
    let file = writer.finish();
    let session = open(&mut &file[..]).unwrap().unwrap();
    let name = session.runs().next().unwrap().attachment.name;
    let range = session.attachment_range(&name).unwrap();
    let bytes = Source::read(&mut &file[..], range).unwrap();
    Session::read_run(&bytes).is_ok()
}

#[test]
fn a_run_that_the_page_could_not_show_is_not_read() {
    let (good, _) = run();
    assert!(read_again(&good));
    let changed: [fn(&mut RunHeader); 8] = [
        // Later than the last date of a browser.
        |run| run.began_unix_ms = 1e300,
        |run| run.began_unix_ms = -1.0,
        |run| run.request_hz = 1e9,
        |run| run.model = "x".repeat(65),
        |run| run.page_version = "x".repeat(65),
        |run| run.setup = "x".repeat((1 << 20) + 1),
        |run| run.study = "x".repeat((4 << 20) + 1),
        |run| run.motors[0].1 = "x".repeat(65),
    ];
    for (place, change) in changed.into_iter().enumerate() {
        let mut run = good.clone();
        change(&mut run);
        assert!(!read_again(&run), "{place}");
    }
}

#[test]
fn a_run_without_a_name_has_its_number() {
    let (mut header, record) = run();
    header.name = String::new();
    let mut writer = Writer::new(ZERO_US, &[]);
    writer.attach_run(&header, &record);
    let file = writer.finish();
    let session = open(&mut &file[..]).unwrap().unwrap();
    let run = session.runs().next().unwrap();
    assert_eq!(
        (run.name.as_str(), run.attachment.name.as_str()),
        ("1795266946", "run-1795266946.json")
    );
}

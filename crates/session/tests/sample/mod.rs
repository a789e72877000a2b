//! A small session with everything in it, for tests.

use motorlink_bus::{JunkBytes, LineEvent, LineEventKind, StopOutcome};
use motorlink_messages::experiments::{
    kept::{Outcome, RunHeader},
    runner::{End, Mark, Record as RunRecord, RecordPart, Sample, SentSetpoint},
};
use motorlink_protocol::{
    Current, Detail, Fault, Faults, Instant, Layout, Mode, MotorId, Position, Reply, Request, Rpm,
    Setpoint, SpeedTarget,
};
use motorlink_session::{
    Event, EventKind, Problems, Record, Session, Source, What, Writer, for_each_record, open,
};

/// 2026-11-21 13:15:36.962 UTC at [`Instant::ZERO`].
pub const ZERO_US: i64 = 1_795_266_936_962_000;

pub const SETUP: &str = "{\"setup\":1}";

fn id(address: u8) -> MotorId {
    MotorId::new(address).unwrap()
}

fn exchange(n: u64) -> [LineEventKind; 2] {
    let id = id(if n.is_multiple_of(2) { 1 } else { 7 });
    let mode = Some(Mode::Velocity);
    let setpoint = Setpoint::velocity(SpeedTarget::new(100).unwrap());
    let frame = Request::drive(id, setpoint).frame();
    let stalls = (40..44).contains(&n);
    let reply = Reply {
        id,
        mode: Mode::Velocity,
        current: Some(Current::from_raw(i16::try_from(n * 37 % 900).unwrap())),
        speed: Some(Rpm::new(i16::try_from(n % 101).unwrap())),
        detail: Detail::Drive {
            position: Position::from_raw(u16::try_from(n * 991 % 32_768).unwrap()),
        },
        faults: if stalls {
            Faults::NONE.with(Fault::Stall)
        } else {
            Faults::NONE
        },
    };
    let asked = Some(Layout::Drive);
    let answer = match n {
        17 => LineEventKind::Silence {
            id,
            waited_us: 8_000,
        },
        23 => LineEventKind::Junk(JunkBytes::new(&[1, 2, 3])),
        _ => LineEventKind::Received {
            frame: reply.frame(),
            asked,
        },
    };
    [LineEventKind::Sent { frame, mode }, answer]
}

/// What goes in: 36 seconds, two motors.
pub fn records() -> Vec<Record> {
    let mut records = Vec::new();
    let mut push = |us: u64, what| {
        records.push(Record {
            at: Instant::from_micros(us),
            utc_ns: (u64::try_from(ZERO_US).unwrap() + us) * 1_000,
            what,
        });
    };
    push(
        0,
        What::Event(Event::new(EventKind::Connected, "Connected: CH343")),
    );
    for n in 0..120 {
        let [sent, answer] = exchange(n);
        push(1_000 + n * 300_000, What::Line(sent));
        push(3_300 + n * 300_000, What::Line(answer));
    }
    let stop = Event {
        motors: vec![StopOutcome {
            id: id(1),
            confirmed: true,
            speed: Some(Rpm::new(0)),
        }],
        ..Event::new(EventKind::StopEnded, "Stop all motors: motor 1 stands")
    };
    push(36_100_000, What::Event(stop));
    push(
        36_200_000,
        What::Event(Event::new(EventKind::Disconnected, "Adapter \"lost\"").bad()),
    );
    records
}

/// A run of an experiment that begins after 10 s: 50 replies while the motor drives at 100 rpm.
pub fn run() -> (RunHeader, RunRecord) {
    let began = Instant::from_millis(10_000);
    let at = |n: u64| Instant::from_millis(10_000 + n * 20);
    let end = End::Finished { at: at(50) };
    let header = RunHeader {
        number: 1_795_266_946,
        name: "Kies/Sand: \"4 kg\" 试验".to_owned(),
        study: r#"{"study":"of another version"}"#.to_owned(),
        motors: vec![(id(1), "front left".to_owned())],
        model: "ddsm115".to_owned(),
        setup: SETUP.to_owned(),
        page_version: "0.1.0".to_owned(),
        began_unix_ms: 1_795_266_946_962.0,
        began: Some(began),
        request_hz: 50.0,
        outcome: Outcome::Ended(end),
        bytes: 0,
    };
    let samples = (0..50).map(|n| Sample {
        id: id(1),
        at: at(n),
        rpm: Some(i16::try_from(n * 2).unwrap()),
        current: Some(Current::from_raw(300)),
        degrees: Some(66.96),
        celsius: (n % 10 == 0).then_some(33),
    });
    let setpoint = Setpoint::velocity(SpeedTarget::new(100).unwrap());
    let mut record = header.record();
    record.add_part(RecordPart {
        samples: samples.collect(),
        sent: vec![SentSetpoint {
            id: id(1),
            at: began,
            setpoint,
        }],
        marks: vec![Mark { at: began, step: 0 }],
    });
    (header, record)
}

/// A file of these records, with the setup and a run.
pub fn file_of(records: &[Record]) -> Vec<u8> {
    file_about(&[("page", "0.1.0")], records)
}

/// The same with this metadata.
pub fn file_about(about: &[(&str, &str)], records: &[Record]) -> Vec<u8> {
    let mut writer = Writer::new(ZERO_US, about);
    let mut file = Vec::new();
    for record in records {
        writer.record(record);
        file.extend(writer.take());
    }
    writer.attach("setup.json", "application/json", SETUP.as_bytes());
    let (header, record) = run();
    writer.attach_run(&header, &record);
    file.extend(writer.finish());
    file
}

/// Without those that the writer derives.
pub fn without_derived(records: Vec<Record>) -> Vec<Record> {
    let derived = |record: &Record| matches!(&record.what, What::Event(event) if event.kind == EventKind::Fault);
    records
        .into_iter()
        .filter(|record| !derived(record))
        .collect()
}

/// Every record, and what is missing.
pub fn read<S: Source>(source: &mut S, session: &Session) -> (Vec<Record>, Problems)
where
    S::Error: std::fmt::Debug,
{
    let mut records = Vec::new();
    let problems = for_each_record(source, session, |record| records.push(record)).unwrap();
    (records, session.problems().and(&problems))
}

/// The same of a whole file, where it is a session.
pub fn read_file(file: &[u8]) -> Option<(Vec<Record>, Problems)> {
    let mut source = file;
    let session = open(&mut source).unwrap().ok()?;
    Some(read(&mut source, &session))
}

/// What passed on the line.
pub fn lines(records: &[Record]) -> Vec<LineEvent> {
    records.iter().filter_map(Record::line).collect()
}

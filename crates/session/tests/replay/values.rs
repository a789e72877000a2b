//! The telemetry of a session file, and its CSV, against what the virtual motor did and what the bus read.

use motorlink_bus::{LineEventKind, Sample};
use motorlink_protocol::{
    Fault, Frame, Mode, OpenLoopTarget, Setpoint,
    family::{Model, Reading},
};
use motorlink_session::{Record, Table, What, for_each_record, open};
use motorlink_simulator::WorldConfig;
use nojson::RawJson;

use super::live::{Live, amps, degrees, id, ms, rpm};

/// A message of `/motors/1/telemetry`.
struct Message(String);

impl Message {
    fn text(&self, name: &str) -> Option<String> {
        let json = RawJson::parse(&self.0).unwrap();
        let member = json.value().to_member(name).unwrap().optional();
        member.map(|member| member.as_raw_str().to_owned())
    }

    fn number(&self, name: &str) -> Option<f64> {
        self.text(name).map(|number| number.parse().unwrap())
    }
}

fn telemetry(file: &[u8]) -> Vec<Message> {
    let messages = mcap::MessageStream::new(file).unwrap().map(Result::unwrap);
    let messages = messages.filter(|message| message.channel.topic == "/motors/1/telemetry");
    let texts = messages.map(|message| String::from_utf8(message.data.to_vec()).unwrap());
    texts.map(Message).collect()
}

fn records(mut file: &[u8]) -> Vec<Record> {
    let session = open(&mut file).unwrap().unwrap();
    let mut records = Vec::new();
    let problems = for_each_record(&mut file, &session, |record| records.push(record)).unwrap();
    assert!(problems.is_empty(), "{problems}");
    records
}

/// The frames of motor 1 that say something of its wheel.
fn replies(model: Model, records: &[Record]) -> Vec<Frame> {
    let frames = records.iter().filter_map(|record| match record.what {
        What::Line(LineEventKind::Received { frame, .. }) => Some(frame),
        _ => None,
    });
    let says_something = |frame: &Frame| {
        let reading = Reading::decode(model, frame, None).unwrap();
        reading.id() == id(1) && !matches!(reading, Reading::Mode(_))
    };
    frames.filter(says_something).collect()
}

/// The rows of a table for motor 1, with the names of its columns.
fn rows(mut table: Table, records: &[Record]) -> Vec<Vec<(String, String)>> {
    let mut csv = Vec::new();
    table.head(&mut csv);
    for record in records {
        table.record(&mut csv, record);
    }
    let mut reader = csv::Reader::from_reader(&csv[..]);
    let names = reader.headers().unwrap().clone();
    let rows = reader.records().map(|row| {
        let row = row.unwrap();
        let cells = names.iter().zip(&row);
        let cells = cells.map(|(name, cell)| (name.to_owned(), cell.to_owned()));
        cells.collect()
    });
    rows.collect()
}

fn cell<'a>(row: &'a [(String, String)], name: &str) -> &'a str {
    let (_, cell) = row.iter().find(|(column, _)| column == name).unwrap();
    cell
}

fn setpoint(mode: Mode) -> (Setpoint, f64) {
    match mode {
        Mode::OpenLoop => {
            let share = OpenLoopTarget::new(-8_000).unwrap();
            (Setpoint::OpenLoop(share), -8_000.0)
        }
        Mode::Current => (amps(0.4), 0.4),
        Mode::Velocity => (rpm(-50), -50.0),
        Mode::Position => (degrees(90.0), 90.0),
    }
}

const fn name(mode: Mode) -> &'static str {
    match mode {
        Mode::OpenLoop => "\"open_loop\"",
        Mode::Current => "\"current\"",
        Mode::Velocity => "\"velocity\"",
        Mode::Position => "\"position\"",
    }
}

/// The line with motor 1 alone, driven in this loop.
fn driven(model: Model, mode: Mode) -> Live {
    let mut live = Live::of(model);
    if mode != Mode::Velocity {
        live.switch(1, mode);
        live.run(ms(700));
    }
    live.drive(1, setpoint(mode).0);
    // Without a speed loop a free wheel soon reaches the speed limit.
    let free = matches!(mode, Mode::OpenLoop | Mode::Current);
    live.run(ms(if free { 100 } else { 400 }));
    live
}

#[test]
fn telemetry_says_what_each_model_reported_in_each_of_its_loops() {
    for model in Model::ALL {
        for mode in model.modes().iter().copied() {
            let live = driven(model, mode);
            let (file, samples) = live.end_with_samples();
            let of_motor = |sample: &&Sample| sample.reply.id == id(1);
            let samples: Vec<Sample> = samples.iter().filter(of_motor).copied().collect();
            let messages = telemetry(&file);
            assert_eq!(messages.len(), samples.len(), "{model} {mode}");
            for (message, sample) in messages.iter().zip(&samples) {
                let what = format!("{model} {mode}: {} of {sample:?}", message.0);
                let speed = sample.reply.speed.map(|speed| f64::from(speed.rpm()));
                assert_eq!(message.number("speed_rpm"), speed, "{what}");
                assert_eq!(
                    message.text("mode").unwrap(),
                    name(sample.reply.mode),
                    "{what}"
                );
                assert_eq!(
                    message.number("fault_code"),
                    Some(f64::from(sample.reply.faults.byte())),
                    "{what}"
                );
                // An angle is not repeated with a new time.
                let (turns, angle) = (message.number("turns"), message.number("position_deg"));
                assert_eq!(turns.is_some(), angle.is_some(), "{what}");
                // The reported number is there where its amps are uncertain.
                let amps = sample
                    .reply
                    .current
                    .map(|current| f64::from(current.amps()));
                let is_certain = model.spec().current.is_certain();
                let uncertain = amps.filter(|_| !is_certain);
                let raw = message.number("current_raw");
                assert_eq!(raw.is_some(), uncertain.is_some(), "{what}");
                let known = amps.filter(|_| is_certain);
                let current = message.number("current_a");
                assert_eq!(current.is_some(), known.is_some(), "{what}");
                if let (Some(current), Some(amps)) = (current, known) {
                    // The bus has steps of 0.244 mA.
                    assert!((current - amps).abs() <= 0.000_625, "{what}");
                }
            }
            let drives: Vec<_> = messages
                .iter()
                .filter(|message| message.text("mode").as_deref() == Some(name(mode)))
                .filter(|message| message.number("setpoint").is_some())
                .collect();
            assert!(drives.len() > 3, "{model} {mode}: {}", drives.len());
            let (_, told) = setpoint(mode);
            let last = drives.last().unwrap().number("setpoint").unwrap();
            assert!((last - told).abs() < 0.01, "{model} {mode}: {last}");
        }
    }
}

#[test]
fn csv_has_the_frames_of_the_wire_and_the_units_of_a_person() {
    for model in Model::ALL {
        for mode in model.modes().iter().copied() {
            let live = driven(model, mode);
            let (file, _) = live.end_with_samples();
            let records = records(&file);
            let frames = replies(model, &records);
            let (mut source, of_motor) = (&file[..], |row: &Vec<_>| cell(row, "motor_id") == "1");
            let mut article = rows(Table::of_telemetry(), &records);
            article.retain(of_motor);
            // Before a motor has named its loop, its replies say nothing.
            let named = frames.len() - article.len();
            assert!(named < 30, "{model} {mode}: {named}");
            for (frame, row) in frames.iter().skip(named).zip(&article) {
                assert_eq!(cell(row, "raw_hex"), frame.to_string(), "{model} {mode}");
            }
            let session = open(&mut source).unwrap().unwrap();
            let (overview, _) = motorlink_session::overview(&mut source, &session).unwrap();
            let plot = rows(Table::of_plot(&overview), &records);
            let mut told = plot.iter().filter_map(|row| {
                let loop_of = cell(row, "motor_1_setpoint_mode").parse::<u8>().ok()?;
                let value = cell(row, "motor_1_unmirrored_setpoint");
                Some((loop_of, value.parse::<f64>().unwrap()))
            });
            let (loop_of, value) = told.next_back().unwrap();
            assert_eq!(loop_of, mode.byte(), "{model}");
            let expected = setpoint(mode).1;
            assert!((value - expected).abs() < 0.01, "{model} {mode}: {value}");
        }
    }
}

/// Turns of the wheel at 50 rpm backwards, for 40 s.
#[test]
fn turns_are_those_of_the_wheel() {
    for model in Model::ALL {
        let mut live = Live::of(model);
        let turns = |live: &Live| f64::from(live.world.motor(id(1)).unwrap().turns());
        let began = turns(&live);
        live.drive(1, rpm(-50));
        live.run(ms(40_000));
        let turned = turns(&live) - began;
        assert!(turned.abs() > 30.0, "{model}: {turned}");
        let (file, _) = live.end_with_samples();
        let reported: Vec<f64> = telemetry(&file)
            .iter()
            .filter_map(|message| message.number("turns"))
            .collect();
        let told = reported.last().unwrap() - reported.first().unwrap();
        // The wheel turns on until the file ends.
        assert!((told - turned).abs() < 0.1, "{model}: {told} of {turned}");
    }
}

/// Bit 1 is the overcurrent of the bus of a DDSM115, of the others any overcurrent.
#[test]
fn faults_have_the_names_of_their_model() {
    for (model, fault, name) in [
        (Model::Ddsm115, Fault::BusOvercurrent, "bus overcurrent"),
        (Model::Ddsm210, Fault::Overcurrent, "overcurrent"),
        (Model::Ddsm400, Fault::Overcurrent, "overcurrent"),
        (Model::Ddsm400, Fault::Voltage, "over- or undervoltage"),
    ] {
        let mut config = WorldConfig::of(model, [id(1), id(2)]);
        config.motors[0].fault = Some(fault);
        let mut live = Live::new(config);
        live.watch();
        live.run(ms(300));
        let (file, _) = live.end_with_samples();
        let messages = telemetry(&file);
        let faults = messages.last().unwrap().text("faults").unwrap();
        assert_eq!(faults, format!("[\"{name}\"]"), "{model}");
        let records = records(&file);
        let article = rows(Table::of_telemetry(), &records);
        let row = article.iter().find(|row| cell(row, "motor_id") == "1");
        assert_eq!(cell(row.unwrap(), "error_str"), name, "{model}");
        let said = records.iter().find_map(|record| match &record.what {
            What::Event(event) => Some(event.text.clone()),
            What::Line(_) | What::State(_) => None,
        });
        assert_eq!(said, Some(format!("Motor 1: {name}")));
    }
}

#[test]
fn two_hundred_replies_a_second_are_two_hundred_messages() {
    for model in [Model::Ddsm115, Model::Ddsm210] {
        let mut live = Live::new(WorldConfig::of(model, [id(1)]));
        let settings = motorlink_bus::BusSettings {
            rate: motorlink_bus::CommandRate::new(200).unwrap(),
            ..motorlink_bus::BusSettings::default()
        };
        let watch = motorlink_bus::Command::Watch(id(1));
        let configure = motorlink_bus::Command::Configure(settings);
        for command in [watch, configure] {
            live.command(command).unwrap();
        }
        live.run(ms(1_000));
        live.drive(1, rpm(40));
        live.run(ms(500));
        let from = live.now;
        live.run(ms(2_000));
        let until = live.now;
        let (file, _) = live.end_with_samples();
        let within = |message: &&Message| {
            let at = message.number("mono_us").unwrap();
            (micros(from)..micros(until)).contains(&at)
        };
        let messages = telemetry(&file);
        let messages = messages.iter().filter(within).count();
        assert!((395..=500).contains(&messages), "{model}: {messages}");
    }
}

#[allow(
    clippy::cast_precision_loss,
    reason = "a test lasts less than 2^53 microseconds"
)]
fn micros(at: motorlink_protocol::Instant) -> f64 {
    at.as_micros() as f64
}

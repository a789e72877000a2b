//! Another device than a motor sends text on the port.

use std::time::Duration;

use motorlink_bus::{Command, Event};
use motorlink_protocol::family::Model;
use motorlink_simulator::{WireFaults, WorldConfig};

use crate::fixture::{Fixture, ID, id, ms};

/// The log of an ESP32 that starts: as much as the line carries.
const BOOT: &[u8] = b"ets Jul 29 2019 12:21:46\r\n\r\nrst:0x1 (POWERON_RESET),boot:0x13 (SPI_FAST_FLASH_BOOT)\r\n\
    configsip: 0, SPIWP:0xee\r\nclk_drv:0x00,q_drv:0x00,d_drv:0x00,cs0_drv:0x00,hd_drv:0x00,wp_drv:0x00\r\n\
    mode:DIO, clock div:1\r\nload:0x3fff0030,len:1344\r\nentry 0x400805f0\r\n\
    \x1B[0;32mI (27) boot: ESP-IDF v5.1 2nd stage bootloader\x1B[0m\r\n";
const JSON: &[u8] =
    b"{\"T\":1005,\"id\":1,\"typ\":115,\"spd\":0,\"crt\":0,\"act\":0,\"tep\":0,\"err\":0}\r\n";

const MINUTES: u64 = 2;

/// A port without motors, on which the page asks for motor 1.
fn port(model: Model) -> Fixture {
    let mut fixture = Fixture::new(WorldConfig::of(model, []));
    fixture.command(Command::IdQuery).unwrap();
    fixture.command(Command::Watch(ID)).unwrap();
    fixture
}

/// Sends text for a time: so many bytes at a time, so far apart.
fn stream(fixture: &mut Fixture, text: &[u8], at_once: usize, apart: Duration, time: Duration) {
    let end = fixture.now + time;
    for piece in text.chunks(at_once).cycle() {
        if fixture.now >= end {
            return;
        }
        fixture.bus.receive(fixture.now, piece);
        fixture.run(apart);
    }
}

fn assert_named_and_left_alone(fixture: &Fixture, is_json: bool, context: &str) {
    let named = |event: &Event| matches!(event, Event::SendsText { .. });
    let named: Vec<&Event> = fixture
        .events
        .iter()
        .map(|(_, event)| event)
        .filter(|event| named(event))
        .collect();
    assert_eq!(named, [&Event::SendsText { is_json }], "{context}");
    let last = fixture.sent.last().unwrap().at;
    let asked = fixture.sent.len();
    assert!((3..40).contains(&asked), "{context}: {asked} requests");
    assert!(
        fixture.now.since(last) > ms(60_000 * MINUTES - 5_000),
        "{context}"
    );
    let is_motor = |event: &Event| {
        matches!(
            event,
            Event::Telemetry(_) | Event::MotorBack(_) | Event::OtherModel { .. }
        )
    };
    assert!(!fixture.happened(is_motor), "{context}");
    let logged = fixture
        .events
        .iter()
        .filter(|(_, event)| matches!(event, Event::Line(_)));
    let logged = u64::try_from(logged.count()).unwrap();
    assert!(
        logged <= 500 * 60 * MINUTES + 200,
        "{context}: {logged} log events"
    );
    let waiting = fixture.bus.line_status(fixture.now).unaddressed;
    assert!(waiting.text_bytes > 1_000, "{context}");
}

#[test]
fn a_boot_log_is_named_and_left_alone() {
    for model in [Model::Ddsm115, Model::Ddsm210] {
        let mut fixture = port(model);
        // 115200 baud carry 11.5 bytes in a millisecond.
        stream(&mut fixture, BOOT, 23, ms(2), ms(60_000 * MINUTES));
        assert_named_and_left_alone(&fixture, false, "boot log");
    }
}

#[test]
fn json_is_named_and_left_alone() {
    for model in [Model::Ddsm115, Model::Ddsm210] {
        let mut fixture = port(model);
        stream(&mut fixture, JSON, 4_096, ms(50), ms(60_000 * MINUTES));
        assert_named_and_left_alone(&fixture, true, "JSON");
    }
}

/// A controller that has written its log becomes a bridge to the motors.
#[test]
fn a_motor_behind_a_device_that_falls_silent_is_found() {
    let mut fixture = Fixture::new(WorldConfig::default());
    fixture.world.motor_mut(ID).unwrap().power(false);
    fixture.command(Command::Watch(ID)).unwrap();
    stream(&mut fixture, BOOT, 23, ms(2), ms(10_000));
    fixture.world.motor_mut(ID).unwrap().power(true);
    fixture.run(ms(6_500));
    assert!(fixture.status(ID).last.is_some());
    assert!(!fixture.bus.hears_text(fixture.now));
}

/// Also where it answers at the same time as a device sends.
#[test]
fn a_motor_that_has_answered_is_asked_on() {
    let mut fixture = Fixture::watching(WorldConfig::with_ids([ID, id(2)]), &[ID]);
    fixture.world.motor_mut(ID).unwrap().power(false);
    stream(&mut fixture, JSON, 4_096, ms(50), ms(10_000));
    fixture.forget_the_past();
    stream(&mut fixture, JSON, 4_096, ms(50), ms(5_000));
    assert!(fixture.sent.len() >= 4, "{}", fixture.sent.len());
}

/// A byte 00 every 2 to 19 ms for ten minutes.
#[test]
fn a_floating_pair_makes_no_motor_and_a_bounded_log() {
    for model in Model::ALL {
        let mut config = WorldConfig::of(model, []);
        config.faults = WireFaults {
            floating: true,
            ..WireFaults::default()
        };
        let mut fixture = Fixture::new(config);
        for command in [Command::IdQuery, Command::Watch(ID)] {
            fixture.command(command).unwrap();
        }
        fixture.run(ms(600_000));
        let is_motor = |event: &Event| {
            matches!(
                event,
                Event::Telemetry(_)
                    | Event::MotorBack(_)
                    | Event::OtherModel { .. }
                    | Event::SendsText { .. }
            )
        };
        assert!(!fixture.happened(is_motor), "{model}");
        assert!(fixture.status(ID).is_silent(), "{model}");
        let line = fixture.bus.line_status(fixture.now).unaddressed;
        let own = fixture.status(ID).counters;
        let levels = line.level_bytes + own.level_bytes;
        assert!(levels > 40_000, "{model}: {levels}");
        assert_eq!(line.junk_bytes + own.junk_bytes, levels, "{model}");
        // Ten bytes at a time, and one request a second.
        assert!(fixture.sent.len() < 700, "{model}: {}", fixture.sent.len());
        assert!(
            fixture.events.len() < 20_000,
            "{model}: {}",
            fixture.events.len()
        );
    }
}

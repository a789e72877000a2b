//! Lines with bytes that are no replies, or with replies that come late or in blocks, and their diagnosis.

use motorlink_simulator::{Beside, WireFaults, World, WorldConfig};

use super::*;
use crate::{
    doctor::Diagnosis,
    recorded_bus::{ID, RecordedBus},
};

/// A line of one motor, or none, with these faults from the start.
fn hostile(motors: WorldConfig, faults: WireFaults) -> Verdict {
    let mut bus = RecordedBus::on(World::new(WorldConfig { faults, ..motors }));
    bus.run(20).clone()
}

#[test]
fn a_floating_pair_and_a_byte_beside_each_reply_are_named() {
    let floating = WireFaults {
        floating: true,
        ..WireFaults::default()
    };
    let verdict = hostile(WorldConfig::with_ids([]), floating);
    assert_eq!(verdict, Verdict::Faulty(vec![Diagnosis::Floating]));
    for byte in [0, 0xFF] {
        for beside in [Beside::Before(byte), Beside::After(byte)] {
            let faults = WireFaults {
                beside: Some(beside),
                ..WireFaults::default()
            };
            let verdict = hostile(WorldConfig::default(), faults);
            let expected = Verdict::Faulty(vec![Diagnosis::Turnaround]);
            assert_eq!(verdict, expected, "{beside:?}");
        }
    }
}

/// For ten minutes.
#[test]
fn a_floating_pair_stays_the_cause() {
    let faults = WireFaults {
        floating: true,
        ..WireFaults::default()
    };
    let mut bus = RecordedBus::on(World::new(WorldConfig {
        faults,
        ..WorldConfig::with_ids([])
    }));
    let floats = Verdict::Faulty(vec![Diagnosis::Floating]);
    for minute in 0..10 {
        assert_eq!(*bus.run(60), floats, "minute {minute}");
    }
}

#[test]
fn a_device_that_sends_text_is_named() {
    for text in [
        &b"rst:0x1 (POWERON_RESET),boot:0x13 (SPI_FAST_FLASH_BOOT)\r\n"[..],
        b"{\"T\":1005,\"id\":1,\"typ\":115}\r\n",
    ] {
        let mut bus = RecordedBus::on(World::new(WorldConfig::with_ids([])));
        for tick in 0..600 {
            bus.bus.receive(bus.now, text);
            bus.run_to(bus.now + Duration::from_millis(50));
            bus.look();
            if tick > 40 {
                let named = Verdict::Faulty(vec![Diagnosis::Text]);
                assert_eq!(*bus.record.verdict(), named, "after {tick} texts");
            }
        }
    }
}

#[test]
fn an_adapter_that_delivers_blocks_is_named() {
    let faults = WireFaults {
        block: 32,
        ..WireFaults::default()
    };
    let verdict = hostile(WorldConfig::default(), faults);
    assert_eq!(verdict, Verdict::Faulty(vec![Diagnosis::Blocks]));
}

/// A late reply is not lost, and what a late computer loses is not the wire's.
#[test]
fn late_replies_name_no_wire() {
    let late = Tally {
        asked: 100,
        answered: 80,
        silent: 20,
        late: 18,
        ..Tally::default()
    };
    let motor = MotorFindings {
        id: ID,
        recent: late,
        heard: late,
        quiet: Tally::default(),
        silent: false,
        loss_per_mille: Some(20),
        standing: late,
        turning: Tally::default(),
    };
    let findings = |tally: Tally, computer_is_late| Findings {
        motors: vec![MotorFindings {
            recent: tally,
            heard: tally,
            ..motor
        }],
        computer_is_late,
        ..Findings::default()
    };
    assert_eq!(diagnose(&findings(late, false)), Verdict::SomeLoss);
    let lost = Tally { late: 0, ..late };
    assert_eq!(diagnose(&findings(lost, true)), Verdict::SomeLoss);
    let named = Verdict::Faulty(vec![Diagnosis::Lost]);
    assert_eq!(diagnose(&findings(lost, false)), named);
}

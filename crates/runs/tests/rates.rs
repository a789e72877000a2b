//! The rate that the page says at Arm is the one that the line carries in the run.
#![cfg(test)]

mod bench;

use std::time::Duration;

use bench::{Bench, id, ms};
use motorlink_bus::{CarriedRate, CommandRate};
use motorlink_experiments::runner::Options;
use motorlink_protocol::{
    Mode,
    family::{Model, Request},
};
use motorlink_simulator::{WireFaults, WorldConfig};

/// How long the rate is counted, in seconds.
const COUNTED_S: u8 = 4;

/// What is said before the run, and the drive frames per second and motor in it.
fn said_and_achieved(mut bench: Bench, motors: u8, hertz: u16) -> (CarriedRate, f64) {
    let model = bench.bus.as_ref().unwrap().model();
    let options = Options {
        period: Duration::from_secs(1) / u32::from(hertz),
        ..Options::default()
    };
    bench.arm(r#"{ "rpm": 30, "for_s": 6 }"#, options);
    bench.run(ms(300));
    let status: Vec<_> = bench.bus.as_ref().unwrap().motors(bench.now).collect();
    let driven: Vec<_> = (1..=motors).map(|it| (id(it), Mode::Velocity)).collect();
    let rate = CommandRate::new(hertz).unwrap();
    let said = CarriedRate::of(model, &status, &driven, rate).unwrap();
    bench.start();
    bench.run(ms(1_000));
    let from = bench.now;
    bench.run(Duration::from_secs(COUNTED_S.into()));
    let counted = bench.wire.iter().filter(|(at, frame)| {
        let request = Request::parse(model, frame);
        *at >= from && matches!(request, Ok(Request::Drive { .. }))
    });
    let counted = u32::try_from(counted.count()).unwrap();
    let achieved = f64::from(counted) / f64::from(COUNTED_S) / f64::from(motors);
    (said, achieved)
}

#[test]
fn the_rate_said_before_a_run_is_achieved_within_a_tenth() {
    let mut worst = 0.0_f64;
    for model in [Model::Ddsm115, Model::Ddsm210, Model::Ddsm400] {
        for motors in [1, 2, 4, 16] {
            for hertz in [50, 200, 500] {
                let bench = Bench::new(model, motors);
                let (said, achieved) = said_and_achieved(bench, motors, hertz);
                let off = said.hertz / achieved - 1.0;
                worst = worst.max(off.abs());
                let of = format!("{motors} {model} at {hertz} Hz");
                println!("{of}: said {:.1}, achieved {achieved:.1}", said.hertz);
                assert!(off.abs() < 0.1, "{of}: {said:?}, achieved {achieved}");
            }
        }
    }
    println!("off by {:.1} % at most", worst * 100.0);
}

/// An adapter that holds bytes for 16 ms, as FTDI's do, is part of the measured round trip.
#[test]
fn the_latency_of_the_adapter_counts() {
    let faults = WireFaults {
        hold: ms(16),
        ..WireFaults::default()
    };
    let config = WorldConfig {
        faults,
        ..WorldConfig::of(Model::Ddsm210, [1, 2].map(id))
    };
    let (said, achieved) = said_and_achieved(Bench::of(config), 2, 200);
    assert!(achieved < 60.0, "a slow adapter: {achieved}");
    assert!(
        (said.hertz / achieved - 1.0).abs() < 0.1,
        "{said:?}, achieved {achieved}"
    );
}

/// Two motors with the ID of their loop's byte answer at two speeds, by their current.
#[test]
fn a_rate_that_depends_on_the_current_is_said_as_about() {
    let (said, _) = said_and_achieved(Bench::new(Model::Ddsm115, 2), 2, 200);
    assert!(said.is_about);
    let (said, _) = said_and_achieved(Bench::new(Model::Ddsm210, 2), 2, 500);
    assert!(!said.is_about);
}

//! Limits that a person sets: received to the worker at once and at its start, and refused where typed.

use motorlink::Preferences;
use motorlink_messages::{
    Notice, ToPage,
    bus::{BusSettings, Command, ExceededLimit, Limits, WithdrawReason},
    protocol::{Celsius, Mode, MotorId, Setpoint, SpeedTarget},
};
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{Event, FocusEvent};

use crate::{
    bench::{Bench, performance, press},
    tools::report,
};

pub fn leave(field: &web_sys::HtmlInputElement) {
    let blur: Event = FocusEvent::new("blur").unwrap().into();
    field.dispatch_event(&blur).unwrap();
}

#[wasm_bindgen_test]
async fn a_worker_knows_the_limits_before_anything_drives_and_whenever_one_is_changed() {
    Preferences::default().save();
    let bench = Bench::new("limits-received").await;
    let time_origin_ms = performance().time_origin();
    bench.post(&ToPage::Hello { time_origin_ms });
    let first = Command::Configure(BusSettings {
        limits: Limits::default(),
        ..BusSettings::default()
    });
    assert_eq!(bench.commands().await, [first]);
    bench.open("Settings").await;
    for (name, text, limits) in [
        ("Speed limit", "120", [120, 2_700, 75]),
        ("Current limit", "1,5", [120, 1_500, 75]),
        ("Temperature limit", "60", [120, 1_500, 60]),
    ] {
        leave(&bench.enter(name, text));
        let limits = Limits::try_from(limits).unwrap();
        assert_eq!(
            bench.commands().await,
            [Command::Configure(BusSettings {
                limits,
                ..BusSettings::default()
            })]
        );
        assert_eq!(Preferences::load().limits, limits, "kept");
    }
    let field = bench.enter("Current limit", "9");
    leave(&field);
    assert_eq!(bench.commands().await, []);
    assert_eq!(field.get_attribute("aria-invalid").as_deref(), Some("true"));
    assert_eq!(field.value(), "9", "nothing that was typed is lost");
    Preferences::default().save();
}

#[wasm_bindgen_test]
async fn the_limit_that_was_crossed_is_told() {
    let bench = Bench::with_motor("limits-exceeded", Mode::Velocity).await;
    let exceeded = ExceededLimit::Temperature {
        reached: Celsius::new(76),
        limit: 75,
    };
    report(&bench, |update| {
        update.notices = vec![Notice::Withdrawn {
            id: MotorId::FIRST,
            reason: WithdrawReason::Limit(exceeded),
        }];
    });
    let received = || bench.text("region", "Notices");
    bench
        .until("the limit", || {
            received().contains("76 °C, above your limit of 75 °C")
        })
        .await;
}

#[wasm_bindgen_test]
async fn a_key_for_a_speed_above_the_limit_drives_nothing_and_keeps_the_target() {
    let limits = Limits::try_from([120, 2_700, 75]).unwrap();
    let chosen = Preferences {
        limits,
        ..Preferences::default()
    };
    chosen.save();
    let bench = Bench::with_motor("limits-key", Mode::Velocity).await;
    bench.commands().await;
    let target = || {
        bench
            .find("spinbutton", "Target speed")
            .get_attribute("aria-valuenow")
    };
    let before = target();
    press("3");
    assert_eq!(bench.commands().await, []);
    assert_eq!(target(), before);
    press("2");
    let speed = SpeedTarget::new(100).unwrap();
    let driven = bench.commands().await;
    assert!(
        matches!(driven.as_slice(), [Command::Start { setpoint: Setpoint::Velocity { speed: driven, .. }, .. }] if *driven == speed),
        "{driven:?}"
    );
    Preferences::default().save();
}

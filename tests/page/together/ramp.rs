//! The ramp of the group's speed.

use motorlink_messages::{
    Adapter, Connection,
    bus::{BusSettings, Command, Ramp},
};
use wasm_bindgen_test::wasm_bindgen_test;

use super::{rover, storage};
use crate::{
    bench::press,
    tools::{report, standing},
};

/// The worker keeps the ramp of the last connection.
#[wasm_bindgen_test]
async fn a_ramp_set_to_0_while_disconnected_stays_0_on_connect() {
    let bench = rover("ramp-apart").await;
    bench.enter("Ramp", "200").focus().unwrap();
    press("Enter");
    let connection = |connection| {
        report(&bench, |update| {
            update.motors = vec![standing(1), standing(2)];
            update.connection = connection;
        });
    };
    let connected = Connection::Connected(Adapter::VIRTUAL);
    connection(Connection::Disconnected);
    bench.commands().await;
    bench.enter("Ramp", "0").focus().unwrap();
    press("Enter");
    connection(connected);
    let commands = bench.commands().await;
    assert!(
        commands.contains(&Command::Configure(BusSettings {
            ramp: None,
            ..BusSettings::default()
        })),
        "{commands:?}"
    );
    storage().remove_item("motorlink.ramp").unwrap();
}

#[wasm_bindgen_test]
async fn a_ramp_is_sent_when_it_is_entered() {
    let bench = rover("ramp").await;
    for (text, ramp) in [("200", Ramp::new(200).ok()), ("0", None)] {
        bench.enter("Ramp", text).focus().unwrap();
        press("Enter");
        assert_eq!(
            bench.commands().await,
            [Command::Configure(BusSettings {
                ramp,
                ..BusSettings::default()
            })]
        );
    }
    storage().remove_item("motorlink.ramp").unwrap();
}

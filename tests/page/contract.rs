//! Every control and read-out is found by its role and name, worker or not.

use motorlink_messages::protocol::Mode;
use wasm_bindgen_test::wasm_bindgen_test;

use crate::bench::Bench;

/// What is there in the place Drive, whichever tab is open.
const ALWAYS: [(&str, &str); 42] = [
    ("button", "Connect motor"),
    ("button", "Other port"),
    ("button", "Virtual motor"),
    ("button", "Virtual motors"),
    ("status", "Connection"),
    ("combobox", "Motor"),
    ("combobox", "Model"),
    ("status", "Link"),
    ("button", "STOP all motors"),
    ("spinbutton", "Command rate"),
    ("button", "Theme"),
    ("button", "Help"),
    ("tablist", "Control"),
    ("tab", "Velocity"),
    ("tab", "Current"),
    ("tab", "Position"),
    ("region", "Telemetry"),
    ("status", "Speed"),
    ("status", "Current"),
    ("status", "Position"),
    ("status", "Temperature"),
    ("status", "Faults"),
    ("status", "Mode"),
    ("status", "Motion"),
    ("region", "Notices"),
    ("region", "Packet log"),
    ("log", "Packets"),
    ("checkbox", "Collapse status polls"),
    ("checkbox", "Auto-scroll"),
    ("searchbox", "Filter"),
    ("combobox", "Log ID"),
    ("combobox", "Log direction"),
    ("button", "Clear"),
    ("button", "Export CSV"),
    ("status", "Entries"),
    ("navigation", "Places"),
    ("button", "Drive"),
    ("button", "Record"),
    ("button", "Test"),
    ("button", "Setup"),
    ("button", "Diagnose"),
    ("button", "Link"),
];

const VELOCITY: &[(&str, &str)] = &[
    ("slider", "Target speed"),
    ("spinbutton", "Target speed"),
    ("spinbutton", "Acceleration"),
    ("button", "-100"),
    ("button", "-50"),
    ("button", "Stop"),
    ("button", "Start"),
    ("button", "Brake"),
    ("button", "+50"),
    ("button", "+100"),
];

const CURRENT: &[(&str, &str)] = &[
    ("slider", "Target current"),
    ("spinbutton", "Target current"),
    ("spinbutton", "Raw current"),
    ("status", "Target torque"),
    ("button", "-2 A"),
    ("button", "-1 A"),
    ("button", "-0.5 A"),
    ("button", "0 A"),
    ("button", "+0.5 A"),
    ("button", "+1 A"),
    ("button", "+2 A"),
    ("button", "Start"),
    ("button", "Stop"),
];

const POSITION: &[(&str, &str)] = &[
    ("slider", "Target angle"),
    ("spinbutton", "Raw position"),
    ("spinbutton", "Target angle"),
    ("button", "0°"),
    ("button", "90°"),
    ("button", "180°"),
    ("button", "270°"),
    ("button", "Go"),
    ("button", "Stop"),
];

const ID_MANAGER: &[(&str, &str)] = &[
    ("button", "Scan"),
    ("button", "Full scan"),
    ("button", "Cancel"),
    ("progressbar", "Scan"),
    ("list", "Motors found"),
    ("spinbutton", "New ID"),
    ("button", "Set ID"),
];

const SETTINGS: &[(&str, &str)] = &[
    ("spinbutton", "Speed limit"),
    ("spinbutton", "Ramp"),
    ("checkbox", "Keep driving while hidden"),
    ("checkbox", "Detect the model"),
    ("button", "Export setup"),
    ("button", "Import setup"),
    ("button", "Setup link"),
    ("button", "Delete all data"),
];

const LINK: &[(&str, &str)] = &[
    ("region", "Link health"),
    ("list", "Link diagnosis"),
    ("status", "Based on"),
    ("combobox", "Simulated fault"),
];

const RECORDING: &[(&str, &str)] = &[
    ("button", "Record telemetry"),
    ("button", "Export telemetry CSV"),
    ("button", "Plot CSV"),
    ("status", "Recorded"),
];

const SESSION: &[(&str, &str)] = &[("button", "Save session"), ("button", "Open recording")];

const EXPERIMENTS: &[(&str, &str)] = &[("tablist", "Experiments"), ("tab", "Sequence")];

const RAW_HEX: &[(&str, &str)] = &[
    ("textbox", "Frame bytes"),
    ("status", "Frame with CRC"),
    ("checkbox", "Repeat"),
    ("spinbutton", "Count"),
    ("spinbutton", "Interval"),
    ("button", "Send"),
    ("button", "Stop"),
];

#[wasm_bindgen_test]
async fn every_control_is_found_by_its_name() {
    let bench = Bench::new("contract").await;
    for (role, name) in ALWAYS {
        bench.find(role, name);
    }
    for (tab, controls) in [
        ("Velocity", VELOCITY),
        ("Current", CURRENT),
        ("Position", POSITION),
    ] {
        bench.find("tab", tab).click();
        bench
            .until(tab, || {
                let (role, name) = controls[0];
                bench.find_all(role, name).len() == 1
            })
            .await;
        for (role, name) in controls {
            bench.find(role, name);
        }
    }
    for (panel, controls) in [
        ("Experiments", EXPERIMENTS),
        ("Recording", RECORDING),
        ("Session file", SESSION),
        ("ID Manager", ID_MANAGER),
        ("Settings", SETTINGS),
        ("Link health", LINK),
        ("Raw Hex", RAW_HEX),
    ] {
        bench.open(panel).await;
        for (role, name) in controls {
            // Without a style sheet the controls of Drive are there too.
            let is_there = || !bench.find_all(role, name).is_empty();
            bench.until(name, is_there).await;
        }
    }
    // The list of runs is read meanwhile.
    bench.received().await;
}

#[wasm_bindgen_test]
async fn unknown_is_a_dash_and_never_zero() {
    let bench = Bench::new("unknown").await;
    for name in [
        "Speed",
        "Current",
        "Position",
        "Temperature",
        "Faults",
        "Mode",
    ] {
        assert_eq!(bench.text("status", name), "–", "{name}");
    }
    assert_eq!(bench.text("status", "Link"), "– Hz – ms – % lost");
}

#[wasm_bindgen_test]
async fn a_control_that_does_not_apply_says_why() {
    let bench = Bench::new("why-not").await;
    let start = bench.find("button", "Start");
    assert!(start.has_attribute("disabled"));
    assert!(start.title().contains("Not connected"), "{}", start.title());
    let stop = bench.find("button", "STOP all motors");
    assert!(!stop.has_attribute("disabled"));
}

#[wasm_bindgen_test]
async fn the_tab_follows_the_loop_of_the_motor() {
    let bench = Bench::with_motor("follow", Mode::Position).await;
    let tab = bench.find("tab", "Position");
    assert_eq!(tab.get_attribute("aria-selected").unwrap(), "true");
    assert_eq!(bench.text("status", "Mode"), "Position loop");
    assert_eq!(bench.text("status", "Speed"), "0 rpm");
}

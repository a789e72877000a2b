//! What the browser remembers.

use motorlink::{Preferences, Theme};
use motorlink_messages::{
    UsbId, VirtualLine, VirtualMotors,
    bus::{CommandRate, Limits},
    protocol::{MotorId, family::Model},
};
use wasm_bindgen_test::wasm_bindgen_test;

use crate::bench::{Bench, document};

#[wasm_bindgen_test]
async fn what_is_saved_is_there_after_a_reload() {
    let chosen = Preferences {
        motor: MotorId::new(7).unwrap(),
        model: Model::Ddsm400,
        detect_model: false,
        adapter: Some(UsbId {
            vendor: 0x1A86,
            product: 0x7523,
        }),
        virtual_line: VirtualLine {
            motors: VirtualMotors::Faults,
            model: Model::Ddsm210,
        },
        rate: CommandRate::new(200).unwrap(),
        limits: Limits::new(120, 1_500, 60).unwrap(),
        theme: Theme::Dark,
        keep_driving: false,
        collapse_polls: false,
    };
    chosen.save();
    assert_eq!(Preferences::load(), chosen);

    let bench = Bench::new("remembering").await;
    let theme = || {
        let root = document().document_element().unwrap();
        root.get_attribute("data-theme")
    };
    bench
        .until("the dark page", || theme().as_deref() == Some("dark"))
        .await;
    bench.click("Theme");
    bench
        .until("high contrast", || theme().as_deref() == Some("contrast"))
        .await;
    // The browser of the tests has a light system.
    bench.click("Theme");
    bench
        .until("the light page", || theme().as_deref() == Some("light"))
        .await;
    bench.click("Theme");
    bench
        .until("the system's colours", || theme().is_none())
        .await;
    assert_eq!(Preferences::load().theme, Theme::System);
    Preferences::default().save();
}

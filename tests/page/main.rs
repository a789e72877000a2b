//! The page in a browser, with a worker that only writes down what it is received.
#![cfg(test)]
#![cfg(target_arch = "wasm32")]

mod bench;
mod contract;
mod dock;
mod experiments;
mod fake_recorder;
mod fake_sessions;
mod first_screen;
mod graph;
mod help;
mod id_wizard;
mod instruments;
mod keyboard;
mod language;
mod limits;
mod link;
mod log;
mod log_bench;
mod log_list;
mod model;
mod names;
mod operating;
mod places;
mod raw_hex;
mod remembering;
mod replay;
mod saved_session;
mod session_file;
mod setup;
mod setup_sharing;
mod together;
mod tools;
mod truth;
mod turning_unasked;
mod virtual_motors;

wasm_bindgen_test::wasm_bindgen_test_configure!(run_in_browser);

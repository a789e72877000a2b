//! Values that no motor has said, per exchange, on lines whose adapters echo at random, deliver blocks or add bytes.
//!
//! `cargo run --release -p motorlink-bus --example hostile_lines -- 1000000` plays so many exchanges of each model on
//! each line, in virtual time. The environment variable `SHOW` prints each wrong value.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::cast_precision_loss,
    clippy::missing_panics_doc,
    unused_imports,
    reason = "a measurement that cannot go on ends"
)]

#[path = "../tests/fixture/mod.rs"]
mod fixture;

use fixture::hostile_line::{lines, run};
use motorlink_protocol::family::Model;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let exchanges: u64 = arguments.next().map_or(100_000, |count| {
        count.parse().expect("a number of exchanges")
    });
    let only = arguments.next();
    println!("| line | model | exchanges | values | wrong | false halts | withdrawn | accepted |");
    println!("|---|---|---|---|---|---|---|---|");
    for (name, faults) in lines() {
        if only
            .as_ref()
            .is_some_and(|only| !name.contains(only.as_str()))
        {
            continue;
        }
        for model in Model::ALL {
            let found = run(model, &faults, 1, exchanges);
            println!(
                "| {name} | {model} | {} | {} | {} | {} | {} | {} |",
                found.exchanges,
                found.read,
                found.wrong,
                found.other_model,
                found.withdrawn,
                found.accepted
            );
        }
    }
}

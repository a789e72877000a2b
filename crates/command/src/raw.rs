//! `motorlink raw`: ten bytes as they are.

use std::time::Duration;

use motorlink_bus::{Command, Consent, RawAnswer, Repeat, is_hazardous};
use motorlink_driver::{Ender, Entry};
use motorlink_protocol::{Frame, explain_received, explain_sent};

use crate::{
    arguments::Global,
    confirm::confirm,
    connection::{Connection, Happened},
    failure::Failure,
};

/// How long to wait until the reply window of the frame has ended.
const ANSWER_MAX: Duration = Duration::from_secs(2);

/// Sends the frame once, and prints the answer. What it has moved is stopped.
pub fn run(global: &Global, frame: Frame, yes: bool, ender: &Ender) -> Result<(), Failure> {
    if is_hazardous(&frame) && !yes {
        eprintln!("{frame} is: {}", explain_sent(&frame, None));
        eprintln!(
            "It may move a wheel or change a motor. A motor that it moves is stopped when this program ends."
        );
        confirm("Send it?")?;
    }
    let connection = Connection::open(global, ender)?;
    connection.wait_for(Duration::from_millis(300), |status| {
        status
            .line
            .is_some_and(|line| line.model_known)
            .then_some(())
    })?;
    let repeat = Repeat::Once;
    let consent = Consent::HighCurrent;
    connection.driver.command(Command::SendRaw {
        frame,
        repeat,
        consent,
    });
    println!("TX: {frame}");
    let until = std::time::Instant::now() + ANSWER_MAX;
    let answer = loop {
        if let Happened::Entry(_, Entry::Refused { refusal, .. }) = connection.next()? {
            return Err(Failure::NotDone(format!("not sent: {refusal}")));
        }
        let raw = connection.status()?.raw;
        let answer = raw.filter(|raw| !raw.running).and_then(|raw| raw.last);
        if answer.is_some() || std::time::Instant::now() >= until {
            break answer;
        }
    };
    match answer {
        Some(RawAnswer::Reply {
            frame,
            asked,
            after_us,
        }) => {
            println!("RX: {frame}");
            let after = f64::from(after_us) / 1000.0;
            println!(
                "    {} (after {after:.2} ms)",
                explain_received(&frame, asked)
            );
        }
        Some(RawAnswer::Garbled) => println!("RX: (bytes that are no frame)"),
        Some(RawAnswer::NoneExpected) => println!("RX: (this frame has no answer)"),
        Some(RawAnswer::NotSent) => println!("RX: (the port did not take the frame)"),
        Some(RawAnswer::Silence { .. }) | None => println!("RX: (no response)"),
    }
    connection.driver.command(Command::StopRaw);
    connection.end()
}

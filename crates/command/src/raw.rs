//! `motorlink raw`: ten bytes as they are.

use std::time::{Duration, Instant};

use motorlink_bus::{Command, Consent, RawAnswer, Repeat, is_hazardous};
use motorlink_driver::Ender;
use motorlink_i18n::{family_terms, load_later_texts};
use motorlink_protocol::Frame;

use crate::{
    arguments::Global,
    confirm::confirm,
    connection::{Connection, Happened, is_not_done, on_line},
    failure::Failure,
    output::{print, say},
};

/// How long to wait until the reply window of the frame has ended.
const ANSWER_MAX: Duration = Duration::from_secs(2);
/// How long to wait for a reply that shows the model. A raw frame needs none.
const MODEL_MAX: Duration = Duration::from_millis(300);

/// Sends the frame once, and prints the answer. What it has moved is stopped.
pub fn run(global: &Global, frame: Frame, yes: bool, ender: &Ender) -> Result<(), Failure> {
    // It uses those texts.
    load_later_texts();
    if is_hazardous(&frame) && !yes {
        let model = global.model.unwrap_or_default();
        let meaning = family_terms::sent(model, &frame, None);
        say(format_args!("{frame}, for a {model}: {meaning}"));
        say(format_args!(
            "It may move a wheel or change a motor. A motor that it moves is stopped when this program ends."
        ));
        confirm(ender, "Send it?")?;
    }
    on_line(global, ender, |_| (), |connection| send(connection, frame))
}

fn send(connection: &Connection, frame: Frame) -> Result<(), Failure> {
    connection.wait_for(MODEL_MAX, |status| {
        let line = status.line;
        line.is_some_and(|line| line.model_known).then_some(())
    })?;
    let repeat = Repeat::Once;
    let consent = Consent::HighCurrent;
    connection.driver.command(Command::SendRaw {
        frame,
        repeat,
        consent,
    });
    let until = Instant::now() + ANSWER_MAX;
    let answer = loop {
        if let Happened::Entry(_, entry) = connection.next()?
            && is_not_done(&entry)
        {
            return Err(Failure::NotDone("the frame was not sent".to_owned()));
        }
        let raw = connection.status()?.raw;
        let answer = raw.filter(|raw| !raw.running).and_then(|raw| raw.last);
        if answer.is_some() || Instant::now() >= until {
            break answer;
        }
    };
    if answer == Some(RawAnswer::NotSent) {
        return Err(Failure::NotDone(
            "the port did not take the frame".to_owned(),
        ));
    }
    print(format_args!("TX: {frame}"))?;
    match answer {
        Some(RawAnswer::Reply {
            frame,
            asked,
            after_us,
        }) => {
            let after = f64::from(after_us) / 1000.0;
            print(format_args!("RX: {frame}"))?;
            let meaning = family_terms::received(connection.driver.model(), &frame, asked);
            print(format_args!("    {meaning} (after {after:.2} ms)"))?;
        }
        Some(RawAnswer::Garbled) => print("RX: (bytes that are no frame)")?,
        Some(RawAnswer::NoneExpected) => print("RX: (this frame has no answer)")?,
        Some(RawAnswer::NotSent | RawAnswer::Silence { .. }) | None => print("RX: (no response)")?,
    }
    connection.driver.command(Command::StopRaw);
    Ok(())
}

//! The text form, for a first look: `echo state | nc -U PATH`.

use std::{fmt::Write as _, time::Duration};

use motorlink_bus::{Activity, Command, StopReason};
use motorlink_controller_messages::Refusal;
use motorlink_protocol::{Faults, Instant};
use tokio::{
    io::{AsyncReadExt as _, AsyncWriteExt as _},
    net::unix::{OwnedReadHalf, OwnedWriteHalf},
    time::{sleep, timeout},
};

use super::{
    refusal::{PATIENCE, refuse},
    snapshot::{Motor, fresh},
};
use crate::viewers::Viewers;

/// The longest command, with spaces.
const COMMAND_MAX: usize = 32;
/// How often `watch` prints.
const WATCH_EVERY: Duration = Duration::from_millis(100);
/// How long a first state of the driver may take.
pub(super) const FIRST_STATE_MAX: Duration = Duration::from_secs(1);

const HELP: &str = "\
state   who has control, and one line for each motor
watch   the same, ten times a second
stop    stops all motors. A controller starts none before release
release lets controllers start motors again after a stop by a person
help    this text
The text form drives nothing. docs/socket.md has the messages that do.
";

/// Answers commands until the client goes.
pub(super) async fn serve(
    first: [u8; 1],
    mut read: OwnedReadHalf,
    mut write: OwnedWriteHalf,
    viewers: &Viewers,
) {
    let mut command = first.to_vec();
    loop {
        match read_line(&mut command, &mut read).await {
            Read::Ended if command.is_empty() => return,
            Read::Whole | Read::Ended => {}
            Read::TooLong => return complain(read, write, Refusal::Magic).await,
        }
        let text = match command.trim_ascii() {
            b"" => String::new(),
            b"state" => state(viewers).await,
            b"watch" => {
                while say(&mut write, &state(viewers).await).await {
                    sleep(WATCH_EVERY).await;
                }
                return;
            }
            b"stop" => stop(viewers).to_owned(),
            b"release" => {
                viewers.operate(|operation, _| operation.release());
                viewers.log("a client of the socket releases the motors".to_owned());
                "A controller may start the motors.\n".to_owned()
            }
            b"help" => HELP.to_owned(),
            _ => return complain(read, write, Refusal::Magic).await,
        };
        if !say(&mut write, &text).await {
            return;
        }
        command.clear();
    }
}

/// Answers a client when there are too many: a stop is taken all the same.
pub(super) async fn serve_stop_only(
    first: [u8; 1],
    mut read: OwnedReadHalf,
    mut write: OwnedWriteHalf,
    viewers: &Viewers,
) {
    let mut command = first.to_vec();
    let line = timeout(PATIENCE, read_line(&mut command, &mut read)).await;
    let is_whole = matches!(line, Ok(Read::Whole | Read::Ended));
    if is_whole && command.trim_ascii() == b"stop" {
        say(&mut write, stop(viewers)).await;
    } else {
        complain(read, write, Refusal::TooMany).await;
    }
}

/// Stops all motors. Returns the answer.
fn stop(viewers: &Viewers) -> &'static str {
    let stop = Command::StopAll(StopReason::Operator);
    viewers.operate(|operation, now| operation.stop(now, None, [stop]));
    viewers.log("a client of the socket stops all motors".to_owned());
    "All motors are being stopped. state shows whether they stand.\n"
}

/// How a line has ended.
enum Read {
    Whole,
    TooLong,
    /// The client sends nothing more, or has gone.
    Ended,
}

async fn read_line(command: &mut Vec<u8>, read: &mut OwnedReadHalf) -> Read {
    loop {
        match command.last() {
            Some(b'\n') => return Read::Whole,
            _ if command.len() > COMMAND_MAX => return Read::TooLong,
            _ => {}
        }
        let mut byte = [0];
        if read.read_exact(&mut byte).await.is_err() {
            return Read::Ended;
        }
        command.extend(byte);
    }
}

async fn say(write: &mut OwnedWriteHalf, text: &str) -> bool {
    let said = timeout(PATIENCE, write.write_all(text.as_bytes())).await;
    matches!(said, Ok(Ok(())))
}

/// Says why the connection is closed.
pub(super) async fn complain(read: OwnedReadHalf, write: OwnedWriteHalf, wrong: Refusal) {
    refuse(read, write, format!("error: {wrong}\n").as_bytes()).await;
}

async fn state(viewers: &Viewers) -> String {
    let mut snapshots = viewers.snapshot().subscribe();
    // The first client of all waits until the driver was asked.
    let known = snapshots.wait_for(|snapshot| snapshot.now().is_some());
    let _ = timeout(FIRST_STATE_MAX, known).await;
    let snapshot = snapshots.borrow().clone();
    let mut text = format!("control: {}", viewers.operator_name());
    if snapshot.is_halted {
        text.push_str(", all motors stopped");
    }
    if !snapshot.is_open {
        text.push_str(", no port");
    }
    if let Some(model) = snapshot.model {
        // Writing into a text cannot fail.
        let _ = write!(text, ", {model}");
    }
    text.push('\n');
    for motor in snapshot.motors.values() {
        push(&mut text, motor, snapshot.now());
    }
    text
}

fn push(text: &mut String, motor: &Motor, now: Option<Instant>) {
    let status = &motor.status;
    let activity = match status.activity {
        Activity::Idle if status.is_silent() => "silent",
        Activity::Idle => "idle",
        Activity::Driven { .. } => "driven",
        Activity::Stopping { .. } => "stopping",
        Activity::Switching { .. } => "switching",
        Activity::DrivenRaw => "raw",
    };
    let or_unknown = |value: Option<String>| value.unwrap_or_else(|| "?".to_owned());
    let (velocity, current) = (fresh(motor.velocity, now), fresh(motor.current, now));
    let age = now.zip(motor.replied);
    let age = age.map(|(now, at)| now.since(at).as_millis());
    let faults = motor.faults.map(Faults::byte);
    // Writing into a text cannot fail.
    let _ = writeln!(
        text,
        "motor {} {activity}{}: {} rad, {} rad/s, {} A, {} degC, faults {}, reply {} ms ago",
        status.id.get(),
        if status.may_turn && !matches!(status.activity, Activity::Driven { .. }) {
            ", not confirmed to stand"
        } else {
            ""
        },
        or_unknown(motor.position.map(|(_, rad)| format!("{rad:.3}"))),
        or_unknown(velocity.map(|(_, rad_per_s)| format!("{rad_per_s:.2}"))),
        or_unknown(current.map(|(_, amps)| format!("{amps:.2}"))),
        or_unknown(motor.temperature.map(|(_, celsius)| celsius.to_string())),
        or_unknown(faults.map(|value| format!("{value:#04x}"))),
        or_unknown(age.map(|value| value.to_string())),
    );
}

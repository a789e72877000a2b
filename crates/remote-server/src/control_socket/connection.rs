//! The connection of one client.

use std::{io, sync::Arc, time::Duration};

use motorlink_bus::Activity;
use motorlink_controller_messages::{
    self as messages, FROM_CLIENT, MAGIC, MOTORS_MAX, Refusal, check_hello, decode_from_client,
    encode_error, encode_state, server_hello,
};
use motorlink_protocol::{Faults, Instant};
use motorlink_remote::ViewerId;
use rustix::time::{ClockId, clock_gettime};
use tokio::{
    io::{AsyncReadExt as _, AsyncWriteExt as _},
    net::{
        UnixStream,
        unix::{OwnedReadHalf, OwnedWriteHalf},
    },
    sync::{oneshot, watch},
    time::{sleep, sleep_until, timeout},
};

use super::{
    refusal::{PATIENCE, refuse},
    snapshot::{Measured, Motor, Snapshot, fresh},
    text,
};
use crate::{
    socket::Rate,
    viewers::{DriveReport, Viewers},
};

/// The shortest time between two states, and the longest.
const STATE_MIN: Duration = Duration::from_millis(1);
const STATE_MAX: Duration = Duration::from_millis(10);
/// Messages of a client in a second: twice those of the fastest controller.
const RATE_MAX: u32 = 2_000;

/// Serves a client until it goes. `has_place`: false if too many are connected, which it is told.
pub(super) async fn serve(stream: UnixStream, viewers: Viewers, has_place: bool) {
    let (mut read, mut write) = stream.into_split();
    let mut first = [0];
    match timeout(PATIENCE, read.read_exact(&mut first)).await {
        Ok(Ok(_)) => {}
        Ok(Err(_)) => return,
        Err(_) => return text::complain(read, write, Refusal::Silent).await,
    }
    let [magic, ..] = MAGIC;
    if first != [magic] {
        if has_place {
            text::serve(first, read, write, &viewers).await;
        } else {
            text::serve_stop_only(first, read, write, &viewers).await;
        }
        return;
    }
    let greeted = greet(magic, &mut read, &mut write, has_place).await;
    let joined = greeted.and_then(|()| viewers.join_controller().ok_or(Refusal::TooMany));
    match joined {
        Ok(joined) => talk(read, write, &viewers, joined).await,
        Err(wrong) => {
            viewers.log(format!("a client of the socket was refused: {wrong}"));
            refuse(read, write, &encode_error(wrong)).await;
        }
    }
}

/// Reads the hello of a client, and answers it.
async fn greet(
    first: u8,
    read: &mut OwnedReadHalf,
    write: &mut OwnedWriteHalf,
    has_place: bool,
) -> Result<(), Refusal> {
    let mut rest = [0; messages::HELLO - 1];
    let received = timeout(PATIENCE, read.read_exact(&mut rest)).await;
    // Also to a client of another version: it sees which one this is.
    let hello = server_hello();
    let _ = timeout(PATIENCE, write.write_all(&hello)).await;
    if !matches!(received, Ok(Ok(_))) {
        return Err(Refusal::Silent);
    }
    check_hello(&[&[first], &rest[..]].concat())?;
    has_place.then_some(()).ok_or(Refusal::TooMany)
}

/// Sends states and takes messages until the client goes.
async fn talk(
    read: OwnedReadHalf,
    write: OwnedWriteHalf,
    viewers: &Viewers,
    (viewer, reports): (ViewerId, watch::Receiver<DriveReport>),
) {
    // However this function ends.
    let _leaves = Leaves { viewers, viewer };
    let (end, ended) = oneshot::channel();
    let receiving = async {
        let received = receive(read, viewers, viewer).await;
        // At once: the last state may wait for a client that takes nothing.
        viewers.leave(viewer);
        if let Err(wrong) = received {
            viewers.log(format!("controller {} was disconnected: {wrong}", viewer.0));
            let _ = end.send(wrong);
        }
    };
    let snapshots = viewers.snapshot().subscribe();
    let mut sending = Box::pin(send(write, reports, snapshots, ended));
    tokio::select! {
        () = &mut sending => return,
        () = receiving => {}
    }
    sending.await;
}

/// Removes the controller from the viewers when dropped.
struct Leaves<'a> {
    viewers: &'a Viewers,
    viewer: ViewerId,
}

impl Drop for Leaves<'_> {
    fn drop(&mut self) {
        self.viewers.leave(self.viewer);
    }
}

/// Passes on the messages of a client until it goes.
async fn receive(
    mut read: OwnedReadHalf,
    viewers: &Viewers,
    viewer: ViewerId,
) -> Result<(), Refusal> {
    let mut bytes = [0; FROM_CLIENT];
    let mut rate = Rate::default();
    while read.read_exact(&mut bytes).await.is_ok() {
        if rate.is_above(RATE_MAX) {
            return Err(Refusal::Floods);
        }
        let asks = decode_from_client(&bytes)?;
        viewers.operate(|operation, now| operation.controller_asks(now, viewer, &asks));
    }
    Ok(())
}

/// Sends the newest state until the client goes, takes nothing, or has done something wrong.
async fn send(
    mut write: OwnedWriteHalf,
    mut reports: watch::Receiver<DriveReport>,
    mut snapshots: watch::Receiver<Arc<Snapshot>>,
    mut ended: oneshot::Receiver<Refusal>,
) {
    // The first client of all waits until the driver was asked.
    let known = snapshots.wait_for(|snapshot| snapshot.now().is_some());
    let _ = timeout(text::FIRST_STATE_MAX, known).await;
    loop {
        // There is room first, so that a slow client gets the newest state.
        if !matches!(timeout(PATIENCE, write.writable()).await, Ok(Ok(()))) {
            return;
        }
        let report = reports.borrow_and_update().clone();
        let snapshot = Arc::clone(&snapshots.borrow_and_update());
        let sent = tokio::time::Instant::now();
        let state = encode_state(&state(&report, &snapshot));
        if !matches!(timeout(PATIENCE, write.write_all(&state)).await, Ok(Ok(()))) {
            return;
        }
        sleep_until(sent + STATE_MIN).await;
        let wrong = tokio::select! {
            biased;
            ended = &mut ended => Some(ended),
            _ = reports.changed() => None,
            _ = snapshots.changed() => None,
            () = sleep(STATE_MAX) => None,
        };
        if let Some(ended) = wrong {
            if let Ok(wrong) = ended {
                let _ = timeout(PATIENCE, write.write_all(&encode_error(wrong))).await;
            }
            return;
        }
    }
}

fn state(report: &DriveReport, snapshot: &Snapshot) -> messages::State {
    let now = snapshot.now();
    let armed = report
        .motors
        .iter()
        .filter_map(|id| snapshot.motors.get(id));
    let is_other = |motor: &&Motor| !report.motors.contains(&motor.status.id);
    let motors = armed.chain(snapshot.motors.values().filter(is_other));
    messages::State {
        is_halted: snapshot.is_halted,
        is_open: snapshot.is_open,
        drive: report.drive,
        ended: report.ended,
        arm: report.arm,
        challenge: report.challenge,
        sent_us: monotonic_us(),
        holder: report.holder,
        model: snapshot.model,
        motors: motors
            .take(MOTORS_MAX)
            .map(|motor| known(motor, now))
            .collect(),
    }
}

/// What is known of a motor now.
fn known(motor: &Motor, now: Option<Instant>) -> messages::Motor {
    let age = |at: Instant| u32::try_from(now?.since(at).as_micros()).ok();
    let with_age = |value: Measured<f32>| value.and_then(|(at, value)| Some((value, age(at)?)));
    let status = &motor.status;
    messages::Motor {
        id: status.id.get(),
        activity: match status.activity {
            Activity::Idle => messages::Activity::Idle,
            Activity::Driven { .. } => messages::Activity::Driven,
            Activity::Stopping { .. } => messages::Activity::Stopping,
            Activity::Switching { .. } => messages::Activity::Switching,
            Activity::DrivenRaw => messages::Activity::DrivenRaw,
        },
        is_silent: status.is_silent(),
        may_turn: status.may_turn,
        turns_unasked: status.turns_unasked,
        faults: motor.faults.map(Faults::byte),
        reply_age: motor.replied.and_then(age),
        position: motor
            .position
            .and_then(|(at, position)| Some((position, age(at)?))),
        velocity: with_age(fresh(motor.velocity, now)),
        current: with_age(fresh(motor.current, now)),
        temperature: with_age(motor.temperature),
    }
}

/// The clock that every program of this computer reads.
fn monotonic_us() -> u64 {
    let now = clock_gettime(ClockId::Monotonic);
    let seconds = u64::try_from(now.tv_sec).unwrap_or_default();
    let nanoseconds = u64::try_from(now.tv_nsec).unwrap_or_default();
    seconds * 1_000_000 + nanoseconds / 1_000
}

/// Keeps few states in the queue of the system: a client that was slow then reads a new one.
pub(super) fn limit_queue(stream: &UnixStream) -> io::Result<()> {
    const BYTES: usize = 4 * messages::FROM_SERVER;
    rustix::net::sockopt::set_socket_send_buffer_size(stream, BYTES)?;
    Ok(())
}

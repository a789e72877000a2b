//! Replays the open session: reads its bytes, waits, and posts what the player says.

use std::{ops::Range, rc::Rc, time::Duration};

use motorlink_messages::sessions::{FromSessions, ToReplay};
use motorlink_session::{Player, Todo};
use wasm_bindgen_futures::spawn_local;

use super::{
    open_session::OpenSession,
    replay::Replay,
    state::{Shared, post},
};
use crate::{local_time::local_time, turn_scheduler::TurnScheduler};

/// After this long, messages are received.
const TURN: Duration = Duration::from_millis(8);

/// Handles a request of the page about the replay.
pub(super) fn handle(shared: &Shared, message: ToReplay) {
    match message {
        ToReplay::Begin => begin(shared),
        ToReplay::End => shared.borrow_mut().replay = None,
        message => {
            let worker = &mut *shared.borrow_mut();
            let now = worker.clock.now();
            if let Some(replay) = &mut worker.replay {
                replay.player.handle(&replay.open.session, message, now);
            }
        }
    }
    turn(shared);
}

fn begin(shared: &Shared) {
    let worker = &mut *shared.borrow_mut();
    let Some(open) = worker.open.clone() else {
        return;
    };
    let begins = open.overview.begins().map_or(0, |(_, utc_ns)| utc_ns);
    let from_ms = i64::try_from(begins / 1_000_000).unwrap_or_default();
    let weak = Rc::downgrade(shared);
    worker.replay = Some(Replay {
        player: Player::new(&open.session, &open.overview, local_time(from_ms)),
        open,
        scheduler: TurnScheduler::new(move || {
            if let Some(shared) = weak.upgrade() {
                turn(&shared);
            }
        }),
        is_reading: false,
    });
}

/// Does what is due, for a few milliseconds.
fn turn(shared: &Shared) {
    let mut began = None;
    loop {
        let todo = {
            let worker = &mut *shared.borrow_mut();
            let now = worker.clock.now();
            let Some(replay) = worker.replay.as_mut().filter(|replay| !replay.is_reading) else {
                return;
            };
            if now.since(*began.get_or_insert(now)) >= TURN {
                return replay.scheduler.soon();
            }
            let todo = replay.poll(now);
            if let Todo::Wait(until) = todo {
                if let Some(until) = until {
                    replay.scheduler.after(until.since(now));
                }
                return;
            }
            replay.is_reading = matches!(todo, Todo::Read(_));
            todo
        };
        match todo {
            Todo::Post(message) => post(&FromSessions::Replay(message)),
            Todo::Read(range) => {
                let open = shared
                    .borrow()
                    .replay
                    .as_ref()
                    .map(|one| Rc::clone(&one.open));
                if let Some(open) = open {
                    let shared = Rc::clone(shared);
                    spawn_local(async move { read(&shared, &open, range).await });
                }
                return;
            }
            Todo::Work | Todo::Wait(_) => {}
        }
    }
}

/// Reads bytes for the player.
async fn read(shared: &Shared, open: &Rc<OpenSession>, range: Range<u64>) {
    let bytes = open.source.read(range.clone()).await;
    {
        let worker = &mut *shared.borrow_mut();
        let replay = worker.replay.as_mut();
        // A replay that has ended, or begun again, has not asked for them.
        let Some(replay) = replay.filter(|one| one.is_reading && Rc::ptr_eq(&one.open, open))
        else {
            return;
        };
        replay.is_reading = false;
        match bytes {
            Ok(bytes) => replay.player.supply(&range, &bytes),
            Err(_) => replay.player.unreadable(),
        }
    }
    turn(shared);
}

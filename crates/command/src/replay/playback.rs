//! The player of the page, and the file that it reads.

use std::time::{Duration, Instant as Moment};

use motorlink_messages::sessions::{FromReplay, Place, ToReplay};
use motorlink_protocol::Instant;
use motorlink_recorder::LocalTime;
use motorlink_session::{Overview, Player, Source, Todo};

use crate::session::file::Opened;

/// After this long, keys are taken.
const TURN: Duration = Duration::from_millis(8);

/// A session that is played.
pub struct Playback {
    opened: Opened,
    player: Player,
    /// The place of the last update.
    pub place: Place,
}

impl Playback {
    /// A playback that is paused at the first record.
    pub fn new(opened: Opened, overview: &Overview) -> Self {
        Self {
            player: Player::new(&opened.session, overview, LocalTime::default()),
            opened,
            place: Place::default(),
        }
    }

    /// Asks the player for something. `now` is on a clock of the caller.
    pub fn ask(&mut self, message: ToReplay, now: Instant) {
        self.player.handle(&self.opened.session, message, now);
    }

    /// Does what is due, and gives what the page would get to `take`. Returns when the next turn is due, if ever.
    pub fn turn(&mut self, now: Instant, mut take: impl FnMut(FromReplay)) -> Option<Instant> {
        let began = Moment::now();
        loop {
            match self.player.poll(&self.opened.session, now) {
                Todo::Read(range) => match self.opened.bytes.read(range.clone()) {
                    Ok(bytes) => self.player.supply(&range, &bytes),
                    Err(_) => self.player.unreadable(),
                },
                Todo::Post(message) => {
                    if let FromReplay::Update { place, .. } = &message {
                        self.place = *place;
                    }
                    take(message);
                }
                Todo::Work if began.elapsed() >= TURN => return Some(now),
                Todo::Work => {}
                Todo::Wait(until) => return until,
            }
        }
    }
}

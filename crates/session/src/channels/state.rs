//! `/state`: what the page showed, for a replay.
//!
//! Each message is the time in microseconds of the session's clock, as eight bytes with the lowest first, and a state as
//! `motorlink_messages::stored_state` stores it. Its replies are in `/wire` too, and are most of its bytes. So all but the
//! first state of a chunk leave them out:
//!
//! | bytes | content |
//! |---|---|
//! | 0-7 | time |
//! | 8 | 0, which is no format of a stored state |
//! | 9-10 | number of replies that are left out, the lowest byte first |
//! | 11.. | the state, with the replies behind them |

use std::collections::VecDeque;

use motorlink_bus::{LineEvent, LineSamples, Sample};
use motorlink_messages::{Update, stored_state};
use motorlink_protocol::{Instant, family::Model};

/// The encoding of the messages, in the file.
pub(crate) const ENCODING: &str = "motorlink-state";

const WITHOUT_REPLIES: u8 = 0;

/// Replies without a state: two seconds of a thousand a second. A state follows a reply within 50 ms.
const REPLIES_MAX: usize = 2_000;

/// The replies of `/wire` since the last state. Writer and reader derive the same.
#[derive(Debug, Default)]
pub(crate) struct Replies {
    samples: LineSamples,
    since: VecDeque<Sample>,
}

impl Replies {
    pub(crate) fn set_model(&mut self, model: Model) {
        if self.samples.model() != model {
            self.samples = LineSamples::of(model);
        }
    }

    pub(crate) fn add_event(&mut self, event: &LineEvent) {
        if self.since.len() >= REPLIES_MAX {
            self.since.clear();
        }
        self.since.extend(self.samples.add_event(event));
    }

    /// A reader may begin at a whole state, so nothing before it counts.
    fn restart(&mut self) {
        self.samples = LineSamples::of(self.samples.model());
        self.since.clear();
    }

    /// Takes so many, and those that are passed over if others follow that are no replies of `/wire`.
    fn take(&mut self, number: usize, others: &[Sample]) -> Vec<Sample> {
        let taken = self.since.drain(..number.min(self.since.len())).collect();
        if !others.is_empty() {
            self.since.clear();
        }
        taken
    }

    /// The message of a whole state, which a reader can begin with.
    pub(crate) fn whole(&mut self, at: Instant, update: Update) -> Vec<u8> {
        self.restart();
        [&time(at)[..], &stored_state::store(update)].concat()
    }

    /// The message of a state behind others.
    pub(crate) fn message(&mut self, at: Instant, mut update: Update) -> Vec<u8> {
        let samples = &mut update.samples;
        let same = self.since.iter().zip(&*samples);
        let same = same.take_while(|(one, other)| one == other).count();
        let number = u16::try_from(same).unwrap_or(u16::MAX);
        samples.drain(..usize::from(number));
        self.take(number.into(), samples);
        let [low, high] = number.to_le_bytes();
        let head = [WITHOUT_REPLIES, low, high];
        [&time(at)[..], &head, &stored_state::store(update)].concat()
    }

    /// The state in a message; `None` of its state if that is of another version.
    pub(crate) fn read(&mut self, data: &[u8]) -> Option<(Instant, Option<Update>)> {
        let (at, stored) = data.split_first_chunk()?;
        let at = Instant::from_micros(u64::from_le_bytes(*at));
        let Some(([WITHOUT_REPLIES, low, high], stored)) = stored.split_first_chunk() else {
            self.restart();
            return Some((at, stored_state::read(stored, at)));
        };
        let number = u16::from_le_bytes([*low, *high]);
        let mut state = stored_state::read(stored, at);
        if let Some(Update { samples, .. }) = &mut state {
            let taken = self.take(number.into(), samples);
            samples.splice(..0, taken);
        }
        Some((at, state))
    }
}

const fn time(at: Instant) -> [u8; 8] {
    at.as_micros().to_le_bytes()
}

#[cfg(test)]
mod tests {
    use motorlink_bus::LineEventKind;
    use motorlink_messages::{Adapter, Connection};

    use super::*;

    fn reply(millis: u64) -> LineEvent {
        let frame = "01 02 02 CD 00 64 17 CF 00 8F".parse().unwrap();
        LineEvent {
            at: Instant::from_millis(millis),
            kind: LineEventKind::Received { frame, asked: None },
        }
    }

    fn state(millis: u64, replies: &[u64]) -> Update {
        let mut line = LineSamples::default();
        let samples = replies.iter().filter_map(|at| line.add_event(&reply(*at)));
        let now = Instant::from_millis(millis);
        Update {
            samples: samples.collect(),
            ..Update::without_motors(now, Connection::Connected(Adapter::VIRTUAL))
        }
    }

    #[test]
    fn replies_of_the_wire_are_left_out_and_read_back() {
        let (mut written, mut read) = (Replies::default(), Replies::default());
        // The reader has not seen this one.
        written.add_event(&reply(1));
        let stretches: [(&[u64], &[u64], usize); 5] = [
            (&[10, 20], &[1, 10, 20], 3),
            (&[60, 70], &[60, 70], 0),
            // The last one comes with the next state.
            (&[110, 120], &[110], 0),
            // The bus did not take the reply at 160.
            (&[160, 170], &[120, 170], 1),
            (&[210, 220], &[210, 220], 0),
        ];
        for ((passed, shown, stored), n) in stretches.into_iter().zip(1..) {
            for at in passed {
                written.add_event(&reply(*at));
                read.add_event(&reply(*at));
            }
            let update = state(50 * n, shown);
            let message = match n {
                1 => written.whole(update.now, update.clone()),
                _ => written.message(update.now, update.clone()),
            };
            let whole = Replies::default().whole(update.now, update.clone());
            let head = usize::from(n > 1) * 3;
            let of_replies = whole.len() + head - message.len();
            let one = Replies::default()
                .whole(update.now, state(50 * n, &[shown[0]]))
                .len()
                - Replies::default()
                    .whole(update.now, state(50 * n, &[]))
                    .len();
            assert_eq!(of_replies / one, shown.len() - stored, "state {n}");
            assert_eq!(
                read.read(&message),
                Some((update.now, Some(update))),
                "state {n}"
            );
        }
    }
}

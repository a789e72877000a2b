//! State of a full scan: which address is probed next, how often, and what the answers prove.
//!
//! One silent window proves nothing on a line that loses replies, and four probes of all 254
//! addresses would take four times as long on a good line. So the scan measures the line: it also
//! probes the motors that it has found, again and again, and probes silent addresses more often
//! only if some of these exchanges are lost. A reply that arrives during the next probe is late,
//! not lost: it makes the windows longer, and its address is probed again.
//!
//! | looks at | how often |
//! |---|---|
//! | every address | once |
//! | one that answered | until two good replies, so that no noise is taken for a motor |
//! | one that was silent less than 50 ms before noise | once more |
//! | one whose window held noise, or whose reply came late | until a look is clean, at most [`PROBES_MAX`](super::address::PROBES_MAX) times |
//! | one that is noisy after that, of a few | as often again, with a window that late bytes do not outlast, until three in a row are clean |
//! | every silent address, on a line that loses replies | once more for every loss, at most [`PASSES_ON_A_BAD_LINE`] times |

mod results;

use std::{collections::VecDeque, time::Duration};

use motorlink_protocol::{Instant, MotorId};

use crate::{
    probe::{Probe, ProbeResult},
    round_trip::RoundTrip,
    scan::{
        address::{ADDRESSES, Address, place},
        reply_times::ReplyTimes,
    },
    timing::{LATE_REPLY_MAX, SCAN_SAMPLING_MAX},
};

/// ID queries at the start of a scan if the round trip is unknown. Their answers collide, but the
/// time of the bytes tells how long a reply takes.
const ID_QUERIES: u8 = 3;

/// With one reply in twenty lost, this many exchanges show no loss in one of 470 scans; the motor
/// that only such a scan can miss is missed by one probe in twenty.
const EXCHANGES_WANTED: u32 = 120;

/// Every fifth exchange goes to a motor that was found: its telemetry stays fresh, and it shows
/// whether replies are lost. With slow exchanges, fewer do.
const PROBES_PER_SAMPLE: u8 = 4;
const PROBES_PER_SLOW_SAMPLE: u8 = 20;
const SLOW_EXCHANGE: Duration = Duration::from_millis(8);

/// With one reply in twenty lost, four probes miss a motor once in 160,000 times.
const PASSES_ON_A_BAD_LINE: u8 = 4;

/// So many silent windows in a row show that the noise was not of this address: with one reply in twenty lost, two motors
/// with one ID are that quiet once in 8,000 times.
const SILENCES_WANTED: u8 = 3;

/// A running full scan.
#[derive(Clone, Debug)]
pub(crate) struct Scan {
    began: Instant,
    addresses: [Address; ADDRESSES as usize],
    /// Addresses to probe next, each at most once.
    queue: VecDeque<MotorId>,
    id_queries_left: u8,
    /// Whether an ID query brought bytes.
    id_query_answered: bool,
    pass: u8,
    asked: u16,
    found: Vec<MotorId>,
    /// Exchanges with motors that were found, and how many of them were lost.
    exchanges: u32,
    lost: u32,
    /// When the last lost one was sent: its reply may still arrive.
    last_lost: Option<Instant>,
    /// The last probed address, if it did not answer.
    previous_unanswered: Option<MotorId>,
    probes_since_sample: u8,
    next_sample: usize,
    sampling_since: Option<Instant>,
    reply_times: ReplyTimes,
    /// Whether the few addresses that are still noisy are asked again, with the longest window.
    is_second_look: bool,
    /// Whether all bytes so far came in full blocks; `None` before the first byte.
    only_blocks: Option<bool>,
    /// Windows with nothing but bytes of a pair that nothing drives.
    level_windows: u16,
}

impl Scan {
    /// A scan that probes the `known` motors first, since they show how fast the adapter is.
    /// `clean_exchanges` is the number of last exchanges on this line without any loss.
    pub(crate) fn begin(
        now: Instant,
        known: &[MotorId],
        round_trip: RoundTrip,
        clean_exchanges: u32,
    ) -> Self {
        let others = MotorId::all().filter(|id| !known.contains(id));
        Self {
            began: now,
            addresses: [Address::default(); ADDRESSES as usize],
            queue: known.iter().copied().chain(others).collect(),
            id_queries_left: if round_trip.window().is_none() {
                ID_QUERIES
            } else {
                1
            },
            id_query_answered: false,
            pass: 1,
            asked: 0,
            found: Vec::new(),
            exchanges: clean_exchanges,
            lost: 0,
            last_lost: None,
            previous_unanswered: None,
            probes_since_sample: 0,
            next_sample: 0,
            sampling_since: None,
            reply_times: ReplyTimes::new(round_trip),
            is_second_look: false,
            only_blocks: None,
            level_windows: 0,
        }
    }

    /// The next probe; `None` when the scan is complete.
    pub(crate) fn next(&mut self, now: Instant) -> Option<Probe> {
        if self.id_queries_left > 0 {
            self.id_queries_left -= 1;
            return Some(Probe::IdQuery);
        }
        let probes_per_sample = if self.reply_times.usual() < SLOW_EXCHANGE {
            PROBES_PER_SAMPLE
        } else {
            PROBES_PER_SLOW_SAMPLE
        };
        if self.probes_since_sample >= probes_per_sample
            && let Some(id) = self.sample()
        {
            return Some(Probe::Query(id));
        }
        if self.queue.is_empty() {
            self.queue = self.doubtful();
        }
        if let Some(id) = self.queue.pop_front() {
            self.probes_since_sample = self.probes_since_sample.saturating_add(1);
            // Noise may be an answer that is identical to its request.
            let address = self.addresses.get(place(id));
            let again = address.is_some_and(|address| address.noisy && address.probes % 2 == 1);
            return Some(if again {
                Probe::OtherQuery(id)
            } else {
                Probe::Query(id)
            });
        }
        let sampling_since = *self.sampling_since.get_or_insert(now);
        let undecided = match self.last_lost.filter(|_| self.lost > 0) {
            Some(sent) => now.since(sent) < LATE_REPLY_MAX,
            None => self.exchanges < EXCHANGES_WANTED,
        };
        if undecided
            && now.since(sampling_since) < SCAN_SAMPLING_MAX
            && let Some(id) = self.sample()
        {
            return Some(Probe::Query(id));
        }
        if self.pass < self.passes() {
            self.pass += 1;
            self.queue = self.silent();
            return self.queue.pop_front().map(Probe::Query);
        }
        if !self.is_second_look {
            self.is_second_look = true;
            self.queue = self.look_again();
            return self.queue.pop_front().map(Probe::Query);
        }
        None
    }

    /// Reply window of a probe.
    pub(crate) fn window(&self) -> Duration {
        if self.is_second_look {
            LATE_REPLY_MAX
        } else {
            self.reply_times.window()
        }
    }

    /// Bytes have come, in a full block or not.
    pub(crate) fn received(&mut self, is_block: bool) {
        self.only_blocks = Some(is_block && self.only_blocks != Some(false));
    }

    /// A window has had nothing but bytes of a pair that nothing drives.
    pub(crate) fn heard_levels(&mut self) {
        self.level_windows = self.level_windows.saturating_add(1);
    }

    /// Result of an ID query: the time of its last byte, if any.
    pub(crate) fn id_query_ended(&mut self, last_byte_after: Option<Duration>) {
        if let Some(took) = last_byte_after {
            self.id_query_answered = true;
            self.reply_times.add(took);
        }
    }

    /// Result of a probe that was sent at `sent`. Returns whether the motor is found by it.
    pub(crate) fn probe_ended(&mut self, id: MotorId, sent: Instant, result: ProbeResult) -> bool {
        if let ProbeResult::Reply(took) = result {
            self.reply_times.add(took);
        }
        let before = self.previous_unanswered.take();
        if result == ProbeResult::Noise && !self.is_behind_blocks() {
            if let Some(before) = before {
                self.reply_met_next_query(before);
            }
            self.doubt_silences(sent);
        }
        self.previous_unanswered = (!matches!(result, ProbeResult::Reply(_))).then_some(id);
        let is_second_look = self.is_second_look;
        let Some(address) = self.addresses.get_mut(place(id)) else {
            return false;
        };
        let answered = matches!(result, ProbeResult::Reply(_));
        if !answered {
            address.unanswered = Some(sent);
        }
        if address.replies > 0 {
            self.exchanges += 1;
            if !answered {
                self.lost += 1;
                self.last_lost = Some(sent);
            }
        }
        self.asked += u16::from(address.probes == 0 && !is_second_look);
        address.probes = address.probes.saturating_add(1);
        if address.is_found() {
            return false;
        }
        address.noisy = if is_second_look {
            address.silences = match result {
                ProbeResult::Silence => address.silences + 1,
                ProbeResult::Noise | ProbeResult::Reply(_) => 0,
            };
            address.silences < SILENCES_WANTED
        } else {
            result == ProbeResult::Noise
        };
        if let ProbeResult::Reply(_) = result {
            address.replies += 1;
        }
        if address.is_found() {
            self.add(id);
            return true;
        }
        if address.replies > 0 && address.is_doubtful() {
            self.queue.push_front(id);
        }
        false
    }

    fn add(&mut self, id: MotorId) {
        let behind = self.found.partition_point(|other| *other < id);
        self.found.insert(behind, id);
    }

    /// Nothing came in the window of this address, and noise came in the next. A delayed machine
    /// sent the query late, and the answer collided with the next query. So no reply was lost on
    /// the line.
    fn reply_met_next_query(&mut self, id: MotorId) {
        let Some(address) = self.addresses.get_mut(place(id)) else {
            return;
        };
        address.unanswered = None;
        if address.replies > 0 {
            self.lost = self.lost.saturating_sub(1);
        } else {
            address.noisy = true;
        }
    }

    /// Noise came in the window of a probe that was sent at `sent`. An adapter that stalls sends several queries at once, and
    /// the replies to them collide. So each address whose only probe may be answered by this noise is asked once more.
    fn doubt_silences(&mut self, sent: Instant) {
        for address in &mut self.addresses {
            let asked = address.unanswered.filter(|_| address.probes == 1);
            if asked.is_some_and(|asked| sent.since(asked) < LATE_REPLY_MAX) {
                address.noisy = true;
            }
        }
    }

    /// A good frame of this motor arrived during a later probe: its window was too short, and
    /// nothing was lost. Returns whether the motor is found by it.
    pub(crate) fn late_reply(&mut self, now: Instant, id: MotorId) -> bool {
        let is_behind_blocks = self.is_behind_blocks();
        let Some(address) = self.addresses.get_mut(place(id)) else {
            return false;
        };
        if is_behind_blocks {
            // No reply comes in its window.
            let is_new = !address.is_found();
            address.replies = address.replies.saturating_add(1);
            let is_found = is_new && address.is_found();
            if is_found {
                self.add(id);
            }
            return is_found;
        }
        if address.probes > 0 && !address.is_found() {
            address.noisy = true;
        }
        let Some(sent) = address.unanswered.take() else {
            return false;
        };
        // It was late, not lost on the line.
        if address.replies > 0 {
            self.lost = self.lost.saturating_sub(1);
        }
        if self.pass > self.passes() {
            // This loss had started another pass over the silent addresses.
            self.pass = self.passes();
            self.queue = self.doubtful();
        }
        let took = now.since(sent);
        if took <= LATE_REPLY_MAX {
            self.reply_times.add(took);
        }
        false
    }

    /// A motor that was found, to be probed again.
    fn sample(&mut self) -> Option<MotorId> {
        let id = self
            .found
            .get(self.next_sample % self.found.len().max(1))
            .copied()?;
        self.next_sample += 1;
        self.probes_since_sample = 0;
        Some(id)
    }
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;

//! A full scan: who is asked next, how often, and what the answers prove.
//!
//! One silent window proves nothing on a line that loses replies, and asking all 254 addresses four
//! times would take four times as long on one that does not. So the scan measures: beside the
//! addresses it asks those that it has found, again and again, and only where some of these exchanges
//! are lost does it ask the silent addresses more often. A reply that comes while the next address is
//! asked is late, not lost: it makes the windows longer, and its address is asked again.
//!
//! | looks at | how often |
//! |---|---|
//! | every address | once |
//! | one that answered | until two good replies, so that no noise is taken for a motor |
//! | one whose window held noise, or whose reply came late | until a look is clean, at most [`LOOKS_MAX`] times |
//! | every silent address, on a line that loses replies | once more for every loss, at most [`PASSES_ON_A_BAD_LINE`] times |

use std::{collections::VecDeque, time::Duration};

use motorlink_protocol::{Instant, MotorId};

use crate::{
    job::status::SurveyStatus,
    probe::{Ask, Look},
    round_trip::RoundTrip,
    scan::report::ScanReport,
    timing::{FIRST_WINDOW, LATE_REPLY_MAX, SCAN_MARGIN, SCAN_SAMPLING_MAX, SCAN_WINDOW_MAX},
};

/// Addresses 1-254.
const ADDRESSES: u16 = 254;

/// So many ID queries begin a scan on an adapter whose round trip is not known. Their answers collide,
/// but when the bytes come they tell how long a reply takes here.
const CALLS: u8 = 3;

/// With one reply in twenty lost, so many exchanges hide that in one of 470 scans; the motor that only
/// such a scan can miss is missed in one look of twenty.
const EXCHANGES_WANTED: u32 = 120;

/// Every fifth exchange goes to a motor that was found: it stays fresh, and shows whether replies are
/// lost. Where an exchange takes long, fewer do.
const LOOKS_PER_SAMPLE: u8 = 4;
const LOOKS_PER_SLOW_SAMPLE: u8 = 20;
const SLOW_EXCHANGE: Duration = Duration::from_millis(8);

/// With one reply in twenty lost, four looks miss a motor once in 160,000 times.
const PASSES_ON_A_BAD_LINE: u8 = 4;

/// Of so many of the last replies, the slowest but one tells how long to wait: one that a busy machine
/// held up does not make every window behind it longer. A reply that its window was too short for is
/// heard in the next, and counts among them.
const RECENT: usize = 16;

/// Good replies that make a motor: chance gives one junk window in 256 a good CRC.
const REPLIES_WANTED: u8 = 2;

/// Looks at one address in one pass, where noise or a single reply asks for another.
const LOOKS_MAX: u8 = 6;

#[derive(Clone, Copy, Debug, Default)]
struct Address {
    looks: u8,
    replies: u8,
    /// Whether the last look brought noise.
    noisy: bool,
    /// When it was asked for the last time without an answer in its window.
    unanswered: Option<Instant>,
}

impl Address {
    const fn is_found(self) -> bool {
        self.replies >= REPLIES_WANTED
    }

    const fn is_silent(self) -> bool {
        self.replies == 0 && !self.noisy
    }

    /// Whether the looks so far leave a doubt that another can clear.
    const fn is_doubtful(self) -> bool {
        !self.is_found() && !self.is_silent() && self.looks < LOOKS_MAX
    }
}

/// A full scan under way.
#[derive(Clone, Debug)]
pub(crate) struct Scan {
    began: Instant,
    addresses: [Address; ADDRESSES as usize],
    /// Whom to ask next; at most every address once.
    queue: VecDeque<MotorId>,
    calls_left: u8,
    /// Whether an ID query brought bytes.
    somebody_called: bool,
    pass: u8,
    asked: u16,
    found: Vec<MotorId>,
    /// Exchanges with motors that were found, and how many of them were lost.
    exchanges: u32,
    lost: u32,
    /// When the last of them was asked: its reply may still be on its way.
    last_lost: Option<Instant>,
    /// Who was asked last, and did not answer.
    unanswered_before: Option<MotorId>,
    looks_since_sample: u8,
    next_sample: usize,
    sampling_since: Option<Instant>,
    /// Round trips on this adapter, with those of before the scan.
    round_trip: RoundTrip,
    /// The last round trips of the scan itself, the newest behind.
    recent: VecDeque<Duration>,
}

impl Scan {
    /// A scan that asks those first who have answered before, since they show how fast the adapter is.
    /// `clean_exchanges` is how many of the last ones on this line were all answered.
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
            calls_left: if round_trip.window().is_none() {
                CALLS
            } else {
                1
            },
            somebody_called: false,
            pass: 1,
            asked: 0,
            found: Vec::new(),
            exchanges: clean_exchanges,
            lost: 0,
            last_lost: None,
            unanswered_before: None,
            looks_since_sample: 0,
            next_sample: 0,
            sampling_since: None,
            round_trip,
            recent: VecDeque::with_capacity(RECENT),
        }
    }

    /// Whom to ask now; `None` when all is known that can be.
    pub(crate) fn next(&mut self, now: Instant) -> Option<Ask> {
        if self.calls_left > 0 {
            self.calls_left -= 1;
            return Some(Ask::Everyone);
        }
        let looks_per_sample = if self.round_trip.usual() < SLOW_EXCHANGE {
            LOOKS_PER_SAMPLE
        } else {
            LOOKS_PER_SLOW_SAMPLE
        };
        if self.looks_since_sample >= looks_per_sample
            && let Some(id) = self.sample()
        {
            return Some(Ask::One(id));
        }
        if self.queue.is_empty() {
            self.queue = self.doubtful();
        }
        if let Some(id) = self.queue.pop_front() {
            self.looks_since_sample = self.looks_since_sample.saturating_add(1);
            return Some(Ask::One(id));
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
            return Some(Ask::One(id));
        }
        if self.pass < self.passes() {
            self.pass += 1;
            self.queue = self.silent();
            return self.queue.pop_front().map(Ask::One);
        }
        None
    }

    /// How long an answer is waited for.
    pub(crate) fn window(&self) -> Duration {
        let measured = self.round_trip.window().unwrap_or(FIRST_WINDOW);
        // The estimator begins with a wide spread, which 254 windows make dear.
        let slowest = self.slowest_but_one().map(|slowest| slowest + SCAN_MARGIN);
        slowest
            .map_or(measured, |slowest| measured.min(slowest))
            .min(SCAN_WINDOW_MAX)
    }

    /// Of the last replies, or the slowest where there are not yet two.
    fn slowest_but_one(&self) -> Option<Duration> {
        let (mut slowest, mut next) = (None, None);
        for took in self.recent.iter().copied().map(Some) {
            next = next.max(slowest.min(took));
            slowest = slowest.max(took);
        }
        next.or(slowest)
    }

    /// What an ID query brought: when its last byte came, if any did.
    pub(crate) fn called(&mut self, last_byte_after: Option<Duration>) {
        if let Some(took) = last_byte_after {
            self.somebody_called = true;
            self.took(took);
        }
    }

    /// What a look at an address brought, which was asked at `sent`. Returns whether that makes it a
    /// motor that is found.
    pub(crate) fn looked(&mut self, id: MotorId, sent: Instant, look: Look) -> bool {
        if let Look::Reply(took) = look {
            self.took(took);
        }
        let before = self
            .unanswered_before
            .take()
            .filter(|_| look == Look::Noise);
        if let Some(before) = before {
            self.collided(before);
        }
        self.unanswered_before = (!matches!(look, Look::Reply(_))).then_some(id);
        let Some(address) = self.addresses.get_mut(place(id)) else {
            return false;
        };
        let answered = matches!(look, Look::Reply(_));
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
        if address.is_found() {
            return false;
        }
        self.asked += u16::from(address.looks == 0);
        address.looks = address.looks.saturating_add(1);
        address.noisy = look == Look::Noise;
        if let Look::Reply(_) = look {
            address.replies += 1;
        }
        if address.is_found() {
            let behind = self.found.partition_point(|other| *other < id);
            self.found.insert(behind, id);
            return true;
        }
        if address.replies > 0 && address.is_doubtful() {
            self.queue.push_front(id);
        }
        false
    }

    /// This address was asked, nothing came in its window, and then noise in the next: a machine that was
    /// held up let the question out late, and its answer met the next question on the line. Of the line
    /// that says nothing.
    fn collided(&mut self, id: MotorId) {
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

    /// A good frame of this motor came when another was asked: its window was too short, and nothing
    /// was lost.
    pub(crate) fn heard_late(&mut self, now: Instant, id: MotorId) {
        let Some(address) = self.addresses.get_mut(place(id)) else {
            return;
        };
        if address.looks > 0 && !address.is_found() {
            address.noisy = true;
        }
        let Some(sent) = address.unanswered.take() else {
            return;
        };
        // However late: it was not lost on the line.
        if address.replies > 0 {
            self.lost = self.lost.saturating_sub(1);
        }
        if self.pass > self.passes() {
            // For this loss the silent addresses were being asked once more.
            self.pass = self.passes();
            self.queue = self.doubtful();
        }
        let took = now.since(sent);
        if took <= LATE_REPLY_MAX {
            self.took(took);
        }
    }

    pub(crate) fn status(&self) -> SurveyStatus {
        let micros = |duration: Duration| u64::try_from(duration.as_micros()).unwrap_or(u64::MAX);
        let looks = self.queue.len() as u64;
        let samples = if self.lost == 0 && !self.found.is_empty() {
            u64::from(EXCHANGES_WANTED.saturating_sub(self.exchanges))
        } else {
            0
        };
        let passes = u64::from(self.passes().saturating_sub(self.pass)) * u64::from(ADDRESSES);
        let sampling = (samples * micros(self.round_trip.usual())).min(micros(SCAN_SAMPLING_MAX));
        let left_us = (looks + passes) * micros(self.window()) + sampling;
        SurveyStatus::Scanning {
            asked: self.asked,
            of: ADDRESSES,
            left_ms: u32::try_from(left_us / 1000).unwrap_or(u32::MAX),
            found: self.found.clone(),
        }
    }

    pub(crate) fn report(&self, now: Instant, complete: bool) -> ScanReport {
        ScanReport {
            found: self.found.clone(),
            noisy: self.where_address(|address| !address.is_found() && !address.is_silent()),
            asked: self.asked,
            complete,
            took_ms: u32::try_from(now.since(self.began).as_millis()).unwrap_or(u32::MAX),
        }
    }

    fn took(&mut self, took: Duration) {
        self.round_trip.replied(took);
        if self.recent.len() == RECENT {
            self.recent.pop_front();
        }
        self.recent.push_back(took);
    }

    /// A motor that was found, to be asked once more.
    fn sample(&mut self) -> Option<MotorId> {
        let id = self
            .found
            .get(self.next_sample % self.found.len().max(1))
            .copied()?;
        self.next_sample += 1;
        self.looks_since_sample = 0;
        Some(id)
    }

    /// How often every silent address is asked: once more for every reply that was lost, since a line
    /// that loses one in twenty loses several while it is measured. Where nobody is found but somebody
    /// answered the ID query, there is a motor to be missed.
    fn passes(&self) -> u8 {
        if self.found.is_empty() && self.somebody_called {
            return PASSES_ON_A_BAD_LINE;
        }
        let again = u8::try_from(self.lost).unwrap_or(u8::MAX);
        again.saturating_add(1).min(PASSES_ON_A_BAD_LINE)
    }

    fn silent(&self) -> VecDeque<MotorId> {
        self.where_address(Address::is_silent)
    }

    fn doubtful(&self) -> VecDeque<MotorId> {
        self.where_address(Address::is_doubtful)
    }

    fn where_address<C: FromIterator<MotorId>>(&self, is: impl Fn(Address) -> bool) -> C {
        let asked = MotorId::all().zip(&self.addresses);
        asked
            .filter(|(_, address)| address.looks > 0 && is(**address))
            .map(|(id, _)| id)
            .collect()
    }
}

const fn place(id: MotorId) -> usize {
    id.get() as usize - 1
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;

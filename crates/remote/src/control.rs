//! Who may drive: the lease of the operator.

use std::{
    collections::{BTreeMap, VecDeque},
    time::Duration,
};

use motorlink_protocol::Instant;

use crate::wire::Stamp;

/// How long the lease lasts after the newest challenge that its holder has answered was made.
pub const LEASE: Duration = Duration::from_millis(400);
/// How often each page is challenged: a lease survives three lost answers.
pub const CHALLENGES_EVERY: Duration = Duration::from_millis(100);
/// How often the operator's page sends its newest answer again. TCP notices that a packet is lost when it hears of later
/// ones. With the answers alone, two losses in a row end the lease on a good network; see docs/performance.md.
pub const ANSWER_AGAIN_EVERY: Duration = Duration::from_millis(25);
/// How old the challenge of an act may be: as old as that of a lease.
pub const ACTS_WITHIN: Duration = LEASE;
/// How long after its question a page may take control without consent. The second click of a double click does not.
pub const FORCE_AFTER: Duration = Duration::from_secs(1);
/// How long a question stands while another page asks. Otherwise a page that asks once would keep all others from asking.
const ASKS_FOR: Duration = Duration::from_secs(5);
/// Pages at the same time. A class of thirty has a laptop and a phone each, and there is room for as many more.
pub const VIEWERS_MAX: usize = 128;

/// A page. Numbers are not used again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ViewerId(pub u32);

/// Why a lease ended. The server stops what it drove.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// No answer in time.
    Silent,
    /// Its page has gone.
    Gone,
    /// Its holder has given it up.
    GivenUp,
    /// Another page has taken it.
    Taken,
}

/// What became of a request for control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taken {
    /// The page holds the lease. If an earlier lease ended now, the server stops what that one drove.
    Granted(Option<Ended>),
    /// The page holds it already.
    Held,
    /// Another page holds it, and is told who asks.
    Asked,
}

/// Why an act has no effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotDone {
    /// The page does not hold the lease, or the act is of an earlier one.
    NotOperator,
    /// The act, or a later one, was done before.
    OutOfOrder,
    /// Its challenge is too old, or was never made.
    Late,
}

/// The pages, and the lease of one of them.
#[derive(Debug, Default)]
pub struct Control {
    pages: BTreeMap<ViewerId, Page>,
    pages_ever: u32,
    /// The number of the newest lease.
    epoch: u32,
    lease: Option<Lease>,
    /// Who asks for control, and since when.
    asks: Option<(ViewerId, Instant)>,
    /// When a page without the lease has stopped motors.
    stopped: Option<Instant>,
}

#[derive(Debug, Default)]
struct Page {
    /// The challenges of the last 400 ms, oldest first, and when they were made.
    challenges: VecDeque<(u64, Instant)>,
    next_challenge: Instant,
}

impl Page {
    fn made_at(&self, challenge: u64) -> Option<Instant> {
        let found = self.challenges.iter().find(|(made, _)| *made == challenge);
        found.map(|(_, at)| *at)
    }

    fn forget_old(&mut self, now: Instant) {
        while self
            .challenges
            .front()
            .is_some_and(|(_, at)| *at + LEASE < now)
        {
            self.challenges.pop_front();
        }
    }
}

#[derive(Debug)]
struct Lease {
    holder: ViewerId,
    /// The number of the last act.
    sequence: u32,
    /// When the newest challenge that was answered was made.
    renewed: Instant,
}

impl Control {
    /// A page has connected. Returns nothing if there are too many.
    pub fn join(&mut self, now: Instant) -> Option<ViewerId> {
        if self.pages.len() >= VIEWERS_MAX {
            return None;
        }
        self.pages_ever += 1;
        let viewer = ViewerId(self.pages_ever);
        let page = Page {
            next_challenge: now,
            ..Page::default()
        };
        self.pages.insert(viewer, page);
        Some(viewer)
    }

    /// A page has gone.
    pub fn leave(&mut self, viewer: ViewerId) -> Option<Ended> {
        self.pages.remove(&viewer);
        self.asks.take_if(|(asks, _)| *asks == viewer);
        self.end_if_held(viewer, Ended::Gone)
    }

    /// Every page.
    pub fn viewers(&self) -> impl Iterator<Item = ViewerId> {
        self.pages.keys().copied()
    }

    /// The pages whose challenge is due, each with a number that no page can guess in advance.
    pub fn challenge(
        &mut self,
        now: Instant,
        mut number: impl FnMut() -> Option<u64>,
    ) -> Vec<(ViewerId, u64)> {
        let mut challenged = Vec::new();
        for (viewer, page) in &mut self.pages {
            if page.next_challenge <= now {
                page.forget_old(now);
                page.next_challenge = now + CHALLENGES_EVERY;
                if let Some(challenge) = number() {
                    page.challenges.push_back((challenge, now));
                    challenged.push((*viewer, challenge));
                }
            }
        }
        challenged
    }

    /// A page has answered a challenge.
    pub fn answer(&mut self, now: Instant, viewer: ViewerId, challenge: u64) {
        // A lease that has ended by now is not renewed.
        let made_at = self
            .pages
            .get(&viewer)
            .and_then(|page| page.made_at(challenge));
        if let Some(made_at) = made_at
            && let Some(lease) = &mut self.lease
            && lease.holder == viewer
            && now <= lease.renewed + LEASE
        {
            lease.renewed = lease.renewed.max(made_at);
        }
    }

    /// Ends a lease that was not renewed.
    pub fn expire(&mut self, now: Instant) -> Option<Ended> {
        let lease = self.lease.as_ref()?;
        let is_over = lease.renewed + LEASE < now;
        is_over.then(|| self.end(Ended::Silent))
    }

    /// When the lease ends, or a challenge is due.
    #[must_use]
    pub fn next_turn(&self) -> Option<Instant> {
        let ends = self.lease.iter().map(|lease| lease.renewed + LEASE);
        let challenges = self.pages.values().map(|page| page.next_challenge);
        ends.chain(challenges).min()
    }

    /// A page asks for control.
    pub fn take(&mut self, now: Instant, viewer: ViewerId, by_force: bool) -> Taken {
        let mut ended = self.expire(now);
        if let Some(lease) = &self.lease {
            if lease.holder == viewer {
                return Taken::Held;
            }
            // The operator sees the first that asks for a while.
            self.asks
                .take_if(|(asks, since)| *asks != viewer && *since + ASKS_FOR < now);
            let (asks, since) = *self.asks.get_or_insert((viewer, now));
            if !by_force || asks != viewer || now < since + FORCE_AFTER {
                return Taken::Asked;
            }
            ended = Some(self.end(Ended::Taken));
        }
        self.epoch += 1;
        self.lease = Some(Lease {
            holder: viewer,
            sequence: 0,
            renewed: now,
        });
        Taken::Granted(ended)
    }

    /// The operator gives up control.
    pub fn give_up(&mut self, viewer: ViewerId) -> Option<Ended> {
        self.end_if_held(viewer, Ended::GivenUp)
    }

    /// A page without the lease has stopped motors. What the operator did before it knew that starts none.
    pub const fn stopped_by_other(&mut self, now: Instant) {
        self.stopped = Some(now);
    }

    /// Whether this page holds the lease with this number.
    #[must_use]
    pub fn holds(&self, now: Instant, viewer: ViewerId, epoch: u32) -> bool {
        let is_live = |lease: &Lease| lease.holder == viewer && now <= lease.renewed + LEASE;
        self.epoch == epoch && self.lease.as_ref().is_some_and(is_live)
    }

    /// Checks an act that only the operator may do. `starts`: it may move a wheel, or allow that.
    ///
    /// # Errors
    /// [`NotDone`] says why it has no effect.
    pub fn act(
        &mut self,
        now: Instant,
        viewer: ViewerId,
        stamp: Stamp,
        starts: bool,
    ) -> Result<(), NotDone> {
        if !self.holds(now, viewer, stamp.epoch) {
            return Err(NotDone::NotOperator);
        }
        let made_at = self
            .pages
            .get(&viewer)
            .and_then(|page| page.made_at(stamp.challenge));
        let lease = self.lease.as_mut().ok_or(NotDone::NotOperator)?;
        if stamp.sequence <= lease.sequence {
            return Err(NotDone::OutOfOrder);
        }
        // A late act counts too: an earlier one behind it is out of order.
        lease.sequence = stamp.sequence;
        let is_new = made_at.is_some_and(|made_at| now <= made_at + ACTS_WITHIN);
        let knows_stop = !starts || made_at > self.stopped;
        if is_new && knows_stop {
            Ok(())
        } else {
            Err(NotDone::Late)
        }
    }

    /// The operator, and the number of its lease.
    #[must_use]
    pub fn operator(&self) -> Option<(ViewerId, u32)> {
        self.lease.as_ref().map(|lease| (lease.holder, self.epoch))
    }

    /// Who asks the operator for control.
    #[must_use]
    pub fn asks(&self) -> Option<ViewerId> {
        self.asks.map(|(viewer, _)| viewer)
    }

    fn end_if_held(&mut self, viewer: ViewerId, why: Ended) -> Option<Ended> {
        let is_held = self
            .lease
            .as_ref()
            .is_some_and(|lease| lease.holder == viewer);
        is_held.then(|| self.end(why))
    }

    fn end(&mut self, why: Ended) -> Ended {
        self.lease = None;
        self.asks = None;
        why
    }
}

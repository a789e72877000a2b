//! Who may drive: the lease of the operator.

use std::{
    collections::{BTreeMap, VecDeque},
    time::Duration,
};

use motorlink_protocol::Instant;

use crate::wire::Stamp;

/// How long the lease of a page lasts after the newest challenge that it has answered was made.
pub const LEASE: Duration = Duration::from_millis(400);
/// How often each page is challenged: a lease survives three lost answers.
pub const CHALLENGES_EVERY: Duration = Duration::from_millis(100);
/// How long the lease of a controller lasts. It is on the same computer and answers with each setpoint: a controller of
/// 50 Hz may miss three. It is half of the time after which a silent motor is stopped.
pub const CONTROLLER_LEASE: Duration = Duration::from_millis(100);
/// How often each controller is challenged, so that its answers are new.
pub const CONTROLLER_CHALLENGES_EVERY: Duration = Duration::from_millis(10);
/// How often the operator's page sends its newest answer again. TCP notices that a packet is lost when it hears of later
/// ones. With the answers alone, two losses in a row end the lease on a good network; see docs/performance.md.
pub const ANSWER_AGAIN_EVERY: Duration = Duration::from_millis(25);
/// How old the challenge of an act of a page may be: as old as that of its lease.
pub const ACTS_WITHIN: Duration = LEASE;
/// How long after its question a page may take control without consent. The second click of a double click does not.
pub const FORCE_AFTER: Duration = Duration::from_secs(1);
/// How long a question stands while another page asks. Otherwise a page that asks once would keep all others from asking.
const ASKS_FOR: Duration = Duration::from_secs(5);
/// Pages at the same time. A class of thirty has a laptop and a phone each, and there is room for as many more.
pub const VIEWERS_MAX: usize = 128;
/// Controllers at the same time: one that drives, and some that watch.
pub const CONTROLLERS_MAX: usize = 8;

/// What takes part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Participant {
    /// A page, over a network: a person drives.
    Page,
    /// A program on the computer of the server, such as a controller of ROS 2.
    Controller,
}

impl Participant {
    /// How long its lease lasts after the newest challenge that it has answered was made. The challenge of an act may be
    /// as old.
    #[must_use]
    pub const fn lease(self) -> Duration {
        match self {
            Self::Page => LEASE,
            Self::Controller => CONTROLLER_LEASE,
        }
    }

    const fn challenges_every(self) -> Duration {
        match self {
            Self::Page => CHALLENGES_EVERY,
            Self::Controller => CONTROLLER_CHALLENGES_EVERY,
        }
    }

    const fn max(self) -> usize {
        match self {
            Self::Page => VIEWERS_MAX,
            Self::Controller => CONTROLLERS_MAX,
        }
    }
}

/// A page or a controller. Numbers are not used again.
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
    /// It holds the lease. If an earlier lease ended now, the server stops what that one drove.
    Granted(Option<Ended>),
    /// It holds it already.
    Held,
    /// Another one holds it, and is told who asks.
    Asked,
}

/// Why an act has no effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotDone {
    /// The page or controller does not hold the lease, or the act is of an earlier one.
    NotOperator,
    /// The act, or a later one, was done before.
    OutOfOrder,
    /// Its challenge is too old, or was never made.
    Late,
}

/// The pages and controllers, and the lease of one of them.
#[derive(Debug, Default)]
pub struct Control {
    members: BTreeMap<ViewerId, Member>,
    members_ever: u32,
    /// The number of the newest lease.
    epoch: u32,
    lease: Option<Lease>,
    /// Who asks for control, and since when.
    asks: Option<(ViewerId, Instant)>,
    /// When a viewer without the lease has stopped motors.
    stopped: Option<Instant>,
}

#[derive(Debug)]
struct Member {
    kind: Participant,
    /// The challenges of the time of a lease, oldest first, and when they were made.
    challenges: VecDeque<(u64, Instant)>,
    next_challenge: Instant,
}

impl Member {
    fn made_at(&self, challenge: u64) -> Option<Instant> {
        let found = self.challenges.iter().find(|(made, _)| *made == challenge);
        found.map(|(_, at)| *at)
    }

    fn forget_old(&mut self, now: Instant) {
        while self
            .challenges
            .front()
            .is_some_and(|(_, at)| *at + self.kind.lease() < now)
        {
            self.challenges.pop_front();
        }
    }
}

#[derive(Debug)]
struct Lease {
    holder: ViewerId,
    /// How long it lasts without an answer.
    lasts: Duration,
    /// The number of the last act.
    sequence: u32,
    /// When the newest challenge that was answered was made.
    renewed: Instant,
}

impl Lease {
    fn ends(&self) -> Instant {
        self.renewed + self.lasts
    }
}

impl Control {
    /// A page or a controller has connected. Returns nothing if there are too many of its kind.
    pub fn join(&mut self, now: Instant, kind: Participant) -> Option<ViewerId> {
        let alike = self.members.values().filter(|member| member.kind == kind);
        if alike.count() >= kind.max() {
            return None;
        }
        self.members_ever += 1;
        let viewer = ViewerId(self.members_ever);
        let member = Member {
            kind,
            challenges: VecDeque::new(),
            next_challenge: now,
        };
        self.members.insert(viewer, member);
        Some(viewer)
    }

    /// A page or a controller has gone.
    pub fn leave(&mut self, viewer: ViewerId) -> Option<Ended> {
        self.members.remove(&viewer);
        self.asks.take_if(|(asks, _)| *asks == viewer);
        self.end_if_held(viewer, Ended::Gone)
    }

    /// Every page and every controller.
    pub fn viewers(&self) -> impl Iterator<Item = ViewerId> {
        self.members.keys().copied()
    }

    /// Those whose challenge is due, each with a number that nobody can guess in advance.
    pub fn challenge(
        &mut self,
        now: Instant,
        mut number: impl FnMut() -> Option<u64>,
    ) -> Vec<(ViewerId, u64)> {
        let mut challenged = Vec::new();
        for (viewer, member) in &mut self.members {
            if member.next_challenge <= now {
                member.forget_old(now);
                member.next_challenge = now + member.kind.challenges_every();
                if let Some(challenge) = number() {
                    member.challenges.push_back((challenge, now));
                    challenged.push((*viewer, challenge));
                }
            }
        }
        challenged
    }

    /// A page or a controller has answered a challenge.
    pub fn answer(&mut self, now: Instant, viewer: ViewerId, challenge: u64) {
        // A lease that has ended by now is not renewed.
        if let Some(made_at) = self.made_at(viewer, challenge)
            && let Some(lease) = &mut self.lease
            && lease.holder == viewer
            && now <= lease.ends()
        {
            lease.renewed = lease.renewed.max(made_at);
        }
    }

    /// Ends a lease that was not renewed.
    pub fn expire(&mut self, now: Instant) -> Option<Ended> {
        let lease = self.lease.as_ref()?;
        let is_over = lease.ends() < now;
        is_over.then(|| self.end(Ended::Silent))
    }

    /// When the lease ends, or a challenge is due.
    #[must_use]
    pub fn next_turn(&self) -> Option<Instant> {
        let ends = self.lease.iter().map(Lease::ends);
        let challenges = self.members.values().map(|member| member.next_challenge);
        ends.chain(challenges).min()
    }

    /// A page or a controller asks for control.
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
        let kind = self.members.get(&viewer).map(|member| member.kind);
        self.epoch += 1;
        self.lease = Some(Lease {
            holder: viewer,
            // One that has gone keeps it for the shorter time.
            lasts: kind.unwrap_or(Participant::Controller).lease(),
            sequence: 0,
            renewed: now,
        });
        Taken::Granted(ended)
    }

    /// A controller takes control by the act that starts its motors. It does not take it from another one.
    ///
    /// # Errors
    /// [`NotDone::Late`]: its challenge is too old, was never made, or is from before a stop by another one.
    pub fn arm(
        &mut self,
        now: Instant,
        viewer: ViewerId,
        challenge: u64,
    ) -> Result<Taken, NotDone> {
        self.check_known(now, viewer, challenge, true)?;
        Ok(self.take(now, viewer, false))
    }

    /// The operator gives up control.
    pub fn give_up(&mut self, viewer: ViewerId) -> Option<Ended> {
        self.end_if_held(viewer, Ended::GivenUp)
    }

    /// A viewer without the lease has stopped motors. An act whose challenge is older than this stop starts none.
    pub const fn stopped_by_other(&mut self, now: Instant) {
        self.stopped = Some(now);
    }

    /// Whether this one holds the lease with this number.
    #[must_use]
    pub fn holds(&self, now: Instant, viewer: ViewerId, epoch: u32) -> bool {
        let is_live = |lease: &Lease| lease.holder == viewer && now <= lease.ends();
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
        let known = self.check_known(now, viewer, stamp.challenge, starts);
        let lease = self.lease.as_mut().ok_or(NotDone::NotOperator)?;
        if stamp.sequence <= lease.sequence {
            return Err(NotDone::OutOfOrder);
        }
        // A late act counts too: an earlier one behind it is out of order.
        lease.sequence = stamp.sequence;
        known
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

    /// Whether the challenge of an act is new enough and, if the act `starts` something, from after the newest stop by
    /// another one.
    fn check_known(
        &self,
        now: Instant,
        viewer: ViewerId,
        challenge: u64,
        starts: bool,
    ) -> Result<(), NotDone> {
        let member = self.members.get(&viewer).ok_or(NotDone::Late)?;
        let made_at = member.made_at(challenge);
        let is_new = made_at.is_some_and(|made_at| now <= made_at + member.kind.lease());
        let knows_stop = !starts || made_at > self.stopped;
        if is_new && knows_stop {
            Ok(())
        } else {
            Err(NotDone::Late)
        }
    }

    fn made_at(&self, viewer: ViewerId, challenge: u64) -> Option<Instant> {
        self.members.get(&viewer)?.made_at(challenge)
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

//! The lease on networks that fail: delays, losses, copies, another order, cuts, frozen pages and pages that die. One seed
//! repeats one world.
#![cfg(test)]

use std::{
    collections::{BTreeMap, BTreeSet},
    time::Duration,
};

use motorlink_protocol::Instant;
use motorlink_remote::{Control, Participant, Stamp, Taken, ViewerId};

const SEEDS: u64 = 10_000;
/// How long the network fails. Then it is good.
const FAILS_MS: u64 = 4_000;
/// How long it is good.
const GOOD_MS: u64 = 10_200;
/// A step of the time.
const STEP_MS: u64 = 2;

/// A way in which the server forgets a part of the lease. The rules must notice it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sabotage {
    /// A lease that is not renewed goes on.
    NeverEnds,
    /// Every act of the operator is done.
    ChecksNoStamp,
    /// Acts are done for a page that has lost its lease.
    AnyPage,
    /// Nothing is granted while a page had the lease once.
    GrantsOnce,
}

#[derive(Clone, Copy, Debug)]
enum Message {
    Challenge(u64),
    Granted(u32),
    Answer(u64),
    Take(bool),
    /// A controller takes control on this challenge.
    Arm(u64),
    Act(Stamp, /* done at */ Instant),
}

/// A message on its way.
#[derive(Clone, Copy, Debug)]
struct Sent {
    arrives: Instant,
    viewer: ViewerId,
    message: Message,
}

/// A page or a controller as the test plays it: it answers at once unless it is frozen, and acts as soon as it believes to
/// be the operator.
struct Page {
    viewer: ViewerId,
    kind: Participant,
    challenge: Option<u64>,
    epoch: Option<u32>,
    sequence: u32,
    frozen_until: Instant,
    is_dead: bool,
    /// What arrived while it was frozen.
    waiting: Vec<Message>,
}

struct World {
    random: fastrand::Rng,
    sabotage: Option<Sabotage>,
    control: Control,
    now: Instant,
    pages: Vec<Page>,
    network: Vec<Sent>,
    is_good: bool,
    cut_until: Instant,
    was_granted: bool,
    /// Whether the wheel is driven, and by whom.
    driven_by: Option<ViewerId>,
    /// What the rules know without the lease: who was granted it and when, and which challenges were made and answered.
    granted: Option<(ViewerId, Instant)>,
    made: Vec<(ViewerId, u64, Instant)>,
    /// When the newest challenge that each has answered was made.
    answered: BTreeMap<ViewerId, Instant>,
    done: BTreeSet<(u32, u32)>,
    last_done: (u32, u32),
    acts_done: u32,
}

impl World {
    fn new(seed: u64, sabotage: Option<Sabotage>) -> Self {
        let mut control = Control::default();
        let now = Instant::from_millis(1_000);
        let mut page = |kind| Page {
            viewer: control.join(now, kind).unwrap(),
            kind,
            challenge: None,
            epoch: None,
            sequence: 0,
            frozen_until: Instant::ZERO,
            is_dead: false,
            waiting: Vec::new(),
        };
        let kinds = [Participant::Page; 3].into_iter();
        let pages = kinds.chain([Participant::Controller]).map(&mut page);
        let pages = pages.collect();
        Self {
            random: fastrand::Rng::with_seed(seed),
            sabotage,
            control,
            now,
            pages,
            network: Vec::new(),
            is_good: false,
            cut_until: Instant::ZERO,
            was_granted: false,
            driven_by: None,
            granted: None,
            made: Vec::new(),
            answered: BTreeMap::new(),
            done: BTreeSet::new(),
            last_done: (0, 0),
            acts_done: 0,
        }
    }

    fn chance(&mut self, percent: u32) -> bool {
        !self.is_good && self.random.u32(0..100) < percent
    }

    /// Sends a message: late, never or twice, each copy with a delay of its own.
    fn send(&mut self, viewer: ViewerId, message: Message) {
        let copies = 1 + u32::from(self.chance(5));
        for _ in 0..copies {
            if self.now < self.cut_until || self.chance(5) {
                continue;
            }
            let longest = if self.chance(3) {
                2_000
            } else if self.is_good {
                20
            } else {
                120
            };
            let delay = Duration::from_millis(self.random.u64(1..=longest));
            self.network.push(Sent {
                arrives: self.now + delay,
                viewer,
                message,
            });
        }
    }

    fn step(&mut self) -> Result<(), String> {
        self.now = self.now + Duration::from_millis(STEP_MS);
        if self.sabotage != Some(Sabotage::NeverEnds) && self.control.expire(self.now).is_some() {
            self.driven_by = None;
        }
        let random = &mut self.random;
        let challenged = self.control.challenge(self.now, || Some(random.u64(..)));
        for (viewer, challenge) in challenged {
            self.made.push((viewer, challenge, self.now));
            self.send(viewer, Message::Challenge(challenge));
        }
        let now = self.now;
        let arrived: Vec<Sent> = self
            .network
            .extract_if(.., |sent| sent.arrives <= now)
            .collect();
        for sent in arrived {
            match sent.message {
                Message::Challenge(_) | Message::Granted(_) => self.receive(sent),
                Message::Answer(challenge) => self.answered(sent.viewer, challenge),
                Message::Take(by_force) => self.take(sent.viewer, by_force),
                Message::Arm(challenge) => self.arm(sent.viewer, challenge),
                Message::Act(stamp, done_at) => self.act(sent.viewer, stamp, done_at)?,
            }
        }
        self.play_pages();
        self.check_driven()
    }

    fn receive(&mut self, sent: Sent) {
        let now = self.now;
        let page = self
            .pages
            .iter_mut()
            .find(|page| page.viewer == sent.viewer);
        let page = page.unwrap();
        page.waiting.push(sent.message);
        if page.is_dead || now < page.frozen_until {
            return;
        }
        let viewer = page.viewer;
        let mut answers = Vec::new();
        for message in std::mem::take(&mut page.waiting) {
            match message {
                Message::Challenge(challenge) => {
                    page.challenge = Some(challenge);
                    answers.push(challenge);
                }
                // A copy, or one that was overtaken, is not new.
                Message::Granted(epoch) if page.epoch < Some(epoch) => {
                    page.epoch = Some(epoch);
                    page.sequence = 0;
                }
                _ => {}
            }
        }
        for challenge in answers {
            self.send(viewer, Message::Answer(challenge));
        }
    }

    fn play_pages(&mut self) {
        if self.chance(1) && self.random.u32(0..4) == 0 {
            self.cut_until = self.now + Duration::from_millis(self.random.u64(50..1_500));
        }
        for index in 0..self.pages.len() {
            let freezes = self.random.u32(0..1_000) < 2 && !self.is_good;
            let dies = self.random.u32(0..20_000) == 0 && !self.is_good;
            let frozen_for = Duration::from_millis(self.random.u64(50..2_000));
            let takes = self.random.u32(0..300) == 0;
            let acts = self.random.u32(0..if self.is_good { 4 } else { 40 }) == 0;
            let by_force = self.random.bool();
            let now = self.now;
            let page = &mut self.pages[index];
            if freezes {
                page.frozen_until = now + frozen_for;
            }
            page.is_dead |= dies;
            if page.is_dead || now < page.frozen_until {
                continue;
            }
            let viewer = page.viewer;
            let mut act = None;
            if let (Some(epoch), Some(challenge), true) = (page.epoch, page.challenge, acts) {
                page.sequence += 1;
                act = Some(Stamp {
                    epoch,
                    sequence: page.sequence,
                    challenge,
                });
            }
            let take = match (page.kind, page.challenge) {
                (Participant::Page, _) => Some(Message::Take(by_force)),
                (Participant::Controller, challenge) => challenge.map(Message::Arm),
            };
            if let Some(take) = take.filter(|_| takes && !self.is_good) {
                self.send(viewer, take);
            }
            if let Some(stamp) = act {
                self.send(viewer, Message::Act(stamp, now));
            }
        }
    }

    fn answered(&mut self, viewer: ViewerId, challenge: u64) {
        let made = self
            .made
            .iter()
            .rev()
            .find(|(to, made, _)| (*to, *made) == (viewer, challenge));
        if let Some((_, _, at)) = made {
            let newest = self.answered.entry(viewer).or_insert(*at);
            *newest = (*newest).max(*at);
        }
        self.control.answer(self.now, viewer, challenge);
    }

    fn take(&mut self, viewer: ViewerId, by_force: bool) {
        if self.was_granted && self.sabotage == Some(Sabotage::GrantsOnce) {
            return;
        }
        let taken = self.control.take(self.now, viewer, by_force);
        self.taken(viewer, taken);
    }

    fn arm(&mut self, viewer: ViewerId, challenge: u64) {
        if self.was_granted && self.sabotage == Some(Sabotage::GrantsOnce) {
            return;
        }
        if let Ok(taken) = self.control.arm(self.now, viewer, challenge) {
            self.taken(viewer, taken);
        }
    }

    fn taken(&mut self, viewer: ViewerId, taken: Taken) {
        match taken {
            Taken::Granted(ended) => {
                if ended.is_some() {
                    self.driven_by = None;
                }
                self.was_granted = true;
                self.granted = Some((viewer, self.now));
            }
            // It is told again.
            Taken::Held => {}
            Taken::Asked => return,
        }
        let (_, epoch) = self.control.operator().unwrap();
        self.send(viewer, Message::Granted(epoch));
    }

    fn act(&mut self, viewer: ViewerId, stamp: Stamp, done_at: Instant) -> Result<(), String> {
        let mut done = self.control.act(self.now, viewer, stamp, true);
        let is_operator = self
            .control
            .operator()
            .is_some_and(|(holder, _)| holder == viewer);
        let passes = match self.sabotage {
            Some(Sabotage::ChecksNoStamp) => is_operator,
            Some(Sabotage::AnyPage) => true,
            _ => false,
        };
        if passes {
            done = Ok(());
        }
        if done.is_err() {
            return Ok(());
        }
        if self.granted.is_none_or(|(holder, _)| holder != viewer) {
            return Err("an act of a page that is not the newest operator".to_owned());
        }
        let age = self.now.since(done_at);
        if age > self.kind(viewer).lease() {
            return Err(format!("an act was done {age:?} late"));
        }
        if !self.done.insert((stamp.epoch, stamp.sequence)) {
            return Err("an act was done twice".to_owned());
        }
        if (stamp.epoch, stamp.sequence) < self.last_done {
            return Err("acts were done in another order".to_owned());
        }
        self.last_done = (stamp.epoch, stamp.sequence);
        self.acts_done += 1;
        self.driven_by = Some(viewer);
        Ok(())
    }

    fn kind(&self, viewer: ViewerId) -> Participant {
        let page = self.pages.iter().find(|page| page.viewer == viewer);
        page.unwrap().kind
    }

    /// A wheel that is driven has an operator who answered a challenge of the time of its lease, or was granted control
    /// then.
    fn check_driven(&self) -> Result<(), String> {
        let Some(driver) = self.driven_by else {
            return Ok(());
        };
        // The lease is looked at once in each step.
        let since = |at: Instant| self.now.since(at);
        let bound = self.kind(driver).lease() + Duration::from_millis(STEP_MS);
        let granted = self.granted.filter(|(viewer, _)| *viewer == driver);
        let is_new = granted.is_some_and(|(_, at)| since(at) <= bound);
        let answered = self.answered.get(&driver);
        let is_renewed = answered.is_some_and(|at| since(*at) <= bound);
        if is_new || is_renewed {
            Ok(())
        } else {
            Err("driven without an operator who answers".to_owned())
        }
    }

    /// A good network at the end: a page that asks drives.
    fn check_recovers(&mut self) -> Result<(), String> {
        self.is_good = true;
        self.cut_until = Instant::ZERO;
        for page in &mut self.pages {
            page.frozen_until = Instant::ZERO;
            page.is_dead = false;
        }
        let viewer = self.pages[0].viewer;
        let mut acts_before = None;
        for step in 0..GOOD_MS / STEP_MS {
            // What was sent earlier has arrived by now. The first question may be one of several.
            if (step * STEP_MS).is_multiple_of(1_200) && step > 0 {
                self.send(viewer, Message::Take(true));
            }
            if step * STEP_MS == 9_600 {
                acts_before = Some(self.acts_done);
            }
            self.step()?;
        }
        let is_operator = self
            .control
            .operator()
            .is_some_and(|(holder, _)| holder == viewer);
        if is_operator && acts_before.is_some_and(|before| self.acts_done > before) {
            Ok(())
        } else {
            Err("a page that asked on a good network does not drive".to_owned())
        }
    }
}

/// Plays one world.
fn play(seed: u64, sabotage: Option<Sabotage>) -> Result<u32, String> {
    let mut world = World::new(seed, sabotage);
    for _ in 0..FAILS_MS / STEP_MS {
        world.step()?;
    }
    let acts = world.acts_done;
    world.check_recovers()?;
    Ok(acts)
}

#[test]
fn no_network_drives_a_wheel_without_its_operator() {
    let mut acts = 0;
    for seed in 0..SEEDS {
        match play(seed, None) {
            Ok(done) => acts += u64::from(done),
            Err(broken) => panic!("seed {seed}: {broken}"),
        }
    }
    // Otherwise the worlds show nothing.
    assert!(acts > 5 * SEEDS, "{acts} acts in {SEEDS} worlds");
}

#[test]
fn the_rules_notice_a_lease_that_forgets_a_part() {
    for sabotage in [
        Sabotage::NeverEnds,
        Sabotage::ChecksNoStamp,
        Sabotage::AnyPage,
        Sabotage::GrantsOnce,
    ] {
        let broken = (0..200)
            .filter(|seed| play(*seed, Some(sabotage)).is_err())
            .count();
        assert!(broken > 10, "{sabotage:?}: {broken} of 200");
    }
}

//! The reports and setpoints of every motor over the last minutes, in plain buffers: written with every reply,
//! read by the drawing code.

use std::{collections::VecDeque, rc::Rc, time::Duration};

use motorlink_messages::{
    Adapter, Connection, Update,
    bus::{Activity, Sample},
    protocol::{Instant, MotorId, Setpoint},
    sessions::ActivityChange,
};

pub(crate) use crate::model::point::Point;

/// How long points are kept.
const KEPT_FOR: Duration = Duration::from_secs(600);

/// Maximal points per motor. A line carries no more in ten minutes: ten bytes each way take 868 us at
/// 115200 baud, so all motors together send at most 576 replies a second. 5.5 MB.
const POINTS_MAX: usize = 600 * 576;

/// Maximal changes of the goal per motor: one per frame of the screen for ten minutes, as with a slider that
/// is dragged all the time. 600 KB.
const GOALS_MAX: usize = 600 * 60;

/// Maximal number of connections: one a second for ten minutes.
const CUTS_MAX: usize = 600;

/// The worker's zero on the clock of the history: a thousand million seconds, so that earlier sessions have
/// positive times, and microseconds are exact in a double.
pub(crate) const ZERO_US: u64 = 1_000_000_000_000_000;

/// A longer time without a reply is a gap: what the motor did is unknown. It is queried ten times a second.
const GAP_US: u64 = 1_000_000;

/// A goal, from this time on; `None` if the motor is not driven.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct GoalChange {
    pub(crate) at: Instant,
    pub(crate) goal: Option<Setpoint>,
}

/// The history of one motor, oldest first.
#[derive(Clone, Debug, Default)]
pub(crate) struct Track {
    points: VecDeque<Point>,
    goals: VecDeque<GoalChange>,
}

impl Track {
    pub(crate) fn oldest(&self) -> Option<&Point> {
        self.points.front()
    }

    pub(crate) fn newest(&self) -> Option<&Point> {
        self.points.back()
    }

    /// The points within a period, and one point on either side, for the lines that cross its edges. In two
    /// consecutive slices.
    pub(crate) fn between(&self, from: Instant, to: Instant) -> [&[Point]; 2] {
        let first = self.points.partition_point(|point| point.at < from);
        let end = self.points.partition_point(|point| point.at < to);
        let end = (end + 1).min(self.points.len());
        let first = first.saturating_sub(1).min(end);
        let (older, newer) = self.points.as_slices();
        // Empty for a slice outside of the period.
        let part = |piece: &'_ [Point], begins: usize| {
            let at = |place: usize| place.saturating_sub(begins).min(piece.len());
            at(first)..at(end)
        };
        let (in_older, in_newer) = (part(older, 0), part(newer, older.len()));
        [
            older.get(in_older).unwrap_or_default(),
            newer.get(in_newer).unwrap_or_default(),
        ]
    }

    /// The points before a time, latest first, and those from it on, oldest first.
    pub(crate) fn around(
        &self,
        at: Instant,
    ) -> (impl Iterator<Item = &Point>, impl Iterator<Item = &Point>) {
        let place = self.points.partition_point(|point| point.at < at);
        (self.points.range(..place).rev(), self.points.range(place..))
    }

    /// The goal at a time.
    pub(crate) fn goal_at(&self, at: Instant) -> Option<Setpoint> {
        let place = self.goals.partition_point(|change| change.at <= at);
        self.goals.get(place.checked_sub(1)?)?.goal
    }

    /// Every change of the goal.
    pub(crate) fn goals(&self) -> impl Iterator<Item = &GoalChange> {
        self.goals.iter()
    }

    /// The changes of the goal within a period, and the one before it.
    pub(crate) fn goals_between(
        &self,
        from: Instant,
        to: Instant,
    ) -> impl Iterator<Item = &GoalChange> {
        let first = self.goals.partition_point(|change| change.at < from);
        let end = self.goals.partition_point(|change| change.at < to);
        self.goals.range(first.saturating_sub(1)..end)
    }

    /// Adds a reply. Replies arrive in order of time; an older one is skipped.
    fn take(&mut self, point: Point) {
        if self.newest().is_some_and(|newest| point.at < newest.at) {
            return;
        }
        if self.points.len() == POINTS_MAX {
            self.points.pop_front();
        }
        self.points.push_back(point);
        while self
            .oldest()
            .is_some_and(|oldest| point.at.since(oldest.at) > KEPT_FOR)
        {
            self.points.pop_front();
        }
    }

    /// Adds a restored point. They arrive newest first; one that is not older is skipped.
    fn recall(&mut self, point: Point) {
        let is_older = self.oldest().is_none_or(|oldest| point.at <= oldest.at);
        let is_kept = self
            .newest()
            .is_none_or(|newest| newest.at.since(point.at) <= KEPT_FOR);
        if is_older && is_kept && self.points.len() < POINTS_MAX {
            self.points.push_front(point);
        }
    }

    /// Adds restored changes of the goal, newest first, before the known ones.
    fn recall_goal(&mut self, change: GoalChange) {
        let is_full = self.goals.len() == GOALS_MAX;
        if let Some(oldest) = self.goals.front_mut() {
            if is_full || oldest.at <= change.at {
                return;
            }
            if oldest.goal == change.goal {
                oldest.at = change.at;
                return;
            }
        }
        self.goals.push_front(change);
    }

    fn set_goal(&mut self, at: Instant, goal: Option<Setpoint>) {
        if self.goals.back().and_then(|change| change.goal) == goal {
            return;
        }
        if self.goals.len() == GOALS_MAX {
            self.goals.pop_front();
        }
        self.goals.push_back(GoalChange { at, goal });
        // The last of the old ones is the goal at the start of the kept time.
        while self
            .goals
            .get(1)
            .is_some_and(|change| at.since(change.at) > KEPT_FOR)
        {
            self.goals.pop_front();
        }
    }
}

/// Called with every update, and without one when what is there is replaced or gets older replies.
pub(crate) type Waker = Rc<dyn Fn(Option<&Update>)>;

/// The history of every motor.
#[derive(Default)]
pub(crate) struct History {
    /// The worker's zero on the clock of the history, in microseconds.
    zero_us: u64,
    /// Number of restored parts.
    recalled: u32,
    tracks: Vec<(MotorId, Track)>,
    /// The first reply of every later connection: lines do not join across it.
    cuts: VecDeque<Instant>,
    /// Whether the next reply is the first of a connection.
    cut_pending: bool,
    connected: bool,
    /// What was connected last.
    adapter: Option<Adapter>,
    /// Wakes the animation loop, which sleeps while nothing changes.
    wake: Option<Waker>,
}

impl History {
    /// A history with room for restored sessions.
    pub(crate) fn with_past() -> Self {
        Self {
            zero_us: ZERO_US,
            ..Self::default()
        }
    }

    /// Shows another history in the same graph, and returns this one.
    pub(crate) fn exchange(&mut self, other: Self) -> Self {
        let next = Self {
            recalled: self.recalled.wrapping_add(1),
            wake: self.wake.clone(),
            ..other
        };
        let before = std::mem::replace(self, next);
        self.wake();
        before
    }

    /// The history of one motor alone, if it has reported.
    pub(crate) fn copy_of(&self, id: MotorId) -> Option<Self> {
        let track = self.track(id).filter(|track| track.newest().is_some())?;
        Some(Self {
            zero_us: self.zero_us,
            tracks: vec![(id, track.clone())],
            cuts: self.cuts.clone(),
            ..Self::default()
        })
    }

    fn wake(&self) {
        if let Some(wake) = &self.wake {
            wake(None);
        }
    }

    /// Converts a time of the worker to the clock of the history.
    const fn at(&self, instant: Instant) -> Instant {
        Instant::from_micros(self.zero_us.saturating_add(instant.as_micros()))
    }

    /// Begins restoring by [`recall`](Self::recall): lines do not join restored and present points.
    pub(crate) fn begin_past(&mut self) {
        let oldest = self.tracks.iter().filter_map(|(_, track)| track.oldest());
        if let Some(oldest) = oldest.map(|point| point.at).min() {
            self.cuts.push_front(oldest);
        }
    }

    /// Adds restored samples: each part is older than the one before, and oldest first in itself. The zero of
    /// their times is this much later than the worker's.
    pub(crate) fn recall(&mut self, zero_us: i64, samples: &[Sample]) {
        for Sample { at, reply } in samples.iter().rev() {
            let at_us = self.at(*at).as_micros().saturating_add_signed(zero_us);
            let point = Point::of(Instant::from_micros(at_us), reply);
            self.on_track(reply.id, |track| track.recall(point));
        }
        self.recalled = self.recalled.wrapping_add(1);
        self.wake();
    }

    /// Adds what motors did before a jump in a recording, oldest first.
    pub(crate) fn recall_goals(&mut self, changes: &[ActivityChange]) {
        for change in changes.iter().rev() {
            let (at, goal) = (self.at(change.at), goal(change.activity));
            self.on_track(change.id, |track| {
                track.recall_goal(GoalChange { at, goal });
            });
        }
        self.recalled = self.recalled.wrapping_add(1);
        self.wake();
    }

    /// Changes whenever samples were restored.
    pub(crate) const fn recalled(&self) -> u32 {
        self.recalled
    }

    /// Adds an update of the worker.
    pub(crate) fn take(&mut self, update: &Update) {
        let now = self.at(update.now);
        match update.connection {
            Connection::Connected(adapter) => {
                self.cut_pending |= !self.connected;
                self.connected = true;
                let before = self.adapter.replace(adapter);
                if before.is_some_and(|before| before != adapter) {
                    // Motors of two lines are not drawn as one.
                    self.tracks.clear();
                    self.recalled = self.recalled.wrapping_add(1);
                    self.wake();
                }
            }
            _ => self.end(update.now),
        }
        for sample in &update.samples {
            self.take_sample(sample);
        }
        for motor in &update.motors {
            let goal = goal(motor.activity);
            if goal.is_some() || self.track(motor.id).is_some() {
                self.on_track(motor.id, |track| track.set_goal(now, goal));
            }
        }
        if let Some(wake) = &self.wake {
            wake(Some(update));
        }
    }

    /// The connection has ended: no motor has a goal.
    pub(crate) fn end(&mut self, at: Instant) {
        if self.connected {
            self.connected = false;
            let at = self.at(at);
            for (_, track) in &mut self.tracks {
                track.set_goal(at, None);
            }
        }
    }

    /// Calls `wake` as [`Waker`] says. It must not access the history.
    pub(crate) fn on_new_data(&mut self, wake: Waker) {
        self.wake = Some(wake);
    }

    pub(crate) fn track(&self, id: MotorId) -> Option<&Track> {
        let (_, track) = self.tracks.iter().find(|(of, _)| *of == id)?;
        Some(track)
    }

    /// All motors that have reported, in no order.
    pub(crate) fn reported(&self) -> Vec<MotorId> {
        let tracks = self.tracks.iter();
        let reported = tracks.filter(|(_, track)| track.newest().is_some());
        reported.map(|(id, _)| *id).collect()
    }

    /// Whether there is a gap between two consecutive replies.
    pub(crate) fn is_gap(&self, from: Instant, to: Instant) -> bool {
        // In whole microseconds, because it is called for every reply in every drawn frame.
        to.as_micros().saturating_sub(from.as_micros()) > GAP_US
            || (!self.cuts.is_empty() && self.is_cut(from, to))
    }

    fn is_cut(&self, from: Instant, to: Instant) -> bool {
        let next = self.cuts.partition_point(|cut| *cut <= from);
        self.cuts.get(next).is_some_and(|cut| *cut <= to)
    }

    fn take_sample(&mut self, sample: &Sample) {
        let point = Point::of(self.at(sample.at), &sample.reply);
        if std::mem::take(&mut self.cut_pending) && !self.tracks.is_empty() {
            if self.cuts.len() == CUTS_MAX {
                self.cuts.pop_front();
            }
            self.cuts.push_back(point.at);
        }
        self.on_track(sample.reply.id, |track| track.take(point));
        while self
            .cuts
            .front()
            .is_some_and(|cut| point.at.since(*cut) > KEPT_FOR)
        {
            self.cuts.pop_front();
        }
    }

    /// Calls `change` with the history of a motor, which is empty for a new one.
    fn on_track(&mut self, id: MotorId, change: impl FnOnce(&mut Track)) {
        if let Some((_, track)) = self.tracks.iter_mut().find(|(of, _)| *of == id) {
            change(track);
        } else {
            let mut track = Track::default();
            change(&mut track);
            self.tracks.push((id, track));
        }
    }
}

/// The goal of an activity. The goal of a stop is the brake.
fn goal(activity: Activity) -> Option<Setpoint> {
    match activity {
        Activity::Driven { setpoint } => Some(setpoint),
        Activity::Stopping { .. } => Some(Setpoint::Brake),
        // A raw frame may have any setpoint.
        Activity::Idle | Activity::Switching { .. } | Activity::DrivenRaw => None,
    }
}

#[cfg(test)]
#[path = "history_tests.rs"]
pub(crate) mod tests;

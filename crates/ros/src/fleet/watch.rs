//! Which robots are known, and for how long nothing came from each. What comes from the network is not trusted: what is no state is
//! counted, and the rest is bounded.

use std::{
    cmp::Reverse,
    collections::{BTreeMap, BTreeSet},
    time::{Duration, Instant},
};

use serde::Serialize;

use super::{
    names::{RobotName, of_state, of_token},
    state::RobotState,
};
use crate::status::Level;

/// A state that is older tells nothing about now: ten are missing.
pub const HEARD_FOR: Duration = Duration::from_secs(1);
/// Robots that are known at most.
pub const ROBOTS_MAX: usize = 10_000;
/// A robot that has gone for so long gives its place to others, and to its own next session.
const KEPT: Duration = Duration::from_secs(60);

/// All robots that were heard.
#[derive(Debug, Default)]
pub struct Watch {
    /// By name and session: two robots may have one name.
    robots: BTreeMap<(RobotName, String), Robot>,
    ignored: u64,
}

#[derive(Debug)]
struct Robot {
    /// Its token is there.
    is_alive: bool,
    /// When something came from it.
    seen: Instant,
    newest: Option<(Instant, RobotState)>,
}

/// A robot as it is now.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Of the robot.
    pub name: String,
    /// Of its Zenoh session.
    pub session: String,
    /// Of its newest state. Absent if none was heard.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub age_ms: Option<u64>,
    /// Its state is that of now.
    pub heard: bool,
    /// Only if it is heard.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub state: Option<RobotState>,
}

impl Row {
    /// How bad it is. A robot that is not heard is stale.
    #[must_use]
    pub fn level(&self) -> Level {
        self.state
            .as_ref()
            .map_or(Level::Stale, |state| state.level)
    }
}

impl Watch {
    /// Takes what was published.
    pub fn take_state(&mut self, now: Instant, key: &str, bytes: &[u8]) {
        let Some((name, state)) = of_state(key).zip(RobotState::read(bytes)) else {
            self.ignored += 1;
            return;
        };
        if let Some(robot) = self.robot(now, name, &state.session) {
            // What comes late tells nothing about now.
            let is_newer = |(_, newest): &(Instant, RobotState)| state.number > newest.number;
            if robot.newest.as_ref().is_none_or(is_newer) {
                robot.newest = Some((now, state));
            }
        }
    }

    /// Takes the coming or going of a token.
    pub fn take_token(&mut self, now: Instant, key: &str, is_alive: bool) {
        let Some((name, session)) = of_token(key) else {
            self.ignored += 1;
            return;
        };
        if let Some(robot) = self.robot(now, name, session) {
            robot.is_alive = is_alive;
        }
    }

    /// That of this name and session, if there is a place for it.
    fn robot(&mut self, now: Instant, name: RobotName, session: &str) -> Option<&mut Robot> {
        let key = (name, session.to_owned());
        if self.robots.len() >= ROBOTS_MAX && !self.robots.contains_key(&key) {
            self.ignored += 1;
            return None;
        }
        let robot = self.robots.entry(key).or_insert(Robot {
            is_alive: false,
            seen: now,
            newest: None,
        });
        robot.seen = now;
        Some(robot)
    }

    /// Messages that were no valid state.
    #[must_use]
    pub const fn ignored(&self) -> u64 {
        self.ignored
    }

    /// All robots, problems first, then by name. Call it once a second: it also forgets.
    pub fn rows(&mut self, now: Instant) -> Vec<Row> {
        self.forget(now);
        let mut rows: Vec<Row> = self
            .robots
            .iter()
            .map(|((name, session), robot)| {
                let heard = robot.is_heard(now);
                let newest = robot.newest.as_ref();
                let age = newest.map(|(at, _)| now.saturating_duration_since(*at));
                let millis = |age: Duration| u64::try_from(age.as_millis()).unwrap_or(u64::MAX);
                Row {
                    name: name.to_string(),
                    session: session.clone(),
                    age_ms: age.map(millis),
                    heard,
                    state: newest.filter(|_| heard).map(|(_, state)| state.clone()),
                }
            })
            .collect();
        // They are sorted by name already.
        rows.sort_by_key(|row| Reverse(row.level()));
        rows
    }

    /// Forgets robots that have gone, where another session has their name or where the places are taken.
    fn forget(&mut self, now: Instant) {
        let heard = self.robots.iter().filter(|(_, robot)| robot.is_heard(now));
        let heard: BTreeSet<RobotName> = heard.map(|((name, _), _)| name.clone()).collect();
        let is_full = self.robots.len() >= ROBOTS_MAX;
        self.robots.retain(|(name, _), robot| {
            let is_gone = now.saturating_duration_since(robot.seen) > KEPT && !robot.is_heard(now);
            !is_gone || !is_full && !heard.contains(name)
        });
    }
}

impl Robot {
    fn is_heard(&self, now: Instant) -> bool {
        let newest = self.newest.as_ref();
        let is_new = newest.is_some_and(|(at, _)| now.saturating_duration_since(*at) <= HEARD_FOR);
        self.is_alive && is_new
    }
}

#[cfg(test)]
#[path = "watch_tests.rs"]
mod tests;

//! Scenarios of the lease, over virtual time.
#![cfg(test)]

use std::{collections::BTreeMap, time::Duration};

use motorlink_protocol::Instant;
use motorlink_remote::{
    CONTROLLERS_MAX, Control, Ended, NotDone, Participant, Stamp, Taken, VIEWERS_MAX, ViewerId,
};

/// A server, and the time.
struct Server {
    control: Control,
    now: Instant,
    challenges_ever: u64,
    /// The newest challenge of each page.
    newest: BTreeMap<ViewerId, u64>,
    sequence: u32,
}

impl Server {
    fn new() -> Self {
        Self {
            control: Control::default(),
            now: Instant::from_millis(5_000),
            challenges_ever: 0,
            newest: BTreeMap::new(),
            sequence: 0,
        }
    }

    fn join(&mut self) -> ViewerId {
        self.join_as(Participant::Page).unwrap()
    }

    fn join_as(&mut self, kind: Participant) -> Option<ViewerId> {
        self.control.join(self.now, kind)
    }

    /// Time passes; these pages answer each challenge at once. Returns the lease that ended.
    fn run(&mut self, ms: u64, answering: &[ViewerId]) -> Option<Ended> {
        let mut ended = None;
        for _ in 0..ms {
            self.now = self.now + Duration::from_millis(1);
            let ever = &mut self.challenges_ever;
            let challenged = self.control.challenge(self.now, || {
                *ever += 1;
                Some(*ever)
            });
            for (viewer, challenge) in challenged {
                self.newest.insert(viewer, challenge);
                if answering.contains(&viewer) {
                    self.control.answer(self.now, viewer, challenge);
                }
            }
            ended = ended.or(self.control.expire(self.now));
        }
        ended
    }

    fn take(&mut self, viewer: ViewerId, by_force: bool) -> Taken {
        self.control.take(self.now, viewer, by_force)
    }

    /// A controller arms, on its newest challenge.
    fn arm(&mut self, viewer: ViewerId) -> Result<Taken, NotDone> {
        let challenge = self.newest.get(&viewer).copied().unwrap_or_default();
        self.control.arm(self.now, viewer, challenge)
    }

    /// An act of this page, on its newest challenge.
    fn act(&mut self, viewer: ViewerId) -> Result<(), NotDone> {
        self.sequence += 1;
        let (_, epoch) = self.control.operator().ok_or(NotDone::NotOperator)?;
        let stamp = Stamp {
            epoch,
            sequence: self.sequence,
            challenge: self.newest.get(&viewer).copied().unwrap_or_default(),
        };
        self.control.act(self.now, viewer, stamp, true)
    }
}

#[test]
fn a_page_that_answers_drives_for_as_long_as_it_likes() {
    let mut server = Server::new();
    let page = server.join();
    assert_eq!(server.act(page), Err(NotDone::NotOperator));
    assert_eq!(server.take(page, false), Taken::Granted(None));
    for _ in 0..100 {
        assert_eq!(server.run(100, &[page]), None);
        assert_eq!(server.act(page), Ok(()));
    }
    assert_eq!(server.take(page, true), Taken::Held);
}

#[test]
fn a_lease_ends_400_ms_after_the_newest_answered_challenge_was_made() {
    let mut server = Server::new();
    let page = server.join();
    server.run(1_000, &[page]);
    server.take(page, false);
    server.run(1_000, &[page]);
    // The newest challenge is under 100 ms old.
    assert_eq!(server.run(300, &[]), None);
    assert_eq!(server.run(101, &[]), Some(Ended::Silent));
    assert_eq!(server.control.operator(), None);
}

#[test]
fn a_late_answer_does_not_bring_a_lease_back() {
    let mut server = Server::new();
    let page = server.join();
    server.take(page, false);
    assert_eq!(server.run(500, &[]), Some(Ended::Silent));
    assert_eq!(server.run(1_000, &[page]), None);
    assert_eq!(server.control.operator(), None);
    // Nor does one that comes before the server has noticed.
    server.take(page, false);
    server.run(1, &[]);
    server.now = server.now + Duration::from_millis(450);
    let newest = server.challenges_ever;
    server.control.answer(server.now, page, newest);
    assert_eq!(server.control.expire(server.now), Some(Ended::Silent));
}

#[test]
fn an_act_that_is_late_doubled_out_of_order_or_of_another_lease_has_no_effect() {
    let mut server = Server::new();
    let page = server.join();
    server.take(page, false);
    server.run(100, &[page]);
    let (_, epoch) = server.control.operator().unwrap();
    let stamp = |sequence, challenge| Stamp {
        epoch,
        sequence,
        challenge,
    };
    let old = server.challenges_ever;
    let act = |server: &mut Server, stamp| server.control.act(server.now, page, stamp, true);
    assert_eq!(act(&mut server, stamp(2, old)), Ok(()));
    assert_eq!(act(&mut server, stamp(2, old)), Err(NotDone::OutOfOrder));
    assert_eq!(act(&mut server, stamp(1, old)), Err(NotDone::OutOfOrder));
    server.run(450, &[page]);
    assert_eq!(act(&mut server, stamp(3, old)), Err(NotDone::Late));
    assert_eq!(act(&mut server, stamp(4, 999)), Err(NotDone::Late));
    let newest = server.challenges_ever;
    let of_another = Stamp {
        epoch: epoch - 1,
        ..stamp(5, newest)
    };
    assert_eq!(act(&mut server, of_another), Err(NotDone::NotOperator));
    assert_eq!(act(&mut server, stamp(5, newest)), Ok(()));
}

#[test]
fn another_page_takes_control_only_by_a_second_press_and_the_operator_knows_who_asks() {
    let mut server = Server::new();
    let (first, second) = (server.join(), server.join());
    server.take(first, false);
    server.run(200, &[first, second]);
    assert_eq!(server.take(second, false), Taken::Asked);
    assert_eq!(server.control.asks(), Some(second));
    assert_eq!(server.act(second), Err(NotDone::NotOperator));
    assert_eq!(server.act(first), Ok(()));
    // The second click of a double click, and another page that asks meanwhile.
    assert_eq!(server.take(second, true), Taken::Asked);
    let third = server.join();
    assert_eq!(server.take(third, true), Taken::Asked);
    server.run(1_000, &[first, second]);
    assert_eq!(server.take(third, true), Taken::Asked);
    assert_eq!(
        server.take(second, true),
        Taken::Granted(Some(Ended::Taken))
    );
    assert_eq!(server.act(first), Err(NotDone::NotOperator));
    server.sequence = 0;
    assert_eq!(server.act(second), Ok(()));
    assert_eq!(server.control.asks(), None);
}

#[test]
fn only_the_loss_of_the_operator_ends_the_lease() {
    let mut server = Server::new();
    let (operator, watcher) = (server.join(), server.join());
    server.take(operator, false);
    // The watcher answers nothing, asks, and goes.
    assert_eq!(server.run(2_000, &[operator]), None);
    server.take(watcher, false);
    assert_eq!(server.control.give_up(watcher), None);
    assert_eq!(server.control.leave(watcher), None);
    assert_eq!(server.control.asks(), None);
    assert_eq!(server.control.leave(operator), Some(Ended::Gone));
    let operator = server.join();
    server.take(operator, false);
    assert_eq!(server.control.give_up(operator), Some(Ended::GivenUp));
}

#[test]
fn pages_are_limited() {
    let mut server = Server::new();
    let pages: Vec<ViewerId> = (0..VIEWERS_MAX).map(|_| server.join()).collect();
    assert_eq!(server.join_as(Participant::Page), None);
    server.control.leave(pages[3]);
    let next = server.join();
    assert!(!pages.contains(&next));
    // However many pages there are, a controller has its place.
    for _ in 0..CONTROLLERS_MAX {
        assert!(server.join_as(Participant::Controller).is_some());
    }
    assert_eq!(server.join_as(Participant::Controller), None);
}

#[test]
fn what_the_operator_did_before_it_knew_of_a_stop_starts_nothing() {
    let mut server = Server::new();
    let page = server.join();
    server.take(page, false);
    server.run(150, &[page]);
    server.control.stopped_by_other(server.now);
    assert_eq!(server.act(page), Err(NotDone::Late));
    server.run(100, &[page]);
    assert_eq!(server.act(page), Ok(()));
}

#[test]
fn the_lease_of_a_controller_ends_100_ms_after_the_newest_answered_challenge_was_made() {
    let mut server = Server::new();
    let controller = server.join_as(Participant::Controller).unwrap();
    // Without a challenge that it has read, it cannot arm.
    assert_eq!(server.arm(controller), Err(NotDone::Late));
    server.run(10, &[]);
    assert_eq!(server.arm(controller), Ok(Taken::Granted(None)));
    for _ in 0..100 {
        assert_eq!(server.run(50, &[controller]), None);
        assert_eq!(server.act(controller), Ok(()));
    }
    // The newest challenge is at most 10 ms old.
    assert_eq!(server.run(90, &[]), None);
    assert_eq!(server.run(11, &[]), Some(Ended::Silent));
    // No answer brings it back, and no act: only the next arm does.
    assert_eq!(server.run(1_000, &[controller]), None);
    assert_eq!(server.act(controller), Err(NotDone::NotOperator));
    assert_eq!(server.arm(controller), Ok(Taken::Granted(None)));
    assert_eq!(server.act(controller), Ok(()));
}

#[test]
fn a_page_keeps_its_400_ms_beside_a_controller() {
    let mut server = Server::new();
    let page = server.join();
    server.join_as(Participant::Controller).unwrap();
    server.take(page, false);
    server.run(1_000, &[page]);
    assert_eq!(server.run(300, &[]), None);
    assert_eq!(server.run(101, &[]), Some(Ended::Silent));
}

#[test]
fn a_controller_takes_control_from_nobody_and_a_page_takes_it_by_the_second_press() {
    let mut server = Server::new();
    let (page, controller) = (
        server.join(),
        server.join_as(Participant::Controller).unwrap(),
    );
    let other = server.join_as(Participant::Controller).unwrap();
    server.take(page, false);
    for _ in 0..30 {
        server.run(100, &[page, controller]);
        assert_eq!(server.arm(controller), Ok(Taken::Asked));
        assert_eq!(server.act(controller), Err(NotDone::NotOperator));
    }
    assert_eq!(server.control.asks(), Some(controller));
    assert_eq!(server.control.give_up(page), Some(Ended::GivenUp));
    assert_eq!(server.arm(controller), Ok(Taken::Granted(None)));
    assert_eq!(server.arm(controller), Ok(Taken::Held));
    server.run(20, &[controller, other]);
    assert_eq!(server.arm(other), Ok(Taken::Asked));

    server.control.leave(other);
    assert_eq!(server.take(page, false), Taken::Asked);
    server.run(1_001, &[page, controller]);
    assert_eq!(server.take(page, true), Taken::Granted(Some(Ended::Taken)));
    assert_eq!(server.act(controller), Err(NotDone::NotOperator));
    assert_eq!(server.arm(controller), Ok(Taken::Asked));
    assert_eq!(server.act(page), Ok(()));
}

#[test]
fn a_controller_that_does_not_know_of_a_stop_arms_nothing() {
    let mut server = Server::new();
    let controller = server.join_as(Participant::Controller).unwrap();
    server.run(50, &[]);
    assert_eq!(server.arm(controller), Ok(Taken::Granted(None)));
    server.control.stopped_by_other(server.now);
    assert_eq!(server.act(controller), Err(NotDone::Late));
    assert_eq!(server.arm(controller), Err(NotDone::Late));
    server.run(11, &[controller]);
    assert_eq!(server.arm(controller), Ok(Taken::Held));
    assert_eq!(server.act(controller), Ok(()));
}

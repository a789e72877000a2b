//! The notices while the state changes.

use motorlink_messages::{
    Adapter, Connection,
    bus::{Answer, Sample, StopReason, StopReport},
    protocol::{Faults, Instant, Rpm, Setpoint, SpeedTarget},
};

use motorlink_messages::{bus::WithdrawReason, protocol::Mode};

use super::*;
use crate::model::{
    notice_board::NoticeBoard,
    snapshot::tests::{ID, status},
};

fn id(number: u8) -> MotorId {
    MotorId::new(number).unwrap()
}

/// A page with motors 1 to 4.
struct Scenario {
    session: Session,
    board: NoticeBoard,
    update: Update,
}

impl Scenario {
    fn new() -> Self {
        let motors = (1..=4).map(|number| MotorStatus {
            id: id(number),
            ..status(1_000, Mode::Velocity, 0)
        });
        let update = Update {
            now: Instant::from_millis(1_000),
            connection: Connection::Connected(Adapter::VIRTUAL),
            halted: false,
            motors: motors.collect(),
            job: None,
            raw: None,
            line: None,
            samples: vec![],
            notices: vec![],
        };
        Self {
            session: Session::default(),
            board: NoticeBoard::default(),
            update,
        }
    }

    fn motor(&mut self, number: u8) -> &mut MotorStatus {
        &mut self.update.motors[usize::from(number) - 1]
    }

    fn all(&mut self, activity: Activity) {
        for motor in &mut self.update.motors {
            motor.activity = activity;
        }
    }

    /// This motor reports this speed so many times.
    fn replies(&mut self, number: u8, rpm: i16, times: usize) -> Vec<String> {
        let mut sample: Sample = self.motor(number).last.unwrap();
        sample.reply.id = id(number);
        sample.reply.speed = Some(Rpm::new(rpm));
        self.update.samples = vec![sample; times];
        let titles = self.update(&[]);
        self.update.samples.clear();
        titles
    }

    /// Applies an update as the page does. Returns the titles of the notices.
    fn update(&mut self, notices: &[Notice]) -> Vec<String> {
        self.session.apply(&self.update);
        let update = &self.update;
        self.board.review(|until| review(until, update));
        for notice in notices {
            if let Some(words) = notice_texts::of_notice_in(notice, &self.session) {
                self.board.post_until(words, until(notice, &self.session));
            }
        }
        let posted = self.board.posted();
        posted.map(|posted| posted.words.title.clone()).collect()
    }
}

#[test]
fn no_motor_answers_until_one_does() {
    let mut scenario = Scenario::new();
    let nobody = Notice::IdQueryEnded(IdQueryOutcome::NoReply);
    let said = ["No motors found on this adapter"];
    assert_eq!(scenario.update(&[nobody]), said);
    assert_eq!(scenario.update(&[]), said, "an update without an answer");
    assert!(scenario.replies(3, 100, 1).is_empty());
}

#[test]
fn motors_that_were_left_driven_are_named_until_the_user_has_read_it() {
    let mut scenario = Scenario::new();
    let stood = StopOutcome {
        id: id(1),
        confirmed: true,
        speed: None,
    };
    let ended = Notice::StopEnded(StopReport {
        reason: StopReason::LeftDriven,
        motors: vec![stood],
    });
    let said = ["Stopped, standstill confirmed: 0x01"];
    assert_eq!(scenario.update(&[ended]), said);
    assert_eq!(scenario.update(&[]), said);
    assert_eq!(scenario.replies(1, 0, 5), said);
}

#[test]
fn silent_motors_are_all_named_and_each_until_it_answers() {
    let mut scenario = Scenario::new();
    scenario.motor(2).answer = Answer::Missing;
    assert_eq!(
        scenario.update(&[Notice::MotorSilent {
            id: id(2),
            garbled: false
        }]),
        ["No reply from motor 0x02 for 2 s"]
    );
    scenario.motor(4).answer = Answer::Missing;
    assert_eq!(
        scenario.update(&[Notice::MotorSilent {
            id: id(4),
            garbled: false
        }]),
        ["No valid reply from 0x02, 0x04 for 2 s"]
    );
    scenario.motor(2).answer = Answer::Comes;
    assert_eq!(
        scenario.update(&[Notice::MotorBack(id(2))]),
        ["No reply from motor 0x04 for 2 s"]
    );
    // Bytes come from it now.
    scenario.motor(4).answer = Answer::Corrupted;
    assert_eq!(scenario.update(&[]), ["No valid reply from 0x04 for 2 s"]);
    scenario.motor(4).answer = Answer::Comes;
    assert!(scenario.update(&[Notice::MotorBack(id(4))]).is_empty());
}

#[test]
fn a_withdrawn_setpoint_names_all_that_are_stopped_and_says_what_was_when_they_stand() {
    let mut scenario = Scenario::new();
    scenario.all(Activity::Stopping { confirmed: false });
    let withdrawn = Notice::Withdrawn {
        id: id(3),
        reason: WithdrawReason::Fault(Faults::from_byte(8)),
    };
    let braking =
        "Stopping motors 0x01, 0x02, 0x03, 0x04 because of motor 0x03: it reports a fault (stall)";
    assert_eq!(scenario.update(&[withdrawn]), [braking]);
    scenario.motor(1).activity = Activity::Idle;
    assert_eq!(scenario.update(&[]), [braking], "three are not at rest");
    scenario.all(Activity::Idle);
    let ended = "Motors 0x01, 0x02, 0x03, 0x04 are no longer driven because of motor 0x03: it \
                 reported a fault (stall)";
    assert_eq!(scenario.update(&[]), [ended]);
    assert_eq!(scenario.update(&[]), [ended]);
    scenario.motor(2).activity = Activity::Driven {
        setpoint: Setpoint::velocity(SpeedTarget::clamped(50)),
    };
    assert!(scenario.update(&[]).is_empty(), "it is driven again");
}

#[test]
fn a_connection_that_ends_leaves_no_motor_being_stopped() {
    let mut scenario = Scenario::new();
    scenario.motor(1).activity = Activity::Stopping { confirmed: false };
    let reason = WithdrawReason::Silent;
    scenario.update(&[Notice::Withdrawn { id: ID, reason }]);
    scenario.update.motors.clear();
    assert_eq!(
        scenario.update(&[]),
        ["Motor 0x01 is no longer driven: no reply for 200 ms"]
    );
}

#[test]
fn a_standstill_is_not_confirmed_until_each_motor_has_reported_it() {
    let mut scenario = Scenario::new();
    let outcome = |number, speed: Option<i16>| StopOutcome {
        id: id(number),
        confirmed: false,
        speed: speed.map(Rpm::new),
    };
    let report = StopReport {
        reason: StopReason::Operator,
        motors: vec![
            outcome(1, Some(30)),
            outcome(2, None),
            StopOutcome {
                confirmed: true,
                ..outcome(3, Some(0))
            },
        ],
    };
    let both = "Standstill not confirmed: motor 0x01 (30 rpm), motor 0x02 (speed unknown)";
    assert_eq!(scenario.update(&[Notice::StopEnded(report)]), [both]);
    assert_eq!(scenario.replies(1, 0, 2), [both], "it may be reversing");
    assert_eq!(scenario.replies(1, -4, 1), [both]);
    assert_eq!(scenario.replies(1, 0, 2), [both]);
    assert_eq!(
        scenario.replies(1, 0, 1),
        ["Standstill not confirmed: motor 0x02 (speed unknown)"]
    );
    assert!(scenario.replies(2, 0, 3).is_empty());
}

#[test]
fn a_loop_that_was_not_taken_is_told_until_it_is_reported() {
    let mut scenario = Scenario::new();
    let failed = Notice::ModeSwitchFailed {
        id: ID,
        asked: Mode::Velocity,
        reported: Some(Mode::Current),
    };
    assert_eq!(scenario.update(&[failed]).len(), 1);
    assert_eq!(scenario.replies(2, 0, 1).len(), 1, "another motor");
    assert!(scenario.replies(1, 0, 1).is_empty());
}

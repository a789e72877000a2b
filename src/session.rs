//! What the worker has told, kept as plain data: the newest state of everything.

use std::time::Duration;

use motorlink_messages::{
    Connection, Notice, Update,
    bus::{
        Activity, FRESH_FOR, LineStatus, MotorStatus, RawStatus, Sample, StopOutcome, StopReason,
        SurveyStatus,
    },
    protocol::{
        Celsius, CoarsePosition, Current, Detail, Faults, Instant, Mode, MotorId, Position, Reply,
        Rpm,
    },
};

use crate::{fleet::Fleet, mirror::Mirror};

/// Everything that the page shows but the entered targets.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Session {
    /// The moment it is looked at, on the worker's clock: ages are counted from here.
    pub(crate) now: Instant,
    /// The state of the port.
    pub(crate) connection: Connection,
    /// Whether Stop all motors stands.
    pub(crate) halted: bool,
    /// Every motor that is asked for telemetry.
    pub(crate) motors: Vec<MotorStatus>,
    /// The scan or ID change that is under way.
    pub(crate) survey: Option<SurveyStatus>,
    /// The last frame of the raw editor.
    pub(crate) raw: Option<RawStatus>,
    /// How the line works; `None` while no port is open.
    pub(crate) line: Option<LineStatus>,
    /// The last Stop all motors, while it stands.
    pub(crate) stop: Option<StopRecord>,
    /// Whose speed and current have the other sign here than the motor reports; nobody's in what the
    /// worker has told.
    pub(crate) mirrored: Vec<MotorId>,
}

/// How Stop all motors goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct StopRecord {
    /// Why.
    pub(crate) reason: StopReason,
    /// How it ended; `None` while it goes on.
    pub(crate) outcomes: Option<Vec<StopOutcome>>,
}

/// A value and how old it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Reading<T> {
    /// What was reported.
    pub(crate) value: T,
    /// Since then.
    pub(crate) age: Duration,
}

impl<T> Reading<T> {
    /// Whether it still says what is.
    pub(crate) fn is_fresh(&self) -> bool {
        self.age <= FRESH_FOR
    }

    fn map<U>(self, read: impl FnOnce(T) -> U) -> Reading<U> {
        Reading {
            value: read(self.value),
            age: self.age,
        }
    }
}

/// An angle, as finely as it is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Angle {
    /// From a drive reply.
    Fine(Position),
    /// From a query reply.
    Coarse(CoarsePosition),
}

impl Angle {
    pub(crate) fn degrees(self) -> f32 {
        match self {
            Self::Fine(position) => position.degrees(),
            Self::Coarse(position) => position.degrees(),
        }
    }
}

impl Default for Session {
    fn default() -> Self {
        Self {
            now: Instant::ZERO,
            connection: Connection::Disconnected,
            halted: false,
            motors: Vec::new(),
            survey: None,
            raw: None,
            line: None,
            stop: None,
            mirrored: Vec::new(),
        }
    }
}

impl Session {
    /// Takes in what the worker says. Its notices are the caller's to show; those about a stop are
    /// kept here too.
    pub(crate) fn apply(&mut self, update: &Update) {
        self.now = update.now;
        self.connection = update.connection;
        self.halted = update.halted;
        self.motors.clone_from(&update.motors);
        self.survey.clone_from(&update.survey);
        self.raw = update.raw;
        self.line = update.line;
        for notice in &update.notices {
            match notice {
                Notice::StopBegan(reason) if concerns_all(*reason) => {
                    self.stop = Some(StopRecord {
                        reason: *reason,
                        outcomes: None,
                    });
                }
                Notice::StopEnded(report) if concerns_all(report.reason) => {
                    self.stop = Some(StopRecord {
                        reason: report.reason,
                        outcomes: Some(report.motors.clone()),
                    });
                }
                _ => {}
            }
        }
        if !self.halted {
            self.stop = None;
        }
    }

    /// The same as a person counts it, of what the worker has told: speed, current and setpoint of mirrored
    /// motors with the other sign.
    pub(crate) fn counted(mut self, fleet: &Fleet) -> Self {
        for motor in &mut self.motors {
            let mirror = fleet.mirror(motor.id);
            if !mirror.is_mirrored() {
                continue;
            }
            self.mirrored.push(motor.id);
            motor.activity = mirror.activity(motor.activity);
            if let Some(Sample { reply, .. }) = &mut motor.last {
                reply.speed = mirror.speed(reply.speed);
                reply.current = mirror.current(reply.current);
            }
        }
        self
    }

    /// How this motor's speed and current are counted here.
    pub(crate) fn mirror(&self, id: MotorId) -> Mirror {
        if self.mirrored.contains(&id) {
            Mirror::Mirrored
        } else {
            Mirror::Straight
        }
    }

    /// Whether anything differs that a person must see at once rather than with the next reading.
    pub(crate) fn differs_in_state(&self, other: &Self) -> bool {
        // As the motors count, in whichever way both are counted.
        let outline = |session: &Self, motor: &MotorStatus| {
            let reply = motor.last.map(|sample| sample.reply);
            (
                motor.id,
                session.mirror(motor.id).activity(motor.activity),
                motor.silent,
                reply.map(|reply| (reply.mode, reply.faults)),
            )
        };
        self.connection != other.connection
            || self.halted != other.halted
            || self.stop != other.stop
            || self.survey != other.survey
            || self.raw.map(|raw| raw.running) != other.raw.map(|raw| raw.running)
            || !self
                .motors
                .iter()
                .map(|motor| outline(self, motor))
                .eq(other.motors.iter().map(|motor| outline(other, motor)))
    }

    pub(crate) fn motor(&self, id: MotorId) -> Option<&MotorStatus> {
        self.motors.iter().find(|motor| motor.id == id)
    }

    /// Those that have answered.
    pub(crate) fn found(&self) -> Vec<MotorId> {
        let heard = self.motors.iter().filter(|motor| motor.last.is_some());
        heard.map(|motor| motor.id).collect()
    }

    /// Those that are driven, switched or being stopped: a page that goes must not let go of them.
    pub(crate) fn in_hand(&self) -> impl Iterator<Item = &MotorStatus> {
        self.motors.iter().filter(|motor| is_in_hand(motor))
    }

    fn last_reply(&self, id: MotorId) -> Option<Reading<Reply>> {
        let sample = self.motor(id)?.last?;
        Some(Reading {
            value: sample.reply,
            age: self.now.since(sample.at),
        })
    }

    pub(crate) fn speed(&self, id: MotorId) -> Option<Reading<Rpm>> {
        Some(self.last_reply(id)?.map(|reply| reply.speed))
    }

    pub(crate) fn current(&self, id: MotorId) -> Option<Reading<Current>> {
        Some(self.last_reply(id)?.map(|reply| reply.current))
    }

    pub(crate) fn faults(&self, id: MotorId) -> Option<Reading<Faults>> {
        Some(self.last_reply(id)?.map(|reply| reply.faults))
    }

    pub(crate) fn mode(&self, id: MotorId) -> Option<Reading<Mode>> {
        Some(self.last_reply(id)?.map(|reply| reply.mode))
    }

    pub(crate) fn temperature(&self, id: MotorId) -> Option<Reading<Celsius>> {
        let (at, value) = self.motor(id)?.temperature?;
        let age = self.now.since(at);
        Some(Reading { value, age })
    }

    /// The fine angle while it is fresh, else whichever is newer.
    pub(crate) fn angle(&self, id: MotorId) -> Option<Reading<Angle>> {
        let fine = self.motor(id)?.position.map(|(at, position)| Reading {
            value: Angle::Fine(position),
            age: self.now.since(at),
        });
        let coarse = self
            .last_reply(id)
            .and_then(|reading| match reading.value.detail {
                Detail::Query { position, .. } => Some(reading.map(|_| Angle::Coarse(position))),
                _ => None,
            });
        match (fine, coarse) {
            (Some(fine), _) if fine.is_fresh() => Some(fine),
            (Some(fine), Some(coarse)) if fine.age <= coarse.age => Some(fine),
            (fine, coarse) => coarse.or(fine),
        }
    }
}

pub(crate) fn is_in_hand(motor: &MotorStatus) -> bool {
    !matches!(motor.activity, Activity::Idle)
}

/// Whether a stop for this reason is one of all motors.
pub(crate) fn concerns_all(reason: StopReason) -> bool {
    !matches!(
        reason,
        StopReason::OneMotor | StopReason::Disconnect | StopReason::Survey
    )
}

#[cfg(test)]
pub(crate) mod tests {
    use motorlink_messages::{
        Adapter,
        bus::{Counters, LinkQuality, StopReport},
        protocol::{Setpoint, SpeedTarget},
    };

    use super::*;
    use crate::fleet::Side;

    pub(crate) const ID: MotorId = MotorId::FIRST;

    /// A motor that last answered a query at this moment.
    pub(crate) fn status(at_ms: u64, mode: Mode, rpm: i16) -> MotorStatus {
        let reply = Reply {
            id: ID,
            mode,
            current: Current::from_raw(100),
            speed: Rpm::new(rpm),
            detail: Detail::Query {
                temperature: Celsius::new(33),
                position: CoarsePosition::from_raw(47),
            },
            faults: Faults::NONE,
        };
        MotorStatus {
            id: ID,
            activity: Activity::Idle,
            last: Some(Sample {
                at: Instant::from_millis(at_ms),
                reply,
            }),
            position: None,
            temperature: Some((Instant::from_millis(at_ms), Celsius::new(33))),
            silent: false,
            link: LinkQuality::default(),
            counters: Counters::default(),
        }
    }

    pub(crate) fn session(now_ms: u64, motor: MotorStatus) -> Session {
        Session {
            now: Instant::from_millis(now_ms),
            connection: Connection::Connected(Adapter::Virtual),
            motors: vec![motor],
            ..Session::default()
        }
    }

    fn update(halted: bool, notices: Vec<Notice>) -> Update {
        Update {
            now: Instant::from_millis(1),
            connection: Connection::Connected(Adapter::Virtual),
            halted,
            survey: None,
            raw: None,
            line: None,
            motors: vec![],
            samples: vec![],
            notices,
        }
    }

    #[test]
    fn a_stop_is_remembered_until_it_is_released() {
        let mut session = Session::default();
        let reason = StopReason::PageSilent;
        session.apply(&update(true, vec![Notice::StopBegan(reason)]));
        assert_eq!(session.stop.as_ref().unwrap().outcomes, None);

        let outcome = StopOutcome {
            id: ID,
            confirmed: false,
            speed: None,
        };
        let report = StopReport {
            reason,
            motors: vec![outcome],
        };
        session.apply(&update(true, vec![Notice::StopEnded(report)]));
        session.apply(&update(true, vec![Notice::StopBegan(StopReason::OneMotor)]));
        let stop = session.stop.clone().unwrap();
        assert_eq!(stop.reason, reason);
        assert_eq!(stop.outcomes, Some(vec![outcome]));

        session.apply(&update(false, vec![]));
        assert_eq!(session.stop, None);
    }

    #[test]
    fn a_reading_is_fresh_for_half_a_second() {
        let at = |now_ms| {
            session(now_ms, status(1_000, Mode::Velocity, 5))
                .speed(ID)
                .unwrap()
        };
        assert!(at(1_500).is_fresh());
        assert!(!at(1_501).is_fresh());
        assert_eq!(at(1_501).value, Rpm::new(5));
        assert_eq!(Session::default().speed(ID), None);
    }

    #[test]
    fn the_fine_angle_is_shown_while_it_is_fresh() {
        let mut motor = status(1_000, Mode::Velocity, 5);
        let fine = Position::from_raw(6_095);
        motor.position = Some((Instant::from_millis(800), fine));
        let angle = |now_ms, motor| session(now_ms, motor).angle(ID).unwrap().value;
        assert_eq!(angle(1_100, motor), Angle::Fine(fine));
        let coarse = Angle::Coarse(CoarsePosition::from_raw(47));
        assert_eq!(angle(1_400, motor), coarse);
        motor.last = None;
        assert_eq!(angle(9_000, motor), Angle::Fine(fine));
    }

    #[test]
    fn a_mirrored_motor_is_read_with_the_other_sign_and_no_state_changes_by_it() {
        let goal = |rpm| Activity::Driven {
            setpoint: Setpoint::velocity(SpeedTarget::new(rpm).unwrap()),
        };
        let mut motor = status(1_000, Mode::Velocity, -98);
        motor.activity = goal(-100);
        let told = session(1_016, motor);
        let mut fleet = Fleet::default();
        fleet.change(ID, |member| member.side = Side::Left);
        assert_eq!(told.clone().counted(&fleet), told);
        fleet.change(ID, |member| member.side = Side::Right);
        let read = told.clone().counted(&fleet);
        assert!(read.mirror(ID).is_mirrored() && !told.mirror(ID).is_mirrored());
        assert_eq!(read.speed(ID).unwrap().value, Rpm::new(98));
        assert_eq!(read.current(ID).unwrap().value, Current::from_raw(-100));
        assert_eq!(read.motor(ID).unwrap().activity, goal(100));
        assert_eq!(
            read.angle(ID),
            told.angle(ID),
            "the wheel stands where it stands"
        );
        assert!(!told.differs_in_state(&read) && !read.differs_in_state(&told));
        motor.activity = goal(100);
        assert!(session(1_016, motor).differs_in_state(&read));
    }

    #[test]
    fn a_new_reading_alone_is_no_change_of_state() {
        let before = session(1_000, status(1_000, Mode::Velocity, 5));
        let after = session(1_020, status(1_020, Mode::Velocity, 9));
        assert!(!after.differs_in_state(&before));
        let switched = session(1_020, status(1_020, Mode::Current, 9));
        assert!(switched.differs_in_state(&before));
    }
}

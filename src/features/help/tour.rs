//! The tour of the first minutes: computes the next step from the session. It drives nothing.

use motorlink_messages::{
    Adapter, Connection,
    bus::{Activity, MotorStatus},
    protocol::MotorId,
};

use crate::model::snapshot::{Reading, Session};

/// The speed that the tour offers: slow enough to follow with the eye.
pub(crate) const SPEED_RPM: i32 = 20;

/// A driven wheel at this speed counts as spun.
const SPINS_RPM: u16 = 10;

/// A step of the tour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Step {
    /// Wire the motor and plug the adapter in.
    PlugIn,
    /// Pick the adapter's port. A page cannot see an adapter before the user has picked it, so this step is open
    /// together with the previous one.
    PickPort,
    /// See the motor answer.
    Answer,
    /// Make sure that the wheel turns freely; the user confirms it. A virtual motor needs no check.
    Free,
    /// Spin it slowly.
    Spin,
    /// Stop it.
    Stop,
    /// The end of the tour.
    Done,
}

impl Step {
    /// The steps with a task.
    pub(crate) const ALL: [Self; 6] = [
        Self::PlugIn,
        Self::PickPort,
        Self::Answer,
        Self::Free,
        Self::Spin,
        Self::Stop,
    ];

    /// Whether it concerns only a real motor.
    pub(crate) const fn is_of_hardware(self) -> bool {
        matches!(self, Self::PlugIn | Self::PickPort | Self::Free)
    }
}

/// Whether the motors are virtual.
pub(crate) fn is_virtual(session: &Session) -> bool {
    session.connection.virtual_line().is_some()
}

/// Whether the tour is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Shown {
    /// No: it was skipped or has ended.
    No,
    /// It is offered at a first visit, if nothing else needs the place.
    #[default]
    Offered,
    /// The user has opened it.
    Opened,
}

/// The progress of the tour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Tour {
    pub(crate) shown: Shown,
    motor: Option<MotorId>,
    /// The user has confirmed that the wheel turns freely.
    pub(crate) free: bool,
    spun: bool,
    stopped: bool,
}

impl Tour {
    /// At its beginning.
    pub(crate) fn new(shown: Shown) -> Self {
        Self {
            shown,
            ..Self::default()
        }
    }

    /// Updates the progress. After a change of the motor, the confirmation and the progress are reset. A finished tour
    /// stays finished, and makes room when the user drives on.
    pub(crate) fn update(&mut self, session: &Session, id: MotorId) {
        // A recorded spin is none of the user's.
        if session.is_recording() {
            return;
        }
        if self.stopped {
            let is_driven = |motor: &MotorStatus| matches!(motor.activity, Activity::Driven { .. });
            if session.motors.iter().any(is_driven) {
                self.shown = Shown::No;
            }
            return;
        }
        let connected = matches!(session.connection, Connection::Connected(_));
        let motor = connected.then_some(id);
        if self.motor != motor {
            *self = Self {
                motor,
                ..Self::new(self.shown)
            };
        }
        let Some(speed) = session.speed(id).filter(Reading::is_fresh) else {
            return;
        };
        match session.motor(id).map(|motor| motor.activity) {
            Some(Activity::Driven { .. }) if speed.value.magnitude() >= SPINS_RPM => {
                self.spun = true;
            }
            // While others still turn or stop, a drive is no new one.
            Some(Activity::Idle) if speed.value.magnitude() == 0 => {
                self.stopped |= self.spun && session.active_motors().next().is_none();
            }
            _ => {}
        }
    }

    /// The next step.
    pub(crate) fn step(self, session: &Session, id: MotorId) -> Step {
        if self.stopped {
            // Later actions are not part of the tour.
            return Step::Done;
        }
        match session.connection {
            Connection::Disconnected | Connection::Connected(Adapter::Recording) => {
                return Step::PlugIn;
            }
            Connection::Connecting | Connection::Failed(_) | Connection::Reconnecting(_) => {
                return Step::PickPort;
            }
            Connection::Connected(_) => {}
        }
        if session.mode(id).is_none_or(|mode| !mode.is_fresh()) {
            Step::Answer
        } else if self.spun {
            Step::Stop
        } else if self.free || is_virtual(session) {
            Step::Spin
        } else {
            Step::Free
        }
    }
}

#[cfg(test)]
mod tests {
    use motorlink_messages::protocol::{Mode, Setpoint, SpeedTarget};

    use super::*;
    use crate::model::snapshot::tests::{ID, session, status};

    fn at(rpm: i16, driven: bool) -> Session {
        let mut session = session(1_000, status(1_000, Mode::Velocity, rpm));
        session.connection = Connection::Connected(Adapter::Serial(None));
        if driven {
            session.motors[0].activity = Activity::Driven {
                setpoint: Setpoint::velocity(SpeedTarget::clamped(SPEED_RPM)),
            };
        }
        session
    }

    fn step(tour: &mut Tour, session: &Session) -> Step {
        tour.update(session, ID);
        tour.step(session, ID)
    }

    #[test]
    fn a_first_spin_ticks_its_steps_off_one_by_one() {
        let mut tour = Tour::default();
        let mut start = Session::default();
        assert_eq!(step(&mut tour, &start), Step::PlugIn);
        start.connection = Connection::Connecting;
        assert_eq!(step(&mut tour, &start), Step::PickPort);
        let mut silent = at(0, false);
        silent.motors.clear();
        assert_eq!(step(&mut tour, &silent), Step::Answer);
        assert_eq!(step(&mut tour, &at(0, false)), Step::Free);
        tour.free = true;
        assert_eq!(step(&mut tour, &at(0, false)), Step::Spin);
        assert_eq!(step(&mut tour, &at(4, true)), Step::Spin, "it only starts");
        assert_eq!(step(&mut tour, &at(20, true)), Step::Stop);
        assert_eq!(step(&mut tour, &at(9, false)), Step::Stop, "it still turns");
        assert_eq!(step(&mut tour, &at(0, false)), Step::Done);
        let mut switching = at(0, false);
        switching.motors[0].activity = Activity::Switching { to: Mode::Current };
        assert_eq!(step(&mut tour, &switching), Step::Done);
        assert_eq!(tour.shown, Shown::Offered);
        assert_eq!(step(&mut tour, &at(20, true)), Step::Done);
        assert_eq!(tour.shown, Shown::No, "the user drives on");
    }

    #[test]
    fn a_virtual_motor_needs_not_be_secured() {
        let mut tour = Tour::default();
        let mut session = at(0, false);
        session.connection = Connection::Connected(Adapter::VIRTUAL);
        assert_eq!(step(&mut tour, &session), Step::Spin);
        assert_eq!(step(&mut tour, &at(0, false)), Step::Free);
    }

    #[test]
    fn a_finished_tour_does_not_begin_again_when_the_port_is_closed() {
        let mut tour = Tour::default();
        tour.update(&at(0, false), ID);
        tour.free = true;
        step(&mut tour, &at(20, true));
        assert_eq!(step(&mut tour, &at(0, false)), Step::Done);
        assert_eq!(step(&mut tour, &Session::default()), Step::Done);
        let other = MotorId::new(9).unwrap();
        tour.update(&at(0, false), other);
        assert_eq!(tour.step(&at(0, false), other), Step::Done);
        assert_eq!(Tour::new(Shown::Opened).step(&at(0, false), ID), Step::Free);
    }

    #[test]
    fn a_wheel_that_is_turned_by_hand_has_not_been_driven() {
        let mut tour = Tour::default();
        step(&mut tour, &at(0, false));
        tour.free = true;
        assert_eq!(step(&mut tour, &at(40, false)), Step::Spin);
        assert_eq!(step(&mut tour, &at(0, false)), Step::Spin);
    }

    #[test]
    fn what_was_confirmed_of_one_motor_says_nothing_of_another() {
        let mut tour = Tour::new(Shown::Opened);
        step(&mut tour, &at(0, false));
        tour.free = true;
        let mut session = at(0, false);
        let other = MotorId::new(9).unwrap();
        session.motors[0].id = other;
        tour.update(&session, other);
        assert_eq!(tour.step(&session, other), Step::Free);
        tour.free = true;
        session.connection = Connection::Disconnected;
        assert_eq!(step(&mut tour, &session), Step::PlugIn);
        assert_eq!(step(&mut tour, &at(0, false)), Step::Free);
        assert_eq!(tour.shown, Shown::Opened);
    }

    #[test]
    fn a_motor_that_falls_silent_is_waited_for() {
        let mut tour = Tour::default();
        step(&mut tour, &at(0, false));
        tour.free = true;
        let mut old = at(0, false);
        old.now = motorlink_messages::protocol::Instant::from_millis(9_000);
        assert_eq!(step(&mut tour, &old), Step::Answer);
        assert_eq!(step(&mut tour, &at(0, false)), Step::Spin);
    }
}

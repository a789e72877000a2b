//! The frames of the protocol card: the last of each kind between the page and the selected motor.

use motorlink_i18n::family_terms;
use motorlink_messages::{
    bus::Activity,
    protocol::{Detail, Frame, Layout, Mode, MotorId, Reply, Request, Setpoint, family::Model},
};

use crate::model::snapshot::Session;

/// The names of the kinds of frames in the help's files, in the order of [`LineCard::frames`].
pub(crate) const KINDS: [&str; 5] = ["drive", "query", "mode", "drive-reply", "query-reply"];

/// The card shows the frames of this model and its like.
const COMBINED: Model = Model::Ddsm115;

/// The last frames of the selected motor. Replies have the signs of the wire, so their frames are exact; requests
/// are rebuilt from the state of the bus.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct LineCard {
    id: Option<MotorId>,
    /// Its setpoint. While a ramp limits it, the frames on the line have a lower speed.
    setpoint: Option<Setpoint>,
    switched_to: Option<Mode>,
    drive_reply: Option<Reply>,
    query_reply: Option<Reply>,
}

impl LineCard {
    /// Updates from the worker's state, with the signs of the wire.
    pub(crate) fn update(&mut self, session: &Session, id: MotorId) {
        if self.id != Some(id) {
            *self = Self {
                id: Some(id),
                ..Self::default()
            };
        }
        let live = Some(session).filter(|session| !session.is_recording());
        let Some(motor) = live.and_then(|session| session.motor(id)) else {
            return;
        };
        match motor.activity {
            Activity::Driven { setpoint } => self.setpoint = Some(setpoint),
            Activity::Switching { to } => self.switched_to = Some(to),
            _ => {}
        }
        if let Some(sample) = motor.last {
            match sample.reply.detail {
                Detail::Drive { .. } => self.drive_reply = Some(sample.reply),
                Detail::Query { .. } => self.query_reply = Some(sample.reply),
                Detail::Temperature(_) | Detail::Odometry { .. } | Detail::Undetermined(_) => {}
            }
        }
    }

    /// The last frame of each kind with its meaning, if there was one.
    pub(crate) fn frames(&self) -> [Option<(String, String)>; 5] {
        let sent = |request: Request, mode| {
            let frame = request.frame();
            (frame, family_terms::sent(COMBINED, &frame, mode))
        };
        let reply_row = |reply: Reply, layout| {
            let frame = reply.frame();
            (
                frame,
                family_terms::received(COMBINED, &frame, Some(layout)),
            )
        };
        let of = |id: MotorId| {
            [
                self.setpoint
                    .map(|setpoint| sent(Request::drive(id, setpoint), Some(setpoint.mode()))),
                // A reply to it implies the request.
                self.query_reply.map(|_| sent(Request::Query { id }, None)),
                self.switched_to
                    .map(|mode| sent(Request::SwitchMode { id, mode }, None)),
                self.drive_reply
                    .map(|reply| reply_row(reply, Layout::Drive)),
                self.query_reply
                    .map(|reply| reply_row(reply, Layout::Query)),
            ]
        };
        let text =
            |seen: Option<(Frame, String)>| seen.map(|(frame, words)| (frame.to_string(), words));
        self.id.map(of).unwrap_or_default().map(text)
    }
}

#[cfg(test)]
mod tests {
    use motorlink_messages::{bus::Sample, protocol::Instant};

    use super::*;
    use crate::model::snapshot::tests::{ID, session, status};

    /// A session with a frame of a real motor.
    fn told(frame: &str, layout: Layout) -> Session {
        let frame: Frame = frame.parse().unwrap();
        let mut session = session(1_000, status(1_000, Mode::Velocity, 0));
        session.motors[0].last = Some(Sample {
            at: Instant::from_millis(1_000),
            reply: Reply::decode(&frame, Some(layout)).unwrap(),
        });
        session
    }

    #[test]
    fn what_was_not_seen_has_no_frame() {
        assert!(LineCard::default().frames().iter().all(Option::is_none));
        let mut card = LineCard::default();
        card.update(&Session::default(), ID);
        assert!(card.frames().iter().all(Option::is_none));
    }

    #[test]
    fn replies_of_real_motors_come_back_to_the_byte() {
        let mut card = LineCard::default();
        let drive = "01 02 02 CD 00 64 17 CF 00 8F";
        card.update(&told(drive, Layout::Drive), ID);
        let query = "01 02 00 0A 00 00 20 F6 00 4A";
        card.update(&told(query, Layout::Query), ID);
        let [driven, asked, _, drive_reply, query_reply] = card.frames();
        assert_eq!(driven, None, "nobody drove it");
        let (frame, words) = asked.unwrap();
        assert_eq!(frame, "01 74 00 00 00 00 00 00 00 04");
        assert_eq!(words, "feedback query");
        assert_eq!(drive_reply.map(|(frame, _)| frame).as_deref(), Some(drive));
        let (frame, words) = query_reply.unwrap();
        assert_eq!(frame, query);
        assert!(words.contains("32"), "{words}");
    }

    #[test]
    fn what_is_driven_or_switched_is_what_was_sent_and_another_motor_starts_again() {
        let mut card = LineCard::default();
        let mut session = session(1_000, status(1_000, Mode::Velocity, 0));
        let speed = motorlink_messages::protocol::SpeedTarget::clamped(50);
        session.motors[0].activity = Activity::Driven {
            setpoint: Setpoint::velocity(speed),
        };
        card.update(&session, ID);
        session.motors[0].activity = Activity::Switching { to: Mode::Current };
        card.update(&session, ID);
        let [driven, _, switched, ..] = card.frames();
        assert_eq!(
            driven.unwrap().0,
            "01 64 00 32 00 00 00 00 00 D3".to_owned()
        );
        assert_eq!(
            switched.unwrap().0,
            "01 A0 00 00 00 00 00 00 00 01".to_owned()
        );
        card.update(&session, MotorId::new(9).unwrap());
        assert!(card.frames().iter().all(Option::is_none));
    }
}

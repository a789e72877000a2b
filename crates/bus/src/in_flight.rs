//! What a port was given and the line may not have carried yet.

use std::time::Duration;

use motorlink_protocol::{FRAME_AIRTIME, Frame, Instant};

/// Behind a frame that moves a wheel, and that the line has not proved to have carried, none goes for
/// so long. A motor that cannot answer still gets what a person sends it by hand.
const UNPROVED_MAX: Duration = Duration::from_secs(1);

/// Frames on their way from a port to the wire.
///
/// A browser says only that it has taken a frame: into a pipe of its own, behind which the system and
/// the adapter have theirs. Behind an adapter that stalls some 3,500 frames fit (measured on Chromium
/// 156 and a pseudo-terminal), and they come out of it in order, a stop behind all of them. So it is
/// counted here what the line can have carried since: no more than its speed allows, and of frames
/// that move a wheel only what a byte that came back proves.
#[derive(Clone, Copy, Debug, Default)]
pub struct InFlight {
    /// When the line has carried everything, if it carries at full speed.
    carried_at: Instant,
    /// When a frame that moves a wheel was handed over, if nothing has come back since.
    moving: Option<Instant>,
}

impl InFlight {
    /// Whether a frame may be handed over now. It waits behind one other at the most, and one that
    /// moves a wheel behind no other of its kind.
    #[must_use]
    pub fn admits(&self, now: Instant, frame: &Frame) -> bool {
        let queue = self.carried_at.since(now);
        let unproved = self.moving.map(|since| now.since(since));
        queue <= FRAME_AIRTIME && !(moves(frame) && unproved.is_some_and(|age| age < UNPROVED_MAX))
    }

    /// A frame was handed over.
    pub fn handed_over(&mut self, now: Instant, frame: &Frame) {
        self.carried_at = self.carried_at.max(now) + FRAME_AIRTIME;
        if moves(frame) {
            self.moving = Some(now);
        }
    }

    /// Bytes have come: the line carries what it is given.
    pub fn heard(&mut self) {
        self.moving = None;
    }
}

/// Whether a frame may move a wheel, whatever else is wrong with it: all drive frames but zeros, with or
/// without the brake. They end a motion, and wait for nothing. In the position loop zero is an angle, for
/// which the bus itself waits.
fn moves(frame: &Frame) -> bool {
    let &[_, command, high, low, ..] = frame.bytes();
    command == 0x64 && (high, low) != (0, 0)
}

#[cfg(test)]
mod tests {
    use motorlink_protocol::{MotorId, Request, Setpoint, SpeedTarget};

    use super::*;

    const ID: MotorId = MotorId::FIRST;

    fn at(micros: u64) -> Instant {
        Instant::from_micros(1_000_000 + micros)
    }

    fn drive(rpm: i32) -> Frame {
        Request::drive(ID, Setpoint::velocity(SpeedTarget::new(rpm).unwrap())).frame()
    }

    fn brake() -> Frame {
        Request::drive(ID, Setpoint::Brake).frame()
    }

    fn query() -> Frame {
        Request::Query { id: ID }.frame()
    }

    #[test]
    fn a_frame_behind_one_in_flight_is_admitted_and_one_behind_two_is_not() {
        let mut in_flight = InFlight::default();
        for _ in 0..2 {
            assert!(in_flight.admits(at(0), &brake()));
            in_flight.handed_over(at(0), &brake());
        }
        assert!(!in_flight.admits(at(0), &brake()));
        assert!(!in_flight.admits(at(867), &brake()));
        assert!(in_flight.admits(at(869), &brake()));
    }

    #[test]
    fn a_drive_frame_behind_one_that_nothing_proves_is_not_admitted_for_a_second() {
        let mut in_flight = InFlight::default();
        in_flight.handed_over(at(0), &drive(100));
        assert!(!in_flight.admits(at(999_999), &drive(100)));
        assert!(in_flight.admits(at(1_000_000), &drive(100)));
        in_flight.heard();
        assert!(in_flight.admits(at(2_000), &drive(-50)));
    }

    #[test]
    fn stops_and_queries_are_admitted_behind_a_drive_frame_that_nothing_proves() {
        let mut in_flight = InFlight::default();
        in_flight.handed_over(at(0), &drive(100));
        let switch = Request::SwitchMode {
            id: ID,
            mode: motorlink_protocol::Mode::Velocity,
        };
        let frames = [brake(), query(), switch.frame(), Request::IdQuery.frame()];
        for (place, frame) in (1..).zip(frames) {
            let now = at(place * 6_000);
            assert!(in_flight.admits(now, &frame), "{frame}");
            in_flight.handed_over(now, &frame);
        }
        assert!(!in_flight.admits(at(100_000), &drive(100)));
    }

    #[test]
    fn a_frame_that_a_motor_may_obey_counts_as_moving_whatever_is_wrong_with_it() {
        for (text, moving) in [
            ("01 64 00 64 00 00 00 00 00 4F", true),
            ("01 64 00 64 00 00 00 FF 00 00", true),
            ("01 64 00 00 00 00 00 00 00 00", false),
            ("C8 64 00 64 00 00 00 00 00 00", true),
            ("01 64 00 00 00 00 00 FF 00 D1", false),
            ("C8 64 00 00 00 00 00 00 00 DE", false),
            ("01 74 00 00 00 00 00 00 00 04", false),
            ("01 A0 00 00 00 00 00 00 00 02", false),
        ] {
            assert_eq!(moves(&text.parse().unwrap()), moving, "{text}");
        }
    }
}

//! Bounds what waits in a port behind the wire.

use std::time::Duration;

use motorlink_protocol::{Frame, Instant, family::Model};

/// Without a received byte, a second frame that moves a wheel waits this long. A motor that cannot
/// answer still gets raw frames.
const UNPROVED_MAX: Duration = Duration::from_secs(1);

/// Frames on their way from a port to the wire.
///
/// A browser only confirms that it has taken a frame, into its own pipe in front of those of the
/// system and the adapter. A stalled adapter lets some 3,500 frames pile up there (measured on
/// Chromium 156 and a pseudo-terminal). They go out in order, a stop behind all of them. So this
/// counts what the line can have carried: at most what its speed allows, and of the frames that
/// move a wheel only what a received byte proves.
#[derive(Clone, Copy, Debug, Default)]
pub struct InFlight {
    /// When the line has carried everything at full speed.
    carried_at: Instant,
    /// When a frame that moves a wheel was handed over, if no byte has arrived since.
    moving: Option<Instant>,
}

impl InFlight {
    /// Whether a frame may be handed over now: behind at most one other frame, and a frame that
    /// moves a wheel behind no other such frame.
    #[must_use]
    pub fn admits(&self, now: Instant, model: Model, frame: &Frame) -> bool {
        let queue = self.carried_at.since(now);
        let unproved = self.moving.map(|since| now.since(since));
        queue <= model.frame_airtime()
            && !(moves(frame) && unproved.is_some_and(|age| age < UNPROVED_MAX))
    }

    /// A frame was handed over.
    pub fn handed_over(&mut self, now: Instant, model: Model, frame: &Frame) {
        self.carried_at = self.carried_at.max(now) + model.frame_airtime();
        if moves(frame) {
            self.moving = Some(now);
        }
    }

    /// Bytes have arrived: the line carries frames.
    pub fn received(&mut self) {
        self.moving = None;
    }
}

/// Whether a frame may move a wheel, even if it is malformed: every drive frame except zeros, with
/// or without brake. Zeros end a motion and wait for nothing. In the position loop zero is an
/// angle; the bus itself waits there.
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
            assert!(in_flight.admits(at(0), Model::Ddsm115, &brake()));
            in_flight.handed_over(at(0), Model::Ddsm115, &brake());
        }
        assert!(!in_flight.admits(at(0), Model::Ddsm115, &brake()));
        assert!(!in_flight.admits(at(867), Model::Ddsm115, &brake()));
        assert!(in_flight.admits(at(869), Model::Ddsm115, &brake()));
    }

    #[test]
    fn a_drive_frame_behind_one_that_nothing_proves_is_not_admitted_for_a_second() {
        let mut in_flight = InFlight::default();
        in_flight.handed_over(at(0), Model::Ddsm115, &drive(100));
        assert!(!in_flight.admits(at(999_999), Model::Ddsm115, &drive(100)));
        assert!(in_flight.admits(at(1_000_000), Model::Ddsm115, &drive(100)));
        in_flight.received();
        assert!(in_flight.admits(at(2_000), Model::Ddsm115, &drive(-50)));
    }

    #[test]
    fn stops_and_queries_are_admitted_behind_a_drive_frame_that_nothing_proves() {
        let mut in_flight = InFlight::default();
        in_flight.handed_over(at(0), Model::Ddsm115, &drive(100));
        let switch = Request::SwitchMode {
            id: ID,
            mode: motorlink_protocol::Mode::Velocity,
        };
        let frames = [brake(), query(), switch.frame(), Request::IdQuery.frame()];
        for (place, frame) in (1..).zip(frames) {
            let now = at(place * 6_000);
            assert!(in_flight.admits(now, Model::Ddsm115, &frame), "{frame}");
            in_flight.handed_over(now, Model::Ddsm115, &frame);
        }
        assert!(!in_flight.admits(at(100_000), Model::Ddsm115, &drive(100)));
    }

    #[test]
    fn a_malformed_frame_counts_as_moving_if_a_motor_may_obey_it() {
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

//! Detects routine exchanges: queries and unchanged drive frames with their replies, a hundred a second.
//!
//! Each entry is classified once, when it is added, by the entries before it. A change is never routine:
//! a different drive frame, a reply with another loop or other faults, or an error. Neither is a raw frame, nor
//! its reply. If several requests in a row have no reply, all but the first are routine, and the reply after them is not.

use motorlink_bus::LineEventKind;
use motorlink_protocol::{
    Faults, Frame, Mode, MotorId,
    family::{Model, Reading, Request},
};

/// Addresses, and one to spare for an index by the address itself.
const MOTORS: usize = 255;

/// The previous frames.
#[derive(Debug)]
pub(crate) struct Routine {
    motors: Vec<Before>,
    /// The motor of the last sent frame, if that was routine.
    asked: Option<MotorId>,
}

/// The previous frames to and from one motor.
#[derive(Clone, Copy, Debug, Default)]
struct Before {
    /// The last drive frame and the loop of the motor: in another loop, the same bytes have another
    /// meaning.
    driven: Option<(Frame, Option<Mode>)>,
    replied: Option<(Option<Mode>, Faults)>,
    /// The mode byte of its last reply to a mode query.
    named: Option<u8>,
    /// Requests in a row that it did not reply to.
    silences: u32,
}

impl Before {
    /// Records a reply. Returns whether it tells the same as the last one of its kind. The loop is in combined frames,
    /// or in replies of its own.
    fn is_repeated_by(&mut self, reading: &Reading) -> bool {
        let now = match reading {
            Reading::Mode(reading) => {
                return self.named.replace(reading.byte) == Some(reading.byte);
            }
            Reading::Combined(reply) => (Some(reply.mode), reply.faults),
            Reading::Drive(reading) => (None, reading.faults),
            Reading::Odometry(odometry) => (None, odometry.faults),
        };
        self.replied.replace(now) == Some(now)
    }
}

impl Default for Routine {
    fn default() -> Self {
        Self {
            motors: vec![Before::default(); MOTORS],
            asked: None,
        }
    }
}

impl Routine {
    /// Whether this event is routine, given all events before it.
    pub(crate) fn is_next(&mut self, model: Model, passed: &LineEventKind) -> bool {
        match passed {
            LineEventKind::Sent { frame, mode } => {
                let routine = match Request::parse(model, frame) {
                    Ok(Request::Query { id } | Request::ModeQuery { id }) => Some(id),
                    Ok(Request::Drive { id, .. }) => self
                        .before(id)
                        .and_then(|before| before.driven.replace((*frame, *mode)))
                        .filter(|driven| *driven == (*frame, *mode))
                        .map(|_| id),
                    _ => None,
                };
                self.asked = routine;
                routine.is_some()
            }
            LineEventKind::Received { frame, .. } => {
                let asked = self.asked.take();
                let Ok(reading) = Reading::decode(model, frame, None) else {
                    return false;
                };
                let id = reading.id();
                let before = self.before(id);
                let repeated = before.is_some_and(|before| {
                    let was_silent = std::mem::take(&mut before.silences) > 1;
                    before.is_repeated_by(&reading) && !was_silent
                });
                asked == Some(id) && repeated
            }
            LineEventKind::Silence { id, .. } => {
                let asked = self.asked.take();
                let again = self.before(*id).is_some_and(|before| {
                    before.silences = before.silences.saturating_add(1);
                    before.silences > 1
                });
                asked == Some(*id) && again
            }
            // It may have driven the motor: the next frame of the bus shows a change.
            LineEventKind::SentByHand { frame, .. }
            | LineEventKind::RepeatedByHand { frame, .. } => {
                self.asked = None;
                if let Ok(Request::Drive { id, .. }) = Request::parse(model, frame)
                    && let Some(before) = self.before(id)
                {
                    before.driven = None;
                }
                false
            }
            LineEventKind::Junk(_)
            | LineEventKind::NotSent { .. }
            | LineEventKind::Known { .. }
            | LineEventKind::ModelSelected(_) => false,
        }
    }

    fn before(&mut self, id: MotorId) -> Option<&mut Before> {
        self.motors.get_mut(usize::from(id.get()))
    }
}

#[cfg(test)]
mod tests {
    use motorlink_bus::JunkBytes;
    use motorlink_protocol::{
        Current, Detail, Fault, Layout, Position, Reply, Request, Rpm, Setpoint, SpeedTarget,
    };

    use super::*;

    fn query(id: u8) -> LineEventKind {
        let id = MotorId::new(id).unwrap();
        sent(Request::Query { id }, None)
    }

    fn drive(id: u8, rpm: i32) -> LineEventKind {
        let setpoint = Setpoint::velocity(SpeedTarget::new(rpm).unwrap());
        sent(
            Request::drive(MotorId::new(id).unwrap(), setpoint),
            Some(Mode::Velocity),
        )
    }

    fn sent(request: Request, mode: Option<Mode>) -> LineEventKind {
        let frame = request.frame();
        LineEventKind::Sent { frame, mode }
    }

    fn reply(id: u8, faults: Faults, mode: Mode, position: u16) -> LineEventKind {
        let reply = Reply {
            id: MotorId::new(id).unwrap(),
            mode,
            current: Some(Current::from_raw(5)),
            speed: Some(Rpm::new(50)),
            detail: Detail::Drive {
                position: Position::from_raw(position),
            },
            faults,
        };
        LineEventKind::Received {
            frame: reply.frame(),
            asked: Some(Layout::Drive),
        }
    }

    fn good(id: u8, position: u16) -> LineEventKind {
        reply(id, Faults::NONE, Mode::Velocity, position)
    }

    fn verdicts(passed: &[LineEventKind]) -> Vec<bool> {
        verdicts_of(Model::Ddsm115, passed)
    }

    fn verdicts_of(model: Model, passed: &[LineEventKind]) -> Vec<bool> {
        let mut routine = Routine::default();
        let verdicts = passed.iter().map(|one| routine.is_next(model, one));
        verdicts.collect()
    }

    #[test]
    fn separate_frames_are_routine_until_the_loop_or_the_faults_change() {
        let frame = |text: &str| text.parse().unwrap();
        let ask = |text| LineEventKind::Sent {
            frame: frame(text),
            mode: None,
        };
        let odometry = ask("01 74 00 00 00 00 00 00 00 04");
        let mode = ask("01 75 00 00 00 00 00 00 00 47");
        let received = |body| LineEventKind::Received {
            frame: Frame::with_crc(body),
            asked: None,
        };
        let turned = |angle, faults| received([1, 0x75, 0, 0, 0, 3, angle, 0, faults]);
        let named = |byte| received([1, 0x76, byte, 0, 0, 0, 0, 0, 0]);
        let passed = [
            (odometry, true),
            (turned(1, 0), false),
            (mode, true),
            (named(2), false),
            (odometry, true),
            (turned(2, 0), true),
            (mode, true),
            (named(2), true),
            (odometry, true),
            (turned(3, 2), false),
            (mode, true),
            (named(9), false),
        ];
        let (passed, expected): (Vec<_>, Vec<_>) = passed.into_iter().unzip();
        assert_eq!(verdicts_of(Model::Ddsm400, &passed), expected);
    }

    #[test]
    fn a_query_is_routine_and_so_are_all_but_the_first_of_its_replies() {
        let passed = [query(1), good(1, 7), query(1), good(1, 9)];
        assert_eq!(verdicts(&passed), [true, false, true, true]);
    }

    #[test]
    fn a_drive_frame_is_routine_only_where_it_repeats_the_last_to_its_motor() {
        let passed = [
            drive(1, 50),
            good(1, 1),
            drive(2, 50),
            good(2, 1),
            drive(1, 50),
            good(1, 2),
            drive(1, 60),
            good(1, 3),
            drive(1, 60),
            good(1, 4),
        ];
        let expected = [
            false, false, false, false, true, true, false, false, true, true,
        ];
        assert_eq!(verdicts(&passed), expected);
    }

    #[test]
    fn the_same_bytes_read_in_another_loop_are_not_routine() {
        let LineEventKind::Sent { frame, .. } = drive(1, 0) else {
            panic!("a drive frame is sent")
        };
        let current = LineEventKind::Sent {
            frame,
            mode: Some(Mode::Current),
        };
        assert_eq!(
            verdicts(&[drive(1, 0), current, current]),
            [false, false, true]
        );
    }

    #[test]
    fn other_faults_or_another_loop_are_shown_once_each() {
        let stalled = Faults::NONE.with(Fault::Stall);
        let passed = [
            query(1),
            good(1, 1),
            query(1),
            reply(1, stalled, Mode::Velocity, 1),
            query(1),
            reply(1, stalled, Mode::Velocity, 2),
            query(1),
            reply(1, stalled, Mode::Current, 2),
            query(1),
            reply(1, Faults::NONE, Mode::Current, 2),
        ];
        let expected = [
            true, false, true, false, true, true, true, false, true, false,
        ];
        assert_eq!(verdicts(&passed), expected);
    }

    #[test]
    fn what_nobody_asked_for_and_what_went_wrong_is_not_routine() {
        let silence = LineEventKind::Silence {
            id: MotorId::FIRST,
            waited_us: 6_000,
        };
        let junk = LineEventKind::Junk(JunkBytes::new(&[1; 10]));
        let passed = [
            query(1),
            good(1, 1),
            good(1, 2),
            silence,
            junk,
            query(2),
            good(1, 3),
        ];
        let expected = [true, false, false, false, false, true, false];
        assert_eq!(verdicts(&passed), expected);
    }

    #[test]
    fn a_motor_that_stays_silent_is_shown_once_and_again_when_it_replies() {
        let silence = LineEventKind::Silence {
            id: MotorId::FIRST,
            waited_us: 6_000,
        };
        let passed = [
            query(1),
            good(1, 1),
            query(1),
            silence,
            query(1),
            silence,
            query(1),
            silence,
            query(1),
            good(1, 2),
            query(1),
            silence,
            query(1),
            good(1, 2),
        ];
        let expected = [
            true, false, true, false, true, true, true, true, true, false, true, false, true, true,
        ];
        assert_eq!(verdicts(&passed), expected);
    }

    #[test]
    fn the_id_query_a_mode_switch_and_what_does_not_parse_are_not_routine() {
        let switch = Request::SwitchMode {
            id: MotorId::FIRST,
            mode: Mode::Current,
        };
        let spoilt = Request::Raw(Frame::new([1; 10]));
        for request in [Request::IdQuery, switch, spoilt] {
            let passed = sent(request, None);
            assert_eq!(verdicts(&[passed, passed]), [false, false]);
        }
    }
}

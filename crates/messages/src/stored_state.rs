//! The state of the page as it is stored: the bytes of an [`Update`], so that a replay shows what the page showed.

use motorlink_bus::{JobStatus, LineStatus, MotorStatus, RawStatus, Sample};
use motorlink_protocol::Instant;
use serde::Deserialize;

use crate::{Connection, ToPage, Update, encode};

/// The format of stored states. Raise it when the encoding of [`Update`] changes: a state of another format is not read.
const FORMAT: u8 = 2;

/// An [`Update`] as far as a replay shows it: without its notices, which are last.
#[derive(Deserialize)]
struct State {
    now: Instant,
    connection: Connection,
    halted: bool,
    motors: Vec<MotorStatus>,
    job: Option<JobStatus>,
    raw: Option<RawStatus>,
    line: Option<LineStatus>,
    samples: Vec<Sample>,
}

/// The state in an encoded [`ToPage::Update`], and its time. The message is not decoded: there are twenty a second.
///
/// Its first byte tells which message it is, and in a store it tells the format.
#[must_use]
pub fn of_message(mut message: Vec<u8>) -> Option<(Instant, Vec<u8>)> {
    let (format, update) = message.split_first_mut()?;
    let (now, _) = postcard::take_from_bytes(update).ok()?;
    *format = FORMAT;
    Some((now, message))
}

/// The connection in a stored state; `None` if it is of another format, or damaged.
#[must_use]
#[inline]
pub fn connection(stored: &[u8]) -> Option<Connection> {
    let (format, update) = stored.split_first()?;
    let known = postcard::take_from_bytes::<(Instant, Connection)>(update).ok();
    known
        .filter(|_| *format == FORMAT)
        .map(|((_, connection), _)| connection)
}

/// Stores a state. A state always encodes.
#[must_use]
pub fn store(update: Update) -> Vec<u8> {
    let message = encode(&ToPage::Update(update)).ok();
    let stored = message.and_then(of_message);
    stored.map(|(_, stored)| stored).unwrap_or_default()
}

/// The stored state, with all of its times moved to a clock on which it was made `at`. It has no notices. `None` if it is of
/// another format, or damaged.
#[must_use]
pub fn read(stored: &[u8], at: Instant) -> Option<Update> {
    let (format, update) = stored.split_first()?;
    if *format != FORMAT {
        return None;
    }
    let (state, _notices) = postcard::take_from_bytes::<State>(update).ok()?;
    let (from, to) = (state.now.as_micros(), at.as_micros());
    let mut update = Update {
        now: at,
        connection: state.connection,
        halted: state.halted,
        motors: state.motors,
        job: state.job,
        raw: state.raw,
        line: state.line,
        samples: state.samples,
        notices: Vec::new(),
    };
    let moved = |time: &mut Instant| {
        let micros = time.as_micros().saturating_add(to).saturating_sub(from);
        *time = Instant::from_micros(micros);
    };
    for motor in &mut update.motors {
        let last = motor.last.as_mut().map(|sample| &mut sample.at);
        let times = [
            last,
            motor.speed.as_mut().map(|(at, _)| at),
            motor.current.as_mut().map(|(at, _)| at),
            motor.position.as_mut().map(|(at, _)| at),
            motor.temperature.as_mut().map(|(at, _)| at),
        ];
        times.into_iter().flatten().for_each(moved);
    }
    update
        .samples
        .iter_mut()
        .for_each(|sample| moved(&mut sample.at));
    Some(update)
}

#[cfg(test)]
mod tests {
    use motorlink_bus::{
        Activity, Answer, Counters, LinkQuality, RawAnswer, RoundTripStatus, Turns,
    };
    use motorlink_protocol::{
        AssignableId, Celsius, Current, Layout, MotorId, Position, Reply, Rpm, Setpoint,
        family::Model,
    };

    use super::*;
    use crate::{Adapter, Notice};

    fn at(millis: u64) -> Instant {
        Instant::from_millis(millis)
    }

    /// Counters with numbers from this one on.
    fn counters(from: u64) -> Counters {
        Counters {
            requests: from,
            replies: from + 1,
            silences: from + 2,
            bad_crcs: from + 3,
            fragments: from + 4,
            wrong_ids: from + 5,
            late: from + 6,
            not_asked: from + 7,
            echoes_whole: from + 8,
            echoes_cut: from + 9,
            junk_bytes: from + 10,
            level_bytes: from + 11,
            text_bytes: from + 12,
            blocks: from + 13,
        }
    }

    /// What the page shows at 500 ms, with times that are so much later.
    fn state(later: u64) -> Update {
        let frame = "01 02 02 CD 00 64 17 CF 00 8F".parse().unwrap();
        let reply = Reply::decode(&frame, Some(Layout::Drive)).unwrap();
        let sample = Sample {
            at: at(480 + later),
            reply,
        };
        let motor = MotorStatus {
            id: MotorId::FIRST,
            activity: Activity::Driven {
                setpoint: Setpoint::Brake,
            },
            waiting: Some(Setpoint::Brake),
            last: Some(sample),
            speed: Some((at(481 + later), Rpm::new(100))),
            current: Some((at(482 + later), Current::from_raw(717))),
            position: Some((at(483 + later), Position::from_raw(6_095))),
            temperature: Some((at(484 + later), Celsius::new(31))),
            turns: Some(Turns::new(-12.5)),
            answer: Answer::Comes,
            may_turn: true,
            turns_unasked: false,
            link: LinkQuality {
                command_hz: 51,
                round_trip_us: Some(2_336),
                loss_per_mille: Some(3),
                late_per_mille: Some(4),
            },
            counters: counters(20),
        };
        Update {
            now: at(500 + later),
            connection: Connection::Connected(Adapter::Serial(None)),
            halted: true,
            motors: vec![motor],
            job: Some(JobStatus::SettingId {
                from: MotorId::FIRST,
                to: AssignableId::new(MotorId::new(7).unwrap()).unwrap(),
            }),
            raw: Some(RawStatus {
                frame,
                count: 5,
                sent: 4,
                answered: 3,
                running: true,
                last: Some(RawAnswer::Silence { waited_us: 8_000 }),
            }),
            line: Some(LineStatus {
                model: Model::Ddsm400,
                model_known: true,
                exchanges_hz: 60,
                drive_per_mille: 61,
                query_per_mille: 62,
                other_per_mille: 63,
                waiting_per_mille: 64,
                late_hz: 65,
                round_trip: RoundTripStatus {
                    median_us: Some(66),
                    p99_us: Some(67),
                    histogram: std::array::from_fn(|bin| u16::try_from(68 + bin).unwrap()),
                },
                carries_hz: Some(90),
                unaddressed: counters(100),
            }),
            samples: vec![sample],
            notices: vec![Notice::MotorBack(MotorId::FIRST)],
        }
    }

    #[test]
    fn what_was_stored_is_read_and_moved_to_another_clock() {
        let message = encode(&ToPage::Update(state(0))).unwrap();
        let (now, stored) = of_message(message).unwrap();
        assert_eq!(now, at(500));
        assert_eq!(stored, store(state(0)));
        assert_eq!(connection(&stored), Some(state(0).connection));
        let shown = |later| {
            let notices = Vec::new();
            Some(Update {
                notices,
                ..state(later)
            })
        };
        assert_eq!(read(&stored, now), shown(0));
        assert_eq!(read(&stored, at(9_500)), shown(9_000));
        assert_eq!(read(&store(state(9_000)), at(500)), shown(0));
    }

    #[test]
    fn another_format_and_damage_are_no_state() {
        let mut stored = store(state(0));
        assert_eq!(read(&stored[..40], at(0)), None);
        stored[0] += 1;
        assert_eq!(read(&stored, at(0)), None);
        assert_eq!(connection(&stored), None);
        assert_eq!(read(&[], at(0)), None);
        assert_eq!(of_message(Vec::new()), None);
    }

    /// If this fails, states of earlier versions are read as something else: raise `FORMAT`, then change the bytes here.
    #[test]
    fn the_format_has_not_changed() {
        let known = [
            0x02, 0xA0, 0xC2, 0x1E, 0x02, 0x01, 0x00, 0x01, 0x01, 0x01, 0x02, 0x01, 0x01, 0x01,
            0x01, 0x80, 0xA6, 0x1D, 0x01, 0x02, 0x01, 0x9A, 0x0B, 0x01, 0xC8, 0x01, 0x00, 0xCF,
            0x2F, 0x00, 0x00, 0x01, 0xE8, 0xAD, 0x1D, 0xC8, 0x01, 0x01, 0xD0, 0xB5, 0x1D, 0x9A,
            0x0B, 0x01, 0xB8, 0xBD, 0x1D, 0xCF, 0x2F, 0x01, 0xA0, 0xC5, 0x1D, 0x1F, 0x01, 0xA7,
            0xC3, 0x01, 0x00, 0x01, 0x00, 0x33, 0x01, 0xA0, 0x12, 0x01, 0x03, 0x01, 0x04, 0x14,
            0x15, 0x16, 0x17, 0x18, 0x19, 0x1A, 0x1B, 0x1C, 0x1D, 0x1E, 0x1F, 0x20, 0x21, 0x01,
            0x02, 0x01, 0x07, 0x01, 0x01, 0x02, 0x02, 0xCD, 0x00, 0x64, 0x17, 0xCF, 0x00, 0x8F,
            0x05, 0x04, 0x03, 0x01, 0x01, 0x04, 0xC0, 0x3E, 0x01, 0x03, 0x01, 0x3C, 0x3D, 0x3E,
            0x3F, 0x40, 0x41, 0x01, 0x42, 0x01, 0x43, 0x44, 0x45, 0x46, 0x47, 0x48, 0x49, 0x4A,
            0x4B, 0x4C, 0x4D, 0x4E, 0x4F, 0x01, 0x5A, 0x64, 0x65, 0x66, 0x67, 0x68, 0x69, 0x6A,
            0x6B, 0x6C, 0x6D, 0x6E, 0x6F, 0x70, 0x71, 0x01, 0x80, 0xA6, 0x1D, 0x01, 0x02, 0x01,
            0x9A, 0x0B, 0x01, 0xC8, 0x01, 0x00, 0xCF, 0x2F, 0x00, 0x00, 0x01, 0x0C, 0x01,
        ];
        assert_eq!(store(state(0)), known);
    }

    /// Earlier versions had `false` and `true` there: whether the motor is silent.
    #[test]
    fn an_answer_is_one_byte_that_earlier_versions_knew_too() {
        let known = store(state(0));
        let with = |answer| {
            let mut state = state(0);
            state.motors[0].answer = answer;
            store(state)
        };
        let corrupted = with(Answer::Corrupted);
        let place = known
            .iter()
            .zip(&corrupted)
            .position(|(one, other)| one != other);
        let place = place.unwrap();
        assert_eq!(known[place], 0);
        for (byte, answer) in [(1, Answer::Missing), (2, Answer::Corrupted)] {
            let mut stored = known.clone();
            stored[place] = byte;
            assert_eq!(stored, with(answer));
            assert_eq!(read(&stored, at(500)).unwrap().motors[0].answer, answer);
        }
    }
}

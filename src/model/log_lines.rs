//! The messages of the page in the packet log. Made within [`untranslated`](motorlink_i18n::untranslated), they are
//! shown in the language that is chosen when they are read.

use motorlink_i18n::tr;
use motorlink_messages::{
    Connection, Notice, Update,
    bus::{Activity, IdQueryOutcome, StopReason, StopReport},
    protocol::{MotorId, Setpoint},
};

use crate::{
    model::{
        mirror::Mirror,
        names_and_sides::NamesAndSides,
        notice_board::{NoticeText, Tone, Topic},
        notice_texts::of_stop_reason,
        snapshot::Session,
        terms,
    },
    ui::format,
};

/// A message for the log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Line {
    /// Whether it is an error.
    pub(crate) error: bool,
    /// One line.
    pub(crate) text: String,
}

/// A message that is no error.
pub(crate) fn calm(text: impl Into<String>) -> Line {
    Line {
        error: false,
        text: text.into(),
    }
}

/// The message of a notice, without its advice; but with the advice if that is the reason why a command was
/// not sent.
pub(crate) fn of_notice(words: &NoticeText) -> Line {
    let refused = words.topic == Topic::Command && words.tone == Tone::Warning;
    let text = if refused {
        tr!(
            "{title}. {advice}",
            title = words.title,
            advice = words.advice.join(" ")
        )
    } else {
        words.title.clone()
    };
    Line {
        error: words.tone == Tone::Error,
        text,
    }
}

/// The messages of an update without its notices: the port, and motors that start to be driven or switched. Setpoints
/// have the signs that the operator sees; those of frames have the signs of the wire.
pub(crate) fn of_update(before: &Session, update: &Update, names: &NamesAndSides) -> Vec<Line> {
    let mut lines = Vec::new();
    lines.extend(of_connection(before.connection, update.connection));
    for motor in &update.motors {
        let activity_before = before.motor(motor.id).map(|motor| motor.activity);
        let mirror = names.mirror(motor.id);
        lines.extend(of_activity(
            motor.id,
            mirror,
            activity_before,
            motor.activity,
        ));
    }
    lines
}

fn of_connection(before: Connection, after: Connection) -> Option<Line> {
    if before == after {
        return None;
    }
    match after {
        Connection::Connected(adapter) => {
            let adapter = terms::adapter(adapter).replace(" · ", ", ");
            Some(calm(tr!("Connected to {adapter}", adapter)))
        }
        Connection::Disconnected => Some(calm(tr!("Disconnected"))),
        Connection::Connecting => Some(calm(tr!("Opening the port"))),
        // These are notices.
        Connection::Reconnecting(_) | Connection::Failed(_) => None,
    }
}

/// The start of driving. Later setpoints are in the frames.
fn of_activity(
    id: MotorId,
    mirror: Mirror,
    before: Option<Activity>,
    after: Activity,
) -> Option<Line> {
    let driven_before = matches!(before, Some(Activity::Driven { .. }));
    match after {
        Activity::Driven { .. } if driven_before => None,
        Activity::Driven {
            setpoint: Setpoint::Brake,
        } => Some(calm(tr!("Motor {id}: brake on", id))),
        Activity::Driven { setpoint } => {
            let goal = format::goal(mirror.setpoint(setpoint));
            Some(calm(tr!("Motor {id} is running: {goal}", id, goal)))
        }
        Activity::Switching { to } if before != Some(after) => Some(calm(tr!(
            "Switching motor {id} to the {mode}",
            id,
            mode = terms::mode(to)
        ))),
        _ => None,
    }
}

/// A notice that the page does not show.
pub(crate) fn of_quiet_notice(notice: &Notice) -> Option<Line> {
    Some(match notice {
        Notice::ModeSwitched { id, mode } => calm(tr!(
            "Motor {id} is in the {mode}",
            id,
            mode = terms::mode(*mode)
        )),
        Notice::MotorBack(id) => calm(tr!("Motor {id} is replying again", id)),
        Notice::IdQueryEnded(IdQueryOutcome::One(id)) => {
            calm(tr!("Motor {id} replied to the ID query", id))
        }
        Notice::StopBegan(reason) => of_stop_begun(*reason),
        Notice::StopEnded(report) => of_stop_ended(report),
        _ => return None,
    })
}

fn of_stop_begun(reason: StopReason) -> Line {
    match reason {
        StopReason::OneMotor => calm(tr!("Stopping one motor")),
        reason => calm(tr!("Stopping. {why}", why = of_stop_reason(reason))),
    }
}

/// A stop that every motor has confirmed; other stops are notices.
fn of_stop_ended(report: &StopReport) -> Line {
    let motors: Vec<MotorId> = report.motors.iter().map(|motor| motor.id).collect();
    if motors.is_empty() {
        return calm(tr!("Stopped: no motor was running"));
    }
    calm(tr!(
        "Stopped, standstill confirmed: {motors}",
        motors = named(&motors)
    ))
}

/// `0x01, 0x07`
fn named(ids: &[MotorId]) -> String {
    let ids: Vec<String> = ids.iter().map(MotorId::to_string).collect();
    ids.join(", ")
}

#[cfg(test)]
mod tests {
    use motorlink_i18n::{Language, set_language, translate, untranslated};
    use motorlink_messages::{
        Adapter, UsbId,
        bus::{CommandKind, ExceededLimit, Refusal, StopOutcome, WithdrawReason},
        protocol::{CurrentTarget, Faults, Mode, Rpm, SpeedTarget},
    };

    use super::*;
    use crate::model::{
        names_and_sides::Side,
        notice_texts,
        snapshot::tests::{ID, session, status},
    };

    fn update(connection: Connection, activity: Activity) -> Update {
        let mut motor = status(1_000, Mode::Velocity, 0);
        motor.activity = activity;
        Update {
            now: motorlink_messages::protocol::Instant::from_millis(1_000),
            connection,
            halted: false,
            motors: vec![motor],
            job: None,
            raw: None,
            line: None,
            samples: vec![],
            notices: vec![],
        }
    }

    fn texts(before: &Session, update: &Update) -> Vec<String> {
        let lines = of_update(before, update, &NamesAndSides::default()).into_iter();
        lines.map(|line| line.text).collect()
    }

    fn text(notice: &Notice) -> String {
        of_quiet_notice(notice).unwrap().text
    }

    #[test]
    fn a_port_that_opens_or_closes_is_logged_once() {
        let adapter = Adapter::Serial(Some(UsbId {
            vendor: 0x1A86,
            product: 0x55D3,
        }));
        let connected = update(Connection::Connected(adapter), Activity::Idle);
        let mut before = Session::default();
        assert_eq!(
            texts(&before, &connected),
            ["Connected to CH343, 1a86:55d3"]
        );
        before.apply(&connected);
        assert!(texts(&before, &connected).is_empty());
        let closed = update(Connection::Disconnected, Activity::Idle);
        assert_eq!(texts(&before, &closed), ["Disconnected"]);
    }

    #[test]
    fn a_setpoint_has_the_sign_that_the_operator_sees() {
        let mut names = NamesAndSides::default();
        names.change(ID, |member| member.side = Side::Right);
        let before = session(1_000, status(1_000, Mode::Velocity, 0));
        let setpoint = Setpoint::velocity(SpeedTarget::clamped(-100));
        let port = Connection::Connected(Adapter::VIRTUAL);
        let begins = update(port, Activity::Driven { setpoint });
        let lines = of_update(&before, &begins, &names);
        assert!(
            lines.contains(&calm("Motor 0x01 is running: +100 rpm")),
            "{lines:?}"
        );
    }

    #[test]
    fn driving_is_logged_when_it_begins_and_not_at_each_new_setpoint() {
        let driven = |rpm| Activity::Driven {
            setpoint: Setpoint::velocity(SpeedTarget::clamped(rpm)),
        };
        let port = Connection::Connected(Adapter::VIRTUAL);
        let mut before = session(1_000, status(1_000, Mode::Velocity, 0));
        let begins = update(port, driven(100));
        assert_eq!(texts(&before, &begins), ["Motor 0x01 is running: +100 rpm"]);
        let braked = Activity::Driven {
            setpoint: Setpoint::Brake,
        };
        assert_eq!(
            texts(&before, &update(port, braked)),
            ["Motor 0x01: brake on"]
        );
        before.apply(&begins);
        assert!(texts(&before, &update(port, driven(150))).is_empty());
        let switching = Activity::Switching { to: Mode::Current };
        assert_eq!(
            texts(&before, &update(port, switching)),
            ["Switching motor 0x01 to the current loop"]
        );
    }

    #[test]
    fn a_stop_is_logged_from_its_beginning_to_its_end() {
        let began = text(&Notice::StopBegan(StopReason::Operator));
        assert_eq!(began, "Stopping. You stopped all motors.");
        let report = |motors| {
            Notice::StopEnded(StopReport {
                reason: StopReason::Operator,
                motors,
            })
        };
        let stands = StopOutcome {
            id: ID,
            confirmed: true,
            speed: None,
        };
        assert_eq!(
            text(&report(vec![stands])),
            "Stopped, standstill confirmed: 0x01"
        );
        assert_eq!(text(&report(vec![])), "Stopped: no motor was running");
    }

    #[test]
    fn the_board_is_logged_without_advice_but_a_refusal_with_its_reason() {
        let words = |topic, tone| NoticeText {
            topic,
            tone,
            title: "Motor 0x01 not started".to_owned(),
            advice: vec!["Press Release.".to_owned()],
            remedy: None,
            help: None,
        };
        let line = of_notice(&words(Topic::Command, Tone::Warning));
        assert_eq!(line, calm("Motor 0x01 not started. Press Release."));
        let line = of_notice(&words(Topic::Port, Tone::Error));
        assert_eq!(line.text, "Motor 0x01 not started");
        assert!(line.error);
    }

    #[test]
    fn every_line_is_read_in_the_language_of_its_reader() {
        let reason = WithdrawReason::Limit(ExceededLimit::Speed {
            reached: Rpm::new(-80),
            limit: 60,
        });
        let faults = WithdrawReason::Fault(Faults::from_byte(0x18));
        let outcome = |speed| StopOutcome {
            id: ID,
            confirmed: false,
            speed,
        };
        let notices = [
            Notice::StopBegan(StopReason::Operator),
            Notice::StopEnded(StopReport {
                reason: StopReason::Operator,
                motors: vec![outcome(None), outcome(Some(Rpm::new(-12)))],
            }),
            Notice::MotorSilent {
                id: ID,
                garbled: false,
            },
            Notice::ModeSwitched {
                id: ID,
                mode: Mode::Current,
            },
            Notice::Withdrawn { id: ID, reason },
            Notice::Withdrawn {
                id: ID,
                reason: faults,
            },
            Notice::Refused {
                command: CommandKind::Drive(ID),
                refusal: Refusal::TooFast(Rpm::new(100)),
            },
            Notice::AdapterLost { driven: vec![ID] },
        ];
        let lines = || -> Vec<String> {
            let of = |notice| {
                let words = notice_texts::of_notice(notice);
                words.map_or_else(|| of_quiet_notice(notice), |words| Some(of_notice(&words)))
            };
            let said = notices.iter().filter_map(of).map(|line| line.text);
            let amps = Activity::Driven {
                setpoint: Setpoint::Current(CurrentTarget::from_amps(-0.5)),
            };
            let driven = update(Connection::Connected(Adapter::VIRTUAL), amps);
            said.chain(texts(&Session::default(), &driven)).collect()
        };
        let stored = untranslated(lines);
        for language in Language::ALL {
            set_language(language);
            let read: Vec<String> = stored.iter().map(|line| translate(line)).collect();
            assert_eq!(read, lines());
        }
    }
}

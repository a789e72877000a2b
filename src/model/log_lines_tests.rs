//! What is said in the packet log.

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
    let port = of_connection(before.connection, update.connection);
    let begun = of_beginnings(before, update, &NamesAndSides::default());
    port.into_iter()
        .chain(begun)
        .map(|line| line.text)
        .collect()
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
    let lines = of_beginnings(&before, &begins, &names);
    assert!(
        lines.contains(&calm("Motor 0x01 is running: +100 rpm (mirrored)")),
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
    assert_eq!(began, "Stopping. STOP was pressed.");
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

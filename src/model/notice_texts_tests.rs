//! What a person reads, and when.

use motorlink_messages::{
    bus::{Command, Consent},
    protocol::{Faults, Rpm, Setpoint, SpeedTarget, family::Model},
};

use super::*;

const ID: MotorId = MotorId::FIRST;

fn said(notice: &Notice) -> Option<String> {
    of_notice(notice).map(|words| format!("{} | {}", words.title, words.advice.join(" ")))
}

fn refused(command: Command) -> Notice {
    Notice::Refused {
        command: command.into(),
        refusal: Refusal::NotDriven(ID),
    }
}

#[test]
fn a_silent_motor_gets_the_checklist() {
    for notice in [
        Notice::MotorSilent {
            id: ID,
            garbled: false,
        },
        Notice::IdQueryEnded(IdQueryOutcome::NoReply),
    ] {
        let said = said(&notice).unwrap();
        for check in ["18 V", "brown", "orange and white", "ID correct"] {
            assert!(said.contains(check), "{said}");
        }
    }
}

#[test]
fn a_motor_whose_replies_are_corrupted_is_not_called_without_power() {
    let said = said(&Notice::MotorSilent {
        id: ID,
        garbled: true,
    })
    .unwrap();
    assert!(
        said.contains("corrupted") && said.contains("Link"),
        "{said}"
    );
    assert!(!said.contains("supply"), "{said}");
}

#[test]
fn a_refused_drag_is_not_told_and_a_refused_press_is() {
    let setpoint = Setpoint::velocity(SpeedTarget::ZERO);
    let consent = Consent::None;
    let id = ID;
    let drag = Command::Adjust {
        id,
        setpoint,
        consent,
    };
    let press = Command::Drive {
        id,
        setpoint,
        consent,
    };
    assert_eq!(said(&refused(drag)), None);
    assert!(said(&refused(press)).unwrap().contains("Press Start"));
}

#[test]
fn a_stop_is_only_told_of_where_it_is_not_confirmed() {
    let report = |confirmed, speed| {
        Notice::StopEnded(StopReport {
            reason: StopReason::OneMotor,
            motors: vec![StopOutcome {
                id: ID,
                confirmed,
                speed,
            }],
        })
    };
    assert_eq!(said(&report(true, Some(Rpm::new(0)))), None);
    let words = said(&report(false, None)).unwrap();
    assert!(words.contains("motor 0x01 (speed unknown)"), "{words}");
    assert!(words.contains("off the power"), "{words}");
    let words = said(&report(false, Some(Rpm::new(-30)))).unwrap();
    assert!(words.contains("(30 rpm)"), "{words}");
}

#[test]
fn what_was_left_driven_is_told_with_its_reason_whether_it_confirms_or_not() {
    let told = |confirmed| {
        said(&Notice::StopEnded(StopReport {
            reason: StopReason::LeftDriven,
            motors: vec![StopOutcome {
                id: ID,
                confirmed,
                speed: None,
            }],
        }))
        .unwrap()
    };
    for confirmed in [true, false] {
        let words = told(confirmed);
        assert!(words.contains("0x01"), "{words}");
        assert!(words.contains("could not be reached"), "{words}");
        assert_eq!(words.contains("off the power"), !confirmed, "{words}");
    }
}

#[test]
fn a_stop_names_the_motors_that_stand_beside_those_that_do_not() {
    let outcome = |id, confirmed| StopOutcome {
        id,
        confirmed,
        speed: None,
    };
    let motors = vec![outcome(ID, false), outcome(MotorId::new(2).unwrap(), true)];
    let reason = StopReason::Operator;
    let words = said(&Notice::StopEnded(StopReport { reason, motors })).unwrap();
    assert!(words.contains("not confirmed: motor 0x01"), "{words}");
    assert!(words.contains("confirmed: 0x02"), "{words}");
}

#[test]
fn a_withdrawn_setpoint_says_why() {
    let withdrawn = |reason| said(&Notice::Withdrawn { id: ID, reason }).unwrap();
    assert!(
        withdrawn(WithdrawReason::Fault(Faults::from_byte(8))).contains("reports a fault (stall)")
    );
    let reported = Mode::Velocity;
    assert!(withdrawn(WithdrawReason::OtherLoop { reported }).contains("power loss"));
    assert!(withdrawn(WithdrawReason::Silent).contains("200 ms"));
}

#[test]
fn a_drive_that_was_ended_says_what_was() {
    let ended = |reason, ids: &[MotorId]| of_ended_drive(ID, reason, ids).title;
    let stall = WithdrawReason::Fault(Faults::from_byte(8));
    assert_eq!(
        ended(stall, &[ID]),
        "Motor 0x01 is no longer driven: it reported a fault (stall)"
    );
    let two = MotorId::new(2).unwrap();
    let both = ended(WithdrawReason::Silent, &[ID, two]);
    assert!(
        both.starts_with("Motors 0x01, 0x02 are no longer driven"),
        "{both}"
    );
    assert!(both.contains("because of motor 0x01: no reply"), "{both}");
}

#[test]
fn a_lost_adapter_says_that_a_driven_wheel_may_keep_turning() {
    let lost = |driven: &[MotorId]| {
        let driven = driven.to_vec();
        said(&Notice::AdapterLost { driven }).unwrap()
    };
    let driven = lost(&[ID]);
    assert!(driven.contains("may keep turning"), "{driven}");
    assert!(driven.contains("power switch"), "{driven}");
    assert!(!lost(&[]).contains("turning"));
}

#[test]
fn our_stop_is_never_called_an_emergency_stop() {
    for reason in [
        StopReason::Operator,
        StopReason::PageHidden,
        StopReason::PageGone,
        StopReason::PageSilent,
        StopReason::ComputerSlept,
        StopReason::LoopDelayed,
    ] {
        assert!(!of_stop_reason(reason).to_lowercase().contains("emergency"));
    }
}

/// Bad input on a line of the family: what it is, and what to do.
#[test]
fn what_is_on_the_line_instead_of_the_motor_is_said_with_what_to_do() {
    let other = Notice::OtherModel {
        expected: Model::Ddsm115,
        found: Model::Ddsm210,
    };
    let not_enabled = Notice::ModeSwitchFailed {
        id: ID,
        asked: Mode::Velocity,
        reported: None,
    };
    let lost_power = Notice::Withdrawn {
        id: ID,
        reason: WithdrawReason::NotEnabled,
    };
    for (notice, what, then) in [
        (
            other,
            "A DDSM210 answers on this line, not a DDSM115.",
            "remove it and press Release",
        ),
        (
            Notice::SendsText { is_json: true },
            "answers in JSON",
            "Set the switch of the DDSM Driver HAT away from ESP32",
        ),
        (
            Notice::SendsText { is_json: false },
            "Another device sends text on this port",
            "this port is left alone",
        ),
        (
            not_enabled,
            "did not confirm",
            "Press Switch or Start again",
        ),
        (lost_power, "not enabled any more", "then press Start"),
    ] {
        let said = said(&notice).unwrap();
        assert!(said.contains(what) && said.contains(then), "{said}");
    }
}

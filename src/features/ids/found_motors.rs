//! The list `Motors found`: the motors that have answered, and what each reports.

use crate::{
    model::{
        motor_list::edit_button,
        names_and_sides::{NamesAndSides, Side},
        snapshot::{Reading, Session},
        terms,
    },
    ui::escape::escaped,
};
use motorlink_i18n::tr;
use std::fmt::Write;

use motorlink_messages::{
    bus::{JobStatus, Refusal},
    protocol::{AssignableId, MotorId},
};

/// A motor of the list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct FoundMotor {
    id: MotorId,
    chosen: bool,
    /// Its loop and faults, but no values that change all the time, so that the list does not move under a
    /// click.
    reports: String,
    /// Whether it has a fault, or does not answer.
    is_wrong: bool,
}

/// All motors that have answered, in a scan or since, in the order of IDs. `kept` are those found by the last
/// full scan.
pub(crate) fn found_motors(
    session: &Session,
    kept: &[MotorId],
    selected: MotorId,
) -> Vec<FoundMotor> {
    let mut ids = session.found();
    ids.extend_from_slice(kept);
    if let Some(JobStatus::Scanning { found, .. }) = &session.job {
        ids.extend_from_slice(found);
    }
    ids.sort_unstable();
    ids.dedup();
    let motor = |id| {
        let (reports, is_wrong) = reports(session, id);
        FoundMotor {
            id,
            chosen: id == selected,
            reports,
            is_wrong,
        }
    };
    ids.into_iter().map(motor).collect()
}

fn reports(session: &Session, id: MotorId) -> (String, bool) {
    let Some(mode) = session.mode(id) else {
        return (tr!("found by scan").to_owned(), false);
    };
    // Other motors are not queried during a scan.
    if !mode.is_fresh() && session.job.is_none() {
        return (tr!("not replying").to_owned(), true);
    }
    let faults = session.faults(id).filter(Reading::is_fresh);
    match faults.filter(|faults| !faults.value.is_none()) {
        Some(faults) => {
            let words = tr!(
                "{mode}, fault: {faults}",
                mode = terms::mode(mode.value),
                faults = terms::faults(faults.value)
            );
            (words, true)
        }
        None => (terms::mode(mode.value).to_owned(), false),
    }
}

/// The items of the list as HTML.
pub(crate) fn list_html(motors: &[FoundMotor], names: &NamesAndSides) -> String {
    let mut html = String::new();
    for FoundMotor {
        id,
        chosen,
        reports,
        is_wrong,
    } in motors
    {
        let number = id.get();
        let member = names.member(*id).cloned().unwrap_or_default();
        let name = escaped(member.name().trim());
        let side = match member.side {
            Side::None => "",
            side => side.words(),
        };
        let look = if *is_wrong { " bad" } else { "" };
        let cease = terms::when_frames_cease();
        let tested = member.when_silent.map(terms::when_silent);
        let tested = tested.unwrap_or(tr!("not tested"));
        let _ = write!(
            html,
            "<li><button type=\"button\" class=\"found\" value=\"{number}\" \
             aria-pressed=\"{chosen}\"><b>{id}</b> <span class=\"found-number\">· {number}</span> \
             <span class=\"found-name\">{name}</span> <span class=\"found-side\">{side}</span> \
             <span class=\"found-reports{look}\">{reports}</span>\
             <span class=\"found-silence\" title=\"{cease}\">\
             <span>{cease}: </span>{tested}</span></button>{}</li>",
            edit_button(*id)
        );
    }
    if motors.is_empty() {
        let words = tr!("No motors found yet.");
        let _ = write!(html, "<li class=\"quiet\">{words}</li>");
    }
    html
}

/// Why this ID is not needed, if the only known motor already has it.
pub(crate) fn objection(session: &Session, to: AssignableId) -> Option<String> {
    let only = session.found() == [to.id()];
    only.then(|| terms::refusal(Refusal::SameId(to.id())))
}

#[cfg(test)]
mod tests {
    use motorlink_messages::{
        experiments::analysis::WhenSilent,
        protocol::{Faults, Mode},
    };

    use super::*;
    use crate::model::{
        scan_texts::tests::{id, new_id},
        snapshot::tests::{ID, session, status},
    };

    fn lines(session: &Session, kept: &[MotorId]) -> Vec<(u8, bool, String)> {
        found_motors(session, kept, ID)
            .into_iter()
            .map(|motor| (motor.id.get(), motor.chosen, motor.reports))
            .collect()
    }

    #[test]
    fn everyone_who_answered_is_listed_once_and_in_order() {
        let mut session = session(1_000, status(1_000, Mode::Velocity, 0));
        session.job = Some(JobStatus::Scanning {
            asked: 9,
            of: 254,
            left_ms: 1_000,
            found: vec![id(1), id(7)],
        });
        let listed = lines(&session, &[id(3)]);
        assert_eq!(
            listed,
            [
                (1, true, "velocity loop".to_owned()),
                (3, false, "found by scan".to_owned()),
                (7, false, "found by scan".to_owned()),
            ]
        );
    }

    #[test]
    fn a_motor_says_its_loop_its_fault_or_that_it_is_silent() {
        let mut faulty = status(1_000, Mode::Current, 0);
        let reply = &mut faulty.last.as_mut().unwrap().reply;
        reply.faults = Faults::from_byte(8);
        let mut session = session(1_000, faulty);
        assert_eq!(lines(&session, &[])[0].2, "current loop, fault: stall");
        session.now = session.now + std::time::Duration::from_secs(3);
        assert_eq!(lines(&session, &[])[0].2, "not replying");
        session.job = Some(JobStatus::Stopping);
        assert_eq!(lines(&session, &[])[0].2, "current loop");
    }

    #[test]
    fn the_list_is_made_of_buttons_that_carry_the_id() {
        let session = session(1_000, status(1_000, Mode::Velocity, 0));
        let mut names = NamesAndSides::default();
        names.change(id(2), |member| {
            member.set_name("<Front>");
            member.side = Side::Left;
            member.when_silent = Some(WhenSilent::Keeps);
        });
        let html = list_html(&found_motors(&session, &[id(2)], ID), &names);
        assert_eq!(html.matches(">&lt;Front&gt;<").count(), 1, "{html}");
        assert_eq!(html.matches(">left<").count(), 1, "{html}");
        for silence in ["keeps its last command", "not tested"] {
            assert_eq!(html.matches(silence).count(), 1, "{html}");
        }
        assert!(html.contains("aria-label=\"Name and side of motor 0x02\""));
        assert!(html.contains("value=\"1\" aria-pressed=\"true\""), "{html}");
        assert!(
            html.contains("value=\"2\" aria-pressed=\"false\""),
            "{html}"
        );
        assert!(list_html(&[], &names).contains("No motors found yet."));
    }

    #[test]
    fn the_only_motor_cannot_be_given_the_id_it_has() {
        let alone = session(1_000, status(1_000, Mode::Velocity, 0));
        assert!(
            objection(&alone, new_id(1))
                .unwrap()
                .contains("already has ID 0x01")
        );
        assert_eq!(objection(&alone, new_id(2)), None);
        let mut two = alone.clone();
        let mut other = status(1_000, Mode::Velocity, 0);
        other.id = id(2);
        two.motors.push(other);
        assert_eq!(objection(&two, new_id(1)), None, "the scan will say it");
    }
}

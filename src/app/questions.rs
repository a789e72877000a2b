//! Questions before actions that a stop cannot undo, or that need care.

use motorlink_i18n::tr;
use motorlink_messages::bus::Repeat;

use crate::{
    model::page::{Dialog, IdChange, RawOrder},
    ui::format,
};

/// The texts of a question.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Question {
    /// The dialog's accessible name.
    pub(crate) name: &'static str,
    pub(crate) title: String,
    /// What will happen, one paragraph per line.
    pub(crate) words: String,
    /// The label of the confirm button.
    pub(crate) yes: String,
}

/// The question of a dialog, if it has one.
pub(crate) fn question(dialog: Dialog) -> Option<Question> {
    Some(match dialog {
        Dialog::Help(_) | Dialog::NameAndSide(_) => return None,
        Dialog::HighCurrent { target, .. } => {
            high_current(tr!("Drive at {amps}", amps = format::amps_of(target)))
        }
        Dialog::ChangeId(change) => change_id(change),
        Dialog::Hazard(order) => hazard(order),
        Dialog::EraseKept => erase_stored_data(),
        Dialog::HighRawCurrent { current, .. } => {
            high_current(tr!("Send {amps}", amps = format::amps_of(current)))
        }
    })
}

fn high_current(yes: String) -> Question {
    Question {
        name: tr!("High current"),
        title: [&*yes, "?"].concat(),
        words: tr!(
            "This is above 6.1 A. Stall current is 2.7 A, and the phase overcurrent protection \
             trips at 4.6 A. Fasten the motor and keep fingers clear."
        )
        .to_owned(),
        yes,
    }
}

fn change_id(IdChange { from, to, frames }: IdChange) -> Question {
    let to = to.id();
    Question {
        name: tr!("Change the ID?"),
        title: tr!("Change the ID?").to_owned(),
        words: tr!(
            "Motor {from} becomes {to} ({number}). The ID is stored in flash and survives \
             power-off.\nThe motor accepts one new ID per power-up: power-cycle it before you \
             change the ID again.\nOnly one motor may be connected: check by eye. A scan cannot \
             tell two motors whose replies are identical from one. Motors without power now keep \
             their ID.\n{count} frames are sent in a row.",
            from,
            to,
            number = to.get(),
            count = frames.count()
        ),
        yes: tr!("Set ID {to}", to),
    }
}

fn erase_stored_data() -> Question {
    Question {
        name: tr!("Delete all data"),
        title: tr!("Delete all data?").to_owned(),
        words: tr!(
            "This deletes every session stored in this browser, with packets and recordings, \
             including the current one. The packet log starts empty.\nIt also deletes runs of experiments, \
             motor names, sides and groups, ramp, rate, model, theme and all other settings. This cannot be \
             undone. Motors are not affected."
        )
        .to_owned(),
        yes: tr!("Delete").to_owned(),
    }
}

fn hazard(order: RawOrder) -> Question {
    let often = match order.repeat {
        Repeat::Times { count: 0, .. } => tr!(" It repeats until you stop it."),
        Repeat::Times { .. } | Repeat::Once => "",
    };
    Question {
        name: tr!("Send this frame?"),
        title: tr!("Send this frame?").to_owned(),
        words: tr!(
            "{frame}\nThis frame can turn the wheel, switch the loop or change an ID.{often} \
             Fasten the motor and keep fingers clear.\nA motor may keep a drive frame for ever, even one that is \
             sent once: it runs until it is stopped.\nSTOP, Space and Escape stop it. MotorLink \
             asks again for any other frame, and for this one in another loop.",
            frame = order.frame,
            often
        ),
        yes: tr!("Send it").to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use motorlink_messages::{
        bus::SetIdFrames,
        protocol::{AssignableId, CurrentTarget, MotorId},
    };

    use super::*;

    fn order(repeat: Repeat) -> RawOrder {
        RawOrder {
            frame: "01 64 00 64 00 00 00 00 00 4F".parse().unwrap(),
            repeat,
        }
    }

    #[test]
    fn an_id_change_says_what_the_motor_keeps_and_what_must_be_connected() {
        let to = AssignableId::new(MotorId::new(10).unwrap()).unwrap();
        let from = MotorId::FIRST;
        let frames = SetIdFrames::Ten;
        let change = IdChange { from, to, frames };
        let asked = question(Dialog::ChangeId(change)).unwrap();
        assert_eq!(asked.yes, "Set ID 0x0A");
        for words in [
            "Motor 0x01 becomes 0x0A (10)",
            "flash",
            "power-off",
            "Only one motor may be connected",
            "cannot tell two motors whose replies are identical from one",
            "10 frames",
        ] {
            assert!(asked.words.contains(words), "{}", asked.words);
        }
    }

    #[test]
    fn a_frame_that_can_move_a_wheel_names_what_stops_it() {
        let words = |repeat| question(Dialog::Hazard(order(repeat))).unwrap().words;
        for stop in ["STOP", "Space", "Escape"] {
            assert!(words(Repeat::Once).contains(stop));
        }
        assert!(words(Repeat::Once).contains("runs until it is stopped"));
        assert!(!words(Repeat::Once).contains("until you stop it"));
        let interval = motorlink_messages::bus::RawInterval::new(20).unwrap();
        let endless = Repeat::Times { count: 0, interval };
        assert!(words(endless).contains("until you stop it"));
    }

    #[test]
    fn a_high_current_is_named_in_amps() {
        let current = CurrentTarget::new(26_000).unwrap();
        let yes = |dialog: Dialog| question(dialog).unwrap().yes;
        let drive = Dialog::HighCurrent {
            id: MotorId::FIRST,
            target: current,
        };
        assert_eq!(yes(drive), "Drive at +6.35 A");
        let order = order(Repeat::Once);
        let raw = Dialog::HighRawCurrent { order, current };
        assert_eq!(yes(raw), "Send +6.35 A");
    }
}

//! The texts of the tour.

use motorlink_i18n::tr;
use motorlink_messages::protocol::MotorId;

use crate::{features::help::tour::Step, model::help_topic::HelpTopic};

pub(crate) fn title() -> &'static str {
    tr!("First spin")
}
pub(crate) fn skip() -> &'static str {
    tr!("Skip the tour")
}
pub(crate) fn end() -> &'static str {
    tr!("End the tour")
}
pub(crate) fn pick() -> &'static str {
    tr!("Select port")
}
pub(crate) fn go_virtual() -> &'static str {
    tr!("Go virtual")
}
pub(crate) fn free() -> &'static str {
    tr!("The motor is fastened, the wheel is free, hands are clear.")
}
pub(crate) fn spin() -> &'static str {
    tr!("Spin at 20 rpm")
}
pub(crate) fn stop() -> &'static str {
    tr!("Stop the wheel")
}

/// The name of a step in the list.
pub(crate) fn name(step: Step) -> &'static str {
    match step {
        Step::PlugIn => tr!("Plug in"),
        Step::PickPort => tr!("Select the port"),
        Step::Answer => tr!("Wait for a reply"),
        Step::Free => tr!("Secure the motor"),
        Step::Spin => tr!("Spin the wheel"),
        Step::Stop => tr!("Stop it"),
        Step::Done => tr!("Done"),
    }
}

/// The task of a step.
pub(crate) fn advice(step: Step, id: MotorId) -> String {
    let words = match step {
        Step::PlugIn => {
            tr!(
                "Signal plug to the adapter, power plug to the supply, adapter to this computer. No \
                 hardware? Use the virtual motor."
            )
        }
        Step::PickPort => {
            tr!("Select the adapter in the browser's list, or use the virtual motor.")
        }
        Step::Answer => return tr!("Waiting for a reply from motor {id}.", id),
        Step::Free => tr!(
            "2 N·m direct drive: fasten the motor, lift the wheel, then tick. If the cable or the \
             computer fails, the wheel may keep turning: only the power switch stops it then."
        ),
        Step::Spin => tr!("The button starts the wheel. STOP or Space stops it."),
        Step::Stop => tr!("Stop it here, with STOP or with Space."),
        Step::Done => tr!("Next: set a target speed and press Start."),
    };
    words.to_owned()
}

/// The place in the help.
pub(crate) const fn topic(step: Step) -> HelpTopic {
    match step {
        Step::PlugIn => HelpTopic::Wiring,
        Step::PickPort => HelpTopic::NoPortInList,
        Step::Answer => HelpTopic::NoAnswer,
        Step::Free | Step::Spin | Step::Stop | Step::Done => HelpTopic::FirstSpin,
    }
}

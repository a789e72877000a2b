//! The tour in words.

use motorlink_messages::protocol::MotorId;

use crate::{help_topic::HelpTopic, tour::Step};

pub(crate) const TITLE: &str = "First spin";
pub(crate) const SKIP: &str = "Skip the tour";
pub(crate) const END: &str = "End the tour";
pub(crate) const PICK: &str = "Pick a port";
pub(crate) const VIRTUAL: &str = "Go virtual";
pub(crate) const FREE: &str = "The motor is fastened, the wheel turns freely, fingers are away.";
pub(crate) const SPIN: &str = "Spin at 20 rpm";
pub(crate) const STOP: &str = "Stop the wheel";

/// A step by its name in the list.
pub(crate) const fn name(step: Step) -> &'static str {
    match step {
        Step::PlugIn => "Plug in",
        Step::PickPort => "Pick the port",
        Step::Answer => "See the motor answer",
        Step::Free => "Free the wheel",
        Step::Spin => "Spin it slowly",
        Step::Stop => "Stop it",
        Step::Done => "Done",
    }
}

/// What there is to do in it.
pub(crate) fn advice(step: Step, id: MotorId) -> String {
    let words = match step {
        Step::PlugIn => {
            "Signal plug to the adapter, power plug to 18 V, adapter to this computer. No hardware? \
             Take the virtual motor."
        }
        Step::PickPort => "Pick the adapter in the browser’s list, or take the virtual motor.",
        Step::Answer => return format!("Waiting for motor {id}. Is its 18 V supply on?"),
        Step::Free => "2 N·m and no gearbox: fasten the motor, lift the wheel, then tick.",
        Step::Spin => "The wheel starts when you press. Space stops it.",
        Step::Stop => "It turns. Now stop it: here, by STOP, or by Space.",
        Step::Done => "That was it. Next: set a speed at the left and press Start.",
    };
    words.to_owned()
}

/// Where the help says more.
pub(crate) const fn topic(step: Step) -> HelpTopic {
    match step {
        Step::PlugIn => HelpTopic::Wiring,
        Step::PickPort => HelpTopic::NoPortInList,
        Step::Answer => HelpTopic::NoAnswer,
        Step::Free | Step::Spin | Step::Stop | Step::Done => HelpTopic::FirstSpin,
    }
}

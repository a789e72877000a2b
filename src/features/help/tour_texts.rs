//! The tour in words.

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
    tr!("Pick a port")
}
pub(crate) fn go_virtual() -> &'static str {
    tr!("Go virtual")
}
pub(crate) fn free() -> &'static str {
    tr!("The motor is fastened, the wheel turns freely, fingers are away.")
}
pub(crate) fn spin() -> &'static str {
    tr!("Spin at 20 rpm")
}
pub(crate) fn stop() -> &'static str {
    tr!("Stop the wheel")
}

/// A step by its name in the list.
pub(crate) fn name(step: Step) -> &'static str {
    match step {
        Step::PlugIn => tr!("Plug in"),
        Step::PickPort => tr!("Pick the port"),
        Step::Answer => tr!("See the motor answer"),
        Step::Free => tr!("Free the wheel"),
        Step::Spin => tr!("Spin it slowly"),
        Step::Stop => tr!("Stop it"),
        Step::Done => tr!("Done"),
    }
}

/// What there is to do in it.
pub(crate) fn advice(step: Step, id: MotorId) -> String {
    let words = match step {
        Step::PlugIn => {
            tr!(
                "Signal plug to the adapter, power plug to 18 V, adapter to this computer. No hardware? \
             Take the virtual motor."
            )
        }
        Step::PickPort => tr!("Pick the adapter in the browser’s list, or take the virtual motor."),
        Step::Answer => return tr!("Waiting for motor {id}. Is its 18 V supply on?", id),
        Step::Free => tr!("2 N·m and no gearbox: fasten the motor, lift the wheel, then tick."),
        Step::Spin => tr!("The wheel starts when you press. Space stops it."),
        Step::Stop => tr!("It turns. Now stop it: here, by STOP, or by Space."),
        Step::Done => tr!("That was it. Next: set a speed at the left and press Start."),
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

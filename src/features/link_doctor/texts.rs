//! What the panel says beside the diagnosis itself, whose words are in `motorlink_diagnosis`.

use motorlink_diagnosis::{Diagnosis, texts::Advice};
use motorlink_i18n::tr;
use motorlink_messages::LineCondition;

use crate::model::{help_topic::HelpTopic, later_notices::choose_another_port, scan_texts::wiring};

/// Nothing is connected.
pub(crate) fn not_connected() -> &'static str {
    tr!("Connect a motor to diagnose the bus.")
}

/// Where the page does what the diagnosis advises.
pub(crate) fn advice() -> Advice {
    Advice {
        wiring: wiring().to_vec(),
        other_port: choose_another_port(),
        change_id: tr!("Connect only one, change its ID in Setup, then connect the other."),
        list_motors: tr!("Full scan in Setup lists every motor on the bus."),
        find_id: tr!("Is the ID correct? Full scan in Setup lists every motor on the bus."),
    }
}

/// Why the virtual line cannot be made faulty.
pub(crate) fn no_virtual_wire() -> &'static str {
    tr!("Available only with the virtual motor.")
}

/// The virtual lines by name.
pub(crate) fn wire(wire: LineCondition) -> &'static str {
    match wire {
        LineCondition::Good => tr!("None"),
        LineCondition::Dead => tr!("No replies"),
        LineCondition::EchoOnly => tr!("Echo only"),
        LineCondition::SharedId => tr!("Two motors share ID 1"),
        LineCondition::NoiseGrowsWithSpeed => tr!("CRC errors rising with speed"),
        LineCondition::HoldsBytes => tr!("Adapter delay of 16 ms"),
        LineCondition::Stranger => tr!("Foreign frames"),
    }
}

/// Where the help says more about what is wrong with the line.
pub(crate) const fn of_diagnosis(diagnosis: Diagnosis) -> HelpTopic {
    match diagnosis {
        Diagnosis::Nothing | Diagnosis::EchoOnly | Diagnosis::Silent(_) | Diagnosis::Lost => {
            HelpTopic::NoAnswer
        }
        Diagnosis::SharedId(_) => HelpTopic::TwoMotorsOneId,
        Diagnosis::NoiseGrowsWithSpeed
        | Diagnosis::Damaged
        | Diagnosis::Text
        | Diagnosis::Blocks
        | Diagnosis::Floating
        | Diagnosis::Turnaround => HelpTopic::DamagedBytes,
        Diagnosis::Stranger => HelpTopic::StrangerAnswers,
        Diagnosis::LatencyTimer => HelpTopic::AdapterSlow,
    }
}

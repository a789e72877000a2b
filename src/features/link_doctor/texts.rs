//! What the link doctor says: the likely cause, and what to do about it.

use motorlink_i18n::tr;
use motorlink_messages::VirtualWire;

use crate::{
    features::link_doctor::doctor::Diagnosis,
    model::{help_topic::HelpTopic, scan_texts::wiring},
};

/// Nothing is connected.
pub(crate) fn not_connected() -> &'static str {
    tr!("Connect a motor; the line is then looked at.")
}

/// The line was not used enough.
pub(crate) fn too_little() -> &'static str {
    tr!("Too little was heard yet to say anything.")
}

/// Nothing is wrong.
pub(crate) fn well() -> &'static str {
    tr!("All is well: nearly every request is answered, and at once.")
}

/// Something is wrong, and nobody knows what.
pub(crate) fn some_lost() -> &'static str {
    tr!("Some replies are lost or damaged: too few to name a cause.")
}

/// Why the virtual line cannot be made ill.
pub(crate) fn no_virtual_wire() -> &'static str {
    tr!("Connect to the virtual motor: a real line is as it is wired.")
}

/// What is likely to be the cause.
pub(crate) fn cause(diagnosis: Diagnosis) -> String {
    match diagnosis {
        Diagnosis::Nothing => tr!("Nothing at all comes back").to_owned(),
        Diagnosis::EchoOnly => tr!("Only our own echo comes back: the adapter works").to_owned(),
        Diagnosis::SharedId(id) => tr!("Two motors seem to share the ID {id}", id),
        Diagnosis::NoiseGrowsWithSpeed => tr!("Replies are damaged while a wheel turns").to_owned(),
        Diagnosis::Lossy => tr!("Replies are lost or damaged").to_owned(),
        Diagnosis::Stranger => tr!("A motor answers that was not asked").to_owned(),
        Diagnosis::Silent(id) => tr!("Motor {id} is silent, and others answer", id),
        Diagnosis::LatencyTimer => tr!("The adapter holds replies for 16 ms").to_owned(),
    }
}

/// What to do about it, one thing a line.
pub(crate) fn remedy(diagnosis: Diagnosis) -> Vec<&'static str> {
    match diagnosis {
        Diagnosis::Nothing | Diagnosis::EchoOnly => wiring().to_vec(),
        Diagnosis::SharedId(_) => vec![
            tr!("Both answer at once, and what arrives is neither."),
            tr!(
                "Leave one connected, give it another ID in the tab ID Manager, then connect the other."
            ),
        ],
        Diagnosis::NoiseGrowsWithSpeed => vec![
            tr!("The motor's current is heard on the line."),
            tr!("Put 120 Ω across A and B at both ends beyond 1 m."),
            tr!("Join the grounds of adapter and supply by a short wire."),
            tr!("Twist A with B, and keep them away from the motor's power wires."),
        ],
        Diagnosis::Lossy => vec![
            tr!(
                "Let the wheels stand for five seconds: errors that go then come with the current."
            ),
            tr!("Errors at rest too: look for a loose wire; beyond 1 m put 120 Ω across A and B."),
        ],
        Diagnosis::Stranger => vec![
            tr!("Does another program or controller speak on these wires? Let only one speak."),
            tr!("Full scan in the tab ID Manager names every motor on the line."),
        ],
        Diagnosis::Silent(_) => vec![
            tr!(
                "Others answer, so adapter and line work: look at its plug, its 18 V and its brown wire."
            ),
            tr!("Is it the right ID? Full scan in the tab ID Manager names those that are there."),
        ],
        Diagnosis::LatencyTimer => vec![
            tr!(
                "This is the latency timer of FTDI chips; 1 ms serves five times as many exchanges."
            ),
            "Linux: echo 1 | sudo tee /sys/bus/usb-serial/devices/ttyUSB0/latency_timer",
            tr!(
                "Windows: Device Manager, Ports, the adapter, Port Settings, Advanced, Latency Timer: 1."
            ),
            tr!(
                "macOS: Apple's driver has no setting; install FTDI's, or use an adapter with a CH34x."
            ),
        ],
    }
}

/// The virtual lines by name.
pub(crate) fn wire(wire: VirtualWire) -> &'static str {
    match wire {
        VirtualWire::Good => tr!("Good"),
        VirtualWire::Dead => tr!("Dead"),
        VirtualWire::EchoOnly => tr!("Echo only"),
        VirtualWire::SharedId => tr!("Two motors share ID 1"),
        VirtualWire::NoiseGrowsWithSpeed => tr!("CRC errors that grow with speed"),
        VirtualWire::HoldsBytes => tr!("Adapter holds bytes 16 ms"),
        VirtualWire::Stranger => tr!("A stranger answers"),
    }
}

/// Where the help says more about what is wrong with the line.
pub(crate) const fn of_diagnosis(diagnosis: Diagnosis) -> HelpTopic {
    match diagnosis {
        Diagnosis::Nothing | Diagnosis::EchoOnly | Diagnosis::Silent(_) => HelpTopic::NoAnswer,
        Diagnosis::SharedId(_) => HelpTopic::TwoMotorsOneId,
        Diagnosis::NoiseGrowsWithSpeed | Diagnosis::Lossy => HelpTopic::DamagedBytes,
        Diagnosis::Stranger => HelpTopic::StrangerAnswers,
        Diagnosis::LatencyTimer => HelpTopic::AdapterSlow,
    }
}

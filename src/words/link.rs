//! What the link doctor says: the likely cause, and what to do about it.

use motorlink_messages::VirtualWire;

use super::WIRING;
use crate::doctor::Diagnosis;

/// Nothing is connected.
pub(crate) const NOT_CONNECTED: &str = "Connect a motor; the line is then looked at.";
/// The line was not used enough.
pub(crate) const TOO_LITTLE: &str = "Too little was heard yet to say anything.";
/// Nothing is wrong.
pub(crate) const WELL: &str = "All is well: nearly every request is answered, and at once.";

/// Why the virtual line cannot be made ill.
pub(crate) const NO_VIRTUAL_WIRE: &str =
    "Connect to the virtual motor: a real line is as it is wired.";

/// What is likely to be the cause.
pub(crate) fn cause(diagnosis: Diagnosis) -> String {
    match diagnosis {
        Diagnosis::Nothing => "Nothing at all comes back".to_owned(),
        Diagnosis::EchoOnly => "Only our own echo comes back: the adapter works".to_owned(),
        Diagnosis::SharedId(id) => format!("Two motors seem to share the ID {id}"),
        Diagnosis::NoiseGrowsWithSpeed => "Replies are damaged while a wheel turns".to_owned(),
        Diagnosis::Lossy => "Replies are lost or damaged".to_owned(),
        Diagnosis::Stranger => "A motor answers that was not asked".to_owned(),
        Diagnosis::Silent(id) => format!("Motor {id} is silent, and others answer"),
        Diagnosis::LatencyTimer => "The adapter holds replies for 16 ms".to_owned(),
    }
}

/// What to do about it, one thing a line.
pub(crate) const fn remedy(diagnosis: Diagnosis) -> &'static [&'static str] {
    match diagnosis {
        Diagnosis::Nothing | Diagnosis::EchoOnly => &WIRING,
        Diagnosis::SharedId(_) => &[
            "Both answer at once, and what arrives is neither.",
            "Leave one connected, give it another ID in the tab ID Manager, then connect the other.",
        ],
        Diagnosis::NoiseGrowsWithSpeed => &[
            "The motor's current is heard on the line.",
            "Put 120 Ω across A and B at both ends beyond 1 m.",
            "Join the grounds of adapter and supply by a short wire.",
            "Twist A with B, and keep them away from the motor's power wires.",
        ],
        Diagnosis::Lossy => &[
            "Let the wheels stand for five seconds: errors that go then come with the current.",
            "Errors at rest too: look for a loose wire; beyond 1 m put 120 Ω across A and B.",
        ],
        Diagnosis::Stranger => &[
            "Does another program or controller speak on these wires? Let only one speak.",
            "Full scan in the tab ID Manager names every motor on the line.",
        ],
        Diagnosis::Silent(_) => &[
            "Others answer, so adapter and line work: look at its plug, its 18 V and its brown wire.",
            "Is it the right ID? Full scan in the tab ID Manager names those that are there.",
        ],
        Diagnosis::LatencyTimer => &[
            "This is the latency timer of FTDI chips; 1 ms serves five times as many exchanges.",
            "Linux: echo 1 | sudo tee /sys/bus/usb-serial/devices/ttyUSB0/latency_timer",
            "Windows: Device Manager, Ports, the adapter, Port Settings, Advanced, Latency Timer: 1.",
            "macOS: Apple's driver has no setting; install FTDI's, or use an adapter with a CH34x.",
        ],
    }
}

/// The virtual lines by name.
pub(crate) const fn wire(wire: VirtualWire) -> &'static str {
    match wire {
        VirtualWire::Good => "Good",
        VirtualWire::Dead => "Dead",
        VirtualWire::EchoOnly => "Echo only",
        VirtualWire::SharedId => "Two motors share ID 1",
        VirtualWire::NoiseGrowsWithSpeed => "CRC errors that grow with speed",
        VirtualWire::HoldsBytes => "Adapter holds bytes 16 ms",
        VirtualWire::Stranger => "A stranger answers",
    }
}

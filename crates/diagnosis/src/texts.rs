//! What a diagnosis says in words: the likely cause, and what to do about it.

use motorlink_i18n::tr;

use crate::{doctor::Diagnosis, tally::Tally};

/// The line was not used enough.
#[must_use]
pub fn too_little() -> &'static str {
    tr!("Not enough data for a diagnosis yet.")
}

/// The bus is healthy.
#[must_use]
pub fn well() -> &'static str {
    tr!("Bus healthy: nearly every request gets a prompt reply.")
}

/// Replies were lost before, and are no longer.
#[must_use]
pub fn loss_ended() -> &'static str {
    tr!("No replies are lost now. Some were lost before.")
}

/// Something is wrong, and nobody knows what.
#[must_use]
pub fn some_lost() -> &'static str {
    tr!("Some replies are lost or corrupted: too few to find a cause.")
}

/// The figures of the last seconds, at most ten, from which the doctor judges the line. Empty before the first request.
#[must_use]
pub fn judged((seconds, judged): (u32, Tally)) -> String {
    let Tally {
        asked,
        silent,
        late,
        garbled,
        ..
    } = judged;
    if asked == 0 {
        return String::new();
    }
    tr!(
        "Last {seconds} s: {asked} requests; replies: {lost} lost, {late} late, {garbled} corrupted.",
        seconds,
        asked,
        lost = silent.saturating_sub(late),
        late,
        garbled
    )
}

/// What is likely to be the cause.
#[must_use]
pub fn cause(diagnosis: Diagnosis) -> String {
    match diagnosis {
        Diagnosis::Text => tr!("Another device sends text on this port").to_owned(),
        Diagnosis::Blocks => blocks().to_owned(),
        Diagnosis::Floating => tr!("Bytes without a motor: the bus floats").to_owned(),
        Diagnosis::Turnaround => tr!("A byte 00 or FF beside each reply").to_owned(),
        Diagnosis::Nothing => tr!("No bytes received").to_owned(),
        Diagnosis::EchoOnly => tr!("Only echoes received: the adapter works").to_owned(),
        Diagnosis::SharedId(id) => tr!("Two motors seem to share ID {id}", id),
        Diagnosis::NoiseGrowsWithSpeed => {
            tr!("Replies are corrupted while a wheel turns").to_owned()
        }
        Diagnosis::Damaged => tr!("Replies are corrupted").to_owned(),
        Diagnosis::Lost => tr!("Replies are lost, few are corrupted").to_owned(),
        Diagnosis::Stranger => tr!("Frames from a motor that was not queried").to_owned(),
        Diagnosis::Silent(id) => tr!("No reply from motor {id}, but others reply", id),
        Diagnosis::LatencyTimer => tr!("The adapter delays replies by 16 ms").to_owned(),
    }
}

/// Advice that names what a program has: its buttons, or its commands.
#[derive(Clone, Debug)]
pub struct Advice {
    /// What to check where no motor answers.
    pub wiring: Vec<&'static str>,
    /// How to choose another port.
    pub other_port: &'static str,
    /// How to give one of two motors another ID.
    pub change_id: &'static str,
    /// How to list every motor.
    pub list_motors: &'static str,
    /// How to find the ID of a motor that does not answer.
    pub find_id: &'static str,
}

/// What to do about it, one thing a line.
#[must_use]
pub fn remedy(diagnosis: Diagnosis, advice: &Advice) -> Vec<&'static str> {
    match diagnosis {
        Diagnosis::Nothing | Diagnosis::EchoOnly => advice.wiring.clone(),
        Diagnosis::Text => vec![advice.other_port],
        Diagnosis::Blocks => vec![no_blocks()],
        Diagnosis::Floating => vec![tr!(
            "Nothing holds A and B at a level. Connect the motor and its supply, or use an adapter with \
             bias resistors."
        )],
        Diagnosis::Turnaround => vec![tr!(
            "The bus floats before or after each reply. Use an adapter with bias resistors, or one that \
             switches its direction by itself."
        )],
        Diagnosis::SharedId(_) => vec![
            tr!("Both reply at once, so their frames collide."),
            advice.change_id,
        ],
        Diagnosis::NoiseGrowsWithSpeed => vec![
            tr!("Motor current interferes with the bus."),
            tr!("If the bus is longer than 1 m, add 120 Ω across A and B at the far end."),
            tr!("Connect adapter GND and supply GND with a short wire."),
            tr!("Use a twisted pair for A and B, away from the motor's power wires."),
        ],
        Diagnosis::Lost => vec![
            tr!(
                "Whole frames are missing: a contact opens, the motor restarts, or the adapter drops bytes."
            ),
            tr!(
                "Check plugs and terminals for a loose wire, and the supply for dips. Connect \
                 the adapter without a USB hub."
            ),
        ],
        Diagnosis::Damaged => vec![
            tr!("Stop the wheels for 5 s. Errors that disappear come from the motor current."),
            tr!(
                "Errors at standstill too? Check for a loose wire. If the bus is longer than 1 m, \
                 add 120 Ω across A and B."
            ),
        ],
        Diagnosis::Stranger => vec![
            tr!("Is another program or controller sending on this bus? Only one may send."),
            advice.list_motors,
        ],
        Diagnosis::Silent(_) => vec![
            tr!(
                "Other motors reply, so the adapter and bus work. Check this motor's plugs, supply and \
                 signal wires."
            ),
            advice.find_id,
        ],
        Diagnosis::LatencyTimer => vec![
            tr!(
                "This is the FTDI latency timer. Set to 1 ms, it allows five times as many \
                 exchanges."
            ),
            "Linux: echo 1 | sudo tee /sys/bus/usb-serial/devices/ttyUSB0/latency_timer",
            tr!(
                "Windows: Device Manager → Ports → adapter → Port Settings → Advanced: set Latency \
                 Timer to 1 ms."
            ),
            tr!(
                "macOS: the Apple driver has no such setting. Install the FTDI driver, or use a \
                 CH34x adapter."
            ),
        ],
    }
}

/// The adapter keeps replies back.
#[must_use]
pub fn blocks() -> &'static str {
    tr!("The adapter delivers only blocks of 32 bytes")
}

/// What to do about that.
#[must_use]
pub fn no_blocks() -> &'static str {
    tr!(
        "Replies wait in the adapter until 32 bytes are there, so they come too late. Use another \
         adapter or driver."
    )
}

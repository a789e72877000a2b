//! A sequence as a program for the Python package `motorlink`.

use super::{Program, plain};

/// The program. The package runs the sequence, and stops the motors at its end, on an error and on Ctrl-C.
#[must_use]
pub fn python(program: &Program<'_>) -> String {
    let Program {
        plan,
        sequence,
        port,
    } = program;
    let ids = plan.motors.iter().map(|motor| {
        let sign = if motor.mirrored { "-" } else { "" };
        format!("{sign}{}", motor.id.get())
    });
    let ids = ids.collect::<Vec<_>>().join(", ");
    let (name, port) = (plain(&sequence.name), plain(port));
    // In a raw string. JSON has a backslash before each quote of a text, so no text ends it.
    let json = sequence.to_json();
    let json = json.trim_end();
    format!(
        r#""""{name}: {plan}.

Needs the Python package motorlink. If the cable or the computer fails, the wheel may keep turning. Only the power switch
stops it then.
"""

import motorlink

SEQUENCE = r"""{json}"""

with motorlink.open("{port}") as bus:
    motors = bus.group({ids})
    print("{plan}. Keep clear of the wheels.")
    if input("Start? [y/N] ") == "y":
        run = motors.run(SEQUENCE)
        print(run.aborted or "finished", run.figures)
        run.save(".")
print(bus.last_stop)
"#
    )
}

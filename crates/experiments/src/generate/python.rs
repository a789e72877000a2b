//! A sequence as a program for the Python package `motorlink`.

use super::{Program, plain};

/// Characters of a line.
const WIDTH_MAX: usize = 100;

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
    let json = dense(&sequence.to_json());
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

/// The same JSON with as much on a line as fits. It has a line for each value, and no text has a line break.
fn dense(json: &str) -> String {
    let mut out = String::new();
    let mut width = 0;
    for part in json.lines().map(str::trim) {
        if width + part.len() < WIDTH_MAX && width > 0 {
            out.push(' ');
        } else if width > 0 {
            out.push('\n');
            width = 0;
        }
        out.push_str(part);
        width += part.len() + 1;
    }
    out
}

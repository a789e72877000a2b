//! The last step: which wheel each motor turns, and which direction is forward.

use std::time::Duration;

use motorlink_bus::{Command, Consent, Mirror};
use motorlink_protocol::MotorId;

use crate::{
    confirm::is_yes,
    connection::Connection,
    drive::{hold, rpm_setpoint},
    failure::Failure,
    output::{print, say},
    signed_id::SignedId,
    starting::start,
};

use super::{Line, try_again};

/// Slow, as on the page.
const SPIN_RPM: i32 = 20;
/// A third of a turn.
const SPIN: Duration = Duration::from_secs(1);
/// Letters of a name.
const NAME_MAX: usize = 40;

/// A motor, and the name of its wheel.
struct Wheel {
    motor: SignedId,
    name: String,
}

/// Turns each wheel for a second if the person agrees, asks which one it was, and prints how to drive them.
///
/// # Errors
/// A motor did not confirm its standstill, or the program ends.
pub fn find_out(line: Line<'_>, found: &[MotorId]) -> Result<(), Failure> {
    let answer = line.ask(
        "\nTurn one wheel after the other, slowly for a second, to find out which is which?\n\
         Lift the rover, and keep clear of its wheels. [y/N] ",
    )?;
    if !is_yes(&answer) {
        return print_use(found.iter().copied().map(SignedId::straight));
    }
    let mut wheels = Vec::new();
    let asked = found.iter().try_for_each(|id| {
        wheels.extend(ask_for_wheel(line, *id, found, &wheels)?);
        Ok(())
    });
    if wheels.is_empty() {
        return asked;
    }
    print("\nmotor  forward   wheel")?;
    for Wheel { motor, name } in &wheels {
        let forward = if motor.mirror.is_mirrored() {
            "mirrored"
        } else {
            "as it is"
        };
        print(format_args!(
            "{:>5}  {forward}  {name}",
            motor.id.to_string()
        ))?;
    }
    print_use(wheels.iter().map(|wheel| wheel.motor))?;
    asked
}

/// Prints the command line that drives these motors forward.
fn print_use(motors: impl Iterator<Item = SignedId>) -> Result<(), Failure> {
    let number = |motor: SignedId| {
        let sign = if motor.mirror.is_mirrored() { "-" } else { "" };
        format!("{sign}{}", motor.id.get())
    };
    let ids = motors.map(number).collect::<Vec<_>>().join(",");
    print(format_args!("\nmotorlink --id {ids} drive velocity 60"))
}

/// Turns this wheel until the person knows which one it is. `None` leaves it out.
fn ask_for_wheel(
    line: Line<'_>,
    id: MotorId,
    plugged_in: &[MotorId],
    known: &[Wheel],
) -> Result<Option<Wheel>, Failure> {
    let name = loop {
        if !turn(line, id, plugged_in)? {
            let question = format!("Motor {id} did not turn. Enter: try again, -: leave it out: ");
            if line.ask(&question)? == "-" {
                return Ok(None);
            }
            continue;
        }
        let name = ask_name(line, known)?;
        if !name.is_empty() {
            break name;
        }
    };
    if name == "-" {
        return Ok(None);
    }
    let mirror = loop {
        let question =
            "Did it turn forward, as when the rover drives forward, or backward? (f or b): ";
        match line.ask(question)?.as_str() {
            "f" | "forward" => break Mirror::Straight,
            "b" | "backward" => break Mirror::Mirrored,
            _ => {}
        }
    };
    let motor = SignedId { id, mirror };
    Ok(Some(Wheel { motor, name }))
}

/// The name of a wheel that is not known yet, `-`, or nothing.
fn ask_name(line: Line<'_>, known: &[Wheel]) -> Result<String, Failure> {
    loop {
        let answer = line.ask(
            "Which wheel was it, such as front left? (Enter: turn it again, -: leave it out): ",
        )?;
        let name = answer.chars().filter(|letter| !letter.is_control());
        let name: String = name.take(NAME_MAX).collect();
        match known.iter().find(|wheel| wheel.name == name) {
            Some(wheel) => say(format_args!(
                "That is the wheel of motor {}.",
                wheel.motor.id
            )),
            None => return Ok(name),
        }
    }
}

/// Turns a wheel for a second. The end of the line stops it, and says whether it stands. Returns whether it has turned.
fn turn(line: Line<'_>, id: MotorId, plugged_in: &[MotorId]) -> Result<bool, Failure> {
    let setpoint = rpm_setpoint(SPIN_RPM, 0)?;
    let mut has_turned = false;
    line.open(plugged_in, |connection: &mut Connection| {
        connection.driver.command(Command::Watch(id));
        connection.motors.push(SignedId::straight(id));
        try_again(connection.wait_for_motors().and_then(|()| {
            let motors = connection.motors.iter().copied();
            let command = start(motors, setpoint, Consent::None);
            let command = command.map_err(|error| Failure::NotDone(error.to_string()))?;
            say(format_args!("\nMotor {id} turns."));
            connection.driver.command(command);
            hold(connection, Some(SPIN))?;
            has_turned = true;
            Ok(())
        }))
    })?;
    Ok(has_turned)
}

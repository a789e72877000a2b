//! `motorlink info`: what each motor reports now.

use motorlink_bus::MotorStatus;
use motorlink_driver::Ender;
use motorlink_protocol::{Fault, Instant, family::Model};
use serde_json::{Value, json};

use crate::{
    arguments::{Global, SignedId},
    connection::Connection,
    failure::Failure,
    values::{Values, or_dash},
};

/// Prints what the motors report.
pub fn run(global: &Global, as_json: bool, ender: &Ender) -> Result<(), Failure> {
    let mut connection = Connection::open(global, ender)?;
    connection.wait_for_motors()?;
    // The first reply to an ID query has no temperature.
    connection.wait_for(global.timeout, |status| {
        let known = status
            .motors
            .iter()
            .all(|motor| motor.temperature.is_some());
        known.then_some(())
    })?;
    let status = connection.status()?;
    let model = connection.driver.model();
    let motors = connection.motors.iter().filter_map(|signed| {
        let motor = status.motors.iter().find(|motor| motor.id == signed.id)?;
        Some((*signed, *motor))
    });
    if as_json {
        let motors = motors.map(|(signed, motor)| to_json(model, &motor, status.now, signed));
        println!("{}", Value::from(motors.collect::<Vec<_>>()));
    } else {
        for (signed, motor) in motors {
            print(model, &motor, status.now, signed);
        }
    }
    connection.end()
}

fn print(model: Model, motor: &MotorStatus, now: Instant, signed: SignedId) {
    let values = Values::of(model, motor, now, signed);
    let spec = model.spec();
    println!("Motor       {signed} ({})", signed.id.get());
    println!(
        "Model       {model} ({}), {} baud",
        spec.maker_name, spec.baud
    );
    println!("Loop        {}", or_dash(values.mode));
    println!(
        "Speed       {}",
        or_dash(values.speed_rpm.map(|rpm| format!("{rpm:+} rpm")))
    );
    println!("Current     {}", or_dash(values.current));
    println!("Angle       {}", or_dash(values.angle));
    println!("Temperature {}", or_dash(values.temperature));
    println!("Faults      {}", or_dash(values.faults));
    let round_trip = motor.link.round_trip_us;
    println!(
        "Round trip  {}",
        or_dash(round_trip.map(|us| format!("{:.2} ms", f64::from(us) / 1000.0)))
    );
    if motor.turns_unasked {
        println!("It turns, and nothing here drives it: motorlink stop");
    }
}

fn to_json(model: Model, motor: &MotorStatus, now: Instant, signed: SignedId) -> Value {
    let values = Values::of(model, motor, now, signed);
    let reply = motor.last.map(|sample| sample.reply);
    json!({
        "id": signed.id.get(),
        "is_mirrored": signed.mirror.is_mirrored(),
        "model": model.spec().key,
        "mode": values.mode,
        "speed_rpm": values.speed_rpm,
        "temperature_c": motor.temperature.map(|(_, celsius)| celsius.degrees()),
        "fault_code": reply.map(|reply| reply.faults.byte()),
        "faults": reply.map(|reply| reply.faults.iter().map(Fault::name).collect::<Vec<_>>()),
        "round_trip_us": motor.link.round_trip_us,
        "turns_unasked": motor.turns_unasked,
    })
}

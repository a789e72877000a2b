//! `motorlink info`: what each motor reports now.

use motorlink_bus::{FRESH_FOR, MotorStatus};
use motorlink_driver::Ender;
use motorlink_protocol::{Angle, Celsius, Current, Fault, Instant, family::Model};
use serde_json::{Value, json};

use crate::{
    arguments::Global,
    connection::on_line,
    failure::Failure,
    output::print,
    signed_id::SignedId,
    values::{Values, fresh_temperature, or_dash},
};

/// Prints what the motors report.
pub fn run(global: &Global, as_json: bool, ender: &Ender) -> Result<(), Failure> {
    on_line(
        global,
        ender,
        |_| (),
        |connection| {
            connection.wait_for_motors()?;
            // The first reply to an ID query has no temperature.
            connection.wait_for(global.timeout, |status| {
                let mut motors = status.motors.iter();
                motors
                    .all(|motor| motor.temperature.is_some())
                    .then_some(())
            })?;
            let status = connection.status()?;
            let model = connection.driver.model();
            let of = |signed: &SignedId| Some((*signed, *status.motor(signed.id)?));
            let mut motors = connection.motors.iter().filter_map(of);
            if as_json {
                let motors =
                    motors.map(|(signed, motor)| to_json(model, &motor, status.now, signed));
                return print(Value::from(motors.collect::<Vec<_>>()));
            }
            motors.try_for_each(|(signed, motor)| describe(model, &motor, status.now, signed))
        },
    )
}

fn describe(
    model: Model,
    motor: &MotorStatus,
    now: Instant,
    signed: SignedId,
) -> Result<(), Failure> {
    let values = Values::of(model, motor, now, signed);
    let spec = model.spec();
    print(format_args!("Motor       {signed} ({})", signed.id.get()))?;
    print(format_args!(
        "Model       {model} ({}), {} baud",
        spec.maker_name, spec.baud
    ))?;
    print(format_args!("Loop        {}", or_dash(values.mode)))?;
    print(format_args!(
        "Speed       {}",
        or_dash(values.speed_rpm.map(|rpm| format!("{rpm:+} rpm")))
    ))?;
    print(format_args!("Current     {}", or_dash(values.current)))?;
    print(format_args!("Angle       {}", or_dash(values.angle)))?;
    print(format_args!("Temperature {}", or_dash(values.temperature)))?;
    print(format_args!("Faults      {}", or_dash(values.faults)))?;
    let round_trip = motor.link.round_trip_us;
    print(format_args!(
        "Round trip  {}",
        or_dash(round_trip.map(|us| format!("{:.2} ms", f64::from(us) / 1000.0)))
    ))?;
    if motor.turns_unasked {
        print(format_args!(
            "It turns, and nothing here drives it: motorlink stop"
        ))?;
    }
    Ok(())
}

fn to_json(model: Model, motor: &MotorStatus, now: Instant, signed: SignedId) -> Value {
    let values = Values::of(model, motor, now, signed);
    let reply = motor.last.map(|sample| sample.reply);
    let current = motor.current.filter(|(at, _)| now.since(*at) <= FRESH_FOR);
    let current = current.map(|(_, current)| signed.mirror.current(current));
    let is_certain = model.spec().current.is_certain();
    let angle = reply.and_then(|reply| reply.detail.angle());
    json!({
        "id": signed.id.get(),
        "is_mirrored": signed.mirror.is_mirrored(),
        "model": model.spec().key,
        "mode": values.mode,
        "speed_rpm": values.speed_rpm,
        "current_a": current.filter(|_| is_certain).map(Current::amps),
        "current_raw": current.map(Current::raw),
        "angle_deg": angle.map(Angle::degrees),
        "temperature_c": fresh_temperature(motor, now).map(Celsius::degrees),
        "fault_code": reply.map(|reply| reply.faults.byte()),
        "faults": reply.map(|reply| reply.faults.iter().map(Fault::name).collect::<Vec<_>>()),
        "round_trip_us": motor.link.round_trip_us,
        "turns_unasked": motor.turns_unasked,
    })
}

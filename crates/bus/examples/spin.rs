//! Drives motor 1 at 50 rpm for two seconds over a serial port of this machine, and stops it.
//!
//! `cargo run -p motorlink-bus --example spin -- /dev/ttyUSB0`. **The wheel turns**: fasten the motor
//! first. If this program or the cable fails, the wheel may keep turning: only
//! the power switch stops it then.

use std::{env, error::Error, io::ErrorKind, time};

use motorlink_bus::{Bus, Command, Consent, Event, Output, StopReason};
use motorlink_protocol::{Instant, MotorId, Setpoint, SpeedTarget};

const ID: MotorId = MotorId::FIRST;
const DRIVE_FOR: time::Duration = time::Duration::from_secs(2);
const PRINT_EVERY: time::Duration = time::Duration::from_millis(250);

fn main() -> Result<(), Box<dyn Error>> {
    spin(&env::args().nth(1).ok_or("which port? /dev/ttyUSB0")?)
}

/// Ends well only where the motor's own replies have reported standstill.
pub(crate) fn spin(path: &str) -> Result<(), Box<dyn Error>> {
    let mut port = serialport::new(path, 115_200).open()?;
    let began = time::Instant::now();
    let clock = || Instant::ZERO + began.elapsed();
    #[rustfmt::skip]
    let drive = Command::Drive { id: ID, setpoint: Setpoint::velocity(SpeedTarget::new(50)?), consent: Consent::None };
    let mut bus = Bus::new(clock());
    bus.command(clock(), Command::Watch(ID))?;
    let (mut stop_at, mut print_at, mut heard) = (None, Instant::ZERO, [0; 256]);
    loop {
        let now = clock();
        if stop_at.is_some_and(|at| now >= at) && !bus.is_halted() {
            bus.command(now, Command::StopAll(StopReason::Operator))?;
        }
        match bus.poll(now) {
            Output::Transmit(frame) => port.write_all(frame.bytes())?,
            Output::Wait(until) => {
                port.set_timeout(until.since(now))?;
                match port.read(&mut heard) {
                    Ok(count) => bus.receive(clock(), heard.get(..count).unwrap_or_default()),
                    Err(error) if error.kind() == ErrorKind::TimedOut => {}
                    Err(error) => return Err(error.into()),
                }
            }
            Output::Event(Event::PingPage) => bus.page_answered(now),
            // Which loop it closes is known by now; before, the bus refuses to drive it.
            Output::Event(Event::Telemetry(_)) if stop_at.is_none() => {
                bus.command(now, drive)?;
                stop_at = Some(now + DRIVE_FOR);
            }
            Output::Event(Event::Telemetry(sample)) if now >= print_at => {
                print_at = now + PRINT_EVERY;
                let reply = sample.reply;
                if let (Some(speed), Some(current)) = (reply.speed, reply.current) {
                    println!("{now:?}  {speed}  {current}  {}", reply.faults);
                }
            }
            Output::Event(Event::StopEnded(report)) => {
                println!("{now:?}  {:?}", report.motors);
                let all_stand = report.motors.iter().all(|motor| motor.confirmed);
                return all_stand.then_some(()).ok_or("no standstill".into());
            }
            Output::Event(Event::MotorSilent { .. }) if stop_at.is_none() => {
                return Err("no answer".into());
            }
            Output::Event(_) => {}
        }
    }
}

//! Commands of a test, one per line, while the program runs.

use std::time::Duration;

use motorlink_protocol::{MotorId, family::Mode};
use motorlink_simulator::{VirtualMotor, World};

use crate::virtual_motors::flags::{celsius, load_nm};

const COMMANDS: &str = "block ID on|off, load ID N.M, temperature ID C, power ID on|off, \
                        mute ID on|off, state ID, stall MS, unplug, plug";

/// Longest stall taken: an adapter that stalls for a minute has been pulled by then.
const STALL_MS_MAX: u64 = 60_000;

/// What a line asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Command {
    /// Something is done to the adapter.
    Adapter(OfAdapter),
    /// Something is done to a motor, or it is looked at.
    Motor(MotorId, Action),
}

/// What is done to the adapter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OfAdapter {
    /// Nothing passes between terminal and wire for so long.
    Stall(Duration),
    /// It is pulled out. Its motors go on.
    Unplug,
    /// It is plugged again, as another terminal at the same link.
    Plug,
}

/// What is done to a motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Action {
    Block(bool),
    Load(f32),
    Temperature(f32),
    Power(bool),
    Mute(bool),
    State,
}

/// Obeys a line and gives the line to answer: `ok ..` or `error: ..`. `of_adapter` does what concerns the adapter.
pub(crate) fn obey(
    line: &str,
    world: &mut World,
    of_adapter: impl FnOnce(OfAdapter) -> Result<(), String>,
) -> String {
    let said = parse(line).and_then(|command| match command {
        Command::Adapter(asked) => {
            of_adapter(asked)?;
            Ok(match asked {
                OfAdapter::Stall(time) => format!("stall {}", time.as_millis()),
                OfAdapter::Unplug => "unplug".to_owned(),
                OfAdapter::Plug => "plug".to_owned(),
            })
        }
        Command::Motor(id, action) => {
            let motor = world.motor_mut(id);
            let motor = motor.ok_or_else(|| format!("no motor has the ID {}", id.get()))?;
            Ok(act(id, action, motor))
        }
    });
    match said {
        Ok(text) => format!("ok {text}"),
        Err(text) => format!("error: {text}"),
    }
}

fn act(id: MotorId, action: Action, motor: &mut VirtualMotor) -> String {
    let id = id.get();
    let on_off = |on: bool| if on { "on" } else { "off" };
    match action {
        Action::Block(on) => {
            motor.block(on);
            format!("{id} block {}", on_off(on))
        }
        Action::Load(nm) => {
            motor.set_load_nm(nm);
            format!("{id} load {nm}")
        }
        Action::Temperature(celsius) => {
            motor.set_temperature_c(celsius);
            format!("{id} temperature {celsius}")
        }
        Action::Power(on) => {
            motor.power(on);
            format!("{id} power {}", on_off(on))
        }
        Action::Mute(on) => {
            motor.mute(on);
            format!("{id} mute {}", on_off(on))
        }
        Action::State => state(id, motor),
    }
}

fn state(id: u8, motor: &VirtualMotor) -> String {
    let mode = match motor.active_mode() {
        None if motor.is_powered() => "disabled",
        active => match active.unwrap_or(motor.mode()) {
            Mode::OpenLoop => "open-loop",
            Mode::Current => "current",
            Mode::Velocity => "velocity",
            Mode::Position => "position",
        },
    };
    format!(
        "{id} rpm={:.2} mode={mode} angle={:.2} current={:.3} temperature={:.1} faults=0x{:02X} \
         driven={} power={}",
        motor.speed_rpm(),
        motor.angle_deg(),
        motor.current_a(),
        motor.temperature_c(),
        motor.fault_byte(),
        motor.is_driven(),
        motor.is_powered(),
    )
}

fn parse(line: &str) -> Result<Command, String> {
    let mut words = line.split_ascii_whitespace();
    let (verb, id, value) = (words.next(), words.next(), words.next());
    if words.next().is_some() {
        return Err(format!("too many words; known are {COMMANDS}"));
    }
    match (verb, id) {
        (Some("unplug"), None) => return Ok(Command::Adapter(OfAdapter::Unplug)),
        (Some("plug"), None) => return Ok(Command::Adapter(OfAdapter::Plug)),
        _ => {}
    }
    if let (Some("stall"), None) = (verb, value) {
        let millis = id.and_then(|millis| millis.parse().ok());
        return millis
            .filter(|millis| (1..=STALL_MS_MAX).contains(millis))
            .map(|millis| Command::Adapter(OfAdapter::Stall(Duration::from_millis(millis))))
            .ok_or_else(|| format!("expected 1 to {STALL_MS_MAX} ms"));
    }
    let switch = || match value {
        Some("on") => Ok(true),
        Some("off") => Ok(false),
        _ => Err("expected `on` or `off`".to_owned()),
    };
    let action = match (verb, value) {
        (Some("block"), _) => Action::Block(switch()?),
        (Some("power"), _) => Action::Power(switch()?),
        (Some("mute"), _) => Action::Mute(switch()?),
        (Some("load"), value) => Action::Load(load_nm(value.unwrap_or_default())?),
        (Some("temperature"), value) => Action::Temperature(celsius(value.unwrap_or_default())?),
        (Some("state"), None) => Action::State,
        _ => return Err(format!("known are {COMMANDS}")),
    };
    let id: MotorId = id
        .unwrap_or_default()
        .parse()
        .map_err(|error| format!("{error}"))?;
    Ok(Command::Motor(id, action))
}

#[cfg(test)]
mod tests {
    use motorlink_simulator::WorldConfig;

    use super::*;

    fn obey(line: &str, world: &mut World) -> String {
        super::obey(line, world, |_| Ok(()))
    }

    #[test]
    fn a_stall_is_told_how_long_it_is() {
        let (mut world, mut stall) = (World::new(WorldConfig::default()), None);
        let answer = super::obey("stall 1000", &mut world, |asked| {
            stall = Some(asked);
            Ok(())
        });
        assert_eq!(answer, "ok stall 1000");
        assert_eq!(stall, Some(OfAdapter::Stall(Duration::from_secs(1))));
    }

    #[test]
    fn every_command_does_what_it_says() {
        let mut world = World::new(WorldConfig::default());
        assert_eq!(obey("block 1 on", &mut world), "ok 1 block on");
        assert_eq!(obey("load 1 0.5", &mut world), "ok 1 load 0.5");
        assert_eq!(obey("temperature 1 60", &mut world), "ok 1 temperature 60");
        assert_eq!(obey("mute 0x01 off", &mut world), "ok 1 mute off");
        assert_eq!(obey("power 1 off", &mut world), "ok 1 power off");
        let state = obey("state 1", &mut world);
        assert!(
            state.starts_with("ok 1 rpm=0.00 mode=velocity angle=0.00 "),
            "{state}"
        );
        assert!(state.ends_with("power=false"), "{state}");
    }

    #[test]
    fn a_line_that_makes_no_sense_says_why() {
        let mut world = World::new(WorldConfig::default());
        for line in [
            "",
            "dance 1",
            "block",
            "block 1",
            "block 1 maybe",
            "block 0 on",
            "block 2 on",
            "load 1 NaN",
            "load 1 -1",
            "temperature 1 hot",
            "state",
            "state 1 now",
            "block 1 on off",
            "stall",
            "stall 0",
            "stall 60001",
            "stall 1 on",
            "unplug 1",
            "plug 1",
        ] {
            let answer = obey(line, &mut world);
            assert!(answer.starts_with("error: "), "{line:?} gave {answer:?}");
            assert_eq!(answer.lines().count(), 1);
        }
    }
}

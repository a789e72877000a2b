//! What a test may do to a motor while it runs, one line each.

use motorlink_protocol::{Mode, MotorId};
use motorlink_simulator::{VirtualMotor, World};

use crate::arguments::{celsius, load_nm};

const COMMANDS: &str = "block ID on|off, load ID N.M, temperature ID C, power ID on|off, \
                        mute ID on|off, state ID";

/// A command that makes sense.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Action {
    Block(bool),
    Load(f32),
    Temperature(f32),
    Power(bool),
    Mute(bool),
    State,
}

/// Obeys a line and gives the line to answer: `ok ..` or `error: ..`.
pub(crate) fn obey(line: &str, world: &mut World) -> String {
    let said = parse(line).and_then(|(id, action)| {
        let motor = world.motor_mut(id);
        let motor = motor.ok_or_else(|| format!("no motor has the ID {}", id.get()))?;
        Ok(act(id, action, motor))
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
    let mode = match motor.mode() {
        Mode::Current => "current",
        Mode::Velocity => "velocity",
        Mode::Position => "position",
    };
    format!(
        "{id} rpm={:.2} mode={mode} angle={:.2} current={:.3} temperature={:.1} faults=0x{:02X} \
         driven={} power={}",
        motor.speed_rpm(),
        motor.angle_deg(),
        motor.current_a(),
        motor.temperature_c(),
        motor.faults().byte(),
        motor.is_driven(),
        motor.is_powered(),
    )
}

fn parse(line: &str) -> Result<(MotorId, Action), String> {
    let mut words = line.split_ascii_whitespace();
    let (verb, id, value) = (words.next(), words.next(), words.next());
    if words.next().is_some() {
        return Err(format!("too many words; known are {COMMANDS}"));
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
    Ok((id, action))
}

#[cfg(test)]
mod tests {
    use motorlink_simulator::WorldConfig;

    use super::*;

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
        ] {
            let answer = obey(line, &mut world);
            assert!(answer.starts_with("error: "), "{line:?} gave {answer:?}");
            assert_eq!(answer.lines().count(), 1);
        }
    }
}

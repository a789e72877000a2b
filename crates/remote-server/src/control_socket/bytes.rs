//! The bytes of the messages. All numbers are little-endian; `docs/socket.md` has the tables.

use motorlink_protocol::MotorId;

use super::messages::{
    FROM_CLIENT, FROM_SERVER, FromClient, Holder, MAGIC, MOTORS_MAX, Motor, Order, State, VERSION,
    Wrong,
};

/// Where the motors begin in a state, and the size of each.
const MOTORS_AT: usize = 32;
const MOTOR: usize = 48;

/// An age that is not known, or too long.
const NO_AGE: u32 = u32::MAX;

pub(super) fn hello() -> Vec<u8> {
    let size = u16::try_from(FROM_SERVER).unwrap_or_default();
    let (version, size) = (VERSION.to_le_bytes(), size.to_le_bytes());
    [&MAGIC[..], &version, &size].concat()
}

/// Checks the hello of a client.
pub(super) fn check_hello(bytes: &[u8]) -> Result<(), Wrong> {
    let mut reader = Reader(bytes);
    if reader.take() != MAGIC {
        return Err(Wrong::Magic);
    }
    let version = u16::from_le_bytes(reader.take());
    if version == VERSION {
        Ok(())
    } else {
        Err(Wrong::Version(version))
    }
}

pub(super) fn decode(bytes: &[u8; FROM_CLIENT]) -> Result<FromClient, Wrong> {
    let mut reader = Reader(bytes);
    let [kind, count, _, _] = reader.take();
    let number = u32::from_le_bytes(reader.take());
    let challenge = u64::from_le_bytes(reader.take());
    let ids: [u8; MOTORS_MAX] = reader.take();
    let mut order = Order {
        number,
        challenge,
        speeds: Vec::new(),
    };
    if kind == 3 {
        return Ok(FromClient::Disarm);
    }
    let count = usize::from(count);
    if !(1..=MOTORS_MAX).contains(&count) {
        return Err(Wrong::Motors);
    }
    for id in ids.into_iter().take(count) {
        let id = MotorId::new(id).map_err(|_| Wrong::Motors)?;
        if order.speeds.iter().any(|(named, _)| *named == id) {
            return Err(Wrong::Motors);
        }
        order.speeds.push((id, f32::from_le_bytes(reader.take())));
    }
    match kind {
        1 => Ok(FromClient::Arm(order)),
        2 => Ok(FromClient::Setpoints(order)),
        kind => Err(Wrong::Kind(kind)),
    }
}

pub(super) fn encode(state: &State) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(FROM_SERVER);
    let (number, result) = state.arm;
    let flags = u8::from(state.holder.0 == Holder::You)
        | u8::from(state.is_halted) << 1
        | u8::from(state.is_open) << 2;
    bytes.extend([1, flags, state.drive as u8, state.ended as u8]);
    bytes.extend(number.to_le_bytes());
    bytes.extend(state.challenge.to_le_bytes());
    bytes.extend(state.sent_us.to_le_bytes());
    bytes.extend(state.holder.1.to_le_bytes());
    let count = state.motors.len().min(MOTORS_MAX);
    bytes.extend([
        state.holder.0 as u8,
        u8::try_from(count).unwrap_or_default(),
        result.map_or(0, |why| why as u8),
        0,
    ]);
    for motor in state.motors.iter().take(MOTORS_MAX) {
        push_motor(&mut bytes, motor);
    }
    let unused = Motor::default();
    while bytes.len() < MOTORS_AT + MOTORS_MAX * MOTOR {
        push_motor(&mut bytes, &unused);
    }
    bytes
}

fn push_motor(bytes: &mut Vec<u8>, motor: &Motor) {
    let age = |age: Option<u32>| age.unwrap_or(NO_AGE).to_le_bytes();
    let value = |value: Option<(f32, u32)>| value.map_or(f32::NAN, |(value, _)| value);
    let age_of = |value: Option<(f32, u32)>| age(value.map(|(_, age)| age));
    bytes.extend([motor.id, motor.activity, motor.flags, motor.faults]);
    bytes.extend(age(motor.reply_age));
    let position = motor.position.map_or(f64::NAN, |(position, _)| position);
    bytes.extend(position.to_le_bytes());
    for measured in [motor.velocity, motor.current, motor.temperature] {
        bytes.extend(value(measured).to_le_bytes());
    }
    bytes.extend(age(motor.position.map(|(_, age)| age)));
    for measured in [motor.velocity, motor.current, motor.temperature] {
        bytes.extend(age_of(measured));
    }
    bytes.extend([0; 4]);
}

/// The last message of a connection.
pub(super) fn error(wrong: Wrong) -> Vec<u8> {
    let text = wrong.to_string();
    let length = u16::try_from(text.len()).unwrap_or_default();
    let mut bytes = vec![2, wrong.code()];
    bytes.extend(length.to_le_bytes());
    bytes.extend(text.as_bytes());
    bytes.resize(FROM_SERVER, 0);
    bytes
}

/// Reads a message of fixed size from its beginning.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    /// The next bytes. Beyond the end of the message there are zeros, which no caller reads.
    fn take<const N: usize>(&mut self) -> [u8; N] {
        match self.0.split_first_chunk() {
            Some((taken, rest)) => {
                self.0 = rest;
                *taken
            }
            None => [0; N],
        }
    }
}

#[cfg(test)]
#[path = "bytes_tests.rs"]
mod tests;

//! The bytes of the messages. All numbers are little-endian; `docs/socket.md` has the tables.

use motorlink_protocol::{MotorId, family::Model};

use crate::messages::{
    Activity, DriveState, EndReason, FROM_CLIENT, FROM_SERVER, FromClient, FromServer, HELLO,
    Holder, MAGIC, MOTORS_MAX, Motor, NotArmed, Refusal, Setpoints, State, VERSION,
};

/// Where the speeds begin in a message of a client.
const SPEEDS_AT: usize = 24;

/// Where the motors begin in a state, and the size of each.
const MOTORS_AT: usize = 32;
const MOTOR: usize = 48;

/// An age that is not known, or too long.
const NO_AGE: u32 = u32::MAX;

/// The first message of the server.
#[must_use]
pub fn server_hello() -> Vec<u8> {
    hello(FROM_SERVER)
}

/// The first message of a client.
#[must_use]
pub fn client_hello() -> Vec<u8> {
    hello(FROM_CLIENT)
}

fn hello(size: usize) -> Vec<u8> {
    let size = u16::try_from(size).unwrap_or_default();
    let (version, size) = (VERSION.to_le_bytes(), size.to_le_bytes());
    [&MAGIC[..], &version, &size].concat()
}

/// Checks the hello of the server. A client of another version closes.
///
/// # Errors
///
/// What differs.
pub fn check_server_hello(bytes: &[u8; HELLO]) -> Result<(), String> {
    let mut reader = Reader(bytes);
    if reader.take() != MAGIC {
        return Err("no motorlink listens there".to_owned());
    }
    let version = u16::from_le_bytes(reader.take());
    if version == VERSION {
        return Ok(());
    }
    Err(format!(
        "motorlink speaks version {version} of the socket, this program version {VERSION}: use those of the same release"
    ))
}

/// Checks the hello of a client.
///
/// # Errors
///
/// When it is none, or of another version.
pub fn check_hello(bytes: &[u8]) -> Result<(), Refusal> {
    let mut reader = Reader(bytes);
    if reader.take() != MAGIC {
        return Err(Refusal::Magic);
    }
    let version = u16::from_le_bytes(reader.take());
    if version == VERSION {
        Ok(())
    } else {
        Err(Refusal::Version(version))
    }
}

/// Reads a message of a client.
///
/// # Errors
///
/// What is wrong with it.
pub fn decode_from_client(bytes: &[u8; FROM_CLIENT]) -> Result<FromClient, Refusal> {
    let mut reader = Reader(bytes);
    let [kind, count, _, _] = reader.take();
    let number = u32::from_le_bytes(reader.take());
    let challenge = u64::from_le_bytes(reader.take());
    let ids: [u8; MOTORS_MAX] = reader.take();
    let mut setpoints = Setpoints {
        number,
        challenge,
        speeds: Vec::new(),
    };
    if kind == 3 {
        return Ok(FromClient::Disarm);
    }
    let count = usize::from(count);
    if !(1..=MOTORS_MAX).contains(&count) {
        return Err(Refusal::Motors);
    }
    for id in ids.into_iter().take(count) {
        let id = MotorId::new(id).map_err(|_| Refusal::Motors)?;
        if setpoints.speeds.iter().any(|(named, _)| *named == id) {
            return Err(Refusal::Motors);
        }
        setpoints
            .speeds
            .push((id, f32::from_le_bytes(reader.take())));
    }
    match kind {
        1 => Ok(FromClient::Arm(setpoints)),
        2 => Ok(FromClient::Setpoints(setpoints)),
        kind => Err(Refusal::Kind(kind)),
    }
}

/// Writes a state.
#[must_use]
pub fn encode_state(state: &State) -> Vec<u8> {
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
        number_of(state.model),
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

/// The number of a model; 0 while it is not known.
const fn number_of(model: Option<Model>) -> u8 {
    match model {
        None => 0,
        Some(Model::Ddsm115) => 1,
        Some(Model::Ddsm315) => 2,
        Some(Model::Ddsm210) => 3,
        Some(Model::Ddsm400) => 4,
    }
}

/// The model of this number. That of a later release is not known here.
fn model_of(number: u8) -> Option<Model> {
    let mut models = Model::ALL.into_iter();
    models.find(|model| number_of(Some(*model)) == number)
}

fn push_motor(bytes: &mut Vec<u8>, motor: &Motor) {
    let age = |age: Option<u32>| age.unwrap_or(NO_AGE).to_le_bytes();
    let value = |value: Option<(f32, u32)>| value.map_or(f32::NAN, |(value, _)| value);
    let age_of = |value: Option<(f32, u32)>| age(value.map(|(_, age)| age));
    let flags = u8::from(motor.is_silent)
        | u8::from(motor.may_turn) << 1
        | u8::from(motor.turns_unasked) << 2
        | u8::from(motor.faults.is_some()) << 3;
    let faults = motor.faults.unwrap_or_default();
    bytes.extend([motor.id, motor.activity as u8, flags, faults]);
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

/// Writes the last message of a connection.
#[must_use]
pub fn encode_error(refusal: Refusal) -> Vec<u8> {
    let text = refusal.to_string();
    let length = u16::try_from(text.len()).unwrap_or_default();
    let mut bytes = vec![2, refusal.code()];
    bytes.extend(length.to_le_bytes());
    bytes.extend(text.as_bytes());
    bytes.resize(FROM_SERVER, 0);
    bytes
}

/// Writes a message of a client.
#[must_use]
pub fn encode_from_client(message: &FromClient) -> [u8; FROM_CLIENT] {
    let none = Setpoints {
        number: 0,
        challenge: 0,
        speeds: Vec::new(),
    };
    let (kind, setpoints) = match message {
        FromClient::Arm(setpoints) => (1, setpoints),
        FromClient::Setpoints(setpoints) => (2, setpoints),
        FromClient::Disarm => (3, &none),
    };
    let speeds = || setpoints.speeds.iter().take(MOTORS_MAX);
    let count = u8::try_from(speeds().count()).unwrap_or_default();
    let mut written = Vec::with_capacity(FROM_CLIENT);
    written.extend([kind, count, 0, 0]);
    written.extend(setpoints.number.to_le_bytes());
    written.extend(setpoints.challenge.to_le_bytes());
    written.extend(speeds().map(|(id, _)| id.get()));
    written.resize(SPEEDS_AT, 0);
    written.extend(speeds().flat_map(|(_, speed)| speed.to_le_bytes()));
    written.resize(FROM_CLIENT, 0);
    Reader(&written).take()
}

/// Reads a message of the server; `None` if it is none of this version.
#[must_use]
pub fn decode_from_server(bytes: &[u8; FROM_SERVER]) -> Option<FromServer> {
    let mut reader = Reader(bytes);
    let [kind, second, third, fourth] = reader.take();
    if kind == 2 {
        let length = usize::from(u16::from_le_bytes([third, fourth]));
        let text = reader.0.get(..length)?;
        return Some(FromServer::Closes(
            String::from_utf8_lossy(text).into_owned(),
        ));
    }
    if kind != 1 {
        return None;
    }
    let number = u32::from_le_bytes(reader.take());
    let (challenge, sent_us) = (
        u64::from_le_bytes(reader.take()),
        u64::from_le_bytes(reader.take()),
    );
    let holder_number = u32::from_le_bytes(reader.take());
    let [holder, count, refused, model] = reader.take();
    let mut state = State {
        is_halted: second & 2 != 0,
        is_open: second & 4 != 0,
        drive: DriveState::of_number(third)?,
        ended: EndReason::of_number(fourth)?,
        arm: (number, NotArmed::of_number(refused)),
        challenge,
        sent_us,
        holder: (Holder::of_number(holder)?, holder_number),
        model: model_of(model),
        motors: Vec::new(),
    };
    for _ in 0..usize::from(count).min(MOTORS_MAX) {
        state.motors.push(take_motor(&mut reader)?);
    }
    Some(FromServer::State(state))
}

fn take_motor(reader: &mut Reader<'_>) -> Option<Motor> {
    let [id, activity, flags, faults] = reader.take();
    let reply_age = reader.take_age();
    let position = f64::from_le_bytes(reader.take());
    let velocity = f32::from_le_bytes(reader.take());
    let current = f32::from_le_bytes(reader.take());
    let temperature = f32::from_le_bytes(reader.take());
    let ages: [Option<u32>; 4] = std::array::from_fn(|_| reader.take_age());
    let [of_position, of_velocity, of_current, of_temperature] = ages;
    let _: [u8; 4] = reader.take();
    let known =
        |value: f32, age: Option<u32>| Some((value, age?)).filter(|(value, _)| !value.is_nan());
    Some(Motor {
        id,
        activity: Activity::of_number(activity)?,
        is_silent: flags & 1 != 0,
        may_turn: flags & 2 != 0,
        turns_unasked: flags & 4 != 0,
        faults: (flags & 8 != 0).then_some(faults),
        reply_age,
        position: Some(position)
            .filter(|position| !position.is_nan())
            .zip(of_position),
        velocity: known(velocity, of_velocity),
        current: known(current, of_current),
        temperature: known(temperature, of_temperature),
    })
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

    fn take_age(&mut self) -> Option<u32> {
        let age = u32::from_le_bytes(self.take());
        (age != NO_AGE).then_some(age)
    }
}

#[cfg(test)]
#[path = "bytes_tests.rs"]
mod tests;

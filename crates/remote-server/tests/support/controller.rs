//! A client of the socket, by the bytes of docs/socket.md. Tests of the server and of the command use it.
#![allow(dead_code, reason = "each test file uses its own part of the client")]

use std::{
    io::{ErrorKind, Read, Write},
    os::unix::net::UnixStream,
    panic::catch_unwind,
    path::Path,
    time::{Duration, Instant},
};

/// Longer than any wait of a test.
const SOON: Duration = Duration::from_secs(10);

pub const HELLO: [u8; 8] = [0x89, b'M', b'L', b'S', 1, 0, 56, 0];
const FROM_SERVER: usize = 416;

/// What becomes of a drive.
pub const STARTING: u8 = 1;
pub const DRIVEN: u8 = 2;
pub const STOPPING: u8 = 3;
pub const STANDS: u8 = 4;
pub const NOT_CONFIRMED: u8 = 5;

/// A state, as it came.
#[derive(Clone)]
pub struct State(Vec<u8>);

impl State {
    fn part<const N: usize>(&self, at: usize) -> [u8; N] {
        self.0[at..at + N].try_into().unwrap()
    }

    pub fn is_armed(&self) -> bool {
        self.0[1] & 1 != 0
    }

    pub fn is_halted(&self) -> bool {
        self.0[1] & 2 != 0
    }

    pub fn drive(&self) -> u8 {
        self.0[2]
    }

    pub fn ended(&self) -> u8 {
        self.0[3]
    }

    /// The number of the newest ARM, and why it was refused.
    pub fn arm(&self) -> (u32, u8) {
        (u32::from_le_bytes(self.part(4)), self.0[30])
    }

    pub fn challenge(&self) -> u64 {
        u64::from_le_bytes(self.part(8))
    }

    /// How long ago it was sent, by the clock of the computer.
    pub fn sent_ago(&self) -> Duration {
        let now = rustix::time::clock_gettime(rustix::time::ClockId::Monotonic);
        let now = Duration::new(
            now.tv_sec.try_into().unwrap(),
            now.tv_nsec.try_into().unwrap(),
        );
        now.saturating_sub(Duration::from_micros(u64::from_le_bytes(self.part(16))))
    }

    /// Kind and number of who has control.
    pub fn holder(&self) -> (u8, u32) {
        (self.0[28], u32::from_le_bytes(self.part(24)))
    }

    pub fn motors(&self) -> u8 {
        self.0[29]
    }

    fn place(&self, id: u8) -> usize {
        let mut places = (32..FROM_SERVER).step_by(48);
        places.find(|at| self.0[*at] == id).expect("the motor")
    }

    fn float(&self, at: usize) -> f32 {
        f32::from_le_bytes(self.part(at))
    }

    /// In rad.
    pub fn position(&self, id: u8) -> f64 {
        f64::from_le_bytes(self.part(self.place(id) + 8))
    }

    /// In rad/s.
    pub fn velocity(&self, id: u8) -> f32 {
        self.float(self.place(id) + 16)
    }

    /// In degrees Celsius.
    pub fn temperature(&self, id: u8) -> f32 {
        self.float(self.place(id) + 24)
    }

    /// The age of the newest reply.
    pub fn age(&self, id: u8) -> Duration {
        let us = u32::from_le_bytes(self.part(self.place(id) + 4));
        Duration::from_micros(us.into())
    }
}

/// A client that has said hello.
pub struct Controller {
    pub stream: UnixStream,
    pub state: State,
    incoming: Vec<u8>,
    arms: u32,
}

impl Controller {
    pub fn connect(path: &Path) -> Self {
        let mut stream = UnixStream::connect(path).unwrap();
        stream.set_read_timeout(Some(SOON)).unwrap();
        stream.write_all(&HELLO).unwrap();
        let mut hello = [0; 8];
        stream.read_exact(&mut hello).unwrap();
        assert_eq!(hello, [0x89, b'M', b'L', b'S', 1, 0, 0xA0, 1]);
        let state = State(vec![0; FROM_SERVER]);
        let mut controller = Self {
            stream,
            state,
            incoming: Vec::new(),
            arms: 0,
        };
        controller.wait("a challenge", |state| state.challenge() != 0);
        controller
    }

    /// Waits for a message and takes all that have come: the newest one counts. `Err` has the text of an error of the
    /// server, or is empty at the end.
    pub fn next(&mut self) -> Result<(), String> {
        let mut is_first = true;
        loop {
            self.stream.set_nonblocking(!is_first).unwrap();
            let mut bytes = [0; 16 * FROM_SERVER];
            match self.stream.read(&mut bytes) {
                Ok(0) => return Err(String::new()),
                Ok(got) => self.incoming.extend(&bytes[..got]),
                Err(error) if error.kind() == ErrorKind::WouldBlock && is_first => {
                    panic!("nothing comes")
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(_) => return Err(String::new()),
            }
            let whole = self.incoming.len() / FROM_SERVER * FROM_SERVER;
            for message in self
                .incoming
                .drain(..whole)
                .collect::<Vec<_>>()
                .chunks(FROM_SERVER)
            {
                if message[0] == 2 {
                    let length = usize::from(u16::from_le_bytes([message[2], message[3]]));
                    let text = message[4..4 + length].to_vec();
                    return Err(String::from_utf8(text).unwrap());
                }
                assert_eq!(message[0], 1);
                self.state = State(message.to_vec());
                is_first = false;
            }
        }
        self.stream.set_nonblocking(false).unwrap();
        Ok(())
    }

    /// Takes states until this is so, without an answer.
    pub fn wait(&mut self, what: &str, mut is_so: impl FnMut(&State) -> bool) {
        let until = Instant::now() + SOON;
        loop {
            self.next().unwrap();
            if is_so(&self.state) {
                return;
            }
            assert!(Instant::now() < until, "waited for {what}");
        }
    }

    /// Gives these setpoints with each state until this is so.
    pub fn drive(
        &mut self,
        speeds: &[(u8, f32)],
        what: &str,
        mut is_so: impl FnMut(&State) -> bool,
    ) {
        let until = Instant::now() + SOON;
        loop {
            self.next().unwrap();
            self.setpoints(speeds);
            if is_so(&self.state) {
                return;
            }
            assert!(
                Instant::now() < until,
                "waited for {what}: drive {}, ended {}",
                self.state.drive(),
                self.state.ended()
            );
        }
    }

    /// Asks for control of these motors. Returns why it was refused: 0 if it was not.
    pub fn arm(&mut self, motors: &[u8]) -> u8 {
        let speeds: Vec<_> = motors.iter().map(|id| (*id, 0.0)).collect();
        self.arm_at(&speeds)
    }

    pub fn arm_at(&mut self, speeds: &[(u8, f32)]) -> u8 {
        // After a pause the first state is old, and its challenge too.
        self.wait("a new state", |state| {
            state.sent_ago() < Duration::from_millis(50)
        });
        self.arms += 1;
        let arms = self.arms;
        self.order(1, self.state.challenge(), speeds);
        self.wait("what becomes of ARM", |state| state.arm().0 == arms);
        self.state.arm().1
    }

    /// Arms, and waits until the motors are driven.
    pub fn start(&mut self, motors: &[u8]) {
        assert_eq!(self.arm(motors), 0);
        let speeds: Vec<_> = motors.iter().map(|id| (*id, 0.0)).collect();
        self.drive(&speeds, "the start", |state| state.drive() == DRIVEN);
        assert!(self.state.is_armed());
    }

    pub fn setpoints(&mut self, speeds: &[(u8, f32)]) {
        self.order(2, self.state.challenge(), speeds);
    }

    pub fn disarm(&mut self) {
        self.order(3, 0, &[]);
    }

    pub fn order(&mut self, kind: u8, challenge: u64, speeds: &[(u8, f32)]) {
        let mut bytes = vec![kind, u8::try_from(speeds.len()).unwrap(), 0, 0];
        bytes.extend(self.arms.to_le_bytes());
        bytes.extend(challenge.to_le_bytes());
        let mut ids: Vec<u8> = speeds.iter().map(|(id, _)| *id).collect();
        ids.resize(8, 0);
        bytes.extend(ids);
        for (_, speed) in speeds {
            bytes.extend(speed.to_le_bytes());
        }
        bytes.resize(56, 0);
        // The server may have closed: the next state tells.
        let _ = self.stream.write_all(&bytes);
    }
}

/// What the text form answers to this command.
pub fn ask(path: &Path, command: &str) -> String {
    let mut stream = UnixStream::connect(path).unwrap();
    stream.set_read_timeout(Some(SOON)).unwrap();
    stream.write_all(command.as_bytes()).unwrap();
    stream.shutdown(std::net::Shutdown::Write).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    answer
}

/// On a busy machine, the 100 ms of a controller are over before its test has run, and the wheels rightly stop. So a test
/// gets another attempt, at most three in all.
pub fn attempts(drive: fn()) {
    for attempt in 1..3 {
        if catch_unwind(drive).is_ok() {
            return;
        }
        println!("attempt {attempt} of 3 failed");
    }
    drive();
}

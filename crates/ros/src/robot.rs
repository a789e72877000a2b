//! The loop: what comes from motorlink and from the network, and what goes to both.

mod emergency_stop;
mod publishing;

use std::{
    path::PathBuf,
    sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender},
    thread,
    time::{Duration, Instant, SystemTime},
};

use anyhow::Result;
use motorlink_controller_messages::{DriveState, FromClient, State};

use crate::{
    arguments::Arguments,
    cmd_vel::{CmdVel, Taken},
    drive::{Drive, Why},
    fleet::publisher::Reporter,
    motorlink::{Connection, FromMotorlink},
    network::{Input, Output},
    node::Request,
    odometry::Odometry,
    rover::Rover,
    say,
};

/// motorlink is told something at least so often: its lease lasts 100 ms.
const STEP: Duration = Duration::from_millis(10);
/// How often a lost connection is tried.
const RETRY: Duration = Duration::from_secs(1);
/// How long an emergency stop may take until its answer says that it is not confirmed.
const STOP_MAX: Duration = Duration::from_secs(2);
const EVERY_SECOND: Duration = Duration::from_secs(1);
/// The only stop that is left.
const NOT_CONFIRMED: &str = "NOT CONFIRMED THAT THE MOTORS STAND. The power switch stops them";

/// The robot, its connection, and what it publishes.
pub struct Robot {
    socket: PathBuf,
    to: Sender<Input>,
    outputs: SyncSender<Output>,
    cmd_vel: CmdVel,
    /// For how long the computer had slept at the last step.
    slept: Duration,
    drive: Drive,
    odometry: Odometry,
    rover: Rover,
    torque_constant: Option<f64>,
    has_transform: bool,
    /// Before the frames.
    prefix: String,
    /// With its namespace.
    name: String,
    period: Duration,
    connection: Option<Connection>,
    /// Counts them.
    connections: u32,
    is_connecting: bool,
    tried: Option<Instant>,
    /// The newest state, and when it came.
    state: Option<(Instant, SystemTime, State)>,
    /// When it publishes next.
    publishes: Instant,
    /// When the state came that was published last.
    published: Option<Instant>,
    diagnosed: Instant,
    reporter: Reporter,
    late: u32,
    /// Emergency stops that wait for the motors, each until when.
    stops: Vec<(Instant, Request)>,
    /// Counts emergency stops.
    e_stops: u32,
    /// When motorlink has taken the newest of them.
    stop_sent: Option<Instant>,
}

impl Robot {
    /// A robot that waits for its connection. `session` is its ID in Zenoh.
    ///
    /// # Errors
    ///
    /// For a name that is none in ROS.
    pub fn new(
        arguments: &Arguments,
        rover: Rover,
        to: Sender<Input>,
        outputs: SyncSender<Output>,
        session: String,
    ) -> Result<Self> {
        let now = Instant::now();
        Ok(Self {
            socket: arguments.socket.clone(),
            to,
            outputs,
            cmd_vel: CmdVel::new(arguments.timeout(), now),
            slept: slept(),
            drive: Drive::new(now),
            odometry: Odometry::new(arguments.odometry),
            rover,
            torque_constant: arguments.torque_constant,
            has_transform: !arguments.no_tf,
            prefix: arguments.frame_prefix.clone(),
            name: arguments.node_name()?.to_string(),
            period: Duration::from_secs_f64(1.0 / arguments.rate),
            connection: None,
            connections: 0,
            is_connecting: false,
            tried: None,
            state: None,
            publishes: now,
            published: None,
            diagnosed: now,
            reporter: Reporter::new(session, arguments.page.clone(), now),
            late: 0,
            stops: Vec::new(),
            e_stops: 0,
            stop_sent: None,
        })
    }

    /// Runs until it is told to quit, and stops what it drives.
    pub fn run(&mut self, inputs: &Receiver<Input>) {
        let mut next = Instant::now();
        // Since when it ends, and whether it drove then.
        let mut quits: Option<(Instant, bool)> = None;
        loop {
            let now = Instant::now();
            if let Some((since, drove)) = quits {
                // Emergency stops are answered by then.
                let is_over = now.duration_since(since) > STOP_MAX + 10 * STEP;
                if self.drive.is_idle() && self.stops.is_empty() || is_over {
                    if drove && self.drive_state() != DriveState::Stands {
                        say(NOT_CONFIRMED);
                    }
                    return;
                }
            }
            // Before the inputs: however many come, motorlink is told something in time.
            if now >= next {
                next = now + STEP;
                self.step();
            }
            match inputs.recv_timeout(next.saturating_duration_since(now)) {
                Ok(Input::Quit) => {
                    let drove = !self.drive.is_idle();
                    self.drive.e_stop();
                    quits.get_or_insert((Instant::now(), drove));
                }
                Ok(input) => self.take(input),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return,
            }
        }
    }

    fn take(&mut self, input: Input) {
        let now = Instant::now();
        match input {
            // What an earlier connection has said is not the state.
            Input::Motorlink(connection, _) if connection != self.connections => {}
            Input::Motorlink(_, FromMotorlink::State(state)) => {
                self.state = Some((now, SystemTime::now(), *state));
            }
            Input::Motorlink(_, FromMotorlink::Lost(why)) => self.lost(&why),
            Input::Connected(result) => self.connected(result),
            Input::Twist(at, twist, attachment) => match self.cmd_vel.take(at, twist, attachment) {
                Taken::InTime => {}
                Taken::TooLate => self.late += 1,
                Taken::ClockSet => self.drive.end(now, Why::ClockSet),
                Taken::NoSpeed => self.drive.end(now, Why::NoSpeed),
            },
            Input::EStop(_) | Input::StopSent(_) | Input::Reset(_) | Input::ResetSent(..) => {
                self.take_stop(input);
            }
            Input::Quit => {}
        }
    }

    fn step(&mut self) {
        let now = Instant::now();
        self.connect(now);
        let slept = slept();
        if slept.saturating_sub(std::mem::replace(&mut self.slept, slept)) > 10 * STEP {
            self.cmd_vel.forget(now);
            self.drive.end(now, Why::Frozen);
            self.odometry.cut_off();
        }
        let state = self.state.as_ref().map(|(_, _, state)| state);
        let message = self.drive.step(now, state, &self.cmd_vel, &self.rover);
        if let Some(message) = message {
            self.send(&message);
        }
        self.answer_stops(now);
        if now >= self.publishes {
            self.publishes += self.period;
            if self.publishes < now {
                // Without what was missed.
                self.publishes = now;
            }
            self.publish();
        }
        self.report(now);
        if now.duration_since(self.diagnosed) >= EVERY_SECOND {
            self.diagnosed = now;
            self.diagnose();
        }
    }

    fn connect(&mut self, now: Instant) {
        let is_due = self.tried.is_none_or(|at| now.duration_since(at) >= RETRY);
        if self.connection.is_some() || self.is_connecting || !is_due {
            return;
        }
        (self.tried, self.is_connecting) = (Some(now), true);
        let (socket, to) = (self.socket.clone(), self.to.clone());
        // A server that hangs delays nothing here.
        thread::spawn(move || {
            // The program may have ended.
            let _ = to.send(Input::Connected(Connection::open(&socket)));
        });
    }

    fn connected(&mut self, result: Result<Connection>) {
        self.is_connecting = false;
        self.connections += 1;
        let (number, to) = (self.connections, self.to.clone());
        let pass_on = move |message| to.send(Input::Motorlink(number, message)).is_ok();
        match result.and_then(|connection| Ok((connection.listen(pass_on)?, connection))) {
            Ok(((), connection)) => {
                say(&format!("connected to {}", self.socket.display()));
                self.connection = Some(connection);
            }
            Err(error) if number == 1 => say(&format!("{error:#}. Trying again")),
            Err(_) => {}
        }
    }

    fn send(&mut self, message: &FromClient) {
        let Some(connection) = &mut self.connection else {
            return;
        };
        if let Err(error) = connection.send(message) {
            self.lost(&format!("motorlink takes nothing: {error}"));
        }
    }

    /// The connection has ended: motorlink stops the motors, and what it says after that is not known.
    fn lost(&mut self, why: &str) {
        if self.connection.take().is_none() {
            return;
        }
        say(&format!("connection lost: {why}"));
        self.tried = Some(Instant::now());
        // States of it may wait.
        self.connections += 1;
        self.state = None;
        self.drive.disconnected(Instant::now());
        self.odometry.cut_off();
    }

    /// What has become of the newest drive.
    fn drive_state(&self) -> DriveState {
        let state = self.state.as_ref();
        state.map_or(DriveState::None, |(_, _, state)| state.drive)
    }
}

/// For how long the computer has slept since it started. A sleep stops the clock of [`Instant`].
#[cfg(target_os = "linux")]
fn slept() -> Duration {
    use rustix::time::{ClockId, clock_gettime};
    let since_start = |clock| Duration::try_from(clock_gettime(clock)).unwrap_or_default();
    since_start(ClockId::Boottime).saturating_sub(since_start(ClockId::Monotonic))
}

/// Not known here. The lease has ended after a sleep, and the drive with it.
#[cfg(not(target_os = "linux"))]
fn slept() -> Duration {
    Duration::ZERO
}

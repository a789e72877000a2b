//! The loop: what comes from motorlink and from the network, and what goes to both.

use std::{
    io::{self, Write as _},
    path::PathBuf,
    sync::{
        Arc,
        mpsc::{self, Receiver, RecvTimeoutError, Sender, SyncSender},
    },
    thread,
    time::{Duration, Instant, SystemTime},
};

use anyhow::{Context as _, Result};
use motorlink_controller_messages::{Activity, DriveState, FromClient, Motor, State};
use rustix::time::{ClockId, clock_gettime};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

use crate::{
    arguments::Arguments,
    cmd_vel::{CmdVel, Taken},
    drive::{Drive, Why},
    motorlink::{self, Connection, FromMotorlink},
    node::{
        Listening, Node, Request, Topic,
        attachment::Attachment,
        messages::{
            DiagnosticArray, JointState, Odometry as OdometryMessage, Temperature, TfMessage,
            Trigger, TriggerResponse, Twist, TwistStamped, decode,
        },
    },
    odometry::{Moved, Odometry},
    rover::Rover,
    telemetry::{self, NodeStatus},
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
/// A wheel that turns no faster stands: 2 rpm, in which a speed is told.
const AT_REST_RAD_PER_S: f32 = 0.22;
/// Messages that wait to be sent. A network that is slow loses the next ones.
const WAITING_MAX: usize = 64;

/// What the loop is told.
enum Input {
    /// Of this connection.
    Motorlink(u32, FromMotorlink),
    /// The answer to an attempt to connect.
    Connected(u32, Result<Connection>),
    /// When it came.
    Twist(Instant, Twist, Option<Attachment>),
    EStop(Request),
    Reset(Request),
    /// Whether motorlink has taken an emergency stop.
    StopSent(Result<()>),
    /// The answer to a reset, and how many emergency stops there had been when it was asked for.
    ResetSent(Result<()>, Request, u32),
    Quit,
}

/// A message that waits to be sent.
enum Output {
    Joints(JointState),
    Moved(Box<OdometryMessage>, Option<TfMessage>),
    Temperature(usize, Temperature),
    Diagnostics(DiagnosticArray),
}

/// Runs until a signal ends it, and stops what it drives.
///
/// # Errors
///
/// For arguments that are wrong, and for a network configuration that Zenoh refuses.
pub fn run(arguments: &Arguments) -> Result<()> {
    let rover = arguments.rover()?;
    let (to, inputs) = mpsc::channel();
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM, SIGHUP])?;
    let quit = to.clone();
    thread::spawn(move || {
        for _ in &mut signals {
            // It ends already.
            let _ = quit.send(Input::Quit);
        }
    });
    let node = Arc::new(Node::open(arguments.zenoh()?, arguments.node_name()?)?);
    let listening = listen(&node, &to)?;
    let outputs = publish(&node, &rover, arguments)?;
    say(&format!(
        "{} is in domain {}",
        arguments.node, arguments.domain
    ));
    watch_router(&node);
    let now = Instant::now();
    let mut robot = Robot {
        socket: arguments.socket.clone(),
        to,
        outputs,
        timeout: arguments.timeout(),
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
        tried: None,
        state: None,
        publishes: now,
        published: None,
        diagnosed: now,
        late: 0,
        stops: Vec::new(),
        e_stops: 0,
        stop_sent: None,
    };
    robot.run(&inputs);
    drop(listening);
    node.close();
    Ok(())
}

/// `cmd_vel` in both forms, and the services.
fn listen(node: &Node, to: &Sender<Input>) -> Result<[Listening; 4]> {
    let plain = to.clone();
    let stamped = to.clone();
    let (e_stop, reset) = (to.clone(), to.clone());
    // Sending fails only when the program ends.
    Ok([
        node.subscribe::<Twist>("cmd_vel", move |bytes, attachment| {
            if let Some(twist) = decode(bytes) {
                let _ = plain.send(Input::Twist(Instant::now(), twist, attachment));
            }
        })?,
        node.subscribe::<TwistStamped>("cmd_vel", move |bytes, attachment| {
            if let Some(TwistStamped { twist, .. }) = decode(bytes) {
                let _ = stamped.send(Input::Twist(Instant::now(), twist, attachment));
            }
        })?,
        node.serve::<Trigger>("hardware/e_stop_trigger", move |request| {
            let _ = e_stop.send(Input::EStop(request));
        })?,
        node.serve::<Trigger>("hardware/e_stop_reset", move |request| {
            let _ = reset.send(Input::Reset(request));
        })?,
    ])
}

/// Says whether there is a router, now and when that changes.
fn watch_router(node: &Arc<Node>) {
    let node = Arc::downgrade(node);
    thread::spawn(move || {
        let mut had = None;
        // Sessions take a moment to connect.
        thread::sleep(EVERY_SECOND);
        while let Some(node) = node.upgrade() {
            let has = node.has_router();
            if had.replace(has) != Some(has) {
                say(if has {
                    "connected to a Zenoh router"
                } else {
                    "no Zenoh router: other nodes do not find this one. Trying again"
                });
            }
            drop(node);
            thread::sleep(EVERY_SECOND);
        }
    });
}

/// Sends what comes, in a thread of its own: the network delays no setpoint.
fn publish(node: &Arc<Node>, rover: &Rover, arguments: &Arguments) -> Result<SyncSender<Output>> {
    let joints = node.publish::<JointState>("joint_states", 10)?;
    let odometry = node.publish::<OdometryMessage>("odom", 10)?;
    let transforms = (!arguments.no_tf)
        .then(|| node.publish::<TfMessage>("/tf", 100))
        .transpose()?;
    let diagnostics = node.publish::<DiagnosticArray>("/diagnostics", 10)?;
    let temperatures = rover.wheels.iter().map(|wheel| {
        let topic = format!("motor_{}/temperature", wheel.id.get());
        node.publish::<Temperature>(&topic, 10)
    });
    let temperatures: Vec<Topic> = temperatures.collect::<Result<_>>()?;
    let (outputs, waiting) = mpsc::sync_channel(WAITING_MAX);
    thread::Builder::new()
        .name("publish".to_owned())
        .spawn(move || {
            for output in waiting {
                let sent = match output {
                    Output::Joints(message) => joints.send(&message),
                    Output::Moved(message, transform) => {
                        let sent = odometry.send(&*message);
                        let transform = transforms.as_ref().zip(transform);
                        sent.and(
                            transform.map_or(Ok(()), |(topic, transform)| topic.send(&transform)),
                        )
                    }
                    Output::Temperature(wheel, message) => temperatures
                        .get(wheel)
                        .map_or(Ok(()), |topic| topic.send(&message)),
                    Output::Diagnostics(message) => diagnostics.send(&message),
                };
                if let Err(error) = sent {
                    say(&format!("not sent: {error}"));
                }
            }
        })
        .context("no thread")?;
    Ok(outputs)
}

struct Robot {
    socket: PathBuf,
    to: Sender<Input>,
    outputs: SyncSender<Output>,
    timeout: Duration,
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
    tried: Option<Instant>,
    /// The newest state, and when it came.
    state: Option<(Instant, SystemTime, State)>,
    /// When it publishes next.
    publishes: Instant,
    /// When the state came that was published last.
    published: Option<Instant>,
    diagnosed: Instant,
    late: u32,
    /// Emergency stops that wait for the motors, each until when.
    stops: Vec<(Instant, Request)>,
    /// Counts emergency stops.
    e_stops: u32,
    /// When motorlink has taken the newest of them.
    stop_sent: Option<Instant>,
}

impl Robot {
    fn run(&mut self, inputs: &Receiver<Input>) {
        let mut next = Instant::now();
        let mut quits: Option<Instant> = None;
        loop {
            let now = Instant::now();
            if let Some(since) = quits {
                let is_over = now.duration_since(since) > STOP_MAX;
                if self.drive.is_idle() || is_over {
                    if is_over || self.drive_state() == DriveState::NotConfirmed {
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
                    self.drive.e_stop();
                    quits.get_or_insert_with(Instant::now);
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
            Input::Connected(number, result) => self.connected(number, result),
            Input::Twist(at, twist, attachment) => match self.cmd_vel.take(at, twist, attachment) {
                Taken::InTime => {}
                Taken::TooLate => self.late += 1,
                Taken::ClockSet => self.drive.end(now, Why::ClockSet),
                Taken::NoSpeed => self.drive.end(now, Why::NoSpeed),
            },
            Input::EStop(request) => {
                self.stop_all();
                self.drive.e_stop();
                self.step();
                self.e_stops += 1;
                self.stops.push((now + STOP_MAX, request));
                say("emergency stop");
            }
            Input::StopSent(Ok(())) => self.stop_sent = Some(now),
            Input::StopSent(Err(error)) => {
                let message = format!("NOT STOPPED: {error:#}. The power switch stops the motors");
                say(&message);
                for (_, request) in self.stops.drain(..) {
                    reply(request, false, &message);
                }
            }
            Input::Reset(request) if !self.stops.is_empty() => {
                reply(request, false, "not released: the motors are being stopped");
            }
            Input::Reset(request) => {
                let (socket, to) = (self.socket.clone(), self.to.clone());
                let before = self.e_stops;
                thread::spawn(move || {
                    let answer = motorlink::release(&socket);
                    // The program may have ended.
                    let _ = to.send(Input::ResetSent(answer, request, before));
                });
            }
            // The release may have come after the stop.
            Input::ResetSent(_, request, before) if before != self.e_stops => {
                self.stop_all();
                reply(
                    request,
                    false,
                    "not released: there is a newer emergency stop",
                );
            }
            Input::ResetSent(Ok(()), request, _) => {
                self.drive.reset(now);
                say("reset after an emergency stop");
                reply(
                    request,
                    true,
                    "released: drives after cmd_vel has rested for 2 s",
                );
            }
            Input::ResetSent(Err(error), request, _) => {
                reply(request, false, &format!("not released: {error:#}"));
            }
            Input::Quit => {}
        }
    }

    /// Stops all motors, whoever drives them.
    fn stop_all(&mut self) {
        self.stop_sent = None;
        let (socket, to) = (self.socket.clone(), self.to.clone());
        thread::spawn(move || {
            let until = Instant::now() + STOP_MAX / 2;
            let mut stopped = motorlink::stop_all(&socket);
            while stopped.is_err() && Instant::now() < until {
                thread::sleep(10 * STEP);
                stopped = motorlink::stop_all(&socket);
            }
            // The program may have ended.
            let _ = to.send(Input::StopSent(stopped));
        });
    }

    fn step(&mut self) {
        let now = Instant::now();
        self.connect(now);
        let slept = slept();
        if slept.saturating_sub(std::mem::replace(&mut self.slept, slept)) > 10 * STEP {
            // What was asked before is not asked now.
            self.cmd_vel = CmdVel::new(self.timeout, now);
            self.drive.end(now, Why::Frozen);
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
        if now.duration_since(self.diagnosed) >= EVERY_SECOND {
            self.diagnosed = now;
            self.diagnose();
        }
    }

    fn connect(&mut self, now: Instant) {
        let is_due = self.tried.is_none_or(|at| now.duration_since(at) >= RETRY);
        if self.connection.is_some() || !is_due {
            return;
        }
        self.tried = Some(now);
        self.connections += 1;
        let (number, socket, to) = (self.connections, self.socket.clone(), self.to.clone());
        // A server that hangs delays nothing here.
        thread::spawn(move || {
            let of_connection = to.clone();
            let pass_on = move |message| {
                of_connection
                    .send(Input::Motorlink(number, message))
                    .is_ok()
            };
            let connection = Connection::open(&socket, pass_on);
            // The program may have ended.
            let _ = to.send(Input::Connected(number, connection));
        });
    }

    fn connected(&mut self, number: u32, result: Result<Connection>) {
        match result {
            // Another attempt has begun meanwhile.
            Ok(_) if number != self.connections => {}
            Ok(connection) => {
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

    /// Whether every motor of the rover is known to stand, by a reply since then.
    fn stands(&self, since: Instant) -> bool {
        let Some((at, _, state)) = &self.state else {
            return false;
        };
        if !state.is_open || !state.is_halted {
            return false;
        }
        let elapsed_us = at.saturating_duration_since(since).as_micros();
        let replied = |motor: &Motor| {
            motor
                .reply_age
                .is_some_and(|age| u128::from(age) < elapsed_us)
        };
        let is_at_rest = |motor: &Motor| {
            let velocity = motor.velocity;
            velocity.is_some_and(|(velocity, _)| velocity.abs() < AT_REST_RAD_PER_S)
        };
        self.rover.wheels.iter().all(|wheel| {
            let mut motors = state.motors.iter();
            motors
                .find(|motor| motor.id == wheel.id.get())
                .is_some_and(|motor| {
                    motor.activity == Activity::Idle
                        && !motor.may_turn
                        && replied(motor)
                        && is_at_rest(motor)
                })
        })
    }

    /// Answers emergency stops once the motors stand, or have not stood in time.
    fn answer_stops(&mut self, now: Instant) {
        let stands = self.stop_sent.is_some_and(|sent| self.stands(sent));
        let mut waiting = Vec::new();
        for (until, request) in self.stops.drain(..) {
            if stands {
                reply(request, true, "the motors stand, confirmed");
            } else if now >= until {
                say(NOT_CONFIRMED);
                reply(request, false, NOT_CONFIRMED);
            } else {
                waiting.push((until, request));
            }
        }
        self.stops = waiting;
    }

    /// What has become of the newest drive.
    fn drive_state(&self) -> DriveState {
        let state = self.state.as_ref();
        state.map_or(DriveState::None, |(_, _, state)| state.drive)
    }

    fn publish(&mut self) {
        let Some((at, clock, state)) = &self.state else {
            return;
        };
        // A state is told once only.
        if self.published.replace(*at) == Some(*at) {
            return;
        }
        let joints = telemetry::joint_states(*clock, state, &self.rover, self.torque_constant);
        let moved: Option<Moved> = self.odometry.advance(*at, state, &self.rover);
        let stamp = telemetry::time(*clock, Duration::ZERO);
        let (has_transform, prefix) = (self.has_transform, &self.prefix);
        let moved = moved.map(|moved| {
            let transform = has_transform.then(|| telemetry::transform(stamp, &moved, prefix));
            Output::Moved(
                Box::new(telemetry::odometry(stamp, &moved, prefix)),
                transform,
            )
        });
        for output in joints.map(Output::Joints).into_iter().chain(moved) {
            // What the network does not take now is old later.
            let _ = self.outputs.try_send(output);
        }
    }

    /// Once a second.
    fn diagnose(&mut self) {
        let of_node = NodeStatus {
            name: self.name.clone(),
            drives: self.drive.is_driving().map_err(|why| why.to_string()),
            must_rest: self.drive.must_rest(),
            gaps: self.odometry.gaps(),
            late: std::mem::take(&mut self.late),
        };
        let state = self.state.as_ref().map(|(_, _, state)| state);
        let stamp = telemetry::time(SystemTime::now(), Duration::ZERO);
        let diagnostics = telemetry::diagnostics(stamp, state, &self.rover, &of_node);
        let _ = self.outputs.try_send(Output::Diagnostics(diagnostics));
        let Some((_, clock, state)) = &self.state else {
            return;
        };
        for (index, wheel) in self.rover.wheels.iter().enumerate() {
            if let Some(message) = telemetry::temperature(*clock, wheel, state, &self.prefix) {
                let _ = self.outputs.try_send(Output::Temperature(index, message));
            }
        }
    }
}

/// Tells the person at the terminal. Nobody may read it.
fn say(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}

/// For how long the computer has slept since it started. A sleep stops the clock of [`Instant`].
fn slept() -> Duration {
    let since_start = |clock| Duration::try_from(clock_gettime(clock)).unwrap_or_default();
    since_start(ClockId::Boottime).saturating_sub(since_start(ClockId::Monotonic))
}

/// Answers a request. The network may take its time.
fn reply(request: Request, success: bool, message: &str) {
    let message = message.to_owned();
    thread::spawn(move || request.answer(&TriggerResponse { success, message }));
}

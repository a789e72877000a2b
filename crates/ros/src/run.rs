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
use motorlink_controller_messages::{Activity, FromClient, State};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

use crate::{
    arguments::Arguments,
    cmd_vel::{CmdVel, Taken},
    drive::Drive,
    motorlink::{Connection, FromMotorlink, command},
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
    telemetry::{self, OfNode},
};

/// motorlink is told something at least so often: its lease lasts 100 ms.
const STEP: Duration = Duration::from_millis(10);
/// How often a lost connection is tried.
const RETRY: Duration = Duration::from_secs(1);
/// How long an emergency stop may take until its answer says that it is not confirmed.
const STOP_MAX: Duration = Duration::from_secs(2);
const EVERY_SECOND: Duration = Duration::from_secs(1);
/// Messages that wait to be sent. A network that is slow loses the next ones.
const WAITING_MAX: usize = 64;

/// What the loop is told.
enum Input {
    /// Of this connection.
    Motorlink(u32, FromMotorlink),
    Twist(Twist, Option<Attachment>),
    EStop(Request),
    Reset(Request),
    /// What the text form has answered.
    StopSent(Result<String>),
    ResetSent(Result<String>, Request),
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
    let now = Instant::now();
    let mut robot = Robot {
        socket: arguments.socket.clone(),
        to,
        outputs,
        cmd_vel: CmdVel::new(arguments.timeout(), now),
        drive: Drive::new(now),
        odometry: Odometry::new(arguments.odometry),
        rover,
        torque_constant: arguments.torque_constant,
        prefix: (!arguments.no_tf, arguments.frame_prefix.clone()),
        period: Duration::from_secs_f64(1.0 / arguments.rate),
        connection: None,
        connections: 0,
        has_armed: false,
        tried: None,
        state: None,
        published: now,
        told: now,
        late: 0,
        stops: Vec::new(),
        stop_sent: None,
    };
    robot.run(&inputs);
    drop(listening);
    if let Ok(node) = Arc::try_unwrap(node) {
        node.close();
    }
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
                let _ = plain.send(Input::Twist(twist, attachment));
            }
        })?,
        node.subscribe::<TwistStamped>("cmd_vel", move |bytes, attachment| {
            if let Some(TwistStamped { twist, .. }) = decode(bytes) {
                let _ = stamped.send(Input::Twist(twist, attachment));
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
    cmd_vel: CmdVel,
    drive: Drive,
    odometry: Odometry,
    rover: Rover,
    torque_constant: Option<f64>,
    /// Whether a transform is sent, and what is before its frames.
    prefix: (bool, String),
    period: Duration,
    connection: Option<Connection>,
    /// Counts them.
    connections: u32,
    /// Whether it has ever driven.
    has_armed: bool,
    tried: Option<Instant>,
    /// The newest state, and when it came.
    state: Option<(Instant, SystemTime, State)>,
    published: Instant,
    told: Instant,
    late: u32,
    /// Emergency stops that wait for the motors, each until when.
    stops: Vec<(Instant, Request)>,
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
                let stands = !self.has_armed || self.stands();
                if stands || self.connection.is_none() || is_over {
                    if !stands {
                        say("NOT CONFIRMED THAT THE MOTORS STAND. The power switch stops them");
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
            Input::Twist(twist, attachment) => match self.cmd_vel.take(now, twist, attachment) {
                Taken::InTime => {}
                Taken::TooLate => self.late += 1,
                Taken::NoSpeed => say("cmd_vel has a value that is no speed: stopped"),
            },
            Input::EStop(request) => {
                self.drive.e_stop();
                self.step();
                self.stop_sent = None;
                self.stops.push((now + STOP_MAX, request));
                let (socket, to) = (self.socket.clone(), self.to.clone());
                thread::spawn(move || {
                    // The program may have ended.
                    let _ = to.send(Input::StopSent(command(&socket, "stop")));
                });
                say("emergency stop");
            }
            Input::StopSent(Ok(_)) => self.stop_sent = Some(now),
            Input::StopSent(Err(error)) => {
                let message = format!("NOT STOPPED: {error:#}. The power switch stops the motors");
                say(&message);
                for (_, request) in self.stops.drain(..) {
                    request.answer(&answer(false, message.clone()));
                }
            }
            Input::Reset(request) => {
                let (socket, to) = (self.socket.clone(), self.to.clone());
                thread::spawn(move || {
                    // The program may have ended.
                    let _ = to.send(Input::ResetSent(command(&socket, "release"), request));
                });
            }
            Input::ResetSent(Ok(_), request) => {
                self.drive.reset(now);
                say("reset after an emergency stop");
                let message = "released: drives after cmd_vel has ceased";
                request.answer(&answer(true, message.to_owned()));
            }
            Input::ResetSent(Err(error), request) => {
                request.answer(&answer(false, format!("not released: {error:#}")));
            }
            Input::Quit => {}
        }
    }

    fn step(&mut self) {
        let now = Instant::now();
        self.connect(now);
        if let Some((_, _, state)) = &self.state {
            let message = self.drive.step(now, state, &self.cmd_vel, &self.rover);
            if let Some(message) = message {
                self.has_armed |= matches!(message, FromClient::Arm(_));
                self.send(&message);
            }
        }
        self.answer_stops(now);
        if now.duration_since(self.published) >= self.period {
            // Without what was missed.
            self.published = now;
            self.publish(now);
        }
        if now.duration_since(self.told) >= EVERY_SECOND {
            self.told = now;
            self.tell();
        }
    }

    fn connect(&mut self, now: Instant) {
        let is_due = self.tried.is_none_or(|at| now.duration_since(at) >= RETRY);
        if self.connection.is_some() || !is_due {
            return;
        }
        let is_first = self.tried.replace(now).is_none();
        self.connections += 1;
        let (number, to) = (self.connections, self.to.clone());
        let pass_on = move |message| to.send(Input::Motorlink(number, message)).is_ok();
        match Connection::open(&self.socket, pass_on) {
            Ok(connection) => {
                say(&format!("connected to {}", self.socket.display()));
                self.connection = Some(connection);
            }
            Err(error) if is_first => say(&format!("{error:#}. Trying again")),
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
        self.state = None;
        self.drive.disconnected(Instant::now());
        self.odometry.cut_off();
    }

    /// Whether every motor of the rover is known to stand.
    fn stands(&self) -> bool {
        let Some((_, _, state)) = &self.state else {
            return false;
        };
        self.rover.wheels.iter().all(|wheel| {
            let mut motors = state.motors.iter();
            motors
                .find(|motor| motor.id == wheel.id.get())
                .is_some_and(|motor| motor.activity == Activity::Idle && !motor.may_turn)
        })
    }

    /// Answers emergency stops once the motors stand, or have not stood in time.
    fn answer_stops(&mut self, now: Instant) {
        let is_new = |sent: Instant| self.state.as_ref().is_some_and(|(at, ..)| *at > sent);
        let stands = self.stop_sent.is_some_and(is_new) && self.stands();
        let mut waiting = Vec::new();
        for (until, request) in self.stops.drain(..) {
            if stands {
                request.answer(&answer(true, "the motors stand, confirmed".to_owned()));
            } else if now >= until {
                let message = "NOT CONFIRMED THAT THE MOTORS STAND. The power switch stops them";
                say(message);
                request.answer(&answer(false, message.to_owned()));
            } else {
                waiting.push((until, request));
            }
        }
        self.stops = waiting;
    }

    fn publish(&mut self, now: Instant) {
        let Some((at, clock, state)) = &self.state else {
            return;
        };
        // A state is told once only.
        if now.duration_since(*at) > self.period.max(2 * STEP) {
            return;
        }
        let joints = telemetry::joint_states(*clock, state, &self.rover, self.torque_constant);
        let moved: Option<Moved> = self.odometry.advance(*at, state, &self.rover);
        let stamp = telemetry::time(*clock, Duration::ZERO);
        let (has_transform, prefix) = &self.prefix;
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
    fn tell(&mut self) {
        let of_node = OfNode {
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
            if let Some(message) = telemetry::temperature(*clock, wheel, state) {
                let _ = self.outputs.try_send(Output::Temperature(index, message));
            }
        }
    }
}

/// Tells the person at the terminal. Nobody may read it.
fn say(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}

const fn answer(success: bool, message: String) -> TriggerResponse {
    TriggerResponse { success, message }
}

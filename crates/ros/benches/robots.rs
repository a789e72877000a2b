//! Many robots in one process, each with a Zenoh session of its own.
//!
//! Real, as in motorlink-ros: the node with its tokens, topics in and services, `CmdVel`, `Drive`, the judgement, the state and its
//! publisher. Not real: motorlink itself, in whose place wheels are stepped here; and two threads step all robots, where each robot has
//! a process of its own. `joint_states`, `odom`, `/tf` and `/diagnostics` are not published: they stay on the robot.

use std::{
    collections::VecDeque,
    sync::{
        Arc, Mutex,
        atomic::{AtomicU64, Ordering},
        mpsc::{self, Receiver},
    },
    thread,
    time::{Duration, Instant},
};

use anyhow::Result;
use motorlink_controller_messages::{
    Activity, DriveState, EndReason, FromClient, Holder, Motor, State,
};
use motorlink_protocol::MotorId;
use motorlink_ros::{
    arguments::Network,
    cmd_vel::CmdVel,
    drive::Drive,
    fleet::{
        publisher::{Publisher, Reporter},
        state::RobotState,
    },
    network::{Input, listen},
    node::{Listening, Node, names::NodeName},
    rover::{Rover, Wheel},
};

const STEP: Duration = Duration::from_millis(10);
/// The lease of motorlink.
const LEASE: Duration = Duration::from_millis(100);
/// What a loaded wheel does, in rad/s².
const ACCELERATION: f32 = 40.0;
/// As the loop of motorlink-ros has it.
const AT_REST_RAD_PER_S: f32 = 0.22;
const WHEELS: u8 = 4;
const THREADS: usize = 2;

/// When each state of a robot was published, the newest last.
pub type Published = Arc<Mutex<VecDeque<(u64, Instant)>>>;

/// All robots.
pub struct Robots {
    /// By number.
    pub published: Vec<Published>,
    /// Bytes of all states.
    pub bytes: Arc<AtomicU64>,
    /// States that found no place in the channel to the network.
    pub dropped: Arc<AtomicU64>,
    /// Robots of which a wheel turns, by thread.
    turning: Arc<[AtomicU64; THREADS]>,
    /// Robots that follow commands, by thread.
    driving: Arc<[AtomicU64; THREADS]>,
    nodes: Vec<Arc<Node>>,
}

/// A client of this router.
pub fn client(endpoint: &str) -> Result<zenoh::Config> {
    let network = Network {
        connect: vec![endpoint.to_owned()],
        config: None,
    };
    network.configuration(&[("mode", "\"client\"")])
}

/// The namespace of a robot, and its name in the fleet.
pub fn name(robot: usize) -> String {
    format!("r{robot:05}")
}

struct Robot {
    inputs: Receiver<Input>,
    cmd_vel: CmdVel,
    drive: Drive,
    rover: Rover,
    reporter: Reporter,
    motorlink: Motorlink,
    _listens: [Listening; 4],
}

/// The robots of a thread, and where each publishes.
type Share = (Vec<Robot>, Vec<(Publisher, Published)>);

impl Robots {
    /// Opens their sessions, one after the other, and starts them.
    pub fn start(endpoint: &str, count: usize) -> Result<Self> {
        let mut robots = Self {
            published: Vec::new(),
            bytes: Arc::default(),
            dropped: Arc::default(),
            turning: Arc::default(),
            driving: Arc::default(),
            nodes: Vec::new(),
        };
        let mut shares: [Share; THREADS] = Default::default();
        let begun = Instant::now();
        for number in 0..count {
            let node = NodeName::new(0, &name(number), "motorlink")?;
            let node = Arc::new(Node::open(client(endpoint)?, node)?);
            let (to, inputs) = mpsc::channel();
            let times = Published::default();
            let now = Instant::now();
            // Not all in one step.
            let first = now + STEP * u32::try_from(number % 10)?;
            let (steps, outputs) = &mut shares[number % THREADS];
            steps.push(Robot {
                inputs,
                cmd_vel: CmdVel::new(Duration::from_millis(500), now),
                drive: Drive::new(now),
                rover: rover()?,
                reporter: Reporter::new(node.zid(), None, first),
                motorlink: Motorlink::new(now),
                _listens: listen(&node, &to)?,
            });
            let publisher = Publisher::new(node.session(), &name(number).parse()?)?;
            outputs.push((publisher, Arc::clone(&times)));
            robots.published.push(times);
            robots.nodes.push(node);
        }
        let took = begun.elapsed().as_secs_f64();
        println!("sessions opened, one after the other: {count} in {took:.1} s");
        for (thread, share) in shares.into_iter().enumerate() {
            robots.run(thread, share);
        }
        Ok(robots)
    }

    /// A thread that steps its share, and one that publishes, as in motorlink-ros.
    fn run(&self, thread: usize, (mut robots, publishers): Share) {
        let (to, waiting) = mpsc::sync_channel::<(usize, RobotState)>(64 * robots.len().max(1));
        let bytes = Arc::clone(&self.bytes);
        thread::spawn(move || {
            for (index, state) in waiting {
                let (publisher, times) = &publishers[index];
                let mut times = times.lock().unwrap();
                times.push_back((state.number, Instant::now()));
                if times.len() > 600 {
                    times.pop_front();
                }
                drop(times);
                let size = state.write().len();
                bytes.fetch_add(size.try_into().unwrap(), Ordering::Relaxed);
                // At the end, the sessions are closed.
                if publisher.send(&state).is_err() {
                    return;
                }
            }
        });
        let (dropped, turning) = (Arc::clone(&self.dropped), Arc::clone(&self.turning));
        let driving = Arc::clone(&self.driving);
        thread::spawn(move || {
            let mut next = Instant::now();
            loop {
                thread::sleep(next.saturating_duration_since(Instant::now()));
                next = (next + STEP).max(Instant::now());
                let (mut turn, mut drive) = (0, 0);
                for (index, robot) in robots.iter_mut().enumerate() {
                    let report = robot.step();
                    turn += u64::from(robot.motorlink.turns());
                    drive += u64::from(robot.drive.is_driving().is_ok());
                    if let Some(report) = report
                        && to.try_send((index, report)).is_err()
                    {
                        dropped.fetch_add(1, Ordering::Relaxed);
                    }
                }
                turning[thread].store(turn, Ordering::Relaxed);
                driving[thread].store(drive, Ordering::Relaxed);
            }
        });
    }

    /// Robots of which a wheel turns.
    pub fn turn(&self) -> u64 {
        sum(&*self.turning)
    }

    /// Robots that follow commands.
    pub fn drive(&self) -> u64 {
        sum(&*self.driving)
    }
}

fn sum(all: &[AtomicU64]) -> u64 {
    all.iter().map(|one| one.load(Ordering::Relaxed)).sum()
}

impl Robot {
    fn step(&mut self) -> Option<RobotState> {
        while let Ok(input) = self.inputs.try_recv() {
            if let Input::Twist(at, twist, attachment) = input {
                self.cmd_vel.take(at, twist, attachment);
            }
        }
        let now = Instant::now();
        self.motorlink.step(now);
        let state = &self.motorlink.state;
        let message = self
            .drive
            .step(now, Some(state), &self.cmd_vel, &self.rover);
        if let Some(message) = message {
            self.motorlink.take(now, message);
        }
        let newest = Some((now, &self.motorlink.state));
        self.reporter.report(now, newest, &self.drive, &self.rover)
    }
}

/// In the place of motorlink and of four motors.
struct Motorlink {
    state: State,
    /// The newest message of the client.
    told: Instant,
    stepped: Instant,
    asked: Vec<f32>,
}

impl Motorlink {
    fn new(now: Instant) -> Self {
        let motor = |id| Motor {
            id,
            faults: Some(0),
            temperature: Some((28.0 + f32::from(id), 50_000)),
            ..Motor::default()
        };
        Self {
            state: State {
                is_open: true,
                motors: (1..=WHEELS).map(motor).collect(),
                ..State::default()
            },
            told: now,
            stepped: now,
            asked: vec![0.0; WHEELS.into()],
        }
    }

    fn take(&mut self, now: Instant, message: FromClient) {
        match message {
            FromClient::Arm(setpoints) => {
                self.told = now;
                self.state.arm = (setpoints.number, None);
                self.state.drive = DriveState::Driven;
                self.state.ended = EndReason::None;
                self.state.holder = (Holder::You, 1);
            }
            FromClient::Setpoints(setpoints) if self.state.drive == DriveState::Driven => {
                self.told = now;
                let speeds = setpoints.speeds.into_iter();
                self.asked = speeds.map(|(_, speed)| speed).collect();
            }
            FromClient::Disarm => self.end(EndReason::Disarmed),
            FromClient::Setpoints(_) => {}
        }
    }

    fn end(&mut self, why: EndReason) {
        self.state.ended = why;
        self.state.drive = DriveState::Stopping;
        self.state.holder = (Holder::Nobody, 0);
        self.asked.fill(0.0);
    }

    fn step(&mut self, now: Instant) {
        let elapsed = now.duration_since(std::mem::replace(&mut self.stepped, now));
        if self.state.drive == DriveState::Driven && now.duration_since(self.told) > LEASE {
            self.end(EndReason::LeaseEnded);
        }
        self.state.challenge += 1;
        let most = ACCELERATION * elapsed.as_secs_f32();
        for (motor, asked) in self.state.motors.iter_mut().zip(&self.asked) {
            let speed = motor.velocity.map_or(0.0, |(speed, _)| speed);
            let speed = speed + (asked - speed).clamp(-most, most);
            motor.velocity = Some((speed, 4_000));
            motor.current = Some((0.05 * speed.abs(), 4_000));
            motor.reply_age = Some(4_000);
            motor.activity = match self.state.drive {
                DriveState::Driven => Activity::Driven,
                DriveState::Stopping => Activity::Stopping,
                _ => Activity::Idle,
            };
        }
        if self.state.drive == DriveState::Stopping && !self.turns() {
            self.state.drive = DriveState::Stands;
        }
    }

    fn turns(&self) -> bool {
        let mut speeds = self.state.motors.iter().filter_map(|motor| motor.velocity);
        speeds.any(|(speed, _)| speed.abs() >= AT_REST_RAD_PER_S)
    }
}

fn rover() -> Result<Rover> {
    let wheels = (1..=WHEELS).map(|id| {
        Ok(Wheel {
            id: MotorId::new(id).map_err(|_| anyhow::anyhow!("no ID"))?,
            joint: format!("wheel_{id}_joint"),
            is_right: id % 2 == 0,
        })
    });
    Ok(Rover {
        wheels: wheels.collect::<Result<_>>()?,
        radius_m: 0.0511,
        track_m: 0.3,
        speed_max_rad_per_s: 20.0,
    })
}

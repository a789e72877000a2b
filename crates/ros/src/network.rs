//! The network of ROS 2: what the loop is told from there, and what it sends there.

use std::{
    sync::{
        Arc,
        mpsc::{self, Sender, SyncSender},
    },
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context as _, Result};

use crate::{
    arguments::Arguments,
    fleet::{publisher::Publisher, state::RobotState},
    motorlink::{Connection, FromMotorlink},
    node::{
        Listening, Node, Request, Topic,
        attachment::Attachment,
        messages::{
            DiagnosticArray, JointState, Odometry, Temperature, TfMessage, Trigger, Twist,
            TwistStamped, decode,
        },
    },
    rover::Rover,
    say,
};

/// How often a router is looked for.
const LOOK_EVERY: Duration = Duration::from_secs(1);
/// Messages that wait to be sent. A network that is slow loses the next ones.
const WAITING_MAX: usize = 64;

/// What the loop is told.
pub enum Input {
    /// What came by this connection.
    Motorlink(u32, FromMotorlink),
    /// The answer to an attempt to connect.
    Connected(Result<Connection>),
    /// When it came.
    Twist(Instant, Twist, Attachment),
    /// An emergency stop.
    EStop(Request),
    /// A reset after it.
    Reset(Request),
    /// Whether motorlink has taken an emergency stop.
    StopSent(Result<()>),
    /// The answer to a reset, and how many emergency stops there had been when it was asked for.
    ResetSent(Result<()>, Request, u32),
    /// The program ends.
    Quit,
}

/// A message that waits to be sent.
pub enum Output {
    /// `joint_states`.
    Joints(JointState),
    /// `odom` and `/tf`.
    Moved(Box<Odometry>, Option<TfMessage>),
    /// That of this wheel.
    Temperature(usize, Temperature),
    /// `/diagnostics`.
    Diagnostics(DiagnosticArray),
    /// The state for the fleet.
    Fleet(Box<RobotState>),
}

/// Listens to `cmd_vel` in both forms, and to the services.
///
/// # Errors
///
/// What Zenoh says.
pub fn listen(node: &Node, to: &Sender<Input>) -> Result<[Listening; 4]> {
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
pub fn watch_router(node: &Arc<Node>) {
    let node = Arc::downgrade(node);
    thread::spawn(move || {
        let mut had = None;
        // Sessions take a moment to connect.
        thread::sleep(LOOK_EVERY);
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
            thread::sleep(LOOK_EVERY);
        }
    });
}

/// Sends what comes, in a thread of its own: the network delays no setpoint.
///
/// # Errors
///
/// What Zenoh says.
pub fn publish(
    node: &Arc<Node>,
    rover: &Rover,
    arguments: &Arguments,
) -> Result<SyncSender<Output>> {
    let joints = node.publish::<JointState>("joint_states", 10)?;
    let odometry = node.publish::<Odometry>("odom", 10)?;
    let transforms = (!arguments.no_tf)
        .then(|| node.publish::<TfMessage>("/tf", 100))
        .transpose()?;
    let diagnostics = node.publish::<DiagnosticArray>("/diagnostics", 10)?;
    let temperatures = rover.wheels.iter().map(|wheel| {
        let topic = format!("motor_{}/temperature", wheel.id.get());
        node.publish::<Temperature>(&topic, 10)
    });
    let temperatures: Vec<Topic> = temperatures.collect::<Result<_>>()?;
    let fleet = Publisher::new(node.session(), &arguments.robot_name()?)?;
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
                    Output::Fleet(state) => fleet.send(&state),
                };
                if let Err(error) = sent {
                    say(&format!("not sent: {error}"));
                }
            }
        })
        .context("no thread")?;
    Ok(outputs)
}

//! The program, from its arguments to its end.

use std::{
    sync::{Arc, mpsc},
    thread,
};

use anyhow::Result;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

use crate::{
    arguments::Arguments,
    fleet::sessions::serve,
    network::{Input, listen, publish, watch_router},
    node::Node,
    robot::Robot,
    say, wait_until_said,
};

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
    let sessions = arguments.sessions.clone();
    let sessions = sessions.map(|folder| serve(node.session(), &arguments.robot_name()?, folder));
    let sessions = sessions.transpose()?;
    say(&format!(
        "{} is in domain {}",
        arguments.node, arguments.domain
    ));
    watch_router(&node);
    let mut robot = Robot::new(arguments, rover, to, outputs, node.zid())?;
    robot.run(&inputs);
    drop((listening, sessions));
    node.close();
    wait_until_said();
    Ok(())
}

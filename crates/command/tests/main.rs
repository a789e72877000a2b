//! The tests of the command: one program, so that it is linked once.
#![cfg(test)]
#![cfg(unix)]

mod bad_input;
mod bench;
mod control;
mod control_socket;
#[path = "../../remote-server/tests/support/controller.rs"]
mod controller;
mod doctor;
mod drop_in;
mod example;
mod experiments;
mod fleet;
mod generated_programs;
mod models;
mod ports;
mod program;
mod replay;
mod ros2_files;
mod ros2_plugin;
mod ros2_positions;
mod serial_port;
mod serve;
mod session_files;
mod terminal;
mod tools;
mod ways_out;
mod wizard;

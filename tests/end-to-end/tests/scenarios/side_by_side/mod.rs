//! Scenarios that hold on a busy machine too, where a motor may be lost for a moment.

mod accessibility;
mod adapters;
mod bad_lines;
mod busy_ports;
mod desk;
mod driving;
mod exports;
mod harness;
mod harness_measuring;
mod keys;
mod limits;
mod offline;
mod pages_gone;
mod parts;
mod phone;
mod raw_frames;
mod scanning;
mod security;
mod session;
mod setup;
mod starting;
mod stopping;
mod together;
mod unplugging;
mod wall_clock;
mod watching;

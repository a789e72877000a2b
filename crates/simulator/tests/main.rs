//! What virtual motors and their line do.
#![cfg(test)]

mod determinism;
mod faults;
mod figures;
mod firmware;
mod fixture;
mod line;
mod model_loops;
mod models;
mod protections;
mod set_id;
mod wire;

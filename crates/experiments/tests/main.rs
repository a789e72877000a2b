//! Figures and studies: known systems, noise, files, and what Python computes.
#![cfg(test)]

mod aborts;
mod analytic_systems;
mod bench;
mod coverage;
mod curves;
mod figures;
mod figures_in_python;
mod fitted_models;
mod frequency_responses;
mod independent_intervals;
mod kept_runs;
mod known_systems;
mod measured;
mod mirrored;
mod noisy_runs;
mod odometry_angle;
mod python_program;
mod random_sequences;
mod run_fixture;
mod runs;
mod sequence;
mod step_responses;
mod studies;
mod thinning;
mod tracking;
mod virtual_motor;

//! Frames: golden vectors and properties.
#![cfg(test)]

mod captures;
mod clock;
mod faults;
mod frames;
mod model_properties;
mod model_values;
mod models;
mod properties;
mod values;

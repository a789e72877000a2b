//! The line that the command line asks for.

use motorlink_driver::{Place, VirtualLine};
use motorlink_protocol::MotorId;

use crate::{arguments::Global, failure::Failure, signed_id::SignedId};

/// The motors of `--id`, or else all virtual ones. Empty if the command looks for them.
///
/// # Errors
/// One is named twice.
pub fn motors(global: &Global) -> Result<Vec<SignedId>, Failure> {
    let all = &global.id;
    for (place, one) in all.iter().enumerate() {
        if all.iter().skip(place + 1).any(|other| other.id == one.id) {
            let text = format!("--id: {} is given twice", one.id);
            return Err(Failure::Usage(text));
        }
    }
    Ok(match global.virtual_motors {
        Some(count) if all.is_empty() => {
            let ids = (1..=count).flat_map(MotorId::new);
            ids.map(SignedId::straight).collect()
        }
        _ => all.clone(),
    })
}

/// Where the motors are.
///
/// # Errors
/// Virtual motors have no port.
pub fn place(global: &Global) -> Result<Place, Failure> {
    match (global.virtual_motors, &global.port) {
        (Some(_), Some(_)) => {
            let text = "--virtual has no port: leave out one of them";
            Err(Failure::Usage(text.to_owned()))
        }
        (Some(count), None) => {
            let ids = (1..=count).flat_map(MotorId::new);
            let model = global.model.unwrap_or_default();
            Ok(Place::Virtual(VirtualLine::of(model, ids)))
        }
        (None, Some(port)) => Ok(Place::Port(port.clone())),
        (None, None) => Ok(Place::OnlyAdapter),
    }
}

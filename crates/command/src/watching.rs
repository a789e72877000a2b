//! Watches the motors that a command shows.

use motorlink_bus::Command;

use crate::{
    connection::{Connection, WIRING},
    failure::Failure,
    scan::scan,
    signed_id::SignedId,
};

/// Watches the motors of `--id`, or else all that answer: the one that answers the ID query, or those of a full scan.
///
/// # Errors
/// None answers.
pub fn watch_found(connection: &mut Connection) -> Result<(), Failure> {
    match connection.wait_for_motors() {
        Ok(()) => return Ok(()),
        Err(failure @ Failure::Interrupted) => return Err(failure),
        Err(failure) if !connection.motors.is_empty() => return Err(failure),
        Err(_) => {}
    }
    let found = scan(connection)?.found;
    if found.is_empty() {
        return Err(Failure::NotDone(format!("no motor answers. {WIRING}")));
    }
    for id in found {
        connection.driver.command(Command::Watch(id));
        connection.motors.push(SignedId::straight(id));
    }
    Ok(())
}

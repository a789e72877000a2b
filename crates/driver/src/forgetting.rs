//! Forgets what was left driven.

use std::io;

use motorlink_protocol::MotorId;

use crate::{
    driven_file::{DrivenFile, NoFile},
    holder::holder_of,
    locked_file::{LockedFile, default_folder},
    open_failure::OpenFailure,
    ports::ChosenPort,
};

/// Forgets motors that an earlier program left driven over the adapter of this port, or of the only one, because they have
/// no power any more: these, or all. The next driver does not stop them. Returns them.
///
/// # Errors
/// There is no such port, a driver uses it, or the system refuses to write its file.
pub fn forget_left_driven(
    path: Option<&str>,
    these: &[MotorId],
) -> Result<Vec<MotorId>, OpenFailure> {
    let port = ChosenPort::find(path)?.that_exists()?;
    let refused = || OpenFailure::Io(port.path.clone(), io::Error::other("its file is refused"));
    let folder = default_folder().ok_or_else(refused)?;
    let (file, content) = match LockedFile::open(&folder, &port.identity()) {
        Ok(opened) => opened,
        Err(NoFile::Refused) => return Err(refused()),
        Err(NoFile::InUse) => {
            let holder = holder_of(&port.path);
            return Err(OpenFailure::Busy {
                path: port.path,
                holder,
            });
        }
    };
    let mut file = DrivenFile::new(Box::new(file), &content);
    let is_meant = |id: &MotorId| these.is_empty() || these.contains(id);
    let forgotten = file.left.motors.iter().map(|motor| motor.id);
    let forgotten = forgotten.filter(is_meant).collect();
    file.left.motors.retain(|motor| !is_meant(&motor.id));
    if !file.remember(file.left.model, || [].into_iter()) {
        return Err(refused());
    }
    Ok(forgotten)
}

//! A group whose start waits for a stop.

use crate::{command::Consent, group::setpoints::GroupSetpoints};

/// A group that a person has started, and that waits for a stop.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WaitingGroup {
    pub(crate) setpoints: GroupSetpoints,
    pub(crate) consent: Consent,
}

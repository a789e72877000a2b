//! The places of the page.

use strum::{IntoStaticStr, VariantArray};

/// A place: what one does there. All have the graph and the packet log.
#[derive(Clone, Copy, Debug, PartialEq, Eq, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "snake_case", const_into_str)]
pub(crate) enum Place {
    /// Drives a motor or a group.
    Drive,
    /// Records telemetry; saves, opens and replays sessions.
    Record,
    /// Runs experiments.
    Test,
    /// IDs of motors, limits, and the setup.
    Setup,
    /// The quality of the link, and raw frames.
    Diagnose,
}

/// A panel that a button opens and `Close` closes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Panel {
    /// The choice of the virtual motors, below its button.
    VirtualMotors,
    /// The setup of the wheels of a rover, one motor after the other, over the ID manager.
    WheelSetup,
    /// The setup as a link, over the settings.
    SetupLink,
}

/// What is open. Another place closes the panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Open {
    pub(crate) place: Place,
    pub(crate) panel: Option<Panel>,
}

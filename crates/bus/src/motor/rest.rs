//! What is known of the standstill of a motor that this bus has commanded.

/// Whether a command of this bus may still turn the wheel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rest {
    /// It was never driven, or its standstill is confirmed.
    Known,
    /// It was driven, and no reply has reported standstill since.
    Unknown,
    /// As `Unknown`; besides, it was silent when it was last stopped, or has fallen silent since. Its stop begins again
    /// when it answers.
    StopWhenBack,
}

impl Rest {
    /// It gets a command that may turn it.
    pub(crate) fn doubt(&mut self) {
        if *self == Self::Known {
            *self = Self::Unknown;
        }
    }

    /// It is silent: if it may turn, it is stopped when it answers.
    pub(crate) fn wait_for_reply(&mut self) {
        if *self == Self::Unknown {
            *self = Self::StopWhenBack;
        }
    }
}

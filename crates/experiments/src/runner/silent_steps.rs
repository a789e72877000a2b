//! The steps of a run in which frames are withheld, to measure what a motor does then.

/// Which frames are withheld during a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Withheld {
    /// Drive frames. The motors are queried instead.
    DriveFrames,
    /// Drive frames and queries.
    Requests,
}

/// A step in which frames are withheld.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SilentStep {
    /// The instruction of the plan.
    pub step: usize,
    /// What is withheld.
    pub withheld: Withheld,
}

/// The steps of a run in which frames are withheld; none in most runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SilentSteps(pub [Option<SilentStep>; 3]);

impl SilentSteps {
    /// No frames are withheld.
    pub const NONE: Self = Self([None; 3]);

    /// What is withheld during this instruction.
    #[must_use]
    pub fn get(&self, step: usize) -> Option<Withheld> {
        let mut steps = self.0.iter().flatten();
        steps.find(|it| it.step == step).map(|it| it.withheld)
    }
}

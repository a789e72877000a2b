//! The tabs of the control panel.

use motorlink_i18n::tr;
use motorlink_messages::protocol::{Mode, family::Model};

/// A tab: a loop to drive in, or a tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tab {
    /// Drives in this loop.
    Loop(Mode),
    /// Finds motors and changes their IDs.
    IdManager,
    /// Sends raw frames.
    RawHex,
}

impl Tab {
    /// Those of all models, in the order of the tabs.
    pub(crate) const ALL: [Self; 6] = [
        Self::Loop(Mode::Velocity),
        Self::Loop(Mode::Current),
        Self::Loop(Mode::Position),
        Self::Loop(Mode::OpenLoop),
        Self::IdManager,
        Self::RawHex,
    ];

    /// The one that every model has.
    pub(crate) const FIRST: Self = Self::Loop(Mode::Velocity);

    /// Its name in element ids.
    pub(crate) const fn key(self) -> &'static str {
        match self {
            Self::Loop(Mode::OpenLoop) => "open-loop",
            Self::Loop(Mode::Velocity) => "velocity",
            Self::Loop(Mode::Current) => "current",
            Self::Loop(Mode::Position) => "position",
            Self::IdManager => "id-manager",
            Self::RawHex => "raw-hex",
        }
    }

    /// Its label.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Loop(Mode::OpenLoop) => tr!("Open loop"),
            Self::Loop(Mode::Velocity) => tr!("Velocity"),
            Self::Loop(Mode::Current) => tr!("Current" as "electric"),
            Self::Loop(Mode::Position) => tr!("Position"),
            Self::IdManager => tr!("ID Manager"),
            Self::RawHex => tr!("Raw Hex"),
        }
    }

    /// Whether a model has it.
    pub(crate) fn is_of(self, model: Model) -> bool {
        match self {
            Self::Loop(mode) => model.has(mode),
            Self::IdManager | Self::RawHex => true,
        }
    }

    /// Whether it is a tool.
    pub(crate) const fn is_tool(self) -> bool {
        !matches!(self, Self::Loop(_))
    }

    /// The tab after a change of the motor's loop. An open tool stays open.
    pub(crate) const fn following(self, mode: Mode) -> Self {
        match self {
            Self::Loop(_) => Self::Loop(mode),
            Self::IdManager | Self::RawHex => self,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_model_has_the_tabs_of_its_loops() {
        let tabs = |model: Model| {
            let of_model = Tab::ALL.into_iter().filter(move |tab| tab.is_of(model));
            of_model.map(Tab::name).collect::<Vec<_>>().join(", ")
        };
        for (model, names) in [
            (
                Model::Ddsm115,
                "Velocity, Current, Position, ID Manager, Raw Hex",
            ),
            (
                Model::Ddsm315,
                "Velocity, Current, Position, ID Manager, Raw Hex",
            ),
            (
                Model::Ddsm210,
                "Velocity, Position, Open loop, ID Manager, Raw Hex",
            ),
            (
                Model::Ddsm400,
                "Velocity, Current, Position, Open loop, ID Manager, Raw Hex",
            ),
        ] {
            assert_eq!(tabs(model), names);
            assert!(Tab::FIRST.is_of(model));
        }
    }

    #[test]
    fn a_loop_tab_follows_the_motor_and_a_tool_stays() {
        for mode in Mode::ALL {
            assert_eq!(Tab::Loop(Mode::Velocity).following(mode), Tab::Loop(mode));
            assert_eq!(Tab::IdManager.following(mode), Tab::IdManager);
            assert_eq!(Tab::RawHex.following(mode), Tab::RawHex);
        }
    }
}

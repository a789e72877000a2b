//! The tabs of the control panel: one for each loop.

use motorlink_i18n::tr;
use motorlink_messages::protocol::Mode;

/// Those of all models, in the order of the tabs.
pub(crate) const TABS: [Mode; 4] = [FIRST, Mode::Current, Mode::Position, Mode::OpenLoop];

/// The one that every model has.
pub(crate) const FIRST: Mode = Mode::Velocity;

/// Its name in element ids.
pub(crate) const fn key(mode: Mode) -> &'static str {
    match mode {
        Mode::OpenLoop => "open-loop",
        Mode::Velocity => "velocity",
        Mode::Current => "current",
        Mode::Position => "position",
    }
}

/// Its label.
pub(crate) fn name(mode: Mode) -> &'static str {
    match mode {
        Mode::OpenLoop => tr!("Open loop"),
        Mode::Velocity => tr!("Velocity"),
        Mode::Current => tr!("Current" as "electric"),
        Mode::Position => tr!("Position"),
    }
}

#[cfg(test)]
mod tests {
    use motorlink_messages::protocol::family::Model;

    use super::*;

    #[test]
    fn each_model_has_the_tabs_of_its_loops() {
        let tabs = |model: Model| {
            let of_model = TABS.into_iter().filter(move |mode| model.has(*mode));
            of_model.map(name).collect::<Vec<_>>().join(", ")
        };
        for (model, names) in [
            (Model::Ddsm115, "Velocity, Current, Position"),
            (Model::Ddsm315, "Velocity, Current, Position"),
            (Model::Ddsm210, "Velocity, Position, Open loop"),
            (Model::Ddsm400, "Velocity, Current, Position, Open loop"),
        ] {
            assert_eq!(tabs(model), names);
            assert!(model.has(FIRST));
        }
    }
}

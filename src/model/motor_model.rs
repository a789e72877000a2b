//! The model of the motors: that of the open line, else the chosen one.

use motorlink_i18n::tr;
use motorlink_messages::{Adapter, Connection, protocol::family::Model};

use crate::model::{replay, snapshot::Session};

/// The model that the page shows. While a port is being opened, the worker tries several.
pub(crate) fn shown(session: &Session, chosen: Model) -> Model {
    let is_open = matches!(session.connection, Connection::Connected(_));
    let line = session.line.filter(|_| is_open);
    line.map_or(chosen, |line| line.model)
}

/// The model that becomes the chosen one, because motors have answered as it.
///
/// Only the person tells a DDSM115 from a DDSM315. A virtual line says nothing about the motors on the port.
pub(crate) fn found(session: &Session, chosen: Model) -> Option<Model> {
    let line = session.line.filter(|line| line.model_known)?;
    let on_port = matches!(
        session.connection,
        Connection::Connected(Adapter::Serial(_))
    );
    let differs = line.model != chosen;
    let is_told_apart = line.model.has_separate_frames() || chosen.has_separate_frames();
    (on_port && differs && is_told_apart).then_some(line.model)
}

/// Why no other model can be chosen now.
pub(crate) fn choice_blocked_by(session: &Session) -> Option<&'static str> {
    match session.connection {
        // The page of a server does not show the choice.
        Connection::Disconnected
        | Connection::Failed(_)
        | Connection::Connected(Adapter::Remote | Adapter::Watched) => None,
        Connection::Connected(Adapter::Recording) => Some(replay::blocked()),
        Connection::Connected(Adapter::Virtual(_)) => {
            Some(tr!("Virtual motors have a model of their own."))
        }
        Connection::Connecting => Some(tr!("Opening the port.")),
        Connection::Reconnecting(_) => Some(tr!("The adapter is unplugged. Plug it back in.")),
        Connection::Connected(Adapter::Serial(_)) => (session.is_anything_driven()
            || session.job.is_some())
        .then(|| tr!("Changing the model reopens the port. Stop all motors first.")),
    }
}

#[cfg(test)]
mod tests {
    use motorlink_messages::{
        bus::{Activity, LineStatus},
        protocol::Mode,
    };

    use super::*;
    use crate::model::snapshot::tests::{session, status};

    const PORT: Connection = Connection::Connected(Adapter::Serial(None));

    fn line(model: Model, model_known: bool) -> Session {
        let mut open = session(1_000, status(1_000, Mode::Velocity, 0));
        open.connection = PORT;
        open.line = Some(LineStatus {
            model,
            model_known,
            ..LineStatus::default()
        });
        open
    }

    #[test]
    fn the_model_is_that_of_the_line_and_without_a_line_the_chosen_one() {
        let open = line(Model::Ddsm400, false);
        assert_eq!(shown(&open, Model::Ddsm210), Model::Ddsm400);
        assert_eq!(shown(&Session::default(), Model::Ddsm210), Model::Ddsm210);
        let mut on_trial = open;
        on_trial.connection = Connection::Connecting;
        assert_eq!(shown(&on_trial, Model::Ddsm210), Model::Ddsm210);
    }

    #[test]
    fn a_found_model_is_chosen_but_a_115_and_a_315_are_left_to_the_person() {
        use Model::{Ddsm115, Ddsm210, Ddsm315, Ddsm400};
        for (chosen, on_line, taken) in [
            (Ddsm115, Ddsm400, Some(Ddsm400)),
            (Ddsm210, Ddsm115, Some(Ddsm115)),
            (Ddsm210, Ddsm400, Some(Ddsm400)),
            (Ddsm210, Ddsm210, None),
            (Ddsm315, Ddsm115, None),
            (Ddsm115, Ddsm315, None),
        ] {
            assert_eq!(
                found(&line(on_line, true), chosen),
                taken,
                "{chosen} {on_line}"
            );
            assert_eq!(found(&line(on_line, false), chosen), None, "not known yet");
            let mut virtual_line = line(on_line, true);
            virtual_line.connection = Connection::Connected(Adapter::VIRTUAL);
            assert_eq!(found(&virtual_line, chosen), None, "virtual");
        }
    }

    #[test]
    fn while_a_motor_is_driven_or_turns_no_other_model_can_be_chosen() {
        let mut open = line(Model::Ddsm115, true);
        assert_eq!(choice_blocked_by(&open), None);
        open.motors[0].activity = Activity::Switching { to: Mode::Current };
        assert!(
            choice_blocked_by(&open)
                .unwrap()
                .contains("Stop all motors")
        );
        let mut turning = session(1_000, status(1_000, Mode::Velocity, 20));
        turning.connection = PORT;
        assert!(choice_blocked_by(&turning).is_some());
        assert_eq!(choice_blocked_by(&Session::default()), None);
    }
}

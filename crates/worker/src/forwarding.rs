//! Forwards the events of the bus to the page.

use motorlink_bus::{CommandKind, Event};
use motorlink_messages::Notice;

use crate::{
    outbox::Outbox,
    port_state::{OpenPort, Stage},
};

/// Forwards an event to the page. While a port is on trial, only stops are forwarded: the port may
/// belong to an adapter that the user did not choose. The outcome of the ID query waits for the end of the trial.
pub(crate) fn forward(outbox: &mut Outbox, open: &mut OpenPort, event: Event) {
    let is_stop = matches!(event, Event::StopBegan(_) | Event::StopEnded(_));
    if matches!(open.stage, Stage::OnTrial { .. }) && !is_stop {
        if let Event::IdQueryEnded(outcome) = event {
            open.id_query = Some(outcome);
        }
        return;
    }
    let notice = match event {
        Event::Telemetry(sample) => {
            outbox.sample(sample);
            // The page shows each step of a stop.
            if open.bus.is_stopping() {
                outbox.touch();
            }
            return;
        }
        // Line events go to the recorder.
        Event::PingPage | Event::Line(_) => return,
        Event::IdQueryEnded(outcome) => Notice::IdQueryEnded(outcome),
        Event::ScanEnded(report) => Notice::ScanEnded(report),
        Event::IdChangeEnded { from, to, outcome } => Notice::IdChangeEnded { from, to, outcome },
        Event::ModeSwitched { id, mode } => Notice::ModeSwitched { id, mode },
        Event::ModeSwitchFailed {
            id,
            asked,
            reported,
        } => Notice::ModeSwitchFailed {
            id,
            asked,
            reported,
        },
        Event::NotStarted { id, refusal } => Notice::Refused {
            command: CommandKind::Drive(id),
            refusal,
        },
        Event::Withdrawn { id, reason } => Notice::Withdrawn { id, reason },
        Event::OtherModel { expected, found } => Notice::OtherModel { expected, found },
        Event::SendsText { is_json } => Notice::SendsText { is_json },
        Event::MotorSilent { id, garbled } => Notice::MotorSilent { id, garbled },
        Event::MotorBack(id) => Notice::MotorBack(id),
        Event::StopBegan(reason) => Notice::StopBegan(reason),
        Event::StopEnded(report) => Notice::StopEnded(report),
    };
    outbox.notice(notice);
}

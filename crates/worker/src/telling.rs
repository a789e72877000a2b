//! What the bus tells, passed on to the page.

use motorlink_bus::Event;
use motorlink_messages::Notice;

use crate::{
    outbox::Outbox,
    session::{OpenSession, Stage},
};

/// Passes on what the bus tells, unless the port is on trial: what is heard there may come from an
/// adapter that nobody meant.
pub(crate) fn tell(outbox: &mut Outbox, open: &OpenSession, event: Event) {
    let is_stop = matches!(event, Event::StopBegan(_) | Event::StopEnded(_));
    if matches!(open.stage, Stage::OnTrial { .. }) && !is_stop {
        return;
    }
    let notice = match event {
        Event::Telemetry(sample) => return outbox.sample(sample),
        // Traffic went to the recorder.
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
        Event::Withdrawn { id, reason } => Notice::Withdrawn { id, reason },
        Event::MotorSilent(id) => Notice::MotorSilent(id),
        Event::MotorBack(id) => Notice::MotorBack(id),
        Event::StopBegan(reason) => Notice::StopBegan(reason),
        Event::StopEnded(report) => Notice::StopEnded(report),
    };
    outbox.notice(notice);
}

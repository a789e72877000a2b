//! Forwards the events of the bus to the page.

use motorlink_bus::Event;
use motorlink_messages::Outbox;

use crate::port_state::{OpenPort, Stage};

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
    outbox.event(event, open.bus.is_stopping());
}

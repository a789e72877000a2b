//! Forwards the events of the bus to the page.

use motorlink_bus::{Bus, Event};
use motorlink_messages::Outbox;

use crate::port_state::Stage;

/// Forwards an event to the page. While a port is on trial, only stops are forwarded: the port may
/// belong to an adapter that the user did not choose. The outcome of the ID query waits for the end of the trial.
pub(crate) fn forward(outbox: &mut Outbox, stage: &mut Stage, bus: &Bus, event: Event) {
    let is_stop = matches!(event, Event::StopBegan(_) | Event::StopEnded(_));
    match (stage, event) {
        (Stage::OnTrial { id_query, .. }, event) if !is_stop => {
            if let Event::IdQueryEnded(outcome) = event {
                *id_query = Some(outcome);
            }
        }
        (_, event) => outbox.event(event, bus.is_stopping()),
    }
}

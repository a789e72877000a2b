//! The start of the worker that owns the port, and the messages of the page.

use std::{cell::RefCell, rc::Rc};

use motorlink_bus::COMMAND_AGE_MAX;
use motorlink_messages::{ToPage, ToWorker, decode};

use crate::{
    alarm::Alarm,
    connecting::{adapter_plugged, pump, stop_and_close},
    port_owner::{PortOwner, Shared},
    port_state::AfterClosing,
    runs::loading::run_message,
    scope::{self, Clock, Incoming},
    serial,
};

/// Starts the worker.
pub(crate) fn start() {
    let clock = Clock::new();
    scope::post(&ToPage::Hello {
        time_origin_ms: clock.origin_ms(),
    });
    let shared = new_owner(&clock);
    let owner = Rc::clone(&shared);
    scope::on_message(move |incoming| match incoming {
        Incoming::Message(bytes) => match decode(&bytes) {
            Ok(message) => handle(&owner, message),
            Err(error) => {
                let error = error.to_string().into();
                scope::report("the page sent a message of another build", &error);
            }
        },
        Incoming::TrafficPort(port) => {
            owner.borrow_mut().connect_recorder(port);
            pump(&owner);
        }
    });
    serial::on_plugged(move || adapter_plugged(&shared));
}

/// The owner of the port, with its alarm.
pub(crate) fn new_owner(clock: &Clock) -> Shared {
    Rc::new_cyclic(|owner| {
        let owner = owner.clone();
        let ring = move || {
            if let Some(shared) = owner.upgrade() {
                pump(&shared);
            }
        };
        let alarm = Alarm::new(clock.clone(), ring);
        RefCell::new(PortOwner::new(clock.clone(), alarm))
    })
}

/// Handles a message of the page. A stop is on the wire, or next, when this returns.
pub(crate) fn handle(shared: &Shared, message: ToWorker) {
    match message {
        ToWorker::ConnectSerial { .. } | ToWorker::ConnectVirtual(_) => {
            stop_and_close(shared, AfterClosing(Some(message)));
        }
        ToWorker::Disconnect => stop_and_close(shared, AfterClosing(None)),
        ToWorker::Select(id) => shared.borrow_mut().select(id),
        ToWorker::Command { command, given_ms } => {
            shared.borrow_mut().command(command, given_ms);
        }
        ToWorker::VirtualWire(wire) => shared.borrow_mut().set_virtual_wire(wire),
        ToWorker::Pong { page_ms } => shared.borrow_mut().page_answered(page_ms),
        ToWorker::Run { message, given_ms } => {
            let is_old = shared.borrow().age(given_ms) > COMMAND_AGE_MAX;
            run_message(shared, (message, is_old));
        }
    }
    pump(shared);
}

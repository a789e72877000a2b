//! The start of the worker that owns the port, and the messages of the page.

use std::{cell::RefCell, rc::Rc};

use motorlink_messages::{ToPage, ToWorker, decode};

use crate::{
    alarm::Alarm,
    connecting::{adapter_plugged, leave, pump},
    scope::{self, Arrived, Clock},
    serial,
    session::AfterClosing,
    station::{Shared, Station},
};

/// Starts the worker.
pub(crate) fn start() {
    let clock = Clock::new();
    scope::post(&ToPage::Hello {
        time_origin_ms: clock.origin_ms(),
    });
    let shared: Shared = Rc::new_cyclic(|station| {
        let station = station.clone();
        let ring = move || {
            if let Some(shared) = station.upgrade() {
                pump(&shared);
            }
        };
        let alarm = Alarm::new(clock.clone(), ring);
        RefCell::new(Station::new(clock.clone(), alarm))
    });
    let station = Rc::clone(&shared);
    scope::on_message(move |arrived| match arrived {
        Arrived::Message(bytes) => match decode(&bytes) {
            Ok(message) => handle(&station, message),
            Err(error) => {
                let error = error.to_string().into();
                scope::report("the page sent a message of another build", &error);
            }
        },
        Arrived::Line(port) => {
            station.borrow_mut().connect_recorder(port);
            pump(&station);
        }
    });
    serial::on_plugged(move || adapter_plugged(&shared));
}

/// Carries out a message of the page. A stop is on the wire, or next on it, when this returns.
fn handle(shared: &Shared, message: ToWorker) {
    match message {
        ToWorker::ConnectSerial { .. } | ToWorker::ConnectVirtual => {
            leave(shared, AfterClosing(Some(message)));
        }
        ToWorker::Disconnect => leave(shared, AfterClosing(None)),
        ToWorker::Select(id) => shared.borrow_mut().select(id),
        ToWorker::Command { command, given_ms } => {
            shared.borrow_mut().command(command, given_ms);
        }
        ToWorker::VirtualWire(wire) => shared.borrow_mut().set_virtual_wire(wire),
        ToWorker::Pong { page_ms } => shared.borrow_mut().page_answered(page_ms),
    }
    pump(shared);
}

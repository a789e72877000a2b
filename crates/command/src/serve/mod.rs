//! `motorlink serve`: the page in a browser anywhere watches and drives the motors of this computer.

pub mod arguments;
mod certificate;
mod fleet;
mod service;
mod socket;
mod token;
mod web;

use std::{io, path::Path, thread, time::Duration};

use motorlink_driver::Ender;
use motorlink_messages::Adapter;
use motorlink_remote_server::{Hub, Viewers};

use crate::{
    arguments::Global,
    connection::{Connection, Happened},
    failure::Failure,
    output::say,
    serve::{arguments::Serve, service::Service, web::Web},
    stop_report::most_serious,
    watching::watch_found,
};

/// Entries between two turns of the hub: those of 20 ms on a fast line, and some more.
const ENTRIES_MAX: usize = 64;
/// How soon the page of the fleet ends after Ctrl-C.
const LOOK_EVERY: Duration = Duration::from_millis(100);

/// Serves until Ctrl-C or a signal.
///
/// # Errors
/// The page is missing, the address or the socket is in use, the token or the certificate cannot be read, or the line cannot
/// be opened.
pub fn run(global: &Global, how: Serve, ender: &Ender) -> Result<(), Failure> {
    let log = how.log.clone();
    let without_motors = how.without_motors;
    let web = Web::prepare(how);
    if without_motors {
        return serve_fleet(web?, ender);
    }
    let opened = Connection::open_with(global, ender, |options| options.tells_traffic = true);
    let (web, mut connection) = match (web, opened) {
        (Ok(web), opened) => (web, opened?),
        // A wheel may turn that an earlier server has left driven. It is stopped whatever is wrong with this one.
        (Err(failure), Ok(connection)) => {
            return most_serious(Err(failure), connection.end_with(|_| ()));
        }
        (Err(failure), Err(_)) => return Err(failure),
    };
    let served = serve(&mut connection, web, log.as_deref());
    let stopped = connection.end_with(|_| ());
    match served {
        // Ctrl-C is how a person ends it.
        Ok(()) | Err(Failure::Interrupted) => stopped,
        Err(failure) => stopped.and(Err(failure)),
    }
}

/// Finds the motors, and serves.
fn serve(connection: &mut Connection, web: Web, log: Option<&Path>) -> Result<(), Failure> {
    if let Some(folder) = log
        && let Err(failure) = connection.log_to(folder)
    {
        // The motors can be driven nevertheless.
        say(format_args!("--log has ended: {failure}"));
    }
    match watch_found(connection) {
        // The page shows that no motor answers, and what to do.
        Err(failure @ (Failure::NotDone(_) | Failure::OtherModel(_))) => say(failure),
        other => other?,
    }
    let viewers = Viewers::new(connection.driver.commander()).map_err(no_threads)?;
    let mut hub = Hub::new(viewers.clone(), Adapter::Serial(None));
    // It answers until the end of this function.
    let started = web.start(Some(viewers.clone())).map_err(no_threads)?;
    started.links.iter().for_each(say);
    let mut service = Service::ready();
    loop {
        let wait = hub.turn(&connection.driver);
        service.notify_alive();
        viewers.take_log().into_iter().for_each(say);
        let mut next = connection.next_within(wait)?;
        // Several, so that a busy line does not turn the hub for each frame.
        for _ in 0..ENTRIES_MAX {
            let Happened::Entry(at, entry) = next else {
                break;
            };
            hub.take(at, entry);
            next = connection.next_within(Duration::ZERO)?;
        }
        if let Happened::Entry(at, entry) = next {
            hub.take(at, entry);
        }
    }
}

/// Serves the page of the fleet alone.
fn serve_fleet(web: Web, ender: &Ender) -> Result<(), Failure> {
    let started = web.start(None).map_err(no_threads)?;
    started.links.iter().for_each(say);
    let mut service = Service::ready();
    while !ender.is_asked() {
        service.notify_alive();
        thread::sleep(LOOK_EVERY);
    }
    Ok(())
}

#[expect(clippy::needless_pass_by_value, reason = "as `map_err` gives it")]
fn no_threads(error: io::Error) -> Failure {
    Failure::NotDone(format!("the web server does not start: {error}"))
}

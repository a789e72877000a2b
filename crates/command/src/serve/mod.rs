//! `motorlink serve`: the page in a browser anywhere watches and drives the motors of this computer.

pub mod arguments;
mod token;

use std::{
    io,
    net::{IpAddr, SocketAddr, TcpListener},
    time::Duration,
};

use motorlink_driver::Ender;
use motorlink_messages::Adapter;
use motorlink_remote_server::{Access, Hub, Server, Site, Token, Viewers};
use qrcode::{QrCode, render::unicode};

use crate::{
    arguments::Global,
    connection::{Connection, Happened},
    failure::Failure,
    output::say,
    serve::arguments::Serve,
    watching::watch_found,
};

/// Entries between two turns of the hub: those of 20 ms on a fast line, and some more.
const ENTRIES_MAX: usize = 64;

/// Serves until Ctrl-C or a signal.
///
/// # Errors
/// The page is missing, the address is in use, the token cannot be read, or the line cannot be opened.
pub fn run(global: &Global, how: Serve, ender: &Ender) -> Result<(), Failure> {
    // What can be wrong without motors is said before the port is opened.
    let site = Site::open(how.page).map_err(|error| Failure::Usage(error.to_string()))?;
    let listen = how.listen.0;
    // Another name is that of a proxy: others connect through it.
    let is_private = listen.ip().is_loopback() && how.names.is_empty();
    let token = if is_private && how.token_file.is_none() {
        None
    } else {
        Some(token::token(how.token_file.as_deref())?)
    };
    let listener = TcpListener::bind(listen).map_err(|error| in_use(listen, &error))?;
    let listen = listener.local_addr().map_err(Failure::output)?;

    let mut connection =
        Connection::open_with(global, ender, |options| options.tells_traffic = true)?;
    let served = serve(&mut connection, listener, |viewers| {
        let link = links(listen, token.as_ref());
        let access = Access::new(listen, how.names, token);
        (access, site, viewers, link)
    });
    let stopped = connection.end_with(|_| ());
    match served {
        // Ctrl-C is how a person ends it.
        Ok(()) | Err(Failure::Interrupted) => stopped,
        Err(failure) => stopped.and(Err(failure)),
    }
}

/// Finds the motors, and serves.
fn serve(
    connection: &mut Connection,
    listener: TcpListener,
    with: impl FnOnce(Viewers) -> (Access, Site, Viewers, Vec<String>),
) -> Result<(), Failure> {
    match watch_found(connection) {
        // The page shows that no motor answers, and what to do.
        Err(Failure::NotDone(text)) => say(text),
        other => other?,
    }
    let viewers = Viewers::new(connection.driver.commander()).map_err(no_threads)?;
    let log = viewers.clone();
    let mut hub = Hub::new(viewers.clone(), Adapter::Serial(None));
    let (access, site, viewers, links) = with(viewers);
    // It answers until the end of this function.
    let _server = Server::start(listener, access, site, viewers).map_err(no_threads)?;
    for line in links {
        say(line);
    }
    loop {
        let wait = hub.turn(&connection.driver);
        log.take_log().into_iter().for_each(say);
        let mut next = connection.next_within(wait)?;
        // Several, so that a busy line does not turn the hub for each frame.
        for _ in 0..ENTRIES_MAX {
            let Happened::Entry(_, entry) = next else {
                break;
            };
            hub.take(entry);
            next = connection.next_within(Duration::ZERO)?;
        }
        if let Happened::Entry(_, entry) = next {
            hub.take(entry);
        }
    }
}

#[expect(clippy::needless_pass_by_value, reason = "as `map_err` gives it")]
fn no_threads(error: io::Error) -> Failure {
    Failure::NotDone(format!("the web server does not start: {error}"))
}

fn in_use(listen: SocketAddr, error: &io::Error) -> Failure {
    Failure::Usage(match error.kind() {
        io::ErrorKind::AddrInUse => {
            format!("--listen {listen}: another program listens there; choose another port")
        }
        io::ErrorKind::PermissionDenied => {
            format!("--listen {listen}: not permitted; choose a port above 1023")
        }
        _ => format!("--listen {listen}: {error}"),
    })
}

/// What a person opens, with a picture for phones.
fn links(listen: SocketAddr, token: Option<&Token>) -> Vec<String> {
    let Some(token) = token else {
        return vec![format!(
            "Open http://{listen}/ on this computer. Ctrl-C ends."
        )];
    };
    let address = match listen.ip() {
        // Every address of this computer; the one that leads to the network is shown.
        ip if ip.is_unspecified() => outgoing_address().unwrap_or(ip),
        ip => ip,
    };
    let link = format!(
        "http://{}/?token={token}",
        SocketAddr::new(address, listen.port())
    );
    let mut lines = vec![
        format!("Open {link}"),
        "Who has this link can drive the motors. The connection is not encrypted: use it in a network that you trust."
            .to_owned(),
    ];
    if let Ok(code) = QrCode::new(&link) {
        lines.push(code.render::<unicode::Dense1x2>().build());
    }
    lines.push("Ctrl-C ends.".to_owned());
    lines
}

/// The address from which this computer reaches others. Nothing is sent.
fn outgoing_address() -> Option<IpAddr> {
    let socket = std::net::UdpSocket::bind("0.0.0.0:0").ok()?;
    // An address for documentation (RFC 5737): only the route to it is asked for.
    socket.connect("192.0.2.1:9").ok()?;
    Some(socket.local_addr().ok()?.ip())
}

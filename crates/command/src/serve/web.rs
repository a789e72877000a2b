//! What the web server is started with. What can be wrong with it is said before the port of the motors is opened.

use std::{
    io::{self, IsTerminal},
    net::{IpAddr, SocketAddr, TcpListener},
    path::{Path, PathBuf},
};

use motorlink_remote_server::{Access, Server, Site, Tls, Token, Viewers};
use qrcode::{QrCode, render::unicode};

use crate::{
    failure::Failure,
    serve::{
        arguments::Serve,
        certificate::{certificate, local_names, names},
        fleet::Watched,
        socket::{Running, Socket},
        token,
    },
};

/// A web server before its start.
pub struct Web {
    listener: TcpListener,
    site: Site,
    access: Access,
    tls: Option<Tls>,
    socket: Option<Socket>,
    fleet: Option<Watched>,
    links: Vec<String>,
}

/// A web server that answers until it is dropped.
pub struct Started {
    /// What a person opens.
    pub links: Vec<String>,
    _socket: Option<Running>,
    _fleet: Option<Watched>,
    _server: Server,
}

impl Web {
    /// Reads the page, token and certificate, and listens, at the socket too.
    ///
    /// # Errors
    /// One of them is missing or wrong, or the address or the socket is in use.
    pub fn prepare(how: Serve) -> Result<Self, Failure> {
        let site = Site::open(how.page).map_err(|error| Failure::Usage(error.to_string()))?;
        let site = match &how.log {
            Some(folder) => site.with_sessions(folder),
            None => site,
        };
        let fleet = how.fleet.map(Watched::start).transpose()?;
        let site = match &fleet {
            Some(fleet) => site.with_fleet(fleet.newest()),
            None => site,
        };
        let listen = how.listen.0;
        let is_private = listen.ip().is_loopback() && how.names.is_empty();
        // Another name is that of a proxy: others connect through it.
        let token = if is_private && how.token_file.is_none() {
            None
        } else {
            Some(token::token(how.token_file.as_deref())?)
        };
        let outgoing = outgoing_address(listen.ip().is_ipv6());
        let tls = match (&how.certificate, &how.key) {
            (Some(file), Some(key)) => {
                let names = names(listen.ip(), outgoing, &how.names);
                Some(certificate(file, key, names)?)
            }
            _ => None,
        };
        let listener = TcpListener::bind(listen).map_err(|error| in_use(listen, &error))?;
        let listen = listener.local_addr().map_err(Failure::output)?;
        let shown = match listen.ip() {
            // Every address of this computer; the one that leads to the network is shown.
            ip if ip.is_unspecified() => outgoing.unwrap_or(ip),
            ip => ip,
        };
        let scheme = if tls.is_some() { "https" } else { "http" };
        let origin = format!("{scheme}://{}", SocketAddr::new(shown, listen.port()));
        let mut links = match &token {
            None => vec![format!("Open {origin}/ on this computer. Ctrl-C ends.")],
            Some(token) => links(
                &origin,
                token,
                how.token_file.as_deref(),
                warning(tls.is_some(), how.without_motors),
            ),
        };
        if fleet.is_some() {
            let first = if token.is_some() {
                ", once that link was opened"
            } else {
                ""
            };
            links.push(format!("The robots are at {origin}/fleet{first}."));
        }
        let socket = how.socket.as_deref().map(Socket::prepare).transpose()?;
        let mut known = how.names;
        // A name that others give this computer is safe where a token is needed.
        if token.is_some() {
            known.extend(local_names());
        }
        let access = Access::new(listen, known, token);
        let access = match tls {
            Some(_) => access.encrypted(),
            None => access,
        };
        Ok(Self {
            listener,
            site,
            access,
            tls,
            socket,
            fleet,
            links,
        })
    }

    /// Starts the server and the socket. Without viewers there is no line, and only the fleet is shown.
    ///
    /// # Errors
    /// The system gives no threads.
    pub fn start(self, viewers: Option<Viewers>) -> io::Result<Started> {
        let socket = self.socket.zip(viewers.clone());
        let socket = socket.map(|(socket, viewers)| socket.start(viewers));
        Ok(Started {
            _socket: socket.transpose()?,
            _fleet: self.fleet,
            _server: Server::start(self.listener, self.access, self.site, viewers, self.tls)?,
            links: self.links,
        })
    }
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

/// Who can do what with the link.
const fn warning(is_encrypted: bool, without_motors: bool) -> &'static str {
    match (without_motors, is_encrypted) {
        (true, _) => "Anyone with this link sees the robots. It drives none.",
        (false, true) => "Anyone with this link can drive the motors.",
        (false, false) => {
            "Anyone with this link can drive the motors. The connection is not encrypted: use it in a network that you trust, or use \
             --certificate."
        }
    }
}

/// What a person opens, with a picture for phones.
fn links(origin: &str, token: &Token, file: Option<&Path>, warning: &str) -> Vec<String> {
    if let Some(file) = file
        .map(PathBuf::from)
        .filter(|_| !io::stderr().is_terminal())
    {
        // The journal of the system is no place for a secret.
        let file = file.display();
        return vec![format!(
            "Open {origin}/?token=TOKEN with the token in {file}."
        )];
    }
    let link = format!("{origin}/?token={token}");
    let mut lines = vec![format!("Open {link}"), warning.to_owned()];
    if let Ok(code) = QrCode::new(&link) {
        lines.push(code.render::<unicode::Dense1x2>().build());
    }
    lines.push("Ctrl-C ends.".to_owned());
    lines
}

/// The address from which this computer reaches others. Nothing is sent.
fn outgoing_address(is_ipv6: bool) -> Option<IpAddr> {
    // Addresses for documentation (RFC 5737 and 3849): only the route to them is asked for.
    let (from, to) = if is_ipv6 {
        ("[::]:0", "[2001:db8::1]:9")
    } else {
        ("0.0.0.0:0", "192.0.2.1:9")
    };
    let socket = std::net::UdpSocket::bind(from).ok()?;
    socket.connect(to).ok()?;
    Some(socket.local_addr().ok()?.ip())
}

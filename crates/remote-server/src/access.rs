//! Who may connect: the name of the server, the origin of the page, and the token.

mod token;

use std::{
    collections::BTreeMap,
    net::{IpAddr, Ipv6Addr, SocketAddr},
    sync::{Arc, Mutex, PoisonError},
    time::{Duration, Instant},
};

use axum::{
    extract::Request,
    http::{
        HeaderMap, HeaderValue, StatusCode,
        header::{COOKIE, HOST, LOCATION, ORIGIN, SEC_WEBSOCKET_PROTOCOL, SET_COOKIE},
        request::Parts,
        uri::Authority,
    },
    response::{IntoResponse, Response},
};
use percent_encoding::percent_decode_str;

pub use token::Token;

use crate::{fleet::FLEET, sessions::SESSIONS};

/// Wrong tokens of one address in a minute. A person who copies it by hand needs fewer.
const ATTEMPTS_MAX: u32 = 10;
const MINUTE: Duration = Duration::from_secs(60);
/// Addresses whose wrong tokens are counted. If there are more, every address that is not counted waits.
const ADDRESSES_MAX: usize = 4096;

/// The path of the WebSocket.
pub(crate) const SOCKET: &str = "/motorlink";

/// The path of the read-only WebSocket for Foxglove and other programs.
const FOXGLOVE: &str = "/foxglove";

const COOKIE_NAME: &str = "motorlink-token";
/// A browser sets no cookie of the first name over a plain connection after it has had an encrypted one of that name.
const ENCRYPTED_COOKIE_NAME: &str = "__Host-motorlink-token";

/// The rules for connecting.
#[derive(Clone, Debug)]
pub struct Access {
    listen: SocketAddr,
    names: Arc<[String]>,
    token: Option<Token>,
    is_encrypted: bool,
    wrong: Arc<Mutex<BTreeMap<IpAddr, Wrong>>>,
}

/// The wrong tokens of an address.
#[derive(Clone, Copy, Debug)]
struct Wrong {
    since: Instant,
    count: u32,
}

impl Access {
    /// The server listens at this address. Beside its IP addresses it has these names. A token is needed unless only
    /// this computer can connect.
    #[must_use]
    pub fn new(listen: SocketAddr, names: Vec<String>, token: Option<Token>) -> Self {
        Self {
            listen,
            names: names.into(),
            token,
            is_encrypted: false,
            wrong: Arc::default(),
        }
    }

    /// The same on encrypted connections.
    #[must_use]
    pub fn encrypted(mut self) -> Self {
        self.is_encrypted = true;
        self
    }

    /// Whether the browser takes the address for a secure context: it is encrypted, by this server or a proxy, or leads to
    /// the browser's own computer.
    pub(crate) fn is_secure(&self, headers: &HeaderMap) -> bool {
        let text = |name: &str| headers.get(name).and_then(|value| value.to_str().ok());
        let host = text("host").unwrap_or_default();
        let is_local = host
            .parse::<Authority>()
            .is_ok_and(|authority| is_loopback(authority.host()));
        self.is_encrypted || is_local || text("x-forwarded-proto") == Some("https")
    }

    /// The answer to a request of this address that is not let through.
    pub(crate) fn check(&self, address: IpAddr, request: &Request) -> Option<Response> {
        let headers = request.headers();
        if !self.is_host_ours(headers) {
            return Some(refused(
                StatusCode::FORBIDDEN,
                "This server does not know the name in the address. Start it with --name NAME.\n",
            ));
        }
        let token = self.token.as_ref()?;
        let path = request.uri().path();
        // The files of the page are public: the browser asks for some of them without its cookies.
        let is_page = matches!(path, "/" | "/index.html" | SOCKET | FOXGLOVE);
        if !is_page
            && ![SESSIONS, FLEET]
                .iter()
                .any(|below| path.starts_with(below))
        {
            return None;
        }
        let has_cookie = self.has_cookie(headers, token);
        let Some(given) = token_in(request.uri().query().unwrap_or_default()) else {
            if has_cookie {
                return None;
            }
            return Some(refused(
                StatusCode::UNAUTHORIZED,
                "Open the link that `motorlink serve` prints: it has the token.\n",
            ));
        };
        if !has_cookie && !self.may_try(address) {
            return Some(refused(
                StatusCode::TOO_MANY_REQUESTS,
                "Too many wrong tokens. Wait a minute.\n",
            ));
        }
        if !token.is(&given) {
            self.note_wrong(address);
            return Some(refused(
                StatusCode::UNAUTHORIZED,
                "Wrong token. Open the link that `motorlink serve` prints.\n",
            ));
        }
        // Its clients keep no cookie and follow no other address.
        (!is_for_foxglove(path, headers)).then(|| self.with_cookie(path, token))
    }

    /// Other web sites can lead a browser here by a name of their own (DNS rebinding).
    fn is_host_ours(&self, headers: &HeaderMap) -> bool {
        let host = headers.get(HOST).and_then(|host| host.to_str().ok());
        host.is_some_and(|host| self.is_ours(host))
    }

    fn is_ours(&self, host: &str) -> bool {
        let (name, port) = match host.rsplit_once(':') {
            Some((name, port)) if !port.ends_with(']') => (name, port.parse().ok()),
            _ => (host, Some(if self.is_encrypted { 443 } else { 80 })),
        };
        // Behind a proxy, `--name` is the proxy's, with its own port.
        if self
            .names
            .iter()
            .any(|ours| ours.eq_ignore_ascii_case(name))
        {
            return true;
        }
        let bare = name.trim_start_matches('[').trim_end_matches(']');
        let is_here = match bare.parse::<IpAddr>() {
            Ok(address) if self.listen.ip().is_loopback() => address.is_loopback(),
            Ok(_) => true,
            Err(_) => name.eq_ignore_ascii_case("localhost"),
        };
        is_here && port == Some(self.listen.port())
    }

    /// Whether a page of this server asks for the WebSocket: a page of another site may not.
    pub(crate) fn is_own_page(headers: &HeaderMap) -> bool {
        let text = |name| {
            headers
                .get(name)
                .and_then(|value: &HeaderValue| value.to_str().ok())
        };
        let (Some(origin), Some(host)) = (text(ORIGIN), text(HOST)) else {
            return false;
        };
        let of_origin = origin
            .strip_prefix("http://")
            .or_else(|| origin.strip_prefix("https://"));
        of_origin.is_some_and(|name| name.eq_ignore_ascii_case(host))
    }

    const fn cookie_name(&self) -> &'static str {
        if self.is_encrypted {
            ENCRYPTED_COOKIE_NAME
        } else {
            COOKIE_NAME
        }
    }

    fn has_cookie(&self, headers: &HeaderMap, token: &Token) -> bool {
        let cookies = headers.get_all(COOKIE).iter();
        let pairs = cookies.filter_map(|value| value.to_str().ok());
        let mut pairs = pairs.flat_map(|pairs| pairs.split(';'));
        pairs.any(|pair| {
            let (name, value) = pair.trim().split_once('=').unwrap_or_default();
            name == self.cookie_name() && token.is(value)
        })
    }

    /// Keeps the token in the browser, and takes it out of the address.
    fn with_cookie(&self, path: &str, token: &Token) -> Response {
        // No script reads it, and no other site makes the browser send it.
        let secure = if self.is_encrypted { "; Secure" } else { "" };
        let name = self.cookie_name();
        let cookie =
            format!("{name}={token}; Path=/; HttpOnly; SameSite=Lax; Max-Age=2592000{secure}");
        // Only a path of this server: `//other` would be another one.
        let path = format!("/{}", path.trim_start_matches('/'));
        let mut response = StatusCode::SEE_OTHER.into_response();
        let headers = response.headers_mut();
        for (name, value) in [(SET_COOKIE, cookie), (LOCATION, path)] {
            if let Ok(value) = HeaderValue::try_from(value) {
                headers.insert(name, value);
            }
        }
        response
    }

    /// Whether a request that [`Access::check`] lets through may watch by Foxglove's protocol. The program may be a page of
    /// another site, which only the token in its address lets in: the browser could add the cookie on its own.
    pub(crate) fn may_watch(&self, parts: &Parts) -> bool {
        // A program that is no browser says no origin, or one of a WebSocket (PlotJuggler 4), which no page has.
        let Some(origin) = parts.headers.get(ORIGIN) else {
            return true;
        };
        let origin = origin.to_str().unwrap_or_default();
        if Self::is_own_page(&parts.headers) || is_web_socket(origin) {
            return true;
        }
        let Some(token) = &self.token else {
            return is_plotter(origin);
        };
        let given = token_in(parts.uri.query().unwrap_or_default());
        given.is_some_and(|given| token.is(&given))
    }

    fn may_try(&self, address: IpAddr) -> bool {
        let mut wrong = self.wrong.lock().unwrap_or_else(PoisonError::into_inner);
        wrong.retain(|_, wrong| wrong.since.elapsed() < MINUTE);
        match wrong.get(&network(address)) {
            Some(wrong) => wrong.count < ATTEMPTS_MAX,
            None => wrong.len() < ADDRESSES_MAX,
        }
    }

    fn note_wrong(&self, address: IpAddr) {
        let mut wrong = self.wrong.lock().unwrap_or_else(PoisonError::into_inner);
        let none = Wrong {
            since: Instant::now(),
            count: 0,
        };
        wrong.entry(network(address)).or_insert(none).count += 1;
    }
}

fn is_web_socket(origin: &str) -> bool {
    origin.starts_with("ws://") || origin.starts_with("wss://")
}

/// Whether a request is for Foxglove's protocol. PlotJuggler 4 has no field for a path.
pub(crate) fn is_for_foxglove(path: &str, headers: &HeaderMap) -> bool {
    let protocols = headers.get(SEC_WEBSOCKET_PROTOCOL);
    let protocols = protocols.and_then(|protocols| protocols.to_str().ok());
    let names_it = protocols.is_some_and(|protocols| protocols.contains("foxglove."));
    path == FOXGLOVE || path == "/" && names_it
}

/// Whether a page of this origin may watch without a token: that of Foxglove, of a program on this computer, or of a file.
/// A frame of any site can have the origin `null`.
fn is_plotter(origin: &str) -> bool {
    if matches!(origin, "https://app.foxglove.dev" | "file://") {
        return true;
    }
    let host = origin
        .strip_prefix("http://")
        .or_else(|| origin.strip_prefix("https://"));
    let Some(host) = host.and_then(|host| host.parse::<Authority>().ok()) else {
        return false;
    };
    is_loopback(host.host())
}

/// Whether a host, as it stands in an address, is the browser's own computer.
fn is_loopback(host: &str) -> bool {
    let name = host.trim_start_matches('[').trim_end_matches(']');
    let is_loopback = name.parse::<IpAddr>().is_ok_and(|ip| ip.is_loopback());
    is_loopback || name.eq_ignore_ascii_case("localhost")
}

/// The address that counts. A home has one of IPv4, but 2^64 of IPv6, which count as one.
fn network(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V6(address) => Ipv6Addr::from_bits(address.to_bits() >> 64 << 64).into(),
        v4 @ IpAddr::V4(_) => v4,
    }
}

fn token_in(query: &str) -> Option<String> {
    let pairs = query.split('&').filter_map(|pair| pair.split_once('='));
    let mut given = pairs.filter(|(name, _)| *name == "token");
    let (_, value) = given.next()?;
    Some(percent_decode_str(value).decode_utf8_lossy().into_owned())
}

fn refused(status: StatusCode, text: &'static str) -> Response {
    (status, text).into_response()
}

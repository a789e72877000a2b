//! The web server, on threads of its own.

use std::{
    convert::Infallible,
    fmt, io,
    net::{IpAddr, SocketAddr},
    sync::Arc,
    time::Duration,
};

use axum::{
    Router,
    extract::{FromRequestParts, Request, State, WebSocketUpgrade},
    http::StatusCode,
    response::{IntoResponse, Redirect, Response},
};
use hyper::{body::Incoming, server::conn::http1, service::service_fn};
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::{
    io::{AsyncRead, AsyncWrite},
    net::TcpListener,
    runtime::{Builder, Runtime},
    sync::Semaphore,
    task::spawn_blocking,
    time::{sleep, timeout},
};
use tower_service::Service as _;

use crate::{
    access::{Access, SOCKET, is_for_foxglove},
    fleet, foxglove,
    page::Site,
    sessions, socket,
    tls::Tls,
    viewers::Viewers,
};

/// Files and sockets of pages. The thread that tells the pages is another one.
const THREADS: usize = 2;
/// Connections at the same time: a browser opens six for files, and each page keeps one.
const CONNECTIONS_MAX: usize = 256;
/// How long a browser may take to send the head of a request.
const HEAD_MAX: Duration = Duration::from_secs(5);
/// The end waits no longer for a connection.
const END_MAX: Duration = Duration::from_millis(200);
/// A pause where the system gives no connection, such as for want of file handles.
const PAUSE: Duration = Duration::from_millis(100);

/// Answers requests until dropped.
pub struct Server {
    /// Taken when dropped.
    runtime: Option<Runtime>,
    address: SocketAddr,
}

#[derive(Clone)]
struct Shared {
    access: Access,
    site: Site,
    /// None without a line: then there is only the page of the fleet.
    viewers: Option<Viewers>,
}

impl Server {
    /// Answers from now on what comes to `listener`, encrypted if there is a certificate. Without viewers, only the page of
    /// the fleet is there.
    ///
    /// # Errors
    /// The system gives no threads, or the listener cannot be used.
    pub fn start(
        listener: std::net::TcpListener,
        access: Access,
        site: Site,
        viewers: Option<Viewers>,
        tls: Option<Tls>,
    ) -> io::Result<Self> {
        let address = listener.local_addr()?;
        listener.set_nonblocking(true)?;
        let runtime = Builder::new_multi_thread()
            .worker_threads(THREADS)
            .thread_name("motorlink web")
            .enable_io()
            .enable_time()
            .build()?;
        let listener = {
            let _in_runtime = runtime.enter();
            TcpListener::from_std(listener)?
        };
        let shared = Shared {
            access,
            site,
            viewers,
        };
        runtime.spawn(accept(listener, shared, tls));
        Ok(Self {
            runtime: Some(runtime),
            address,
        })
    }

    /// The address that it listens at.
    #[must_use]
    pub const fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_timeout(END_MAX);
        }
    }
}

impl fmt::Debug for Server {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Server").field(&self.address).finish()
    }
}

async fn accept(listener: TcpListener, shared: Shared, tls: Option<Tls>) {
    let places = Arc::new(Semaphore::new(CONNECTIONS_MAX));
    loop {
        let Ok((stream, peer)) = listener.accept().await else {
            sleep(PAUSE).await;
            continue;
        };
        // One too many is closed at once.
        let Ok(place) = Arc::clone(&places).try_acquire_owned() else {
            continue;
        };
        let (shared, tls) = (shared.clone(), tls.clone());
        tokio::spawn(async move {
            // Nagle's algorithm delays small messages.
            let _ = stream.set_nodelay(true);
            let address = peer.ip().to_canonical();
            match tls {
                None => serve(stream, address, shared).await,
                Some(tls) => {
                    let encrypted = timeout(HEAD_MAX, tls.acceptor().accept(stream)).await;
                    // Otherwise it speaks no TLS, or does not trust the certificate.
                    if let Ok(Ok(stream)) = encrypted {
                        serve(stream, address, shared).await;
                    }
                }
            }
            drop(place);
        });
    }
}

async fn serve<S>(stream: S, address: IpAddr, shared: Shared)
where
    S: AsyncRead + AsyncWrite + Unpin + Send + 'static,
{
    let router = Router::new().fallback(answer).with_state((shared, address));
    let service = service_fn(move |request: hyper::Request<Incoming>| {
        let mut router = router.clone();
        async move {
            let answered: Result<Response, Infallible> = router.call(request).await;
            answered
        }
    });
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEAD_MAX)
        .serve_connection(TokioIo::new(stream), service)
        .with_upgrades();
    // The browser has gone, or has sent something else than HTTP.
    let _ = connection.await;
}

async fn answer(State((shared, address)): State<(Shared, IpAddr)>, request: Request) -> Response {
    if let Some(refused) = shared.access.check(address, &request) {
        return refused;
    }
    let (mut parts, _) = request.into_parts();
    if let Some((robots, name)) = shared.site.fleet(parts.uri.path()) {
        return fleet::answer(robots, name);
    }
    let Some(viewers) = shared.viewers else {
        return Redirect::temporary(fleet::FLEET).into_response();
    };
    if is_for_foxglove(parts.uri.path(), &parts.headers) {
        if !shared.access.may_watch(&parts) {
            let text = "A page of another site needs the token in the address: ?token=TOKEN.\n";
            return (StatusCode::FORBIDDEN, text).into_response();
        }
        return foxglove::answer(&mut parts, viewers.foxglove()).await;
    }
    if let Some((folder, name)) = shared.site.session(parts.uri.path()) {
        let name = name.to_owned();
        // A disk that is slow delays no page.
        let answered = spawn_blocking(move || sessions::answer(&folder, &name)).await;
        return answered.unwrap_or_else(|_| StatusCode::INTERNAL_SERVER_ERROR.into_response());
    }
    if parts.uri.path() != SOCKET {
        let is_secure = shared.access.is_secure(&parts.headers);
        let (path, query) = (parts.uri.path(), parts.uri.query());
        return shared.site.answer(path, query, &parts.headers, is_secure);
    }
    if !Access::is_own_page(&parts.headers) {
        let text = "Only the page of this server may connect.\n";
        return (StatusCode::FORBIDDEN, text).into_response();
    }
    let version = parts
        .uri
        .query()
        .and_then(|query| query.strip_prefix("page="));
    let is_same_version = version.is_some_and(|version| shared.site.is_version(version));
    match WebSocketUpgrade::from_request_parts(&mut parts, &()).await {
        Ok(upgrade) => socket::answer(upgrade, (viewers, address), is_same_version),
        Err(refused) => refused.into_response(),
    }
}

#[cfg(test)]
mod tests {
    use std::{
        fs,
        io::{Read as _, Write as _},
        net::{TcpListener, TcpStream},
    };

    use super::*;
    use crate::fleet::Fleet;

    #[test]
    fn without_a_line_every_path_leads_to_the_fleet() {
        let folder = tempfile::tempdir().unwrap();
        let index = "<meta name=\"motorlink-worker\" content=\"a\"><meta name=\"motorlink-remote\" content=\"b\">";
        fs::write(folder.path().join("index.html"), index).unwrap();
        let site = Site::open(Some(folder.path().into())).unwrap();
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        let access = Access::new(address, Vec::new(), None);
        let site = site.with_fleet(Fleet::default());
        let _server = Server::start(listener, access, site, None, None).unwrap();
        for (path, answer) in [
            ("/", "HTTP/1.1 307"),
            (SOCKET, "HTTP/1.1 307"),
            ("/fleet", "HTTP/1.1 200"),
            ("/fleet/state", "HTTP/1.1 503"),
            ("/fleet/none", "HTTP/1.1 404"),
        ] {
            let mut stream = TcpStream::connect(address).unwrap();
            let request =
                format!("GET {path} HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n");
            stream.write_all(request.as_bytes()).unwrap();
            let mut answered = String::new();
            stream.read_to_string(&mut answered).unwrap();
            assert!(answered.starts_with(answer), "{path}: {answered}");
        }
    }
}

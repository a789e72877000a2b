//! A server on threads of its own.

use std::fmt;
use std::io;
use std::net::{SocketAddr, TcpListener};
use std::time::Duration;

use axum::Router;
use tokio::runtime::{Builder, Runtime};
use tokio::task::JoinHandle;

/// Files are read on further threads, so that one that is slow delays no other.
const THREADS: usize = 2;

/// Reading a file from a disk takes milliseconds; the end of the server waits no longer for one.
const END_MAX: Duration = Duration::from_secs(2);

/// Answers requests until dropped. Then its port is closed, and every connection ends.
pub struct Server {
    /// Taken when dropped.
    runtime: Option<Runtime>,
    serving: JoinHandle<io::Result<()>>,
    address: SocketAddr,
}

impl Server {
    /// Answers from now on what comes to `listener`.
    ///
    /// # Errors
    ///
    /// When the system gives no threads, or the listener is not usable.
    pub fn start(listener: TcpListener, router: Router) -> io::Result<Self> {
        let address = listener.local_addr()?;
        listener.set_nonblocking(true)?;
        let runtime = Builder::new_multi_thread()
            .worker_threads(THREADS)
            .thread_name("web-server")
            .enable_io()
            .build()?;
        let listener = {
            let _in_runtime = runtime.enter();
            tokio::net::TcpListener::from_std(listener)?
        };
        let serving = runtime.spawn(async move { axum::serve(listener, router).await });
        Ok(Self {
            runtime: Some(runtime),
            serving,
            address,
        })
    }

    /// The origin of what is served, without a slash at its end.
    #[must_use]
    pub fn origin(&self) -> String {
        format!("http://{}", self.address)
    }

    /// Serves until the process ends.
    ///
    /// # Errors
    ///
    /// When the server ends before.
    pub fn wait(mut self) -> io::Result<()> {
        let Some(runtime) = &self.runtime else {
            return Ok(());
        };
        runtime
            .block_on(&mut self.serving)
            .map_err(io::Error::other)?
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
        f.debug_tuple("Server").field(&self.origin()).finish()
    }
}

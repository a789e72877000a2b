//! The file of the socket, and who is let in.

use std::{
    fs, io,
    os::unix::{
        fs::{FileTypeExt as _, MetadataExt as _, PermissionsExt as _},
        net,
    },
    path::{Path, PathBuf},
    sync::Arc,
    time::Duration,
};

use tokio::{
    net::UnixListener,
    runtime::{Builder, Runtime},
    sync::Semaphore,
    time::sleep,
};

use super::connection;
use crate::viewers::Viewers;

/// Clients at the same time: one that drives, and some that watch. Also of the text form.
const CLIENTS_MAX: usize = 8;
/// Its owner and its group can connect, which needs the permission to write.
const MODE: u32 = 0o660;
/// How long the end waits for connections at most.
const END_MAX: Duration = Duration::from_millis(200);
/// A pause where the system gives no connection, such as for want of file handles.
const PAUSE: Duration = Duration::from_millis(100);

/// Why there is no socket.
#[derive(Debug, thiserror::Error)]
pub enum NoSocket {
    /// Another program listens there.
    #[error("another program listens there; choose another path")]
    InUse,
    /// There is another file.
    #[error("a file that is no socket; remove it or choose another path")]
    OtherFile,
    /// The system refuses it.
    #[error("{0}")]
    Io(io::Error),
}

/// A socket before its start.
#[derive(Debug)]
pub struct ControlSocket {
    listener: net::UnixListener,
    file: SocketFile,
}

/// A socket that lets clients in until it is dropped.
#[derive(Debug)]
pub struct RunningSocket {
    /// Taken when dropped.
    runtime: Option<Runtime>,
    _file: SocketFile,
}

/// The file. It is removed when this value is dropped.
#[derive(Debug)]
struct SocketFile {
    path: PathBuf,
    /// Device and number of the file: one that another program has put there stays.
    is: (u64, u64),
}

impl ControlSocket {
    /// Listens at this path. A socket of a server that has ended is replaced.
    ///
    /// # Errors
    /// Another program listens there, the file is no socket, or the system refuses it.
    pub fn bind(path: &Path) -> Result<Self, NoSocket> {
        match fs::symlink_metadata(path) {
            Ok(found) if !found.file_type().is_socket() => return Err(NoSocket::OtherFile),
            Ok(_) => match net::UnixStream::connect(path) {
                Err(error) if error.kind() == io::ErrorKind::ConnectionRefused => {}
                Err(error) if error.kind() == io::ErrorKind::PermissionDenied => {
                    return Err(NoSocket::Io(error));
                }
                _ => return Err(NoSocket::InUse),
            },
            Err(_) => {}
        }
        // Under another name, until its mode is right: nobody connects before.
        let mut new = path.as_os_str().to_owned();
        new.push(format!(".{}", std::process::id()));
        let new = PathBuf::from(new);
        let listener = net::UnixListener::bind(&new).map_err(NoSocket::Io)?;
        let made = fs::set_permissions(&new, fs::Permissions::from_mode(MODE))
            .and_then(|()| fs::symlink_metadata(&new))
            .and_then(|made| fs::rename(&new, path).map(|()| made));
        let made = made.map_err(|error| {
            // It may not be there.
            let _ = fs::remove_file(&new);
            NoSocket::Io(error)
        })?;
        let file = SocketFile {
            path: path.to_owned(),
            is: (made.dev(), made.ino()),
        };
        Ok(Self { listener, file })
    }

    /// Lets clients in from now on, on a thread of its own: no page delays them.
    ///
    /// # Errors
    /// The system gives no thread, or the socket cannot be used.
    pub fn start(self, viewers: Viewers) -> io::Result<RunningSocket> {
        self.listener.set_nonblocking(true)?;
        let runtime = Builder::new_multi_thread()
            .worker_threads(1)
            .thread_name("motorlink socket")
            .enable_io()
            .enable_time()
            .build()?;
        let listener = {
            let _in_runtime = runtime.enter();
            UnixListener::from_std(self.listener)?
        };
        runtime.spawn(accept(listener, viewers));
        Ok(RunningSocket {
            runtime: Some(runtime),
            _file: self.file,
        })
    }
}

impl Drop for RunningSocket {
    fn drop(&mut self) {
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_timeout(END_MAX);
        }
    }
}

impl Drop for SocketFile {
    fn drop(&mut self) {
        let found = fs::symlink_metadata(&self.path);
        if found.is_ok_and(|found| (found.dev(), found.ino()) == self.is) {
            // At the end nobody can do anything about it.
            let _ = fs::remove_file(&self.path);
        }
    }
}

async fn accept(listener: UnixListener, viewers: Viewers) {
    let places = Arc::new(Semaphore::new(CLIENTS_MAX));
    // Those that are told that there are too many. Beyond them, a client is closed at once.
    let refusals = Arc::new(Semaphore::new(CLIENTS_MAX));
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            sleep(PAUSE).await;
            continue;
        };
        if connection::limit_queue(&stream).is_err() {
            continue;
        }
        let own = Arc::clone(&places).try_acquire_owned();
        let has_place = own.is_ok();
        let Ok(place) = own.or_else(|_| Arc::clone(&refusals).try_acquire_owned()) else {
            continue;
        };
        let viewers = viewers.clone();
        tokio::spawn(async move {
            connection::serve(stream, viewers, has_place).await;
            drop(place);
        });
    }
}

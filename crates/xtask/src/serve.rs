//! Serves a built page on this machine.

use std::io::ErrorKind;
use std::net::{Ipv4Addr, TcpListener};
use std::path::Path;

use anyhow::{Context, Result, anyhow};
use motorlink_web_server::{Delivery, Server, files};

use crate::failure::BadInput;

/// Permissions for serial ports belong to an origin, port number included, so it stays the same
/// from one run to the next.
const PORT_DEFAULT: u16 = 8017;

/// How many ports after the default are tried: as many as one person has checkouts open.
const PORT_TRIES: u16 = 20;

/// Serves a directory until the process ends.
pub fn serve(dir: &Path, listener: TcpListener, open_browser: bool) -> Result<()> {
    let server = start(dir, listener)?;
    let url = format!("{}/", server.origin());
    println!("MotorLink is at {url} (Ctrl-C ends it)");
    if open_browser && has_screen() && open::that_detached(&url).is_err() {
        eprintln!("no browser could be opened: open {url} yourself");
    }
    Ok(server.wait()?)
}

/// Serves a directory on threads of its own.
pub fn start(dir: &Path, listener: TcpListener) -> Result<Server> {
    let files = files(dir, Delivery::AsAHost).map_err(|_| {
        BadInput(format!(
            "{} does not exist; make it with cargo xtask build",
            dir.display()
        ))
    })?;
    Server::start(listener, files).context("cannot serve the page")
}

/// Takes a port: the one given, else the default one or the next that is free.
pub fn listen(port: Option<u16>) -> Result<TcpListener> {
    let bind = |port: u16| TcpListener::bind((Ipv4Addr::LOCALHOST, port));
    if let Some(port) = port {
        return bind(port).with_context(|| format!("cannot serve on port {port}"));
    }
    for port in PORT_DEFAULT..PORT_DEFAULT + PORT_TRIES {
        match bind(port) {
            Err(error) if error.kind() == ErrorKind::AddrInUse => {}
            other => return other.with_context(|| format!("cannot serve on port {port}")),
        }
    }
    Err(anyhow!(
        "ports {PORT_DEFAULT} to {} are all taken: choose one with --port",
        PORT_DEFAULT + PORT_TRIES - 1
    ))
}

/// On Linux a browser started without a display only prints errors.
fn has_screen() -> bool {
    !cfg!(target_os = "linux")
        || std::env::var_os("DISPLAY").is_some()
        || std::env::var_os("WAYLAND_DISPLAY").is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_taken_port_is_named() {
        let taken = listen(Some(0)).unwrap();
        let port = taken.local_addr().unwrap().port();
        let error = listen(Some(port)).unwrap_err();
        assert!(error.to_string().contains(&port.to_string()));
    }

    #[test]
    fn a_page_that_is_not_built_is_named_with_the_command() {
        let error = start(Path::new("/nowhere/dist"), listen(Some(0)).unwrap()).unwrap_err();
        assert!(error.is::<BadInput>() && error.to_string().contains("cargo xtask build"));
    }
}

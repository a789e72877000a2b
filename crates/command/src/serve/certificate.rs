//! The certificate of the server, and its files.

use std::{fs, io, net::IpAddr, path::Path};

use motorlink_remote_server::{NoTls, Pem, Tls};

use crate::{failure::Failure, serve::token::write_secret};

/// The certificate in these files. If neither exists, they are made, for a server with these names.
///
/// # Errors
/// One of them is missing, cannot be used, or is wrong.
pub fn certificate(file: &Path, key_file: &Path, names: Vec<String>) -> Result<Tls, Failure> {
    let pem = match (read(file)?, read(key_file)?) {
        (Some(certificate), Some(key)) => Pem { certificate, key },
        (None, None) => {
            let pem = Pem::make(names).map_err(|why| wrong(file, why))?;
            write_secret(key_file, &pem.key).map_err(Failure::file(key_file))?;
            fs::write(file, &pem.certificate).map_err(Failure::file(file))?;
            pem
        }
        (None, Some(_)) => return Err(missing(file, key_file)),
        (Some(_), None) => return Err(missing(key_file, file)),
    };
    Tls::new(&pem).map_err(|why| match why {
        NoTls::Key | NoTls::OtherKey => wrong(key_file, why),
        _ => wrong(file, why),
    })
}

/// The names and addresses under which browsers find this computer.
pub fn names(listen: IpAddr, outgoing: Option<IpAddr>, given: &[String]) -> Vec<String> {
    let mut names = vec!["localhost".to_owned(), "127.0.0.1".to_owned()];
    let addresses = outgoing
        .into_iter()
        .chain((!listen.is_unspecified()).then_some(listen));
    names.extend(addresses.map(|address| address.to_string()));
    names.extend(local_names());
    names.extend(given.iter().cloned());
    names.sort();
    names.dedup();
    names
}

/// The names that this computer has in its network.
pub fn local_names() -> Vec<String> {
    let Some(host) = host_name() else {
        return Vec::new();
    };
    vec![format!("{host}.local"), host]
}

#[cfg(unix)]
fn host_name() -> Option<String> {
    let system = rustix::system::uname();
    let name = system.nodename().to_str().ok()?;
    Some(name.split('.').next()?.to_ascii_lowercase())
}

#[cfg(not(unix))]
fn host_name() -> Option<String> {
    Some(std::env::var("COMPUTERNAME").ok()?.to_ascii_lowercase())
}

fn read(file: &Path) -> Result<Option<String>, Failure> {
    match fs::read_to_string(file) {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) if error.kind() == io::ErrorKind::InvalidData => Ok(Some(String::new())),
        Err(error) => Err(Failure::file(file)(error)),
    }
}

fn wrong(file: &Path, why: NoTls) -> Failure {
    Failure::Usage(format!("{}: {why}", file.display()))
}

fn missing(file: &Path, other: &Path) -> Failure {
    let (file, other) = (file.display(), other.display());
    Failure::Usage(format!(
        "{file}: is missing, although {other} is there; without both, new ones are made"
    ))
}

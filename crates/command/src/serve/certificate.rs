//! The certificate of the server, and its files.

use std::{fs, io, net::IpAddr, path::Path};

use motorlink_remote_server::{Invalid, NoTls, Pem, Tls};

use crate::{failure::Failure, output::say, serve::token::write_whole};

/// The certificate in these files. If neither exists, they are made, for a server with these names.
///
/// # Errors
/// One of them is missing, cannot be used, or is wrong.
pub fn certificate(file: &Path, key_file: &Path, names: Vec<String>) -> Result<Tls, Failure> {
    let pem = match (read(file)?, read(key_file)?) {
        (Some(certificate), Some(key)) => Pem { certificate, key },
        (None, None) => {
            let pem = Pem::make(names).map_err(|why| wrong(file, why))?;
            write_whole(key_file, &pem.key).map_err(Failure::file(key_file))?;
            write_whole(file, &pem.certificate).map_err(Failure::file(file))?;
            pem
        }
        (None, Some(_)) => return Err(missing(file, key_file)),
        (Some(_), None) => return Err(missing(key_file, file)),
    };
    let tls = Tls::new(&pem).map_err(|why| match why {
        NoTls::Key | NoTls::OtherKey => wrong(key_file, why),
        _ => wrong(file, why),
    })?;
    if let Some(invalid) = pem.invalid() {
        let why = match invalid {
            Invalid::Expired => "has expired",
            Invalid::NotYet => "is not valid yet, or the clock of this computer is behind",
        };
        say(format_args!(
            "{}: the certificate {why}: browsers warn",
            file.display()
        ));
    }
    Ok(tls)
}

/// The names and addresses under which browsers find this computer.
pub fn names(listen: IpAddr, outgoing: Option<IpAddr>, given: &[String]) -> Vec<String> {
    let mut names = ["localhost", "127.0.0.1", "::1"]
        .map(str::to_owned)
        .to_vec();
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
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-';
    if host.is_empty() || !host.bytes().all(is_plain) {
        // No name that stands in an address as it is.
        return Vec::new();
    }
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

//! The command line of `motorlink serve`.

use std::{
    net::{IpAddr, SocketAddr},
    path::PathBuf,
    str::FromStr,
};

use clap::Args;

/// What `serve` takes.
#[derive(Debug, Args)]
pub struct Serve {
    /// Address and port to listen at. 127.0.0.1 lets only this computer connect; 0.0.0.0 lets the network connect, by a
    /// link with a token
    #[arg(long, default_value = "127.0.0.1:8017", value_name = "ADDRESS[:PORT]")]
    pub listen: Listen,
    /// A further name of this computer, as browsers have it in the address. With a token, its own name needs none. May be
    /// given more than once
    #[arg(long = "name", value_name = "NAME")]
    pub names: Vec<String>,
    /// File of the token. It is created if it does not exist. Without it, each start makes a new token
    #[arg(long, value_name = "FILE")]
    pub token_file: Option<PathBuf>,
    /// File of a certificate in PEM form, for an encrypted connection. It is made, with its key, if neither exists
    #[arg(long, value_name = "FILE", requires = "key")]
    pub certificate: Option<PathBuf>,
    /// File of the private key of the certificate
    #[arg(long, value_name = "FILE", requires = "certificate")]
    pub key: Option<PathBuf>,
    /// Folder for session files of all that happens on the line. The page has a link to them: save one to replay it. The
    /// oldest are removed above 2 GB
    #[arg(long, value_name = "FOLDER")]
    pub log: Option<PathBuf>,
    /// Unix socket at which a controller on this computer drives the motors, such as one of ROS 2. Its owner and its group
    /// may use it: see docs/socket.md
    #[arg(long, value_name = "PATH")]
    pub socket: Option<PathBuf>,
    /// Show the robots in a Zenoh network at /fleet, by the program motorlink-fleet: see docs/fleet.md. With =ENDPOINT, by
    /// this router, such as tcp/site.local:7447
    #[arg(
        long,
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "",
        value_name = "ENDPOINT"
    )]
    pub fleet: Option<String>,
    /// Serve nothing but the fleet: this computer has no motors
    #[arg(long, requires = "fleet", conflicts_with_all = ["log", "socket"])]
    pub without_motors: bool,
    /// Folder of the page, in place of the one that this program was built with
    #[arg(long, value_name = "FOLDER")]
    pub page: Option<PathBuf>,
}

/// The port, if none is given.
const PORT: u16 = 8017;

/// Where to listen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Listen(pub SocketAddr);

impl FromStr for Listen {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if let Ok(address) = text.parse() {
            return Ok(Self(address));
        }
        let address: IpAddr = text
            .parse()
            .map_err(|_| "not an IP address with a port, such as 0.0.0.0:8017")?;
        Ok(Self(SocketAddr::new(address, PORT)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_has_a_port_or_the_usual_one() {
        let of = |text: &str| text.parse::<Listen>().map(|listen| listen.0.to_string());
        assert_eq!(of("127.0.0.1:80"), Ok("127.0.0.1:80".to_owned()));
        assert_eq!(of("0.0.0.0"), Ok("0.0.0.0:8017".to_owned()));
        assert_eq!(of("::1"), Ok("[::1]:8017".to_owned()));
        assert!(of("rover.local").is_err());
    }
}

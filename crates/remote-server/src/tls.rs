//! TLS: makes, reads and checks the certificate.

use std::{
    fmt,
    sync::Arc,
    time::{Duration, SystemTime, UNIX_EPOCH},
};

use rcgen::{CertificateParams, DnType, KeyPair, date_time_ymd};
use tokio_rustls::{
    TlsAcceptor,
    rustls::{
        Error, ServerConfig,
        crypto::ring,
        pki_types::{CertificateDer, PrivateKeyDer, UnixTime, pem::PemObject},
    },
};
use webpki::{EndEntityCert, KeyUsage, anchor_from_trusted_cert};

/// A certificate with its key, ready for connections.
#[derive(Clone)]
pub struct Tls(TlsAcceptor);

impl fmt::Debug for Tls {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Not the key.
        f.write_str("Tls")
    }
}

/// Why a certificate cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoTls {
    /// There is no certificate in the text.
    #[error("not a certificate in PEM form")]
    Certificate,
    /// There is no private key in the text.
    #[error("not a private key in PEM form that can be used")]
    Key,
    /// The key is not that of the certificate.
    #[error("the private key does not match the certificate")]
    OtherKey,
    /// A new one could not be made.
    #[error("no certificate can be made for these names")]
    NotMade,
}

/// A certificate and its key as text, in PEM form.
#[derive(Clone)]
pub struct Pem {
    /// The certificate, with those of its issuers behind it.
    pub certificate: String,
    /// The private key.
    pub key: String,
}

impl fmt::Debug for Pem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Pem").finish_non_exhaustive()
    }
}

impl Pem {
    /// A new certificate for these names and addresses, which no authority has signed: browsers ask the person whether to
    /// trust it.
    ///
    /// # Errors
    /// [`NoTls::NotMade`]: a name has other characters than names of computers have.
    pub fn make(names: Vec<String>) -> Result<Self, NoTls> {
        let make = || {
            let mut params = CertificateParams::new(names)?;
            params
                .distinguished_name
                .push(DnType::CommonName, "MotorLink");
            // A Raspberry Pi has no clock that runs without power: no early date is too early.
            params.not_before = date_time_ymd(1975, 1, 1);
            params.not_after = date_time_ymd(2049, 1, 1);
            let key = KeyPair::generate()?;
            let certificate = params.self_signed(&key)?;
            Ok::<_, rcgen::Error>(Self {
                certificate: certificate.pem(),
                key: key.serialize_pem(),
            })
        };
        make().map_err(|_| NoTls::NotMade)
    }
}

/// Why browsers refuse a certificate today.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Invalid {
    /// It was valid until an earlier day.
    Expired,
    /// It is not valid yet, or the clock of this computer is behind.
    NotYet,
}

impl Pem {
    /// Why browsers refuse this certificate today, if it is by its dates. They also check who has signed it.
    #[must_use]
    pub fn invalid(&self) -> Option<Invalid> {
        let certificate = CertificateDer::from_pem_slice(self.certificate.as_bytes()).ok()?;
        let leaf = EndEntityCert::try_from(&certificate).ok()?;
        // As if it were its own issuer: its dates are checked first.
        let anchors = [anchor_from_trusted_cert(&certificate).ok()?];
        let now = SystemTime::now().duration_since(UNIX_EPOCH);
        let now = UnixTime::since_unix_epoch(now.unwrap_or(Duration::ZERO));
        let algorithms = ring::default_provider()
            .signature_verification_algorithms
            .all;
        let usage = KeyUsage::server_auth();
        match leaf.verify_for_usage(algorithms, &anchors, &[], now, usage, None, None) {
            Err(webpki::Error::CertExpired { .. }) => Some(Invalid::Expired),
            Err(webpki::Error::CertNotValidYet { .. }) => Some(Invalid::NotYet),
            _ => None,
        }
    }
}

impl Tls {
    /// Encrypts with this certificate.
    ///
    /// # Errors
    /// [`NoTls`] says what is wrong with it.
    pub fn new(pem: &Pem) -> Result<Self, NoTls> {
        let chain: Vec<CertificateDer<'static>> =
            CertificateDer::pem_slice_iter(pem.certificate.as_bytes())
                .collect::<Result<_, _>>()
                .map_err(|_| NoTls::Certificate)?;
        let leaf = chain.first().ok_or(NoTls::Certificate)?;
        EndEntityCert::try_from(leaf).map_err(|_| NoTls::Certificate)?;
        let key = PrivateKeyDer::from_pem_slice(pem.key.as_bytes()).map_err(|_| NoTls::Key)?;
        let provider = Arc::new(ring::default_provider());
        let config = ServerConfig::builder_with_provider(provider)
            .with_safe_default_protocol_versions()
            .map_err(|_| NoTls::NotMade)?
            .with_no_client_auth()
            .with_single_cert(chain, key)
            .map_err(|error| match error {
                Error::InconsistentKeys(_) => NoTls::OtherKey,
                _ => NoTls::Key,
            })?;
        Ok(Self(TlsAcceptor::from(Arc::new(config))))
    }

    pub(crate) const fn acceptor(&self) -> &TlsAcceptor {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made() -> Pem {
        Pem::make(vec!["rover.local".to_owned(), "192.168.1.20".to_owned()]).unwrap()
    }

    fn with_dates(from: i32, to: i32) -> Pem {
        let mut params = CertificateParams::new(vec!["rover.local".to_owned()]).unwrap();
        params.not_before = date_time_ymd(from, 1, 1);
        params.not_after = date_time_ymd(to, 1, 1);
        let key = KeyPair::generate().unwrap();
        Pem {
            certificate: params.self_signed(&key).unwrap().pem(),
            key: key.serialize_pem(),
        }
    }

    fn refused(pem: &Pem) -> Option<NoTls> {
        Tls::new(pem).err()
    }

    #[test]
    fn a_certificate_is_made_and_read() {
        assert_eq!(refused(&made()), None);
        assert_eq!(
            Pem::make(vec!["röver".to_owned()]).unwrap_err(),
            NoTls::NotMade
        );
    }

    #[test]
    fn what_is_wrong_with_a_certificate_is_said() {
        let (good, other) = (made(), made());
        let with_other_key = Pem {
            key: other.key,
            ..good.clone()
        };
        assert_eq!(refused(&with_other_key), Some(NoTls::OtherKey));
        let without_key = Pem {
            key: "-----BEGIN".to_owned(),
            ..good.clone()
        };
        assert_eq!(refused(&without_key), Some(NoTls::Key));
        let without_certificate = Pem {
            certificate: good.key.clone(),
            ..good
        };
        assert_eq!(refused(&without_certificate), Some(NoTls::Certificate));
    }

    /// The motors can be driven nevertheless: a browser warns, and goes on if the person wants.
    #[test]
    fn a_certificate_that_is_not_valid_today_can_be_used() {
        for (from, to, invalid) in [
            (2001, 2002, Some(Invalid::Expired)),
            (2090, 2091, Some(Invalid::NotYet)),
            (2001, 2091, None),
        ] {
            let pem = with_dates(from, to);
            assert_eq!(pem.invalid(), invalid);
            assert_eq!(refused(&pem), None);
        }
    }
}

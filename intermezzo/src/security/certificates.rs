//! Certificates for mutual TLS: an authority of one's own, and one certificate for each identity.

use rcgen::{
    BasicConstraints, CertificateParams, DistinguishedName, DnType, ExtendedKeyUsagePurpose, IsCa,
    Issuer, KeyPair, KeyUsagePurpose,
};
use time::{Duration, OffsetDateTime};

use crate::exit::Failure;

/// The authority's certificate, which everybody has.
pub(crate) const AUTHORITY: &str = "ca.pem";
/// What makes more certificates.
pub(crate) const AUTHORITY_KEY: &str = "ca-key.pem";

/// The name of the authority.
const AUTHORITY_NAME: &str = "Intermezzo";

/// An authority lasts as long as robots do.
const AUTHORITY_DAYS: i64 = 3650;

/// Clocks of two machines may differ by this much.
const CLOCKS_APART: Duration = Duration::hours(1);

/// Where a router is reached on its own machine.
const THIS_MACHINE: [&str; 3] = ["localhost", "127.0.0.1", "::1"];

/// A certificate and its private key.
pub(crate) struct Signed {
    pub(crate) certificate: String,
    pub(crate) key: String,
}

/// What signs certificates.
pub(crate) struct Authority {
    issuer: Issuer<'static, KeyPair>,
    begins: OffsetDateTime,
}

impl Authority {
    /// A new one, with its certificate.
    pub(crate) fn new() -> Result<(Self, Signed), Failure> {
        let begins = OffsetDateTime::now_utc() - CLOCKS_APART;
        let mut params = params(AUTHORITY_NAME, &[], begins, AUTHORITY_DAYS)?;
        // It signs certificates, and none that sign others.
        params.is_ca = IsCa::Ca(BasicConstraints::Constrained(0));
        params.key_usages = vec![KeyUsagePurpose::KeyCertSign, KeyUsagePurpose::CrlSign];
        let key = KeyPair::generate().map_err(failed)?;
        let signed = Signed {
            certificate: params.self_signed(&key).map_err(failed)?.pem(),
            key: key.serialize_pem(),
        };
        let issuer = Issuer::new(params, key);
        Ok((Self { issuer, begins }, signed))
    }

    /// One that was made before.
    pub(crate) fn again(certificate: &str, key: &str) -> Result<Self, Failure> {
        let key = KeyPair::from_pem(key).map_err(failed)?;
        Ok(Self {
            issuer: Issuer::from_ca_cert_pem(certificate, key).map_err(failed)?,
            begins: OffsetDateTime::now_utc() - CLOCKS_APART,
        })
    }

    /// For the router, which is also reached by these names and addresses.
    pub(crate) fn router(
        &self,
        name: &str,
        hosts: &[String],
        days: i64,
    ) -> Result<Signed, Failure> {
        let here = THIS_MACHINE.iter().map(|host| (*host).to_owned());
        let hosts: Vec<String> = here.chain(hosts.iter().cloned()).collect();
        let mut params = params(name, &hosts, self.begins, days)?;
        // It connects to other routers, too, if it is told to.
        params.extended_key_usages = vec![
            ExtendedKeyUsagePurpose::ServerAuth,
            ExtendedKeyUsagePurpose::ClientAuth,
        ];
        self.sign(params)
    }

    /// For somebody who connects to a router. Nobody can play the router with it.
    pub(crate) fn client(&self, name: &str, days: i64) -> Result<Signed, Failure> {
        let mut params = params(name, &[], self.begins, days)?;
        params.extended_key_usages = vec![ExtendedKeyUsagePurpose::ClientAuth];
        self.sign(params)
    }

    fn sign(&self, mut params: CertificateParams) -> Result<Signed, Failure> {
        params.use_authority_key_identifier_extension = true;
        params.key_usages = vec![KeyUsagePurpose::DigitalSignature];
        let key = KeyPair::generate().map_err(failed)?;
        let certificate = params.signed_by(&key, &self.issuer).map_err(failed)?;
        Ok(Signed {
            certificate: certificate.pem(),
            key: key.serialize_pem(),
        })
    }
}

fn params(
    name: &str,
    hosts: &[String],
    begins: OffsetDateTime,
    days: i64,
) -> Result<CertificateParams, Failure> {
    let mut params = CertificateParams::new(hosts).map_err(|error| {
        Failure::bad_input(format_args!(
            "one of {hosts:?} is no name of a host: {error}"
        ))
    })?;
    let mut names = DistinguishedName::new();
    names.push(DnType::CommonName, name);
    params.distinguished_name = names;
    params.not_before = begins;
    params.not_after = begins
        .checked_add(Duration::days(days))
        .ok_or_else(|| Failure::bad_input(format_args!("{days} days from now is no date")))?;
    Ok(params)
}

fn failed(error: rcgen::Error) -> Failure {
    Failure::failed(format_args!("cannot make certificates: {error}"))
}

//! TLS with certificates made for the test.

use crate::house::{House, Tested};
use adit_server::ServerError;
use adit_server::api::{TlsFiles, serve};
use rustls::pki_types::ServerName;
use std::net::TcpListener;
use std::path::Path;
use std::sync::Arc;
use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::TcpStream;
use tokio_rustls::TlsConnector;
use tokio_rustls::rustls;

fn files(folder: &Path) -> TlsFiles {
    TlsFiles { certificate: folder.join("cert.pem"), key: folder.join("key.pem") }
}

#[test]
fn files_that_cannot_be_used_are_told_with_what_was_expected() -> Tested {
    let folder = tempfile::tempdir()?;
    let tls = files(folder.path());
    assert!(matches!(tls.read(), Err(ServerError::Io { path, .. }) if path == tls.certificate));
    let one = rcgen::generate_simple_self_signed(vec!["localhost".into()])?;
    let other = rcgen::generate_simple_self_signed(vec!["localhost".into()])?;
    let bad = [
        ("", one.signing_key.serialize_pem(), &tls.certificate),
        ("no PEM at all", one.signing_key.serialize_pem(), &tls.certificate),
        (&one.cert.pem(), String::new(), &tls.key),
        (&one.cert.pem(), one.cert.pem(), &tls.key),
        (&one.cert.pem(), other.signing_key.serialize_pem(), &tls.key),
    ];
    for (certificate, key, at) in bad {
        std::fs::write(&tls.certificate, certificate)?;
        std::fs::write(&tls.key, key)?;
        match tls.read() {
            Err(ServerError::Tls { path, expected, found }) => {
                assert_eq!(&path, at);
                assert!(!expected.is_empty() && !found.is_empty());
            }
            other => return Err(format!("{other:?}").into()),
        }
    }
    std::fs::write(&tls.certificate, one.cert.pem())?;
    std::fs::write(&tls.key, one.signing_key.serialize_pem())?;
    tls.read()?;
    Ok(())
}

#[tokio::test]
async fn a_client_that_trusts_the_certificate_is_served_and_one_without_tls_is_not() -> Tested {
    let folder = tempfile::tempdir()?;
    let tls = files(folder.path());
    let made = rcgen::generate_simple_self_signed(vec!["localhost".into()])?;
    std::fs::write(&tls.certificate, made.cert.pem())?;
    std::fs::write(&tls.key, made.signing_key.serialize_pem())?;
    let house = House::new().await?;
    let listener = TcpListener::bind("127.0.0.1:0")?;
    let address = listener.local_addr()?;
    tokio::spawn(serve(Arc::clone(&house.context), listener, Some(tls.read()?), std::future::pending()));

    let mut roots = rustls::RootCertStore::empty();
    roots.add(made.cert.der().clone())?;
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let client =
        rustls::ClientConfig::builder_with_provider(provider).with_safe_default_protocol_versions()?;
    let client = client.with_root_certificates(roots).with_no_client_auth();
    let stream = TcpStream::connect(address).await?;
    let mut stream =
        TlsConnector::from(Arc::new(client)).connect(ServerName::try_from("localhost")?, stream).await?;
    let request = "GET /health HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";
    stream.write_all(request.as_bytes()).await?;
    let mut answer = String::new();
    stream.read_to_string(&mut answer).await?;
    assert!(answer.starts_with("HTTP/1.1 200") && answer.contains("\"ready\":true"), "{answer}");

    let mut plain = TcpStream::connect(address).await?;
    plain.write_all(request.as_bytes()).await?;
    let mut answer = Vec::new();
    // The server may end the connection before or after its alert.
    let _ = plain.read_to_end(&mut answer).await;
    assert!(!answer.starts_with(b"HTTP"), "served without TLS");
    Ok(())
}

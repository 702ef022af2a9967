//! The listening socket, with TLS or without.

use super::{ApiError, Context};
use crate::ServerError;
use axum::Router;
use axum_server::Handle;
use axum_server::tls_rustls::{RustlsAcceptor, RustlsConfig};
use rustls::pki_types::pem::PemObject as _;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use serde::{Deserialize, Serialize};
use std::future::Future;
use std::net::{SocketAddr, TcpListener};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// A client that sends its header more slowly is let go.
const HEADER: Duration = Duration::from_secs(15);
/// How long answers under way may take when the server stops.
const GRACE: Duration = Duration::from_secs(5);

/// The files of a certificate.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TlsFiles {
    /// Certificates in PEM, the server's own first.
    pub certificate: PathBuf,
    /// Its private key in PEM.
    pub key: PathBuf,
}

impl TlsFiles {
    /// Reads and checks both.
    pub fn read(&self) -> Result<Arc<rustls::ServerConfig>, ServerError> {
        let certificates = read(&self.certificate)?;
        let chain: Vec<CertificateDer<'static>> = CertificateDer::pem_slice_iter(&certificates)
            .collect::<Result<_, _>>()
            .map_err(|error| tls(&self.certificate, "PEM certificates", &error))?;
        if chain.is_empty() {
            return Err(tls(&self.certificate, "PEM certificates", &"found none"));
        }
        let key = PrivateKeyDer::from_pem_slice(&read(&self.key)?)
            .map_err(|error| tls(&self.key, "a private key in PEM", &error))?;
        let provider = Arc::new(rustls::crypto::ring::default_provider());
        let fits = |error: rustls::Error| tls(&self.key, "the key of the certificate", &error);
        let mut config = rustls::ServerConfig::builder_with_provider(provider)
            .with_safe_default_protocol_versions()
            .map_err(fits)?
            .with_no_client_auth()
            .with_single_cert(chain, key)
            .map_err(fits)?;
        config.alpn_protocols = vec![b"http/1.1".to_vec()];
        Ok(Arc::new(config))
    }
}

fn read(path: &Path) -> Result<Vec<u8>, ServerError> {
    std::fs::read(path).map_err(|source| ServerError::Io { path: path.into(), source })
}

fn tls(path: &Path, expected: &'static str, found: &dyn std::fmt::Display) -> ServerError {
    ServerError::Tls { path: path.into(), expected, found: found.to_string() }
}

/// Serves the API on a socket until `stop` is ready; answers under way may end.
pub async fn serve(
    context: Arc<Context>,
    listener: TcpListener,
    tls: Option<Arc<rustls::ServerConfig>>,
    stop: impl Future<Output = ()> + Send + 'static,
) -> Result<(), ServerError> {
    let socket = |source| ServerError::Listen { source };
    listener.set_nonblocking(true).map_err(socket)?;
    let fences = tokio::spawn(super::omlox::watch(Arc::clone(&context)));
    let app: Router = super::router(context);
    let app = app.into_make_service_with_connect_info::<SocketAddr>();
    let handle = Handle::new();
    let stopping = handle.clone();
    let stopper = tokio::spawn(async move {
        stop.await;
        stopping.graceful_shutdown(Some(GRACE));
    });
    let mut server =
        axum_server::from_tcp(listener).map_err(socket)?.handle(handle).first_request_timeout(HEADER);
    server.http_builder().http1().header_read_timeout(HEADER);
    let served = match tls {
        Some(config) => {
            server.acceptor(RustlsAcceptor::new(RustlsConfig::from_config(config))).serve(app).await
        }
        None => server.serve(app).await,
    };
    stopper.abort();
    fences.abort();
    served.map_err(socket)
}

/// What is no route.
pub(super) async fn no_route(uri: axum::http::Uri) -> ApiError {
    ApiError::not_found(format!("no route {}", uri.path()))
}

/// What is a route, but not with this method.
pub(super) async fn no_method(method: axum::http::Method, uri: axum::http::Uri) -> ApiError {
    ApiError::method_not_allowed(format!("{method} is not for {}", uri.path()))
}

//! From where a request comes: the address of the connection, or what proxies that are trusted say.
//!
//! `X-Forwarded-For` is a list to which each proxy appends whom it was asked by; everything but the ends that trusted proxies have
//! written can be made up by the client. So it is read from the end: the first address that is no trusted proxy's is the client's.

use super::ApiSettings;
use axum::extract::ConnectInfo;
use axum::http::request::Parts;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};

const FORWARDED: &str = "x-forwarded-for";

/// Where a request comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ClientAddress(pub IpAddr);

/// Whom limits and the audit log count.
pub(super) fn of(settings: &ApiSettings, request: &Parts) -> ClientAddress {
    let known = request.extensions.get::<ConnectInfo<SocketAddr>>();
    let peer = known.map_or(IpAddr::V4(Ipv4Addr::UNSPECIFIED), |info| info.0.ip().to_canonical());
    let lines = request.headers.get_all(FORWARDED).iter().map(|line| line.to_str().unwrap_or("?"));
    let told: Vec<&str> = lines.flat_map(|line| line.split(',')).map(str::trim).collect();
    ClientAddress(client(settings, peer, &told))
}

fn client(settings: &ApiSettings, peer: IpAddr, told: &[&str]) -> IpAddr {
    let is_proxy = |address: IpAddr| settings.trusted_proxies.iter().any(|net| net.contains(&address));
    let mut address = peer;
    for told in told.iter().rev() {
        if !is_proxy(address) {
            break;
        }
        // What a trusted proxy has not understood is not guessed at: then it is the proxy's request.
        let Some(before) = read(told) else { break };
        address = before;
    }
    address
}

/// An address, with a port or without.
fn read(told: &str) -> Option<IpAddr> {
    let bare = told.trim_start_matches('[').trim_end_matches(']');
    let address = bare.parse().ok().or_else(|| told.parse::<SocketAddr>().ok().map(|socket| socket.ip()));
    address.map(|address| address.to_canonical())
}

#[cfg(test)]
mod tests {
    use super::*;

    type Tested = Result<(), Box<dyn std::error::Error>>;

    #[test]
    fn only_what_trusted_proxies_say_counts() -> Tested {
        let trusted_proxies = vec!["10.0.0.0/8".parse()?, "fd00::/8".parse()?];
        let settings = ApiSettings { trusted_proxies, ..ApiSettings::default() };
        for (peer, told, expected) in [
            // Nobody may say for themselves who they are.
            ("192.0.2.7", &["198.51.100.1"][..], "192.0.2.7"),
            ("10.0.0.1", &[], "10.0.0.1"),
            ("10.0.0.1", &["198.51.100.1"], "198.51.100.1"),
            // The client made the first up.
            ("10.0.0.1", &["127.0.0.1", "198.51.100.1"], "198.51.100.1"),
            // … also as a trusted proxy.
            ("10.0.0.1", &["1.2.3.4", "10.9.9.9", "198.51.100.1"], "198.51.100.1"),
            ("10.0.0.1", &["198.51.100.1", "10.0.0.2"], "198.51.100.1"),
            ("fd00::1", &["[2001:db8::5]:4711"], "2001:db8::5"),
            ("10.0.0.1", &["198.51.100.1:80"], "198.51.100.1"),
            ("::ffff:10.0.0.1", &["198.51.100.1"], "198.51.100.1"),
            ("10.0.0.1", &["198.51.100.1", "unknown"], "10.0.0.1"),
            ("10.0.0.1", &["10.0.0.3", "10.0.0.2"], "10.0.0.3"),
        ] {
            let peer = peer.parse::<IpAddr>()?.to_canonical();
            assert_eq!(client(&settings, peer, told), expected.parse::<IpAddr>()?, "{peer} {told:?}");
        }
        let nobody = ApiSettings::default();
        assert_eq!(client(&nobody, "10.0.0.1".parse()?, &["1.2.3.4"]), "10.0.0.1".parse::<IpAddr>()?);
        Ok(())
    }
}

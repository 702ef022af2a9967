//! How often one may try to log in: per address and per name, whether the name exists or not.

use super::AuthError;
use governor::clock::{Clock as _, DefaultClock};
use governor::{DefaultKeyedRateLimiter, Quota, RateLimiter};
use std::net::IpAddr;
use std::num::NonZeroU32;
use std::sync::atomic::{AtomicU32, Ordering};

/// After so many tries, those whose time has passed are forgotten.
const TIDY_EVERY: u32 = 1024;

/// Tries, counted.
pub(super) struct LoginLimiter {
    of_address: DefaultKeyedRateLimiter<IpAddr>,
    of_name: DefaultKeyedRateLimiter<String>,
    tries: AtomicU32,
    clock: DefaultClock,
}

impl LoginLimiter {
    /// So many tries a minute; as many at once.
    pub(super) fn new(address_per_minute: NonZeroU32, name_per_minute: NonZeroU32) -> Self {
        Self {
            of_address: RateLimiter::keyed(Quota::per_minute(address_per_minute)),
            of_name: RateLimiter::keyed(Quota::per_minute(name_per_minute)),
            tries: AtomicU32::new(0),
            clock: DefaultClock::default(),
        }
    }

    /// Counts a try; the time to wait when there were too many.
    pub(super) fn check(&self, address: IpAddr, name: &str) -> Result<(), AuthError> {
        if self.tries.fetch_add(1, Ordering::Relaxed) % TIDY_EVERY == TIDY_EVERY - 1 {
            self.of_address.retain_recent();
            self.of_name.retain_recent();
        }
        let name = name.chars().take(super::users::LONGEST_NAME).collect();
        let limited =
            self.of_address.check_key(&network_of(address)).and_then(|()| self.of_name.check_key(&name));
        limited.map_err(|until| {
            let wait = until.wait_time_from(self.clock.now());
            AuthError::TooManyTries { wait_s: wait.as_secs().saturating_add(1) }
        })
    }
}

/// A house has many IPv6 addresses: the network of 64 bits counts as one.
fn network_of(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V6(v6) => IpAddr::V6((v6.to_bits() >> 64 << 64).into()),
        v4 @ IpAddr::V4(_) => v4,
    }
}

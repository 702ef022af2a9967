//! Who may do what: users with roles, passwords, sessions, tokens.
//!
//! | what | how |
//! |---|---|
//! | password | argon2id, 19 MiB, 2 passes, 1 lane (OWASP Password Storage Cheat Sheet), hashed off the serving threads, two at once |
//! | session, API token | 256 random bits; only the SHA-256 is kept |
//! | session ends | after [`AuthSettings::session_idle_s`] without a request and [`AuthSettings::session_s`] in all; at log-out; when the user's password or role changes |
//! | tries to log in | so many a minute from one address and for one name; unknown names take as long as known ones |
//! | lock-out | [`LOCKED_AFTER`] wrong passwords in a row lock a name for [`LOCKED_S`]; sessions that are open go on, an admin unlocks by a new password |
//! | the last admin | cannot be deleted, disabled or made less |
//!
//! What a role may is one table, [`Permission`]. The API asks [`Auth::principal`] for every request; who that is, is all that it knows.

mod error;
mod limiter;
mod password;
mod principal;
mod role;
mod secret;
mod sessions;
mod tokens;
mod users;

pub use error::AuthError;
pub use password::LENGTHS as PASSWORD_LENGTHS;
pub use principal::{Credential, Principal};
pub use role::{Grant, Permission, Role};
pub use secret::Secret;
pub use sessions::NewSession;
pub use tokens::{ApiToken, NewToken};
pub use users::{LOCKED_AFTER, LOCKED_S, User, UserChange};

use crate::store::Store;
use adit_core::time::Time;
use limiter::LoginLimiter;
use password::Passwords;
use serde::{Deserialize, Serialize};
use sqlx::SqlitePool;
use std::num::NonZeroU32;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// The time of day, as the server knows it.
pub type WallClock = Arc<dyn Fn() -> Time + Send + Sync>;

/// How long sessions last and how often one may try.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AuthSettings {
    /// A session ends after so long without a request, s.
    pub session_idle_s: u32,
    /// A session ends after so long in all, s.
    pub session_s: u32,
    /// Tries to log in from one address, per minute.
    pub logins_per_address_per_minute: NonZeroU32,
    /// Tries to log in with one name, per minute.
    pub logins_per_name_per_minute: NonZeroU32,
}

impl Default for AuthSettings {
    fn default() -> Self {
        const TEN: NonZeroU32 = NonZeroU32::MIN.saturating_add(9);
        const THIRTY: NonZeroU32 = NonZeroU32::MIN.saturating_add(29);
        Self {
            session_idle_s: 12 * 3600,
            session_s: 7 * 24 * 3600,
            logins_per_address_per_minute: THIRTY,
            logins_per_name_per_minute: TEN,
        }
    }
}

/// The keeper of users, sessions and tokens.
#[derive(Clone)]
pub struct Auth {
    store: Store,
    settings: Arc<AuthSettings>,
    passwords: Passwords,
    limiter: Arc<LoginLimiter>,
    clock: WallClock,
    /// When a session was seen is being written.
    noting: Arc<AtomicBool>,
}

impl Auth {
    /// On the tables of a store. The clock tells when sessions and tokens end.
    pub async fn open(store: Store, settings: AuthSettings, clock: WallClock) -> Result<Self, AuthError> {
        let limiter =
            LoginLimiter::new(settings.logins_per_address_per_minute, settings.logins_per_name_per_minute);
        let passwords = Passwords::new().await?;
        let (settings, limiter, noting) = (Arc::new(settings), Arc::new(limiter), Arc::default());
        Ok(Self { store, settings, passwords, limiter, clock, noting })
    }

    /// On the first start, makes the user `admin` and returns the password, which is not kept: to be printed once. `None` when there
    /// are users.
    pub async fn first_admin(&self) -> Result<Option<String>, AuthError> {
        if self.has_users().await? {
            return Ok(None);
        }
        let password = secret::random_text::<15>()?;
        self.add_user("admin", Role::Admin, password.clone()).await?;
        Ok(Some(password))
    }

    /// How long sessions last and how often one may try.
    pub fn settings(&self) -> &AuthSettings {
        &self.settings
    }

    fn readers(&self) -> &SqlitePool {
        self.store.readers()
    }

    fn now(&self) -> i64 {
        (self.clock)().nanos()
    }
}

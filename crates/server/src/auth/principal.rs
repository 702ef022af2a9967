//! Who asks: what a request carries, looked up.

use super::secret::{Kind, digest};
use super::{Auth, AuthError, Grant, Permission};
use adit_core::time::Time;
use sqlx::Row as _;
use std::sync::atomic::Ordering;

/// A session's time of the last request is written again after so long, ns: not for every request.
const SEEN_EVERY_NS: i64 = 60_000_000_000;

/// What a request carried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Credential {
    /// A session.
    Session,
    /// An API token.
    Token,
}

/// Who asks.
#[derive(Debug, Clone)]
pub struct Principal {
    /// The name that the audit log has: a user's, or `token:` and the token's.
    pub name: String,
    /// What is allowed.
    pub grant: Grant,
    /// How it was shown.
    pub credential: Credential,
    /// When it ends without further requests; `None` when it does not.
    pub expires: Option<Time>,
    /// Of a session: what is kept of its secret.
    pub(super) digest: Vec<u8>,
}

impl Principal {
    /// Is this allowed?
    pub fn may(&self, permission: Permission) -> bool {
        self.grant.allows(permission)
    }

    /// The user whose session it is; `None` for tokens.
    pub fn user(&self) -> Option<&str> {
        (self.credential == Credential::Session).then_some(self.name.as_str())
    }
}

impl Auth {
    /// Whose secret it is; `None` when it is no one's (any more).
    pub async fn principal(&self, secret: &str) -> Result<Option<Principal>, AuthError> {
        match Kind::of(secret) {
            Some(Kind::Session) => self.of_session(digest(secret)).await,
            Some(Kind::Token) => self.of_token(digest(secret)).await,
            None => Ok(None),
        }
    }

    /// The same principal as things stand now; `None` when session or token have ended.
    pub async fn again(&self, principal: &Principal) -> Result<Option<Principal>, AuthError> {
        let digest = principal.digest.clone();
        match principal.credential {
            Credential::Session => self.of_session(digest).await,
            Credential::Token => self.of_token(digest).await,
        }
    }

    async fn of_session(&self, digest: Vec<u8>) -> Result<Option<Principal>, AuthError> {
        const SESSION: &str = "SELECT u.name, u.role, s.created_ns, s.seen_ns FROM sessions s JOIN users u ON u.id = s.user_id \
                               WHERE s.digest = ? AND u.disabled = 0";
        let Some(row) = sqlx::query(SESSION).bind(&digest).fetch_optional(self.readers()).await? else {
            return Ok(None);
        };
        let now = self.now();
        let (created, seen): (i64, i64) = (row.try_get("created_ns")?, row.try_get("seen_ns")?);
        let nanos = |seconds: u32| i64::from(seconds) * 1_000_000_000;
        let end = (created + nanos(self.settings.session_s)).min(seen + nanos(self.settings.session_idle_s));
        if now >= end {
            // The next log-in deletes it.
            return Ok(None);
        }
        if now - seen > SEEN_EVERY_NS {
            self.note_seen(digest.clone(), now);
        }
        let grant = grant(row.try_get("role")?)?;
        let expires = Some(Time::from_nanos(end));
        let name = row.try_get("name")?;
        Ok(Some(Principal { name, grant, credential: Credential::Session, expires, digest }))
    }

    /// Writes when a session was seen last, behind the request: whoever asks does not wait for a store that is locked or full. One at a
    /// time; what is left out then is written with a later request.
    fn note_seen(&self, digest: Vec<u8>, now: i64) {
        if self.noting.swap(true, Ordering::Relaxed) {
            return;
        }
        let auth = self.clone();
        tokio::spawn(async move {
            if let Err(error) = auth.write_seen(&digest, now).await {
                tracing::debug!("{error}");
            }
            auth.noting.store(false, Ordering::Relaxed);
        });
    }

    async fn write_seen(&self, digest: &[u8], now: i64) -> Result<(), AuthError> {
        let seen = sqlx::query("UPDATE sessions SET seen_ns = ? WHERE digest = ?").bind(now).bind(digest);
        let mut transaction = self.store.write().await?;
        seen.execute(&mut *transaction).await?;
        Ok(transaction.commit().await?)
    }

    async fn of_token(&self, digest: Vec<u8>) -> Result<Option<Principal>, AuthError> {
        const TOKEN: &str = "SELECT name, grants, expires_ns FROM api_tokens WHERE digest = ? AND revoked_ns IS NULL \
                             AND (expires_ns IS NULL OR expires_ns > ?)";
        let row = sqlx::query(TOKEN).bind(&digest).bind(self.now()).fetch_optional(self.readers()).await?;
        let Some(row) = row else { return Ok(None) };
        let name: String = row.try_get("name")?;
        let expires: Option<i64> = row.try_get("expires_ns")?;
        Ok(Some(Principal {
            name: format!("token:{name}"),
            grant: grant(row.try_get("grants")?)?,
            credential: Credential::Token,
            expires: expires.map(Time::from_nanos),
            digest,
        }))
    }
}

pub(super) fn grant(name: &str) -> Result<Grant, AuthError> {
    Grant::named(name).ok_or_else(|| AuthError::Role { found: name.into() })
}

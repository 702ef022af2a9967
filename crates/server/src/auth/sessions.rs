//! Logging in and out.

use super::secret::{Kind, Secret};
use super::users::{LOCKED_AFTER, LOCKED_S};
use super::{Auth, AuthError, Principal, Role};
use adit_core::time::Time;
use sqlx::Row as _;
use std::net::IpAddr;

/// A session just begun.
#[derive(Debug)]
pub struct NewSession {
    /// The secret, for the cookie or the header.
    pub secret: Secret,
    /// Whose.
    pub name: String,
    /// What they may.
    pub role: Role,
    /// When it ends at the latest.
    pub expires: Time,
}

const USER: &str = "SELECT id, role, password_hash, disabled, locked_until_ns FROM users WHERE name = ?";

impl Auth {
    /// Lets a user in: counts the try, checks the password, begins a session.
    pub async fn login(
        &self,
        address: IpAddr,
        name: &str,
        password: String,
    ) -> Result<NewSession, AuthError> {
        let name = name.to_lowercase();
        self.limiter.check(address, &name)?;
        let user = sqlx::query(USER).bind(&name).fetch_optional(self.readers()).await?;
        let hash = user.as_ref().map(|row| row.try_get("password_hash")).transpose()?;
        let right = self.passwords.verify(password, hash).await?;
        let Some(user) = user else { return Err(AuthError::WrongCredentials) };

        let now = self.now();
        let (id, disabled): (String, bool) = (user.try_get("id")?, user.try_get("disabled")?);
        let locked_until: Option<i64> = user.try_get("locked_until_ns")?;
        let locked = locked_until.is_some_and(|until| now < until);
        if !right && !locked {
            self.count_failure(&id, now).await?;
        }
        if !right || locked || disabled {
            return Err(AuthError::WrongCredentials);
        }
        let role: String = user.try_get("role")?;
        let role = Role::named(&role).ok_or(AuthError::Role { found: role })?;
        let secret = Secret::new(Kind::Session)?;
        let mut transaction = self.store.write().await?;
        let unlock = sqlx::query("UPDATE users SET failures = 0, locked_until_ns = NULL WHERE id = ?");
        unlock.bind(&id).execute(&mut *transaction).await?;
        let nanos = |seconds: u32| i64::from(seconds) * 1_000_000_000;
        let tidy = sqlx::query("DELETE FROM sessions WHERE created_ns <= ? OR seen_ns <= ?");
        let (end, idle) = (now - nanos(self.settings.session_s), now - nanos(self.settings.session_idle_s));
        tidy.bind(end).bind(idle).execute(&mut *transaction).await?;
        let begin =
            sqlx::query("INSERT INTO sessions (digest, user_id, created_ns, seen_ns) VALUES (?, ?, ?, ?)");
        begin.bind(secret.digest()).bind(&id).bind(now).bind(now).execute(&mut *transaction).await?;
        transaction.commit().await?;
        let expires = Time::from_nanos(now + i64::from(self.settings.session_s) * 1_000_000_000);
        Ok(NewSession { secret, name, role, expires })
    }

    /// Ends a session; a token stays.
    pub async fn logout(&self, principal: &Principal) -> Result<(), AuthError> {
        let end = sqlx::query("DELETE FROM sessions WHERE digest = ?").bind(&principal.digest);
        let mut transaction = self.store.write().await?;
        end.execute(&mut *transaction).await?;
        Ok(transaction.commit().await?)
    }

    /// Changes one's own password: asks for the old one, ends all other sessions.
    pub async fn change_password(
        &self,
        address: IpAddr,
        principal: &Principal,
        old: String,
        new: String,
    ) -> Result<(), AuthError> {
        let name = principal.user().ok_or(AuthError::WrongCredentials)?;
        self.limiter.check(address, name)?;
        let user = sqlx::query("SELECT id, password_hash FROM users WHERE name = ?").bind(name);
        let user = user.fetch_one(self.readers()).await?;
        if !self.passwords.verify(old, Some(user.try_get("password_hash")?)).await? {
            return Err(AuthError::WrongCredentials);
        }
        let hash = self.passwords.hash(new).await?;
        let id: String = user.try_get("id")?;
        let mut transaction = self.store.write().await?;
        let change = sqlx::query("UPDATE users SET password_hash = ? WHERE id = ?").bind(hash).bind(&id);
        change.execute(&mut *transaction).await?;
        let end = sqlx::query("DELETE FROM sessions WHERE user_id = ? AND digest <> ?");
        end.bind(&id).bind(&principal.digest).execute(&mut *transaction).await?;
        transaction.commit().await?;
        Ok(())
    }

    async fn count_failure(&self, id: &str, now: i64) -> Result<(), AuthError> {
        const COUNT: &str = "UPDATE users SET failures = (failures + 1) % ?2, \
                             locked_until_ns = CASE WHEN failures + 1 >= ?2 THEN ?3 ELSE NULL END WHERE id = ?1";
        let until = now + i64::from(LOCKED_S) * 1_000_000_000;
        let mut transaction = self.store.write().await?;
        sqlx::query(COUNT).bind(id).bind(LOCKED_AFTER).bind(until).execute(&mut *transaction).await?;
        Ok(transaction.commit().await?)
    }
}

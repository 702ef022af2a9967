//! Users: added, changed, removed by an admin.

use super::error::taken;
use super::{Auth, AuthError, Role};
use adit_core::time::Time;
use sqlx::sqlite::SqliteRow;
use sqlx::{Row as _, SqliteConnection};

/// So many wrong passwords in a row lock a name.
pub const LOCKED_AFTER: u32 = 10;
/// For so long, s.
pub const LOCKED_S: u32 = 15 * 60;
/// Most characters of a name.
pub(super) const LONGEST_NAME: usize = 64;

/// A user.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct User {
    /// Name to log in with, lower case.
    pub name: String,
    /// What they may.
    pub role: Role,
    /// May not log in.
    pub disabled: bool,
    /// Locked after wrong passwords until then.
    pub locked_until: Option<Time>,
    /// Since when.
    pub created: Time,
}

/// What is to be changed of a user; what is `None` stays.
#[derive(Debug, Clone, Default)]
pub struct UserChange {
    /// Another role.
    pub role: Option<Role>,
    /// A new password, which also unlocks.
    pub password: Option<String>,
    /// May (not) log in.
    pub disabled: Option<bool>,
}

const CHANGE: &str = "UPDATE users SET role = ?2, disabled = ?3, password_hash = COALESCE(?4, password_hash), \
     failures = CASE WHEN ?4 IS NULL THEN failures ELSE 0 END, \
     locked_until_ns = CASE WHEN ?4 IS NULL THEN locked_until_ns ELSE NULL END WHERE name = ?1";

impl Auth {
    pub(super) async fn has_users(&self) -> Result<bool, AuthError> {
        Ok(sqlx::query("SELECT 1 FROM users LIMIT 1").fetch_optional(self.readers()).await?.is_some())
    }

    /// All users by name.
    pub async fn users(&self) -> Result<Vec<User>, AuthError> {
        let rows = sqlx::query("SELECT * FROM users ORDER BY name").fetch_all(self.readers()).await?;
        let now = self.now();
        rows.iter().map(|row| user(row, now)).collect()
    }

    /// One user.
    pub async fn user(&self, name: &str) -> Result<User, AuthError> {
        let row = sqlx::query("SELECT * FROM users WHERE name = ?").bind(name.to_lowercase());
        let row = row.fetch_optional(self.readers()).await?.ok_or_else(|| unknown(name))?;
        user(&row, self.now())
    }

    /// Adds a user.
    pub async fn add_user(&self, name: &str, role: Role, password: String) -> Result<User, AuthError> {
        check_name(name)?;
        let hash = self.passwords.hash(password).await?;
        let add = "INSERT INTO users (id, name, role, password_hash, created_ns) VALUES (?, ?, ?, ?, ?)";
        let add = sqlx::query(add).bind(uuid::Uuid::now_v7().to_string()).bind(name).bind(role.name());
        let add = add.bind(hash).bind(self.now());
        let mut transaction = self.store.write().await?;
        add.execute(&mut *transaction).await.map_err(taken(name))?;
        transaction.commit().await?;
        self.user(name).await
    }

    /// Changes a user. A new role or password ends the user's sessions.
    pub async fn change_user(&self, name: &str, change: UserChange) -> Result<User, AuthError> {
        let name = name.to_lowercase();
        let hash = match change.password {
            Some(password) => Some(self.passwords.hash(password).await?),
            None => None,
        };
        let mut transaction = self.store.write().await?;
        let before = sqlx::query("SELECT * FROM users WHERE name = ?").bind(&name);
        let before = before.fetch_optional(&mut *transaction).await?.ok_or_else(|| unknown(&name))?;
        let before = user(&before, self.now())?;
        let role = change.role.unwrap_or(before.role);
        let disabled = change.disabled.unwrap_or(before.disabled);
        let write = sqlx::query(CHANGE).bind(&name).bind(role.name()).bind(disabled).bind(&hash);
        write.execute(&mut *transaction).await?;
        if hash.is_some() || role != before.role || disabled {
            let end = "DELETE FROM sessions WHERE user_id = (SELECT id FROM users WHERE name = ?)";
            sqlx::query(end).bind(&name).execute(&mut *transaction).await?;
        }
        keep_an_admin(&mut transaction, &name).await?;
        transaction.commit().await?;
        self.user(&name).await
    }

    /// Removes a user and their sessions.
    pub async fn remove_user(&self, name: &str) -> Result<(), AuthError> {
        let name = name.to_lowercase();
        let mut transaction = self.store.write().await?;
        let end = "DELETE FROM sessions WHERE user_id = (SELECT id FROM users WHERE name = ?)";
        sqlx::query(end).bind(&name).execute(&mut *transaction).await?;
        let gone = sqlx::query("DELETE FROM users WHERE name = ?").bind(&name);
        if gone.execute(&mut *transaction).await?.rows_affected() == 0 {
            return Err(unknown(&name));
        }
        keep_an_admin(&mut transaction, &name).await?;
        transaction.commit().await?;
        Ok(())
    }
}

/// Refuses a change after which no admin could log in.
async fn keep_an_admin(connection: &mut SqliteConnection, name: &str) -> Result<(), AuthError> {
    let left = sqlx::query("SELECT 1 FROM users WHERE role = 'admin' AND disabled = 0 LIMIT 1");
    match left.fetch_optional(connection).await? {
        Some(_) => Ok(()),
        None => Err(AuthError::LastAdmin { name: name.into() }),
    }
}

pub(super) fn check_name(name: &str) -> Result<(), AuthError> {
    let known = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "._-@".contains(c);
    if (1..=LONGEST_NAME).contains(&name.len()) && name.chars().all(known) {
        Ok(())
    } else {
        let found = name.chars().take(LONGEST_NAME).collect();
        Err(AuthError::Name { found, longest: LONGEST_NAME })
    }
}

fn user(row: &SqliteRow, now: i64) -> Result<User, AuthError> {
    let role: String = row.try_get("role")?;
    let locked: Option<i64> = row.try_get("locked_until_ns")?;
    Ok(User {
        name: row.try_get("name")?,
        role: Role::named(&role).ok_or(AuthError::Role { found: role })?,
        disabled: row.try_get("disabled")?,
        locked_until: locked.filter(|until| now < *until).map(Time::from_nanos),
        created: Time::from_nanos(row.try_get("created_ns")?),
    })
}

fn unknown(name: &str) -> AuthError {
    AuthError::Unknown { what: "user", id: name.into() }
}

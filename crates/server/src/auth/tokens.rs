//! API tokens, for programs: named, with an end, revocable.

use super::error::taken;
use super::principal::grant;
use super::secret::{Kind, Secret};
use super::users::check_name;
use super::{Auth, AuthError, Grant};
use adit_core::time::Time;
use sqlx::Row as _;
use sqlx::sqlite::SqliteRow;

/// An API token, without its secret.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ApiToken {
    /// Identifier, a UUID.
    pub id: String,
    /// Name, which the audit log has after `token:`.
    pub name: String,
    /// How the secret begins.
    pub prefix: String,
    /// What it is good for.
    pub grant: Grant,
    /// Who made it.
    pub created_by: String,
    /// When.
    pub created: Time,
    /// When it ends; `None` for never.
    pub expires: Option<Time>,
    /// When it was revoked.
    pub revoked: Option<Time>,
}

/// A token just made.
#[derive(Debug)]
pub struct NewToken {
    /// What is kept of it.
    pub token: ApiToken,
    /// The secret, told once.
    pub secret: Secret,
}

const ADD: &str = "INSERT INTO api_tokens (id, name, prefix, digest, grants, created_by, created_ns, expires_ns) \
                   VALUES (?, ?, ?, ?, ?, ?, ?, ?)";

impl Auth {
    /// All tokens by name, revoked ones too.
    pub async fn tokens(&self) -> Result<Vec<ApiToken>, AuthError> {
        let rows = sqlx::query("SELECT * FROM api_tokens ORDER BY name").fetch_all(self.readers()).await?;
        rows.iter().map(token).collect()
    }

    /// Makes a token.
    pub async fn add_token(
        &self,
        by: &str,
        name: &str,
        grant: Grant,
        expires: Option<Time>,
    ) -> Result<NewToken, AuthError> {
        check_name(name)?;
        if let Some(expires) = expires.filter(|expires| expires.nanos() <= self.now()) {
            return Err(AuthError::Expired { expires_ns: expires.nanos() });
        }
        let secret = Secret::new(Kind::Token)?;
        let id = uuid::Uuid::now_v7().to_string();
        let add = sqlx::query(ADD).bind(&id).bind(name).bind(secret.shown()).bind(secret.digest());
        let add = add.bind(grant.name()).bind(by).bind(self.now()).bind(expires.map(Time::nanos));
        let mut transaction = self.store.write().await?;
        add.execute(&mut *transaction).await.map_err(taken(name))?;
        transaction.commit().await?;
        let row =
            sqlx::query("SELECT * FROM api_tokens WHERE id = ?").bind(&id).fetch_one(self.readers()).await?;
        Ok(NewToken { token: token(&row)?, secret })
    }

    /// Ends a token; what it was stays in the list. A token revoked before stays as it is.
    pub async fn revoke_token(&self, id: &str) -> Result<ApiToken, AuthError> {
        let revoke = sqlx::query(
            "UPDATE api_tokens SET revoked_ns = COALESCE(revoked_ns, ?) WHERE id = ? RETURNING *",
        );
        let mut transaction = self.store.write().await?;
        let row = revoke.bind(self.now()).bind(id).fetch_optional(&mut *transaction).await?;
        transaction.commit().await?;
        let unknown = || AuthError::Unknown { what: "token", id: id.into() };
        token(&row.ok_or_else(unknown)?)
    }
}

fn token(row: &SqliteRow) -> Result<ApiToken, AuthError> {
    let time = |column| row.try_get::<Option<i64>, _>(column).map(|ns| ns.map(Time::from_nanos));
    Ok(ApiToken {
        id: row.try_get("id")?,
        name: row.try_get("name")?,
        prefix: row.try_get("prefix")?,
        grant: grant(row.try_get("grants")?)?,
        created_by: row.try_get("created_by")?,
        created: Time::from_nanos(row.try_get("created_ns")?),
        expires: time("expires_ns")?,
        revoked: time("revoked_ns")?,
    })
}

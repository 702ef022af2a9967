//! Why someone is not let in, or a user cannot be as asked.

use super::password::LENGTHS;

/// Why someone is not let in, or a user cannot be as asked.
#[derive(Debug, thiserror::Error)]
pub enum AuthError {
    /// Name or password is wrong, or the user is locked or disabled: which of them is not told.
    #[error("wrong name or password, or the account is locked")]
    WrongCredentials,
    /// Too many tries.
    #[error("too many tries to log in: wait {wait_s} s")]
    TooManyTries {
        /// How long to wait, s.
        wait_s: u64,
    },
    /// A password too short or too long.
    #[error("a password has {} to {} characters, this one {found}", LENGTHS.start(), LENGTHS.end())]
    PasswordLength {
        /// Its characters.
        found: usize,
    },
    /// A name that cannot be one.
    #[error("a name is 1 to {longest} of a–z, 0–9, `.`, `_`, `-` and `@`; found {found:?}")]
    Name {
        /// What was asked for.
        found: String,
        /// Most characters.
        longest: usize,
    },
    /// A user or token of that name is there already.
    #[error("`{name}` is taken")]
    Taken {
        /// The name.
        name: String,
    },
    /// There is none.
    #[error("no {what} `{id}`")]
    Unknown {
        /// User or token.
        what: &'static str,
        /// As asked for.
        id: String,
    },
    /// The last admin would be gone.
    #[error("`{name}` is the last admin who can log in: make another first")]
    LastAdmin {
        /// Who.
        name: String,
    },
    /// A token would end before it begins.
    #[error("a token that expires at {expires_ns} ns has expired already")]
    Expired {
        /// When, ns since the Unix epoch.
        expires_ns: i64,
    },
    /// The system has no random numbers.
    #[error("no random numbers: {0}")]
    Random(String),
    /// A password could not be hashed.
    #[error("hashing of a password: {0}")]
    Hash(String),
    /// The store cannot be written.
    #[error("users: {0}")]
    Store(#[from] crate::store::StoreError),
    /// What the database said.
    #[error("users: {0}")]
    Database(#[from] sqlx::Error),
    /// What stands in the database is not what was written.
    #[error("users: `{found}` is no role")]
    Role {
        /// What stands there.
        found: String,
    },
}

/// A name that is there already is told as such.
pub(super) fn taken(name: &str) -> impl FnOnce(sqlx::Error) -> AuthError {
    move |error| match &error {
        sqlx::Error::Database(e) if e.is_unique_violation() => AuthError::Taken { name: name.into() },
        _ => AuthError::Database(error),
    }
}

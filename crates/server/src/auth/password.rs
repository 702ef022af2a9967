//! Passwords: argon2id with the parameters that OWASP recommends (Password Storage Cheat Sheet: 19 MiB, 2 passes, 1 lane).

use super::AuthError;
use argon2::password_hash::{PasswordHasher as _, PasswordVerifier as _};
use argon2::{Algorithm, Argon2, Params, Version};
use std::sync::Arc;
use tokio::sync::Semaphore;

const MEMORY_KIB: u32 = 19 * 1024;
const PASSES: u32 = 2;
/// Hashes at once; each takes [`MEMORY_KIB`] and a thread.
const AT_ONCE: usize = 2;

/// Fewest and most characters of a password.
pub const LENGTHS: std::ops::RangeInclusive<usize> = 12..=128;

/// Makes and checks hashes, off the threads that serve.
#[derive(Clone)]
pub(super) struct Passwords {
    gate: Arc<Semaphore>,
    /// Of no one's password: what is checked for a user who does not exist, so that it takes as long.
    nobody: Arc<str>,
}

impl Passwords {
    pub(super) async fn new() -> Result<Self, AuthError> {
        let gate = Arc::new(Semaphore::new(AT_ONCE));
        let nobody = super::secret::random_text::<32>()?;
        let nobody = on_thread(&gate, move || hash(&nobody)).await??.into();
        Ok(Self { gate, nobody })
    }

    /// The hash of a password, in PHC form.
    pub(super) async fn hash(&self, password: String) -> Result<String, AuthError> {
        check_length(&password)?;
        on_thread(&self.gate, move || hash(&password)).await?
    }

    /// Is it the password of that hash? Without a hash the answer is no, after the same work.
    pub(super) async fn verify(&self, password: String, hash: Option<String>) -> Result<bool, AuthError> {
        if password.chars().count() > *LENGTHS.end() {
            return Ok(false);
        }
        let nobody = Arc::clone(&self.nobody);
        on_thread(&self.gate, move || {
            let known = hash.is_some();
            let hash = hash.as_deref().unwrap_or(&nobody);
            argon()?.verify_password(password.as_bytes(), hash).map(|()| known).or_else(|error| match error {
                argon2::password_hash::Error::PasswordInvalid => Ok(false),
                error => Err(AuthError::Hash(error.to_string())),
            })
        })
        .await?
    }
}

fn check_length(password: &str) -> Result<(), AuthError> {
    let found = password.chars().count();
    if LENGTHS.contains(&found) { Ok(()) } else { Err(AuthError::PasswordLength { found }) }
}

fn argon() -> Result<Argon2<'static>, AuthError> {
    let params =
        Params::new(MEMORY_KIB, PASSES, 1, None).map_err(|error| AuthError::Hash(error.to_string()))?;
    Ok(Argon2::new(Algorithm::Argon2id, Version::V0x13, params))
}

fn hash(password: &str) -> Result<String, AuthError> {
    let hash = argon()?.hash_password(password.as_bytes());
    hash.map(|hash| hash.to_string()).map_err(|error| AuthError::Hash(error.to_string()))
}

async fn on_thread<T: Send + 'static>(
    gate: &Arc<Semaphore>,
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T, AuthError> {
    let stopped = |_| AuthError::Hash("the server is stopping".into());
    let permit = Arc::clone(gate).acquire_owned().await.map_err(stopped)?;
    let work = tokio::task::spawn_blocking(move || {
        let _permit = permit;
        work()
    });
    work.await.map_err(|error| AuthError::Hash(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_password_is_told_from_others_and_nobody_has_one() -> Result<(), AuthError> {
        let passwords = Passwords::new().await?;
        let hash = passwords.hash("correct horse battery".into()).await?;
        assert!(hash.starts_with("$argon2id$v=19$m=19456,t=2,p=1$"), "{hash}");
        assert!(passwords.verify("correct horse battery".into(), Some(hash.clone())).await?);
        assert!(!passwords.verify("correct horse batterz".into(), Some(hash)).await?);
        assert!(!passwords.verify("correct horse battery".into(), None).await?);
        Ok(())
    }

    #[tokio::test]
    async fn a_short_password_is_refused() -> Result<(), AuthError> {
        let refused = Passwords::new().await?.hash("elevenchars".into()).await;
        assert!(matches!(refused, Err(AuthError::PasswordLength { found: 11 })));
        Ok(())
    }
}

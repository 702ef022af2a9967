//! Secrets that the server gives out: 256 random bits, of which only the SHA-256 is kept.

use super::AuthError;
use base64::Engine as _;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use rand::TryRng as _;
use rand::rngs::SysRng;
use sha2::{Digest as _, Sha256};

/// Longest secret that is looked at, bytes.
const LONGEST: usize = 128;
/// Characters of a token that are shown to tell it from others: its kind and 30 of its 256 bits.
const SHOWN: usize = 12;

/// What a secret opens, told by how it begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Session,
    Token,
}

impl Kind {
    const fn prefix(self) -> &'static str {
        match self {
            Self::Session => "adit_s_",
            Self::Token => "adit_t_",
        }
    }

    pub(super) fn of(text: &str) -> Option<Self> {
        let known = |kind: &Self| text.len() <= LONGEST && text.starts_with(kind.prefix());
        [Self::Session, Self::Token].into_iter().find(known)
    }
}

/// A secret, on its way to the one who asked for it.
#[derive(Clone)]
pub struct Secret(String);

impl Secret {
    pub(super) fn new(kind: Kind) -> Result<Self, AuthError> {
        Ok(Self(format!("{}{}", kind.prefix(), random_text::<32>()?)))
    }

    /// The secret itself; it is told once.
    pub fn expose(&self) -> &str {
        &self.0
    }

    pub(super) fn digest(&self) -> Vec<u8> {
        digest(&self.0)
    }

    pub(super) fn shown(&self) -> &str {
        self.0.get(..SHOWN).unwrap_or_default()
    }
}

impl std::fmt::Debug for Secret {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}…", self.shown())
    }
}

/// What is kept of a secret. No salt: 256 random bits cannot be guessed.
pub(super) fn digest(secret: &str) -> Vec<u8> {
    Sha256::digest(secret.as_bytes()).to_vec()
}

/// `N` random bytes of the system as text of A–Z, a–z, 0–9, `-` and `_`.
pub(super) fn random_text<const N: usize>() -> Result<String, AuthError> {
    let mut bytes = [0; N];
    SysRng.try_fill_bytes(&mut bytes).map_err(|error| AuthError::Random(error.to_string()))?;
    Ok(URL_SAFE_NO_PAD.encode(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn secrets_differ_and_do_not_print_themselves() -> Result<(), AuthError> {
        let (a, b) = (Secret::new(Kind::Token)?, Secret::new(Kind::Token)?);
        assert_ne!(a.expose(), b.expose());
        assert_ne!(a.digest(), b.digest());
        assert_eq!(a.expose().len(), "adit_t_".len() + 43);
        assert_eq!(Kind::of(a.expose()), Some(Kind::Token));
        assert!(!format!("{a:?}").contains(a.expose()));
        Ok(())
    }
}

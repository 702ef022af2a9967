//! A message in the forms in which anybody wants it, each written once.

use axum::extract::ws::Utf8Bytes;
use std::sync::{Mutex, PoisonError};

/// A message by form; a form is the topic with its coordinate system.
#[derive(Debug, Default)]
pub struct Texts {
    written: Mutex<Vec<(String, Utf8Bytes)>>,
}

impl Texts {
    /// The message in a form, which is written when nobody has asked for it before. All who ask share the same bytes.
    pub fn get(&self, form: &str, write: impl FnOnce() -> String) -> Utf8Bytes {
        let mut written = self.written.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, text)) = written.iter().find(|(known, _)| known == form) {
            return text.clone();
        }
        let text = Utf8Bytes::from(write());
        written.push((form.into(), text.clone()));
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_written_once_for_each_form() {
        let texts = Texts::default();
        let mut written = 0;
        for form in ["a", "b", "a", "a"] {
            texts.get(form, || {
                written += 1;
                form.to_owned()
            });
        }
        assert_eq!(written, 2);
        let (one, other) = (texts.get("a", String::new), texts.get("a", String::new));
        assert_eq!(one.as_str().as_ptr(), other.as_str().as_ptr(), "the bytes are not shared");
    }
}

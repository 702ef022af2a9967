//! TOML files of settings, with the line in every error.

use anyhow::{Context, Result, anyhow};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fs;
use std::path::Path;

/// Checks TOML text; `path` is its name in errors.
pub fn parse<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T> {
    toml::from_str(text).map_err(|error| {
        let at = error.span().map_or(text.len(), |span| span.start);
        anyhow!("{}:{}: {}", path.display(), line(text, at), error.message())
    })
}

/// Line of the byte `at` of a text, from 1.
pub fn line(text: &str, at: usize) -> usize {
    1 + text.bytes().take(at).filter(|byte| *byte == b'\n').count()
}

/// `base` with the values that stand in the TOML file in place of its own.
pub fn overlay<T: Serialize + DeserializeOwned>(base: &T, path: &Path) -> Result<T> {
    let text = text(path)?;
    // Checked on its own first: this is where names and types get their line numbers.
    parse::<T>(path, &text)?;
    overlay_table(base, parse(path, &text)?).map_err(|error| anyhow!("{}: {error}", path.display()))
}

/// `base` with the values of a table in place of its own; a name that it does not know is an error.
pub fn overlay_table<T: Serialize + DeserializeOwned>(base: &T, over: toml::Table) -> Result<T> {
    let mut merged = toml::Table::try_from(base).context("settings cannot be written as TOML")?;
    merge(&mut merged, over);
    merged.try_into().map_err(|error| anyhow!("{}", error.message()))
}

/// The whole of a text file.
pub fn text(path: &Path) -> Result<String> {
    fs::read_to_string(path).with_context(|| format!("{}: cannot read it", path.display()))
}

/// Puts the values of one table in place of those of another.
pub fn merge(base: &mut toml::Table, over: toml::Table) {
    for (key, value) in over {
        match (base.get_mut(&key), value) {
            (Some(toml::Value::Table(below)), toml::Value::Table(above)) => merge(below, above),
            (_, value) => {
                base.insert(key, value);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use serde::Deserialize;
    use std::io::Write;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields, default)]
    struct Settings {
        noise: f64,
        limit: f64,
        window: Window,
    }

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields, default)]
    struct Window {
        samples: u32,
        shape: Option<String>,
    }

    impl Default for Settings {
        fn default() -> Self {
            Self { noise: 1.0, limit: 2.0, window: Window::default() }
        }
    }

    impl Default for Window {
        fn default() -> Self {
            Self { samples: 5, shape: None }
        }
    }

    fn over(base: &Settings, text: &str) -> Result<Settings> {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(text.as_bytes()).unwrap();
        overlay(base, file.path())
    }

    #[test]
    fn a_file_changes_what_it_names_and_nothing_else() {
        let base = Settings {
            noise: 7.0,
            window: Window { samples: 9, shape: Some("box".into()) },
            ..Settings::default()
        };
        let merged = over(&base, "limit = 3.0\n[window]\nsamples = 4\n").unwrap();
        let window = Window { samples: 4, shape: Some("box".into()) };
        assert_eq!(merged, Settings { noise: 7.0, limit: 3.0, window });
    }

    #[test]
    fn errors_tell_the_line() {
        let error = over(&Settings::default(), "limit = 3.0\nnoize = 1.0\n").unwrap_err().to_string();
        assert!(error.contains(":2: unknown field `noize`"), "{error}");
        let error = over(&Settings::default(), "\n[window]\nsamples = \"four\"\n").unwrap_err().to_string();
        assert!(error.contains(":3: "), "{error}");
    }
}

//! Which tag is followed how.

use super::estimator::Settings;
use adit_nlos::Model;
use adit_observation::sidecar::{Location, Sidecar};
use std::sync::Arc;

/// A tag that has no place yet looks on the map of the radio so often, s: all the tags of a mine begin at once.
const SCAN_REST_S: f64 = 5.0;

/// How tags of one kind are followed.
#[derive(Debug, Clone)]
pub struct Profile {
    /// Its name in the configuration.
    pub name: String,
    /// Which tags: names, with `*` for any text at the end.
    pub tags: Vec<String>,
    /// How the sensor is worn, what its signs and noise are.
    pub sidecar: Sidecar,
    /// The method and its settings.
    pub settings: Settings,
    /// Judges the ranges before the method gets them, where there is one.
    pub nlos: Option<Arc<Model>>,
    method: Arc<str>,
}

impl Profile {
    /// Of these tags, followed so.
    pub fn new(name: impl Into<String>, tags: Vec<String>, sidecar: Sidecar, mut settings: Settings) -> Self {
        if let Settings::Fused(fused) = &mut settings {
            // Somebody who has not walked since the tag was switched on is to be found too.
            fused.place.before_direction = true;
            fused.place.scan_rest_s = SCAN_REST_S;
        }
        let method = settings.name().into();
        Self { name: name.into(), tags, sidecar, settings, nlos: None, method }
    }

    /// The same, ranges judged by a model first.
    #[must_use]
    pub fn judging(self, model: Arc<Model>) -> Self {
        Self { nlos: Some(model), ..self }
    }

    /// Whether the tag sits on the trunk of a body, which stands or lies.
    pub fn is_on_body(&self) -> bool {
        matches!(self.sidecar.mounting.location, Some(Location::Waist | Location::Chest | Location::Head))
    }

    /// Name of the method.
    pub fn method(&self) -> Arc<str> {
        Arc::clone(&self.method)
    }
}

/// All profiles; the first that a tag fits is its own.
#[derive(Debug, Clone)]
pub struct Profiles(Vec<Profile>);

/// Why profiles cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ProfilesError {
    /// There is none.
    #[error("no profile: expected at least one, with tags = [\"*\"] for all tags that no other names")]
    None,
    /// Two have one name.
    #[error("two profiles are called '{0}'")]
    Twice(String),
}

impl Profiles {
    /// In the order in which they are asked.
    pub fn new(profiles: Vec<Profile>) -> Result<Self, ProfilesError> {
        if profiles.is_empty() {
            return Err(ProfilesError::None);
        }
        for (index, profile) in profiles.iter().enumerate() {
            if profiles[..index].iter().any(|before| before.name == profile.name) {
                return Err(ProfilesError::Twice(profile.name.clone()));
            }
        }
        Ok(Self(profiles))
    }

    /// That of a tag.
    pub fn of(&self, tag: &str) -> Option<&Profile> {
        let fits = |pattern: &String| match pattern.strip_suffix('*') {
            Some(start) => tag.starts_with(start),
            None => tag == pattern,
        };
        self.0.iter().find(|profile| profile.tags.iter().any(fits))
    }

    /// That of a name.
    pub fn named(&self, name: &str) -> Option<&Profile> {
        self.0.iter().find(|profile| profile.name == name)
    }
}

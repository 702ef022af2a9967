//! `--nlos` and `nlos = "…"`: ranges judged before they reach a method, by a model that ships with adit or by one from a file.

use adit_nlos::network::Scratch;
use adit_nlos::{Links, Model, SHIPPED, annotate};
use adit_observation::Observation;
use anyhow::{Context, Result};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A model by the name under which it ships, else from a file below the folder.
pub fn model(name: &str, folder: &Path) -> Result<Arc<Model>> {
    if let Some(shipped) = Model::named(name) {
        return Ok(Arc::new(shipped?));
    }
    let path = folder.join(PathBuf::from(name));
    let bytes = fs::read(&path).with_context(|| {
        let known: Vec<&str> = SHIPPED.iter().map(|(name, _)| *name).collect();
        format!("{}: cannot read it, and the models that ship are {}", path.display(), known.join(", "))
    })?;
    Ok(Arc::new(Model::from_bytes(&path.display().to_string(), &bytes)?))
}

/// Ranges of a log, judged as they pass.
pub struct JudgedRanges {
    model: Arc<Model>,
    links: Links,
    scratch: Scratch,
    judged: u64,
}

impl JudgedRanges {
    /// By a model.
    pub fn by(model: &Arc<Model>) -> Self {
        Self { model: Arc::clone(model), links: Links::default(), scratch: Scratch::default(), judged: 0 }
    }

    /// Judges the observation where it is a range that tells how its signal came in.
    pub fn see(&mut self, observation: &mut Observation) {
        if let Observation::Range(range) = observation {
            self.judged += u64::from(annotate(range, &self.model, &mut self.links, &mut self.scratch));
        }
    }

    /// The whole log at once.
    pub fn of(model: &Arc<Model>, observations: &[Observation]) -> Vec<Observation> {
        let mut judge = Self::by(model);
        let mut judged = observations.to_vec();
        for observation in &mut judged {
            judge.see(observation);
        }
        judged
    }

    /// How many were judged.
    pub fn judged(&self) -> u64 {
        self.judged
    }

    /// What is odd: nothing to judge.
    pub fn warning(&self) -> Option<String> {
        (self.judged == 0)
            .then(|| "--nlos: no range of the log tells how its signal came in, none was judged".to_owned())
    }
}

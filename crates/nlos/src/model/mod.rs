//! A classifier as it is kept and asked: the baseline, the network where there is one, and the record of its training.

mod file;
mod record;

pub use record::{DataRecord, HeldOutRecord, NetworkRecord, Record, ScoreRecord};

use crate::baseline::Baseline;
use crate::calibration::{self, Logits};
use crate::error::NlosError;
use crate::features;
use crate::network::{Network, Scratch};
use crate::task::{MOST_CLASSES, Task};
use crate::window::{self, Window};
use adit_observation::Reception;

/// Layout of the file.
pub(crate) const VERSION: u32 = 1;

/// Probability of each class, the first of line of sight; those beyond the classes of the model are 0.
pub type Probabilities = [f32; MOST_CLASSES];

/// A classifier.
#[derive(Debug, Clone)]
pub struct Model {
    /// What it tells apart.
    pub task: Task,
    /// What it says of itself.
    pub record: Record,
    /// What features made by hand tell.
    pub baseline: Baseline,
    /// What the response tells beside them.
    pub network: Option<Network>,
}

/// The models that ship with adit, by name, the default first.
///
/// `flat`: LOS, NLOS and no direct path, learnt of the set uwb-cirs-2018 (Kolakowski, CC BY 4.0) and of rooms simulated by adit; its record tells the rest.
///
/// `mine`: what is in the way of a link ([`adit_observation::InTheWay`]), learnt of walks in rooms of mines simulated by adit, of nothing else.
pub const SHIPPED: [(&str, &[u8]); 2] = [
    ("flat", include_bytes!("../../models/flat.safetensors")),
    ("mine", include_bytes!("../../models/mine.safetensors")),
];

impl Model {
    /// The default of those that ship with adit: three classes, DW1000, with or without impulse responses.
    pub fn shipped() -> Result<Self, NlosError> {
        let [(name, bytes), ..] = SHIPPED;
        Self::from_bytes(name, bytes)
    }

    /// One that ships with adit; `None` for a name that none has.
    pub fn named(name: &str) -> Option<Result<Self, NlosError>> {
        let (name, bytes) = SHIPPED.iter().find(|(known, _)| *known == name)?;
        Some(Self::from_bytes(name, bytes))
    }

    /// Judges a reception; with the baseline where there is no network, or no impulse response for it.
    pub fn judge(&self, reception: &Reception, range_m: Option<f64>, scratch: &mut Scratch) -> Probabilities {
        let features = features::of(reception, range_m);
        let window = self.network.as_ref().and_then(|_| window::of(reception));
        self.judge_features(&features, window.as_ref(), scratch)
    }

    /// The same of features and window made before.
    pub fn judge_features(
        &self,
        features: &[f32; features::COUNT],
        window: Option<&Window>,
        scratch: &mut Scratch,
    ) -> Probabilities {
        let (logits, scalings) = match (&self.network, &self.record.network) {
            (Some(network), Some(record)) if window.is_some() || !network.looks_at_window() => {
                let mut scores = [0.0; features::COUNT];
                self.baseline.write_scores(features, &mut scores);
                let mut logits = Logits::default();
                let asked = &mut logits[..self.task.questions()];
                network.logits(&scores[..self.baseline.used.len()], window, scratch, asked);
                (logits, &record.scalings)
            }
            _ => (self.baseline.logits(features), &self.record.baseline_scalings),
        };
        calibration::probabilities(logits, scalings, self.task.classes().len())
    }

    /// The same of the baseline alone.
    pub fn judge_baseline(&self, features: &[f32; features::COUNT]) -> Probabilities {
        let logits = self.baseline.logits(features);
        calibration::probabilities(logits, &self.record.baseline_scalings, self.task.classes().len())
    }

    /// How often each class came where it was learnt.
    pub fn shares(&self) -> Probabilities {
        calibration::shares(&self.record.baseline_scalings, self.task.classes().len())
    }
}

#[cfg(test)]
mod tests;

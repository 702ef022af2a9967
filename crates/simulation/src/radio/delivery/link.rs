//! The way from a tag to the server: losses in bursts, duplicates, delays, a gateway that keeps what it cannot forward.

use crate::error::{SimulationError, check_within};
use crate::radio::keyed::{Key, exponential, uniform};
use crate::radio::spec::check_share;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

/// How well observations get through.
///
/// Losses are those of a channel with a good and a bad state, each with its own probability of loss (Gilbert 1960, Elliott 1963);
/// the state may change with each observation. Share of losses: `(π_bad)·lost_bad + (1 − π_bad)·lost_good`, with
/// `π_bad = to_bad / (to_bad + to_good)`; bursts last `1/to_good` observations on average.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LinkSpec {
    /// Share lost in the good state.
    pub lost_good: f64,
    /// Share lost in the bad state.
    pub lost_bad: f64,
    /// Probability per observation to go from good to bad.
    pub to_bad: f64,
    /// Probability per observation to go from bad to good.
    pub to_good: f64,
    /// Share that arrives twice.
    pub duplicated: f64,
    /// Shortest delay, s.
    pub least_delay_s: f64,
    /// What comes on top, mean of an exponential, s: above the interval of the observations they overtake each other.
    pub extra_delay_s: f64,
    /// No delay is longer, apart from outages, s.
    pub most_delay_s: f64,
    /// When the gateway cannot forward.
    pub cut_off: Vec<StoreAndForward>,
    /// Observations that it keeps meanwhile; more are lost.
    pub store: usize,
    /// How many of them it forwards per second afterwards.
    pub forwarded_per_s: f64,
}

/// A time in which the gateway stores and does not forward.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoreAndForward {
    /// When it begins, s after the start.
    pub from_s: f64,
    /// When it is over, s after the start.
    pub until_s: f64,
}

impl Default for LinkSpec {
    fn default() -> Self {
        Self {
            lost_good: 0.002,
            lost_bad: 0.5,
            to_bad: 0.001,
            to_good: 0.05,
            duplicated: 0.002,
            least_delay_s: 0.02,
            extra_delay_s: 0.05,
            most_delay_s: 5.0,
            cut_off: Vec::new(),
            store: 100_000,
            forwarded_per_s: 2_000.0,
        }
    }
}

impl LinkSpec {
    /// Everything arrives at once, once, in order.
    pub const fn perfect() -> Self {
        Self {
            lost_good: 0.0,
            lost_bad: 0.0,
            to_bad: 0.0,
            to_good: 1.0,
            duplicated: 0.0,
            least_delay_s: 0.0,
            extra_delay_s: 0.0,
            most_delay_s: 0.0,
            cut_off: Vec::new(),
            store: 0,
            forwarded_per_s: 1.0,
        }
    }

    fn check(&self) -> Result<(), SimulationError> {
        for (name, found) in [
            ("lost_good", self.lost_good),
            ("lost_bad", self.lost_bad),
            ("to_bad", self.to_bad),
            ("to_good", self.to_good),
            ("duplicated", self.duplicated),
        ] {
            check_share(name, found)?;
        }
        check_within("least_delay_s", self.least_delay_s, 0.0, 3600.0, "0 to 3600 s")?;
        check_within("extra_delay_s", self.extra_delay_s, 0.0, 3600.0, "0 to 3600 s")?;
        check_within(
            "most_delay_s",
            self.most_delay_s,
            self.least_delay_s,
            3600.0,
            "least_delay_s to 3600 s",
        )?;
        check_within("forwarded_per_s", self.forwarded_per_s, 0.1, 1e9, "0.1 or more per s")?;
        let mut before_s = f64::NEG_INFINITY;
        for cut in &self.cut_off {
            check_within("from_s", cut.from_s, before_s, f64::MAX, "after the cut before it")?;
            check_within("until_s", cut.until_s, cut.from_s, f64::MAX, "not before from_s")?;
            before_s = cut.until_s;
        }
        Ok(())
    }
}

/// What becomes of an observation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Fate {
    Lost,
    /// The gateway's store is full.
    Dropped,
    Arrives {
        at_s: f64,
        again_s: Option<f64>,
    },
}

/// A link in use.
#[derive(Debug, Clone)]
pub(crate) struct Link {
    spec: LinkSpec,
    rng: ChaCha8Rng,
    bad: bool,
    /// The cut that was met last, and what it has stored.
    cut: Option<usize>,
    stored: usize,
}

impl Link {
    pub fn new(spec: &LinkSpec, key: Key) -> Result<Self, SimulationError> {
        spec.check()?;
        Ok(Self { spec: spec.clone(), rng: key.stream(), bad: false, cut: None, stored: 0 })
    }

    pub fn fate(&mut self, time_s: f64) -> Fate {
        let spec = &self.spec;
        let rng = &mut self.rng;
        // Always the same draws, so that another setting changes no other observation.
        let [turn, lost, twice] = [(); 3].map(|()| uniform(rng));
        let [first, second] = [(); 2].map(|()| exponential(rng));
        self.bad = if self.bad { turn >= spec.to_good } else { turn < spec.to_bad };
        if lost < if self.bad { spec.lost_bad } else { spec.lost_good } {
            return Fate::Lost;
        }
        let delayed = |draw: f64| (spec.least_delay_s + spec.extra_delay_s * draw).min(spec.most_delay_s);
        let mut at_s = time_s + delayed(first);
        let again_s = (twice < spec.duplicated).then(|| at_s + delayed(second));
        let cut = spec.cut_off.iter().position(|cut| (cut.from_s..cut.until_s).contains(&at_s));
        if let Some(number) = cut {
            if self.cut != Some(number) {
                (self.cut, self.stored) = (Some(number), 0);
            }
            if self.stored >= spec.store {
                return Fate::Dropped;
            }
            self.stored += 1;
            at_s = spec.cut_off[number].until_s + self.stored as f64 / spec.forwarded_per_s;
            // The gateway has one copy only.
            return Fate::Arrives { at_s, again_s: None };
        }
        let again_s =
            again_s.filter(|again| !spec.cut_off.iter().any(|c| (c.from_s..c.until_s).contains(again)));
        Fate::Arrives { at_s, again_s }
    }
}

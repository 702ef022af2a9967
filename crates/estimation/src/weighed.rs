//! The last innovation of each anchor and transmitter: what a method made of what it heard last of whom.
//!
//! A few numbers for each of the sources heard lately, in place: nothing is allocated once they are known.

use adit_core::time::Time;
use alloc::string::String;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// Sources that are remembered; then the one that was heard longest ago is forgotten.
pub const MOST: usize = 16;

/// What was weighed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum WeighedKind {
    /// A range to an anchor.
    Range,
    /// The signal strength of a transmitter.
    Signal,
}

/// An observation held against an estimate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Weighed {
    /// What it was.
    pub kind: WeighedKind,
    /// Number of the anchor or transmitter at its site.
    pub number: u32,
    /// When it was true.
    pub time: Time,
    /// Measured less expected before it counted: m of a range, dB of a signal strength.
    pub residual: f32,
    /// The same squared over its variance as predicted.
    pub nis: f32,
    /// It counted in full: was neither refused, nor weighed down, nor its noise widened.
    pub believed: bool,
}

impl Weighed {
    /// Of a source's number, a time, what it was off (m or dB), over what variance squared, and whether it counted in full.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "numbers of a site are few; an account needs seven digits"
    )]
    pub(crate) fn new(
        (kind, number): (WeighedKind, usize),
        time: Time,
        (residual, nis): (f64, f64),
        believed: bool,
    ) -> Self {
        Self { kind, number: number as u32, time, residual: residual as f32, nis: nis as f32, believed }
    }
}

/// The last of each source.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct LastWeighed(Vec<Weighed>);

/// The last innovation of a source, by the names under which logs may have it.
#[derive(Debug, Clone, PartialEq)]
pub struct SourceWeighed {
    /// Its id at the site, and other names such as a MAC address.
    pub names: Vec<String>,
    /// What was weighed.
    pub last: Weighed,
}

impl LastWeighed {
    /// In place of the one before of the same source, or of the oldest.
    #[inline]
    pub(crate) fn note(&mut self, weighed: Weighed) {
        let Self(all) = self;
        let full = all.len() >= MOST;
        let same = |known: &&mut Weighed| (known.kind, known.number) == (weighed.kind, weighed.number);
        if let Some(known) = all.iter_mut().find(same) {
            *known = weighed;
        } else if let Some(oldest) = all.iter_mut().min_by_key(|known| known.time).filter(|_| full) {
            *oldest = weighed;
        } else {
            all.push(weighed);
        }
    }

    /// All of them, with their names; those without names are left out.
    pub(crate) fn named(&self, names: impl Fn(WeighedKind, usize) -> Vec<String>) -> Vec<SourceWeighed> {
        let Self(all) = self;
        let named = all
            .iter()
            .map(|last| SourceWeighed { names: names(last.kind, last.number as usize), last: *last });
        named.filter(|source| !source.names.is_empty()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn range(number: usize, seconds: i64) -> Weighed {
        Weighed::new(
            (WeighedKind::Range, number),
            Time::from_nanos(seconds * 1_000_000_000),
            (0.1, 1.0),
            true,
        )
    }

    #[test]
    fn the_last_of_each_source_stays_and_the_oldest_source_goes() {
        let mut last = LastWeighed::default();
        let number = |number: usize| alloc::vec![alloc::format!("a{number}")];
        for second in 0..100 {
            last.note(range(0, second));
            last.note(Weighed { kind: WeighedKind::Signal, ..range(0, second) });
        }
        assert_eq!(last.0.len(), 2, "one of each kind");
        for source in 0..3 * MOST {
            last.note(range(1 + source, 100 + i64::try_from(source).unwrap_or_default()));
        }
        assert_eq!(last.0.len(), MOST);
        let named = last.named(|_, source| number(source));
        assert!(named.iter().all(|source| source.last.number as usize > 2 * MOST), "{named:?}");
        assert!(last.named(|_, _| Vec::new()).is_empty());
    }
}

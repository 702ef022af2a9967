//! The parameters of a search: which settings, from where to where, and what a point of the search stands for.
//!
//! A coordinate of a point goes from −1, the least value, over 0, the setting as it is, to 1, the largest; between them it is
//! even in the logarithm. So every optimiser begins about the setting as it is, and one that pulls towards zero pulls towards that.

use crate::config;
use crate::method::MethodName;
use adit_estimation::methods::NoiseParameter;
use anyhow::{Result, bail};
use serde::{Deserialize, Serialize};
use toml::Value;

/// How near to a bound, as a share of the way there, a value counts as being at it.
const AT_BOUND: f64 = 0.99;

/// One setting that is searched.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parameter {
    /// Where it stands in the settings, names with dots between them.
    pub name: String,
    /// Its value now.
    pub default: f64,
    /// Least value.
    pub least: f64,
    /// Largest value.
    pub largest: f64,
}

/// Which bound a value is at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Bound {
    /// The least value.
    Least,
    /// The largest.
    Largest,
}

/// All that is searched.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters(pub Vec<Parameter>);

impl Parameter {
    /// Least and largest coordinate: 0 on a side on which there is nowhere to go.
    fn bounds(&self) -> [f64; 2] {
        let side = |away: bool, bound: f64| if away { bound } else { 0.0 };
        [side(self.least < self.default, -1.0), side(self.largest > self.default, 1.0)]
    }

    /// What a coordinate stands for.
    fn value(&self, coordinate: f64) -> f64 {
        let towards = if coordinate < 0.0 { self.least } else { self.largest };
        let value = self.default * (towards / self.default).powf(coordinate.abs());
        value.clamp(self.least, self.largest)
    }

    /// The bound at which a value is.
    pub fn at_bound(&self, value: f64) -> Option<Bound> {
        let share = |towards: f64| (value / self.default).ln() / (towards / self.default).ln();
        if value < self.default && share(self.least) >= AT_BOUND {
            Some(Bound::Least)
        } else if value > self.default && share(self.largest) >= AT_BOUND {
            Some(Bound::Largest)
        } else {
            None
        }
    }
}

impl Parameters {
    /// Those of a method that were asked for, all where none were ([`TuneArgs::contradiction`](crate::args::TuneArgs::contradiction) has looked at the names); `settings` are those of each run. Warnings come along.
    pub fn choose(
        method: MethodName,
        asked: &[String],
        settings: &[toml::Table],
    ) -> Result<(Self, Vec<String>)> {
        let (mut chosen, mut warnings) = (Vec::new(), Vec::new());
        for NoiseParameter { path, least, largest } in method.noise_parameters() {
            if !asked.is_empty() && !asked.iter().any(|name| name == path) {
                continue;
            }
            let values: Vec<f64> = settings.iter().filter_map(|table| number(table, path)).collect();
            let Some(default) = values.first().copied().filter(|value| value.is_finite() && *value > 0.0)
            else {
                let what = format!(
                    "{path} is not above 0 with these settings, by which it cannot be searched: the sidecar or --config can give it a value"
                );
                if !asked.is_empty() {
                    bail!("{what}");
                }
                warnings.push(what);
                continue;
            };
            if let Some(other) = values.iter().find(|value| value.to_bits() != default.to_bits()) {
                warnings.push(format!(
                    "{path} differs between the runs by their sidecars ({default} and {other}): one value for all is searched, from the first"
                ));
            }
            let (least, largest) = (least.min(default), largest.max(default));
            chosen.push(Parameter { name: (*path).to_owned(), default, least, largest });
        }
        if chosen.is_empty() {
            bail!("{}: no noise parameter is above 0 with these settings", method.name());
        }
        Ok((Self(chosen), warnings))
    }

    /// Bounds of a point of the search.
    pub fn bounds(&self) -> Vec<[f64; 2]> {
        self.0.iter().map(Parameter::bounds).collect()
    }

    /// What a point of the search stands for.
    pub fn values(&self, point: &[f64]) -> Vec<f64> {
        self.0.iter().zip(point).map(|(parameter, coordinate)| parameter.value(*coordinate)).collect()
    }

    /// The same in four digits, as they are written: more would say nothing.
    pub fn rounded(&self, point: &[f64]) -> Vec<f64> {
        let round = |value: f64| format!("{value:.3e}").parse().unwrap_or(value);
        self.values(point).into_iter().map(round).collect()
    }

    /// The settings as they are.
    pub fn defaults(&self) -> Vec<f64> {
        self.0.iter().map(|parameter| parameter.default).collect()
    }

    /// Values as a table of their own.
    pub fn table(&self, values: &[f64]) -> toml::Table {
        let mut all = toml::Table::new();
        for (parameter, value) in self.0.iter().zip(values) {
            let mut names: Vec<&str> = parameter.name.split('.').collect();
            let Some(last) = names.pop() else { continue };
            let mut inner = toml::Table::from_iter([(last.to_owned(), Value::Float(*value))]);
            for name in names.into_iter().rev() {
                inner = toml::Table::from_iter([(name.to_owned(), Value::Table(inner))]);
            }
            config::merge(&mut all, inner);
        }
        all
    }

    /// Puts values in the place of those of a table.
    pub fn put(&self, table: &mut toml::Table, values: &[f64]) {
        for (parameter, value) in self.0.iter().zip(values) {
            if let Some(place) = place(table, &parameter.name) {
                *place = Value::Float(*value);
            }
        }
    }
}

/// A number of the settings.
fn number(table: &toml::Table, path: &str) -> Option<f64> {
    let mut names = path.split('.');
    let first = table.get(names.next()?)?;
    let value = names.try_fold(first, |value, name| value.get(name))?;
    value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))
}

/// Where a number of the settings stands.
fn place<'t>(table: &'t mut toml::Table, path: &str) -> Option<&'t mut Value> {
    let mut names = path.split('.');
    let first = table.get_mut(names.next()?)?;
    names.try_fold(first, |value, name| value.get_mut(name))
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::method::with_settings;
    use clap::ValueEnum;

    /// With the bounds around it: what every optimiser relies on.
    #[test]
    fn every_noise_parameter_of_every_method_is_a_setting_within_its_bounds() {
        let mut searched = 0;
        for method in MethodName::value_variants() {
            let settings = with_settings!(*method, S => toml::Table::try_from(S::default())).unwrap();
            for NoiseParameter { path, least, largest } in method.noise_parameters() {
                let value = number(&settings, path);
                let inside = value.is_some_and(|v| *least < v && v < *largest) && *least > 0.0;
                assert!(inside, "{} {path}: {value:?} in {least} to {largest}", method.name());
                searched += 1;
            }
        }
        assert!(searched > 50, "{searched}");
    }

    fn parameter() -> Parameter {
        Parameter { name: "noise.field_ut".into(), default: 1.0, least: 0.1, largest: 1000.0 }
    }

    #[test]
    fn the_middle_is_the_default_and_the_ends_are_the_bounds() {
        let parameter = parameter();
        for (coordinate, expected) in [(-1.0, 0.1), (0.0, 1.0), (1.0, 1000.0), (1.0 / 3.0, 10.0)] {
            // Rounding of a power.
            assert!((parameter.value(coordinate) / expected - 1.0).abs() < 1e-12, "{coordinate}");
        }
        assert_eq!(parameter.at_bound(0.1), Some(Bound::Least));
        assert_eq!(parameter.at_bound(990.0), Some(Bound::Largest));
        assert_eq!((parameter.at_bound(0.2), parameter.at_bound(1.0)), (None, None));
    }

    #[test]
    fn a_default_on_its_bound_is_searched_on_the_other_side() {
        let lowest = Parameter { least: 1.0, ..parameter() };
        assert_eq!(lowest.bounds().map(f64::to_bits), [0.0_f64, 1.0].map(f64::to_bits));
        assert_eq!(lowest.at_bound(1.0), None);
    }
}

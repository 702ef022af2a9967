//! Candidates for how ranges of one kind err, and the choice by groups held out.

use super::curve;
use super::folds::{Row, Rows};
use super::offsets::Offsets;
use super::polynomial::{self, PolynomialParams, RangePair};
use adit_estimation::ranging::correction::{Diagnostic, ErrorModel};
use serde::{Serialize, Serializer};

/// Which ranges a model is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// All.
    Unjudged,
    /// Those that came straight.
    Straight,
    /// Those that did not: of these a polynomial is tried too.
    Nlos,
}

/// What was tried and what was chosen.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Choice {
    /// All that was tried, from plain to rich.
    pub tried: Vec<Tried>,
    /// Which of it was chosen.
    #[serde(skip)]
    pub index: usize,
    /// Its name.
    pub chosen: String,
}

/// One that was tried.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tried {
    /// Its name.
    pub name: String,
    /// How rich it is.
    #[serde(skip)]
    pub tier: usize,
    /// Mean absolute error of each group held out, m; written as their mean.
    #[serde(rename = "mae_m", serialize_with = "as_mean")]
    pub errors_m: Vec<f64>,
}

impl Tried {
    /// Mean absolute error over the groups, m.
    pub fn mae_m(&self) -> f64 {
        self.errors_m.iter().sum::<f64>() / self.errors_m.len().max(1) as f64
    }

    /// By how much it is worse than another, m, and the standard error of that over the groups.
    fn worse_than(&self, other: &Self) -> (f64, f64) {
        let apart: Vec<f64> = self.errors_m.iter().zip(&other.errors_m).map(|(a, b)| a - b).collect();
        let count = apart.len() as f64;
        let mean = apart.iter().sum::<f64>() / count;
        let square = apart.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
        (mean, (square / (count * (count - 1.0).max(1.0))).sqrt())
    }
}

fn as_mean<S: Serializer>(errors: &[f64], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_f64(errors.iter().sum::<f64>() / errors.len().max(1) as f64)
}

/// The plainest that is not worse than the best by more than the standard error of that; of equally plain ones the best.
pub(super) fn pick(tried: Vec<Tried>) -> Choice {
    let better = |a: &usize, b: &usize| tried[*a].mae_m().total_cmp(&tried[*b].mae_m());
    let best = (0..tried.len()).min_by(better).unwrap_or(0);
    let good = |index: &usize| {
        let (worse, error) = tried[*index].worse_than(&tried[best]);
        *index == best || worse <= error
    };
    let plainest = (0..tried.len()).filter(good).map(|index| tried[index].tier).min();
    let of_tier = (0..tried.len()).filter(good).filter(|index| Some(tried[*index].tier) == plainest);
    let index = of_tier.min_by(better).unwrap_or(best);
    Choice { chosen: tried[index].name.clone(), index, tried }
}

/// How ranges of one kind may err.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Candidate {
    Nothing,
    Constant,
    Polynomial(usize),
    Curve(Diagnostic),
}

/// Polynomials up to this degree.
const DEGREES: usize = 3;
/// Long tails.
const DOF: f64 = 3.0;
/// A device tells a diagnostic when it does of this share of its ranges.
const TOLD: f64 = 0.9;
/// No range is better than this, m.
const LEAST_SIGMA_M: f64 = 0.01;

impl Candidate {
    fn all(rows: &Rows<'_>, kind: Kind) -> Vec<Self> {
        let told = |diagnostic: &Diagnostic| {
            let count = rows.rows.iter().filter(|row| diagnostic.of(&row.known.range).is_some()).count();
            count as f64 >= TOLD * rows.rows.len() as f64
        };
        let polynomials = if kind == Kind::Nlos { DEGREES } else { 0 };
        [Self::Nothing, Self::Constant]
            .into_iter()
            .chain((1..=polynomials).map(Self::Polynomial))
            .chain(Diagnostic::ALL.into_iter().filter(told).map(Self::Curve))
            .collect()
    }

    /// How rich it is.
    const fn tier(self) -> usize {
        match self {
            Self::Nothing => 0,
            Self::Constant | Self::Polynomial(_) | Self::Curve(_) => 1,
        }
    }

    fn name(self) -> String {
        match self {
            Self::Nothing => "nothing".to_owned(),
            Self::Constant => "constant".to_owned(),
            Self::Polynomial(degree) => format!("polynomial of degree {degree}"),
            Self::Curve(diagnostic) => format!("curve of {}", diagnostic.name()),
        }
    }

    /// Fitted; the spread is left to [`spread`].
    fn fit(self, rows: &Rows<'_>, offsets: &Offsets) -> ErrorModel {
        let nothing = ErrorModel { sigma_m: LEAST_SIGMA_M, polynomial: None, curve: None };
        let measured = |row: &Row<'_>| row.known.range.range_m - offsets.of(row.known.range.anchor.as_str());
        match self {
            Self::Nothing => nothing,
            Self::Constant => {
                let curve = curve::fit(rows, offsets, Diagnostic::Range, 1);
                ErrorModel { curve, ..nothing }
            }
            Self::Polynomial(degree) => {
                let pair = |row: &Row<'_>| RangePair { measured_m: measured(row), true_m: row.known.true_m };
                let pairs: Vec<RangePair> = rows.rows.iter().map(pair).collect();
                let fitted = polynomial::fit(&pairs, &PolynomialParams { degree, dof: DOF });
                ErrorModel { polynomial: fitted.ok(), ..nothing }
            }
            Self::Curve(diagnostic) => {
                let knots = curve::knots_for(rows);
                ErrorModel { curve: curve::fit(rows, offsets, diagnostic, knots), ..nothing }
            }
        }
    }
}

/// What is left of a range's error after offset and model, m.
fn residual(row: &Row<'_>, offsets: &Offsets, model: &ErrorModel) -> f64 {
    let range = &row.known.range;
    let without_offset = range.range_m - offsets.of(range.anchor.as_str());
    let (too_long, _) = model.expected(range, without_offset);
    without_offset - too_long - row.known.true_m
}

/// Which model of these ranges their groups ask for, held out in turn; its spread is that of the ranges held out.
pub(super) fn choose(rows: &Rows<'_>, offsets: &Offsets, kind: Kind) -> (ErrorModel, Choice) {
    let candidates = Candidate::all(rows, kind);
    let folds = rows.folds();
    let mut tried = Vec::new();
    let mut left = Vec::new();
    for candidate in &candidates {
        let (mut errors_m, mut residuals) = (Vec::new(), Vec::new());
        for (kept, held) in &folds {
            let model = candidate.fit(kept, offsets);
            let of_held: Vec<f64> = held.rows.iter().map(|row| residual(row, offsets, &model)).collect();
            errors_m.extend(held.group_means(&of_held.iter().map(|value| value.abs()).collect::<Vec<_>>()));
            residuals.extend(held.rows.iter().copied().zip(of_held));
        }
        tried.push(Tried { name: candidate.name(), tier: candidate.tier(), errors_m });
        left.push(residuals);
    }
    let choice = pick(tried);
    let mut model = candidates[choice.index].fit(rows, offsets);
    let rms = |residuals: &[(Row<'_>, f64)]| {
        let sums = residuals.iter().fold([0.0; 2], |[square, weight], (row, value)| {
            [square + row.weight * value * value, weight + row.weight]
        });
        (sums[0] / sums[1]).sqrt().max(LEAST_SIGMA_M)
    };
    // The first candidate takes nothing off: what is left when the device does not tell what a curve needs.
    model.sigma_m = rms(&left[0]);
    let chosen = &left[choice.index];
    if let Some(polynomial) = &mut model.polynomial {
        polynomial.sigma_m = rms(chosen);
    }
    if let Some(curve) = &mut model.curve {
        curve::spread(curve, chosen, rms(chosen));
    }
    (model, choice)
}

//! A classifier that learns from one source and is tried on another: whether simulated responses teach what recorded ones do.
//!
//! Linear discriminant of the features of [`super::responses`], two classes (line of sight or not), equal priors. Recorded on recorded leaves
//! one geometry out at a time.

use super::responses::Response;
use super::sites::Class;
use adit_core::nalgebra::{SMatrix, SVector};
use std::fmt::Write as _;

type Features = SVector<f64, 9>;

struct Discriminant {
    weights: Features,
    border: f64,
}

/// Features as the discriminant sees them: ratios and counts in logarithms.
fn seen(response: &Response) -> Features {
    let mut features = response.features;
    for index in [0, 1, 4, 8] {
        features[index] = features[index].max(0.1).ln();
    }
    Features::from(features)
}

fn learned<'r>(responses: &(impl Iterator<Item = &'r Response> + Clone)) -> Option<Discriminant> {
    let of = |los: bool| -> Vec<Features> {
        responses.clone().filter(|r| (r.class == Class::Los) == los).map(seen).collect()
    };
    let (yes, no) = (of(true), of(false));
    if yes.is_empty() || no.is_empty() {
        return None;
    }
    let mean = |of: &[Features]| of.iter().sum::<Features>() / of.len() as f64;
    let (a, b) = (mean(&yes), mean(&no));
    let mut covariance = SMatrix::<f64, 9, 9>::identity() * 1e-6;
    for (group, centre) in [(&yes, &a), (&no, &b)] {
        for value in group {
            let off = value - centre;
            covariance += off * off.transpose() / (2.0 * group.len() as f64);
        }
    }
    let weights = covariance.cholesky()?.solve(&(a - b));
    let border = 0.5 * weights.dot(&(a + b));
    Some(Discriminant { weights, border })
}

/// Mean of the shares of either class that are told rightly.
fn balanced<'r>(tested: impl Iterator<Item = (&'r Response, bool)>) -> f64 {
    let mut right = [(0.0, 0.0); 2];
    for (response, told) in tested {
        let los = response.class == Class::Los;
        let entry = &mut right[usize::from(los)];
        entry.0 += f64::from(u8::from(told == los));
        entry.1 += 1.0;
    }
    0.5 * (right[0].0 / right[0].1 + right[1].0 / right[1].1)
}

impl Discriminant {
    fn line_of_sight(&self, response: &Response) -> bool {
        self.weights.dot(&seen(response)) > self.border
    }
}

fn groups(responses: &[Response]) -> Vec<&str> {
    let mut groups: Vec<&str> = responses.iter().map(|r| r.group.as_str()).collect();
    groups.sort_unstable();
    groups.dedup();
    groups
}

fn left_out(responses: &[Response]) -> f64 {
    let told = groups(responses).into_iter().flat_map(|group| {
        let discriminant = learned(&responses.iter().filter(move |r| r.group != group));
        responses
            .iter()
            .filter(move |r| r.group == group)
            .filter_map(move |r| Some((r, discriminant.as_ref()?.line_of_sight(r))))
    });
    balanced(told)
}

fn across(from: &[Response], to: &[Response]) -> f64 {
    let discriminant = learned(&from.iter());
    balanced(to.iter().filter_map(|r| Some((r, discriminant.as_ref()?.line_of_sight(r)))))
}

/// Balanced accuracies of all four ways.
pub fn table(recorded: &[Response], simulated: &[Response]) -> String {
    let mut text = String::from(
        "| linear discriminant of the nine features, LOS or not: balanced accuracy | tried on recorded | tried on simulated |\n|---|---|---|\n",
    );
    let _ = writeln!(
        text,
        "| learned from recorded | {:.3} (geometries left out) | {:.3} |",
        left_out(recorded),
        across(recorded, simulated)
    );
    let _ = writeln!(
        text,
        "| learned from simulated | {:.3} | {:.3} (rooms left out) |",
        across(simulated, recorded),
        left_out(simulated)
    );
    text
}

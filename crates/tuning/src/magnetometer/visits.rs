//! How much of the residual is the sensor's noise and how much the place's.
//!
//! The field of a room is not the same everywhere: a hand that turns a sensor also carries it through gradients. Such an
//! error is common to neighbouring samples, and ten thousand of them at one place know no more about the ellipsoid than ten.
//! Samples are therefore gathered in visits, during which the direction of the field in the sensor changes by less than 20°,
//! and the residual is split in two by a one-way analysis of variance (Searle, Casella & `McCulloch` 1992, section 3.6):
//! `r = place(visit) + noise`. A sample is then weighted by `1/(σ_noise² + n σ_place²)`, n the samples of its visit: where
//! there is only noise all samples count alike, where the place rules every visit does. A place outlasts a visit: the correlation of one visit
//! with the next is measured, and the covariance of the parameters takes it as falling geometrically from visit to visit.

use super::ellipsoid::{Ellipsoid, PARAMETERS};
use super::refine::{ParameterMatrix, derivatives};
use adit_core::nalgebra::{Cholesky, SVector, Vector3};
use std::ops::Range;

/// Cosine of the change of direction that ends a visit, 20°.
const ENDS_AT_COS: f64 = 0.939_692_620_785_908_4;
/// With fewer visits the place cannot be told from the noise.
const FEWEST_VISITS: usize = PARAMETERS + 4;
/// Correlation beyond which a place would never change.
const LONGEST_MEMORY: f64 = 0.98;
/// Finer than any sensor: keeps weights finite where readings have no noise at all.
const FINEST_NOISE: f64 = 1e-9;

/// The two kinds of error of the field's length, as shares of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errors {
    /// σ from sample to sample.
    pub noise: f64,
    /// σ from visit to visit.
    pub place: f64,
    /// Correlation of the place of one visit with that of the next.
    pub memory: f64,
}

impl Errors {
    /// Weight of each of `samples` of one visit.
    pub fn weight(&self, samples: usize) -> f64 {
        1.0 / (self.noise * self.noise + samples as f64 * self.place * self.place)
    }
}

/// Samples of one visit: neighbours in time and direction. Outliers in between belong to it without counting.
#[derive(Debug, Clone)]
pub struct Visit {
    /// Which samples.
    pub samples: Range<usize>,
    /// How many of them count.
    pub counting: usize,
}

/// Gathers samples; those with a residual past `limit` are outliers.
pub fn gather(points: &[Vector3<f64>], ellipsoid: &Ellipsoid, limit: f64) -> Vec<Visit> {
    let mut visits: Vec<Visit> = Vec::new();
    let mut first = Vector3::zeros();
    for (index, point) in points.iter().enumerate() {
        let on_sphere = ellipsoid.on_sphere(point);
        let length = on_sphere.norm();
        if (length - 1.0).abs() > limit {
            continue;
        }
        let direction = on_sphere / length;
        match visits.last_mut() {
            Some(visit) if first.dot(&direction) > ENDS_AT_COS => {
                visit.samples.end = index + 1;
                visit.counting += 1;
            }
            _ => {
                first = direction;
                visits.push(Visit { samples: index..index + 1, counting: 1 });
            }
        }
    }
    visits
}

/// Splits the residuals of the samples that count.
pub fn errors(points: &[Vector3<f64>], ellipsoid: &Ellipsoid, visits: &[Visit], limit: f64) -> Errors {
    let (mut within, mut between, mut samples, mut squares) = (0.0, 0.0, 0.0, 0.0);
    let mut means = Vec::with_capacity(visits.len());
    for visit in visits {
        let residuals = || residuals(points, ellipsoid, visit, limit);
        let count = visit.counting as f64;
        let mean = residuals().sum::<f64>() / count;
        within += residuals().map(|r| (r - mean) * (r - mean)).sum::<f64>();
        between += count * mean * mean;
        means.push(mean);
        samples += count;
        squares += count * count;
    }
    let count = visits.len() as f64;
    let all = ((within + between) / (samples - PARAMETERS as f64).max(1.0)).sqrt().max(FINEST_NOISE);
    if visits.len() < FEWEST_VISITS || samples <= count {
        return Errors { noise: all, place: 0.0, memory: 0.0 };
    }
    let noise = within / (samples - count);
    let mean_square = between / (count - PARAMETERS as f64);
    let samples_of_a_visit = (samples - squares / samples) / (count - 1.0);
    let place = ((mean_square - noise) / samples_of_a_visit).max(0.0);
    // Without a place the split has nothing to add: the sum over all samples is the better estimate.
    if place == 0.0 {
        return Errors { noise: all, place, memory: 0.0 };
    }
    let product = means.windows(2).map(|two| two[0] * two[1]).sum::<f64>() / (count - 1.0);
    let memory = (product / place).clamp(0.0, LONGEST_MEMORY);
    Errors { noise: noise.sqrt().max(FINEST_NOISE), place: place.sqrt(), memory }
}

fn residuals<'a>(
    points: &'a [Vector3<f64>],
    ellipsoid: &'a Ellipsoid,
    visit: &Visit,
    limit: f64,
) -> impl Iterator<Item = f64> + use<'a> {
    points[visit.samples.clone()].iter().map(|p| ellipsoid.residual(p)).filter(move |r| r.abs() <= limit)
}

/// Weight of every sample; 0 for outliers.
pub fn weights(
    points: &[Vector3<f64>],
    ellipsoid: &Ellipsoid,
    visits: &[Visit],
    errors: &Errors,
    limit: f64,
) -> Vec<f64> {
    let mut weights = vec![0.0; points.len()];
    for visit in visits {
        let weight = errors.weight(visit.counting);
        for index in visit.samples.clone() {
            if ellipsoid.residual(&points[index]).abs() <= limit {
                weights[index] = weight;
            }
        }
    }
    weights
}

/// Covariance of the parameters of the weighted fit: `A⁻¹ B A⁻¹` with `A = Σ w J Jᵀ` and B the covariance of `Σ w J r`, in
/// which the samples of a visit share their place.
pub fn covariance(
    points: &[Vector3<f64>],
    ellipsoid: &Ellipsoid,
    visits: &[Visit],
    errors: &Errors,
    limit: f64,
) -> Option<ParameterMatrix> {
    let (mut information, mut scatter) = (ParameterMatrix::zeros(), ParameterMatrix::zeros());
    let mut remembered = SVector::<f64, PARAMETERS>::zeros();
    for visit in visits {
        let weight = errors.weight(visit.counting);
        let mut own = ParameterMatrix::zeros();
        let mut sum = SVector::<f64, PARAMETERS>::zeros();
        for point in &points[visit.samples.clone()] {
            let (residual, slope) = derivatives(ellipsoid, point);
            if residual.abs() <= limit {
                own.ger(1.0, &slope, &slope, 1.0);
                sum += slope;
            }
        }
        information += own * weight;
        let (noise, place) = (weight * errors.noise, sum * (weight * errors.place));
        scatter += own * (noise * noise) + place * place.transpose();
        scatter += place * remembered.transpose() + remembered * place.transpose();
        remembered = (remembered + place) * errors.memory;
    }
    let inverse = Cholesky::new(information)?.inverse();
    Some(inverse * scatter * inverse)
}

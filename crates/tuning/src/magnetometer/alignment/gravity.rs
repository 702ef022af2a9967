//! The rotation that keeps the field at one angle to gravity.
//!
//! `(R w)·û = −sin(dip)` in every calm attitude û (up in the inertial sensor). With the elements of R taken as free this is linear and
//! homogeneous in ten unknowns; refined over R and the dip. The accelerometer's own errors go straight
//! into the result, at a steep dip several times enlarged: the gyro, where there is one, does better (Kok & Schön 2016, section 5).

use super::rotation::{Linear, RotationFit, nearest, step, turned};
use adit_core::nalgebra::{Matrix3, SMatrix, SVector, SymmetricEigen, Vector3};

/// Samples are thinned to this many: neighbours say the same.
const MOST_SAMPLES: usize = 20_000;
const FEWEST_SAMPLES: usize = 100;
/// A sample is taken when field or gravity have turned by this much since the last one, cosine of 5°: between such samples the errors of
/// accelerometer and place are taken as independent.
const APART_COS: f64 = 0.996_194_698_091_745_5;
const STEPS: usize = 12;

/// The rotation from magnetometer to accelerometer axes, or why there is none.
pub fn align(field: &[Option<Vector3<f64>>], up: &[Option<Vector3<f64>>]) -> Result<RotationFit, String> {
    let mut kept: Vec<(Vector3<f64>, Vector3<f64>)> = Vec::new();
    for (field, up) in field.iter().zip(up).filter_map(|(field, up)| Some(((*field)?, (*up)?))) {
        let moved =
            kept.last().is_none_or(|last| last.0.dot(&field) < APART_COS || last.1.dot(&up) < APART_COS);
        if moved && kept.len() < MOST_SAMPLES {
            kept.push((field, up));
        }
    }
    if kept.len() < FEWEST_SAMPLES {
        return Err(format!(
            "gravity was seen in {} calm attitudes 5° apart, expected {FEWEST_SAMPLES} or more",
            kept.len()
        ));
    }
    let (mut rotation, mut sine) = start(&kept).ok_or("gravity gives no start for the axes")?;
    let mut last = None;
    for _ in 0..STEPS {
        let observations: Vec<Linear<4>> = kept
            .iter()
            .map(|(field, up)| {
                let turned = rotation * field;
                let by_rotation = turned.cross(up);
                let slope = SVector::from([by_rotation.x, by_rotation.y, by_rotation.z, -1.0]);
                Linear { residual: turned.dot(up) - sine, slope }
            })
            .collect();
        let Some((change, covariance, scale)) = step(&observations, &SVector::zeros(), &SVector::zeros())
        else {
            break;
        };
        let [x, y, z, sine_change] = change.into();
        rotation = turned(&rotation, &Vector3::new(x, y, z));
        sine += sine_change;
        last = Some((covariance, scale));
        if change.amax() < 1e-9 {
            break;
        }
    }
    let (covariance, scale) = last.ok_or("gravity does not determine the axes")?;
    let sd_rad = Vector3::from_fn(|i, _| covariance[(i, i)].sqrt());
    let horizontal = (1.0 - sine * sine).max(0.0).sqrt();
    Ok(RotationFit { rotation, sd_rad, residual_rad: scale / horizontal.max(0.1) })
}

/// The ten unknowns by homogeneous least squares.
fn start(samples: &[(Vector3<f64>, Vector3<f64>)]) -> Option<(Matrix3<f64>, f64)> {
    let mut scatter = SMatrix::<f64, 10, 10>::zeros();
    for (field, up) in samples {
        let equation =
            SVector::<f64, 10>::from_fn(|e, _| if e == 9 { -1.0 } else { up[e / 3] * field[e % 3] });
        scatter += equation * equation.transpose();
    }
    let eigen = SymmetricEigen::new(scatter);
    let unknowns = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned();
    let rotation = nearest(&Matrix3::from_fn(|r, c| unknowns[3 * r + c]))?;
    let sine =
        samples.iter().map(|(field, up)| (rotation * field).dot(up)).sum::<f64>() / samples.len() as f64;
    Some((rotation, sine))
}

//! The rotation by which the field turns as the gyro says.
//!
//! Over an interval (i, j) the gyro gives the turn `ΔR`; a field that stands still in the room obeys
//! `R w_j = ΔRᵀ R w_i` (w: calibrated field in magnetometer axes). This is linear in the nine elements of R taken as free: their
//! homogeneous least squares starts without any guess, also where axes are swapped. Then R, the gyro's bias and the lag of the
//! magnetometer's stamps are refined together, robustly (in the way of Kok & Schön 2016, who add them to one likelihood with the
//! ellipsoid; the ellipsoid is so much better known that nothing is lost by holding it fixed). `ΔR` and its derivative by the bias are
//! preintegrated (Forster et al. 2017, eq. 35 and appendix B), gyro readings being means over the interval they end.

use super::rotation::{Linear, RotationFit, nearest, step, turned};
use adit_core::attitude::{exp, skew};
use adit_core::nalgebra::{Matrix3, SMatrix, SVector, SymmetricEigen, Vector3};

/// An interval ends when the sensor has turned so far, rad …
const TURN_RAD: f64 = 0.7;
/// … or after this time, s.
const LONGEST_S: f64 = 2.0;
/// Gyro readings farther apart are a hole that no interval crosses, s.
const HOLE_S: f64 = 0.1;
const MOST_INTERVALS: usize = 3000;
const FEWEST_INTERVALS: usize = 20;
const STEPS: usize = 12;
/// What is known beforehand of bias (rad/s) and lag (s), σ.
const BIAS_SD: f64 = 0.2;
const LAG_SD_S: f64 = 0.05;
const PARAMETERS: usize = 7;

/// What the gyro tells.
pub struct GyroAlignment {
    /// The rotation.
    pub fit: RotationFit,
    /// Bias of the gyro, rad/s.
    pub bias_rad_s: Vector3<f64>,
    /// Its σ, rad/s.
    pub bias_sd_rad_s: Vector3<f64>,
    /// Magnetometer after gyro, s.
    pub lag_s: f64,
    /// Its σ, s.
    pub lag_sd_s: f64,
}

struct Rates<'a> {
    times: &'a [f64],
    rates: &'a [Vector3<f64>],
}

/// A turn and what a bias makes of it.
struct Turn {
    rotation: Matrix3<f64>,
    by_bias: Matrix3<f64>,
    /// Rates at its start and end, rad/s.
    ends: [Vector3<f64>; 2],
}

impl Rates<'_> {
    /// The reading that holds at a time.
    fn index(&self, time: f64) -> usize {
        self.times.partition_point(|t| *t < time).min(self.times.len() - 1)
    }

    /// The turn from one time to another; `None` where the gyro was silent.
    fn turn(&self, from: f64, to: f64, bias: &Vector3<f64>) -> Option<Turn> {
        let (first, last) = (self.index(from), self.index(to));
        if from < *self.times.first()? || to > *self.times.last()? {
            return None;
        }
        let (mut rotation, mut by_bias) = (Matrix3::identity(), Matrix3::zeros());
        let mut at = from;
        for index in first..=last {
            let until = self.times[index].min(to);
            let interval = until - at;
            if interval > HOLE_S {
                return None;
            }
            let angle = (self.rates[index] - bias) * interval;
            let own = exp(&angle).to_rotation_matrix().into_inner();
            by_bias = own.transpose() * by_bias - (Matrix3::identity() - 0.5 * skew(&angle)) * interval;
            rotation *= own;
            at = until;
        }
        Some(Turn { rotation, by_bias, ends: [self.rates[first] - bias, self.rates[last] - bias] })
    }
}

/// Samples of the field at both ends of an interval.
struct Ends {
    times: [f64; 2],
    field: [Vector3<f64>; 2],
}

/// The rotation from magnetometer to gyro axes, or why there is none.
pub fn align(
    field_s: &[f64],
    field: &[Option<Vector3<f64>>],
    gyro_s: &[f64],
    rates: &[Vector3<f64>],
) -> Result<GyroAlignment, String> {
    let rates = Rates { times: gyro_s, rates };
    let ends = intervals(field_s, field, &rates);
    if ends.len() < FEWEST_INTERVALS {
        return Err(format!(
            "the gyro shares {} intervals of turning with the magnetometer, expected {FEWEST_INTERVALS} or more",
            ends.len()
        ));
    }
    let mut rotation = start(&ends, &rates).ok_or("the gyro gives no start for the axes")?;
    let (mut bias_rad_s, mut lag_s) = (Vector3::zeros(), 0.0);
    let prior = SVector::<f64, PARAMETERS>::from([
        0.0,
        0.0,
        0.0,
        BIAS_SD.powi(-2),
        BIAS_SD.powi(-2),
        BIAS_SD.powi(-2),
        LAG_SD_S.powi(-2),
    ]);
    let mut last = None;
    for _ in 0..STEPS {
        let observations = linearise(&ends, &rates, &rotation, &bias_rad_s, lag_s);
        let b = bias_rad_s;
        let known = SVector::<f64, PARAMETERS>::from([0.0, 0.0, 0.0, b.x, b.y, b.z, lag_s]);
        let Some((change, covariance, scale)) = step(&observations, &prior, &known) else { break };
        let [rx, ry, rz, bx, by, bz, lag] = change.into();
        rotation = turned(&rotation, &Vector3::new(rx, ry, rz));
        bias_rad_s += Vector3::new(bx, by, bz);
        lag_s += lag;
        last = Some((covariance, scale));
        if change.amax() < 1e-9 {
            break;
        }
    }
    let (covariance, residual_rad) = last.ok_or("the gyro does not determine the axes")?;
    let sd_rad = Vector3::from_fn(|i, _| covariance[(i, i)].sqrt());
    let bias_sd_rad_s = Vector3::from_fn(|i, _| covariance[(3 + i, 3 + i)].sqrt());
    let fit = RotationFit { rotation, sd_rad, residual_rad };
    Ok(GyroAlignment { fit, bias_rad_s, bias_sd_rad_s, lag_s, lag_sd_s: covariance[(6, 6)].sqrt() })
}

/// Disjoint intervals of turning, at most [`MOST_INTERVALS`], spread over the log.
fn intervals(field_s: &[f64], field: &[Option<Vector3<f64>>], rates: &Rates<'_>) -> Vec<Ends> {
    if rates.times.is_empty() {
        return Vec::new();
    }
    let mut found = Vec::new();
    let mut open: Option<(f64, Vector3<f64>)> = None;
    let (mut turned, mut at) = (0.0, 0);
    for (time, field) in field_s.iter().zip(field) {
        while at < rates.times.len() && rates.times[at] < *time {
            if at > 0 {
                turned += rates.rates[at].norm() * (rates.times[at] - rates.times[at - 1]);
            }
            at += 1;
        }
        let Some(field) = field else { continue };
        match open {
            Some((from, _)) if turned < TURN_RAD && time - from < LONGEST_S => {}
            Some((from, first)) => {
                found.push(Ends { times: [from, *time], field: [first, *field] });
                (open, turned) = (Some((*time, *field)), 0.0);
            }
            None => (open, turned) = (Some((*time, *field)), 0.0),
        }
    }
    let stride = found.len().div_ceil(MOST_INTERVALS).max(1);
    found.into_iter().step_by(stride).collect()
}

/// The nine elements by homogeneous least squares, made a rotation.
fn start(ends: &[Ends], rates: &Rates<'_>) -> Option<Matrix3<f64>> {
    let mut scatter = SMatrix::<f64, 9, 9>::zeros();
    for Ends { times: [from, to], field: [before, after] } in ends {
        let Some(turn) = rates.turn(*from, *to, &Vector3::zeros()) else { continue };
        let back = turn.rotation.transpose();
        // Row r of `R w_j − ΔRᵀ R w_i`, by the elements of R, row by row.
        let equations = SMatrix::<f64, 3, 9>::from_fn(|r, element| {
            let (row, column) = (element / 3, element % 3);
            let own = if row == r { after[column] } else { 0.0 };
            own - back[(r, row)] * before[column]
        });
        scatter += equations.transpose() * equations;
    }
    let eigen = SymmetricEigen::new(scatter);
    let elements = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned();
    nearest(&Matrix3::from_fn(|r, c| elements[3 * r + c]))
}

fn linearise(
    ends: &[Ends],
    rates: &Rates<'_>,
    rotation: &Matrix3<f64>,
    bias: &Vector3<f64>,
    lag: f64,
) -> Vec<Linear<PARAMETERS>> {
    let mut observations = Vec::with_capacity(3 * ends.len());
    for Ends { times: [from, to], field: [before, after] } in ends {
        let Some(turn) = rates.turn(from - lag, to - lag, bias) else { continue };
        let back = turn.rotation.transpose();
        let (before, after) = (rotation * before, rotation * after);
        let expected = back * before;
        let by_rotation = back * skew(&before) - skew(&after);
        let by_bias = -(skew(&expected) * turn.by_bias);
        let by_lag = -(turn.ends[1].cross(&expected) - back * turn.ends[0].cross(&before));
        for axis in 0..3 {
            let slope = SVector::from_fn(|p, _| match p {
                0..3 => by_rotation[(axis, p)],
                3..6 => by_bias[(axis, p - 3)],
                _ => by_lag[axis],
            });
            observations.push(Linear { residual: (after - expected)[axis], slope });
        }
    }
    observations
}

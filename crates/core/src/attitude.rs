//! Rotation algebra: unit quaternions, rotation vectors, direction cosine matrices.
//!
//! Quaternions are nalgebra's [`UnitQuaternion`] (Hamilton product, `i j = k`); [`Attitude`] turns body into
//! navigation coordinates. nalgebra stores the scalar last; only `wxyz`/`xyzw` constructors meet files.
//!
//! Sources: Solà, *Quaternion kinematics for the error-state Kalman filter* (2017), §4 and eq. 183;
//! Savage, *Strapdown inertial navigation integration algorithm design* (1998), part 1.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

/// Body-to-navigation rotation, `C_b^n` as a unit quaternion.
pub type Attitude = UnitQuaternion<f64>;

/// Below this squared angle (rad²) the series of [`exp`] is exact to the last bit of an `f64`.
const SMALL_ANGLE_SQUARED: f64 = 1e-4;

/// Rotation vector (rad) to unit quaternion: `exp(θ/2)`, Solà 2017 eq. 101.
///
/// Small angles, as a gyro gives at its sampling rate, take a four-term series and no trigonometry.
///
/// ```
/// use adit_core::{attitude, nalgebra::Vector3};
/// let quarter_turn = attitude::exp(&Vector3::new(0.0, 0.0, core::f64::consts::FRAC_PI_2));
/// let north = quarter_turn * Vector3::x();
/// assert!((north - Vector3::y()).norm() < 1e-15);
/// ```
#[inline]
pub fn exp(rotation_vector: &Vector3<f64>) -> UnitQuaternion<f64> {
    let angle_squared = rotation_vector.norm_squared();
    let (scalar, vector_gain) = if angle_squared < SMALL_ANGLE_SQUARED {
        // cos(θ/2) and sin(θ/2)/θ to θ⁶: the next terms are below 2⁻⁵³ here.
        let s = angle_squared;
        (
            1.0 - s / 8.0 * (1.0 - s / 48.0 * (1.0 - s / 120.0)),
            0.5 * (1.0 - s / 24.0 * (1.0 - s / 80.0 * (1.0 - s / 168.0))),
        )
    } else {
        let angle = libm::sqrt(angle_squared);
        let (sin, cos) = libm::sincos(0.5 * angle);
        (cos, sin / angle)
    };
    UnitQuaternion::new_unchecked(Quaternion::from_parts(scalar, rotation_vector * vector_gain))
}

/// Unit quaternion to the shortest rotation vector, rad; inverse of [`exp`] for angles up to π.
pub fn log(q: &UnitQuaternion<f64>) -> Vector3<f64> {
    let sign = if q.w < 0.0 { -1.0 } else { 1.0 };
    let vector = q.imag() * sign;
    let sin_half = libm::sqrt(vector.norm_squared());
    if sin_half < 1e-9 {
        return vector * 2.0;
    }
    vector * (2.0 * libm::atan2(sin_half, q.w * sign) / sin_half)
}

/// Cross-product matrix: `skew(a) b = a × b`.
#[inline]
pub fn skew(a: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::new(0.0, -a.z, a.y, a.z, 0.0, -a.x, -a.y, a.x, 0.0)
}

/// Product `q ∘ exp(θ)` renormalised to first order: the strapdown attitude update by a body rotation.
///
/// One Newton step of the inverse square root keeps the norm at 1 within 4e-16 however long the log is.
#[inline]
pub fn turn_body(q: &Attitude, body_rotation: &Vector3<f64>) -> Attitude {
    renormalise(q * exp(body_rotation))
}

/// Product `exp(φ) ∘ q`: feeds a navigation-frame attitude error (rad) back into the attitude.
#[inline]
pub fn turn_navigation(q: &Attitude, navigation_rotation: &Vector3<f64>) -> Attitude {
    renormalise(exp(navigation_rotation) * q)
}

#[inline]
fn renormalise(q: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    let q = q.into_inner();
    let gain = 1.5 - 0.5 * q.norm_squared();
    UnitQuaternion::new_unchecked(q * gain)
}

/// Attitude that levels a specific force measured at rest, with the given heading of the body's x axis.
///
/// Roll and pitch come from gravity, whatever way up the sensor is mounted (Groves 2013, eq. 5.101, in z-up form).
/// `heading_rad` is the compass heading of the body x axis projected on the level; where x is within 2.6° of the
/// vertical the body z axis takes its place.
/// `None` when the specific force is zero, or it, its norm or the heading is not finite.
pub fn level(specific_force: &Vector3<f64>, heading_rad: f64) -> Option<Attitude> {
    let norm = specific_force.norm();
    // An overflowing norm would otherwise make a zero vector of a finite force.
    if !norm.is_finite() || !heading_rad.is_finite() {
        return None;
    }
    let up = specific_force.try_normalize(f64::MIN_POSITIVE)?;
    // Horizontal direction nearest to the reference axis of the body.
    let reference = if up.x.abs() < 0.999 { Vector3::x() } else { Vector3::z() };
    let forward = (reference - up * up.dot(&reference)).try_normalize(f64::MIN_POSITIVE)?;
    let left = up.cross(&forward);
    // Rows are the navigation axes (east, north, up) seen from the body, for a heading of 90° (forward = east).
    let levelled = Matrix3::from_rows(&[forward.transpose(), left.transpose(), up.transpose()]);
    let attitude = from_matrix(&levelled);
    let turn = core::f64::consts::FRAC_PI_2 - heading_rad;
    Some(turn_navigation(&attitude, &Vector3::new(0.0, 0.0, turn)))
}

/// Direction cosine matrix to unit quaternion (Shepperd 1978: the largest component first, so that nothing is divided
/// by a small number).
pub fn from_matrix(c: &Matrix3<f64>) -> UnitQuaternion<f64> {
    let trace = c.trace();
    let squares = [
        1.0 + trace,
        1.0 + 2.0 * c[(0, 0)] - trace,
        1.0 + 2.0 * c[(1, 1)] - trace,
        1.0 + 2.0 * c[(2, 2)] - trace,
    ];
    let xy = c[(0, 1)] + c[(1, 0)];
    let xz = c[(0, 2)] + c[(2, 0)];
    let yz = c[(1, 2)] + c[(2, 1)];
    let wx = c[(2, 1)] - c[(1, 2)];
    let wy = c[(0, 2)] - c[(2, 0)];
    let wz = c[(1, 0)] - c[(0, 1)];
    let largest = (1..4).fold(0, |best, i| if squares[i] > squares[best] { i } else { best });
    let (w, x, y, z) = match largest {
        0 => (squares[0], wx, wy, wz),
        1 => (wx, squares[1], xy, xz),
        2 => (wy, xy, squares[2], yz),
        _ => (wz, xz, yz, squares[3]),
    };
    UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z))
}

/// Heading of the body's x axis: compass angle from north, clockwise, in (−π, π] rad.
pub fn heading(q: &Attitude) -> f64 {
    let x = q * Vector3::x();
    libm::atan2(x.x, x.y)
}

/// Smallest signed difference `a − b` of two angles, in (−π, π] rad.
pub fn angle_difference(a: f64, b: f64) -> f64 {
    let turn = core::f64::consts::TAU;
    let d = (a - b) % turn;
    if d > core::f64::consts::PI {
        d - turn
    } else if d <= -core::f64::consts::PI {
        d + turn
    } else {
        d
    }
}

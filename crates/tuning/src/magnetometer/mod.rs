//! Hard and soft iron of a magnetometer from a tumble: `field = matrix · (reading − offset)`.
//!
//! A magnetometer turned every way in a constant field reads the points of an ellipsoid. Its centre is the hard iron (magnets,
//! the sensor's zero), its shape the soft iron (steel, scales, axes that are not square). Steps:
//!
//! | step | module | source |
//! |---|---|---|
//! | a start that most points agree with | `start` | Li & Griffiths 2004; Rousseeuw 1984 |
//! | robust least squares of the field's length | `refine` | Renaudin, Afzal & Lachapelle 2010 |
//! | noise of the sensor, unevenness of the place; weights, covariance | `visits` | analysis of variance |
//! | was enough of the sphere seen? | `coverage` | optimal design |
//! | the residual on samples left out of the fit | here | 5-fold cross-validation |
//! | axes of the magnetometer against those of the inertial sensor, dip | `alignment` | Kok & Schön 2016 |
//!
//! Everything is in sensor axes. Limits: one constant calibration (no temperature, no currents that come and go); the
//! field's true length cannot be seen from within and comes from outside, else the sensor's own scale stands (`det = 1`).

mod alignment;
mod clock;
mod coverage;
mod ellipsoid;
mod refine;
mod report;
mod start;
mod visits;

pub use alignment::{Alignment, AlignmentSource};
pub use coverage::{CELLS, Coverage, Direction, LARGEST_ERROR};
pub use report::{MagnetometerFit, Spread};

use crate::error::TuningError;
use crate::robust;
use crate::series::Series;
use adit_core::nalgebra::{Matrix3, SVector, SymmetricEigen, Vector3};
use adit_observation::sidecar::MagnetometerCalibration;
use alignment::Sensed;
use ellipsoid::Ellipsoid;
use refine::ParameterMatrix;
use visits::{Errors, Visit};

/// Readings below this are not worth a fit.
pub const FEWEST_READINGS: usize = 200;
/// Share of the readings, and of the points of the path, that may lie beyond the extent taken.
const EXTREMES: f64 = 0.002;
const PATH_EXTREMES: f64 = 0.05;
/// Thinnest over widest extent (σ) of readings that are a disc.
const FLAT: f64 = 0.05;
/// Longest over shortest axis of an ellipsoid that is believed.
const LARGEST_RATIO: f64 = 5.0;
/// A residual of more than this many σ is an outlier: of normal errors 1 in 150,000.
const OUTLIER_SIGMAS: f64 = 4.5;
/// Weights and outliers are taken anew this often.
const REWEIGHTINGS: usize = 3;
/// The robust fit looks at this many points of the path.
const ROBUST_POINTS: usize = 50_000;
/// Cross-validation: stretches of the log, by turns left out.
const FOLDS: usize = 5;
const STRETCHES: usize = 20;
const HELD_OUT_SAMPLES: usize = 50_000;

/// What was logged while the sensor was tumbled.
#[derive(Debug, Clone, Default)]
pub struct Tumble {
    /// Magnetometer, µT.
    pub field_ut: Series,
    /// Gyro, rad/s; may be empty.
    pub angular_rate_rad_s: Series,
    /// Accelerometer, up at rest; may be empty.
    pub specific_force_m_s2: Series,
}

/// What is known beforehand.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct KnownField {
    /// Length of the field where the sensor was tumbled, µT.
    pub norm_ut: Option<f64>,
    /// An axis of the magnetometer has the wrong sign in the log: the axes are each other's mirror image.
    pub mirrored: bool,
}

/// Coordinates in which the readings are about 1 in size.
struct Scaled {
    points: Vec<Vector3<f64>>,
    origin: Vector3<f64>,
    scale: f64,
}

/// The ellipsoid with all that the weights stand on, in scaled coordinates.
struct Fitted {
    ellipsoid: Ellipsoid,
    visits: Vec<Visit>,
    errors: Errors,
    /// Residual from which on a sample is an outlier.
    limit: f64,
}

/// Calibrates a magnetometer.
///
/// Errors: too few readings, a motion that showed too little of the sphere (with what is missing), readings that lie on no
/// ellipsoid. About a second for a million readings.
pub fn calibrate(tumble: &Tumble, known: &KnownField) -> Result<MagnetometerFit, TuningError> {
    let readings = tumble.field_ut.readings();
    if readings.len() < FEWEST_READINGS {
        let (sensor, found) = ("magnetometer", readings.len());
        return Err(TuningError::TooFewReadings { sensor, found, expected: FEWEST_READINGS });
    }
    let scaled = Scaled::new(readings)?;
    let fitted = Fitted::to(&scaled.points)?;
    let seen = coverage::directions(&scaled.points, &fitted.ellipsoid, fitted.limit);
    let coverage = Coverage::of(seen, fitted.errors.place);
    if !coverage.is_enough() {
        return Err(TuningError::Coverage { coverage: Box::new(coverage) });
    }
    let covariance = visits::covariance(
        &scaled.points,
        &fitted.ellipsoid,
        &fitted.visits,
        &fitted.errors,
        fitted.limit,
    )
    .ok_or_else(|| TuningError::NoEllipsoid { what: "its parameters depend on each other".to_owned() })?;

    let alignment = align(tumble, known, &scaled, &fitted);
    let ellipsoid = fitted.ellipsoid.unscaled(&scaled.origin, scaled.scale);
    let norm_ut = known.norm_ut.unwrap_or_else(|| ellipsoid.shape.determinant().cbrt().recip());
    let calibration =
        MagnetometerCalibration::new(ellipsoid.centre, alignment.rotation * ellipsoid.shape * norm_ut)
            .map_err(|what| TuningError::NoEllipsoid { what })?;
    let units = SVector::from_fn(|i, _| if i < 3 { scaled.scale } else { norm_ut / scaled.scale });
    let units = ParameterMatrix::from_diagonal(&units);
    let covariance = units * covariance * units;
    let residuals: Vec<f64> = scaled.points.iter().map(|p| fitted.ellipsoid.residual(p)).collect();
    let lengths = |residuals: &[f64]| residuals.iter().map(|r| norm_ut * (1.0 + r)).collect::<Vec<f64>>();
    let outliers = residuals.iter().filter(|r| r.abs() > fitted.limit).count();
    let sd = |i: usize| covariance[(i, i)].sqrt();

    Ok(MagnetometerFit {
        calibration,
        soft_iron: ellipsoid.shape * norm_ut,
        offset_ut: ellipsoid.centre.into(),
        offset_sd_ut: [sd(0), sd(1), sd(2)],
        matrix: rows(calibration.matrix()),
        matrix_sd: rows(&symmetric([sd(3), sd(4), sd(5), sd(6), sd(7), sd(8)])),
        norm_ut,
        norm_given: known.norm_ut.is_some(),
        readings: readings.len(),
        outliers,
        duration_s: tumble.field_ut.duration_s(),
        before: Spread::of(readings.iter().map(Vector3::norm).collect()),
        after: Spread::of(lengths(&residuals)),
        held_out: held_out(&scaled.points, &fitted).map(|residuals| Spread::of(lengths(&residuals))),
        noise_percent: 100.0 * fitted.errors.noise,
        place_percent: 100.0 * fitted.errors.place,
        axis_ratio: fitted.ellipsoid.ratio(),
        direction_sd_percent: 100.0 * coverage::largest_sd(&covariance) / norm_ut,
        covariance,
        warnings: report::warnings(tumble, &fitted, outliers, &alignment),
        coverage,
        alignment,
    })
}

impl Scaled {
    /// By the path of the field, so that neither a long rest nor spikes decide; the path itself needs a first idea.
    fn new(readings: &[Vector3<f64>]) -> Result<Self, TuningError> {
        let alike = || TuningError::NoEllipsoid { what: "they are all alike".to_owned() };
        let rough = Self::by_extent(readings, EXTREMES).ok_or_else(alike)?;
        let path = start::thinned(&rough.points);
        let fine = Self::by_extent(&path, PATH_EXTREMES).unwrap_or(Self {
            points: Vec::new(),
            origin: Vector3::zeros(),
            scale: 1.0,
        });
        let (origin, scale) = (rough.origin + fine.origin * rough.scale, rough.scale * fine.scale);
        let points = readings.iter().map(|r| (r - origin) / scale).collect();
        Ok(Self { points, origin, scale })
    }

    /// Middle and half of the widest extent, of all but a share of the readings at either end.
    fn by_extent(readings: &[Vector3<f64>], share: f64) -> Option<Self> {
        let (mut low, mut high) = (Vector3::zeros(), Vector3::zeros());
        for axis in 0..3 {
            let mut values: Vec<f64> = readings.iter().map(|r| r[axis]).collect();
            low[axis] = robust::quantile(&mut values, share)?;
            high[axis] = robust::quantile(&mut values, 1.0 - share)?;
        }
        let (origin, scale) = ((low + high) * 0.5, 0.5 * (high - low).amax());
        let points = || readings.iter().map(|r| (r - origin) / scale).collect();
        (scale > 0.0 && scale.is_finite()).then(|| Self { points: points(), origin, scale })
    }
}

impl Fitted {
    fn to(points: &[Vector3<f64>]) -> Result<Self, TuningError> {
        let none = |what: &str| TuningError::NoEllipsoid { what: what.to_owned() };
        let path = start::thinned(points);
        refuse_a_disc(&path)?;
        let start = start::ellipsoid(&path).ok_or_else(|| none("no start was found"))?;
        // Of the path, not of all samples: a rest in between would be a majority.
        let path = start::some(&path, ROBUST_POINTS);
        let (mut ellipsoid, scale) =
            refine::robust(&path, start).ok_or_else(|| none("the robust fit failed"))?;
        let limit = OUTLIER_SIGMAS * scale;
        let mut visits = visits::gather(points, &ellipsoid, limit);
        let mut errors = visits::errors(points, &ellipsoid, &visits, limit);
        for _ in 0..REWEIGHTINGS {
            let weights = visits::weights(points, &ellipsoid, &visits, &errors, limit);
            ellipsoid = refine::weighted(points, ellipsoid, |index| weights[index])
                .ok_or_else(|| none("the weighted fit failed"))?;
            visits = visits::gather(points, &ellipsoid, limit);
            errors = visits::errors(points, &ellipsoid, &visits, limit);
        }
        let ratio = ellipsoid.ratio();
        if ratio > LARGEST_RATIO {
            return Err(none(&format!(
                "the nearest one is {ratio:.1} times as long as it is wide, expected {LARGEST_RATIO} or less"
            )));
        }
        Ok(Self { ellipsoid, visits, errors, limit })
    }
}

/// Readings on a plane come from a sensor that was turned about one axis.
fn refuse_a_disc(path: &[Vector3<f64>]) -> Result<(), TuningError> {
    if path.len() < ellipsoid::PARAMETERS {
        return Err(TuningError::TooFewReadings {
            sensor: "magnetometer at different directions of the field",
            found: path.len(),
            expected: ellipsoid::PARAMETERS,
        });
    }
    let mean = path.iter().sum::<Vector3<f64>>() / path.len() as f64;
    let scatter = path.iter().map(|p| (p - mean) * (p - mean).transpose()).sum::<Matrix3<f64>>();
    let eigen = SymmetricEigen::new(scatter);
    let thinnest = eigen.eigenvalues.imin();
    let thickness = (eigen.eigenvalues.min().max(0.0) / eigen.eigenvalues.max()).sqrt();
    if thickness < FLAT {
        let normal = Direction(eigen.eigenvectors.column(thinnest).into_owned());
        return Err(TuningError::Flat { thickness_percent: 100.0 * thickness, normal });
    }
    Ok(())
}

/// Residuals of samples that the fit has not seen; `None` where a part of the log does not carry a fit.
fn held_out(points: &[Vector3<f64>], fitted: &Fitted) -> Option<Vec<f64>> {
    let weights = visits::weights(points, &fitted.ellipsoid, &fitted.visits, &fitted.errors, fitted.limit);
    // Stretches have like numbers of visits: a long rest is no larger a part of the motion than a short one.
    let mut fold = vec![0_u8; points.len()];
    for (number, visit) in fitted.visits.iter().enumerate() {
        let stretch = number * STRETCHES / fitted.visits.len();
        let end = fitted.visits.get(number + 1).map_or(points.len(), |next| next.samples.start);
        fold[visit.samples.start..end].fill(u8::try_from(stretch % FOLDS).unwrap_or(0));
    }
    let stride = points.len().div_ceil(HELD_OUT_SAMPLES);
    let some: Vec<usize> = (0..points.len()).step_by(stride).collect();
    let chosen: Vec<Vector3<f64>> = some.iter().map(|index| points[*index]).collect();
    let mut residuals = Vec::with_capacity(some.len());
    for left_out in (0..FOLDS).filter_map(|f| u8::try_from(f).ok()) {
        let ellipsoid = refine::weighted(&chosen, fitted.ellipsoid, |number| {
            let index = some[number];
            if fold[index] == left_out { 0.0 } else { weights[index] }
        })?;
        let unseen = some.iter().filter(|index| fold[**index] == left_out);
        residuals.extend(unseen.map(|index| ellipsoid.residual(&points[*index])));
    }
    Some(residuals)
}

fn align(tumble: &Tumble, known: &KnownField, scaled: &Scaled, fitted: &Fitted) -> Alignment {
    let origin = tumble.field_ut.times().first().copied().unwrap_or_default();
    let clocked = |series: &Series| {
        let stamps = series.seconds_from(origin);
        clock::evened(&stamps).unwrap_or(stamps)
    };
    let present = |series: &Series| (!series.is_empty()).then(|| clocked(series));
    let (gyro_s, force_s) = (present(&tumble.angular_rate_rad_s), present(&tumble.specific_force_m_s2));
    let on_sphere = |point: &Vector3<f64>| {
        let field = fitted.ellipsoid.on_sphere(point);
        let length = field.norm();
        ((length - 1.0).abs() <= fitted.limit).then(|| field / length)
    };
    let field: Vec<Option<Vector3<f64>>> = scaled.points.iter().map(on_sphere).collect();
    let sensed = Sensed {
        field_s: &clocked(&tumble.field_ut),
        field: &field,
        gyro: gyro_s.as_deref().map(|times| (times, tumble.angular_rate_rad_s.readings())),
        accelerometer: force_s.as_deref().map(|times| (times, tumble.specific_force_m_s2.readings())),
    };
    Alignment::find(&sensed, known.mirrored)
}

fn symmetric([xx, yy, zz, yz, xz, xy]: [f64; 6]) -> Matrix3<f64> {
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

fn rows(matrix: &Matrix3<f64>) -> [[f64; 3]; 3] {
    std::array::from_fn(|r| std::array::from_fn(|c| matrix[(r, c)]))
}

//! Where in a log the sensor lay still.
//!
//! The log is cut into windows of a second. A window moves when its readings scatter more than twice as much (σ) as in the
//! quietest tenth of the log, or when its mean jumps against the window before. The longest run of still windows is the rest.

use crate::error::TuningError;
use crate::robust;
use crate::series::Series;
use adit_core::nalgebra::Vector3;
use adit_core::time::{Interval, Time};

/// Least length of a window, s, and in mean intervals.
const WINDOW_S: f64 = 1.0;
const WINDOW_INTERVALS: f64 = 30.0;
/// Variance over that of the quietest tenth at which a window moves.
const LOUDER: f64 = 4.0;
/// A jump of the mean by more than this many σ of a mean is motion.
const JUMP_SIGMAS: f64 = 8.0;
/// Part of the readings that a window may lack.
const LACKING: f64 = 0.5;
/// The rest must last so long, s: averaging times to a minute then have eight degrees of freedom.
pub const SHORTEST_REST_S: f64 = 300.0;

/// What a sensor of a kind does not exceed at rest.
struct Kind {
    sensor: &'static str,
    unit: &'static str,
    /// Scatter of the quietest windows at which nothing in the log is rest.
    never_at_rest: f64,
    /// Scatter and jumps below this are no motion, however quiet the rest of the log.
    negligible: f64,
}

const GYRO: Kind = Kind { sensor: "gyro", unit: "rad/s", never_at_rest: 0.05, negligible: 1e-3 };
const ACCELEROMETER: Kind =
    Kind { sensor: "accelerometer", unit: "m/s²", never_at_rest: 0.5, negligible: 1e-2 };

/// A stretch of rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rest {
    /// First time of it.
    pub from: Time,
    /// Last time of it.
    pub to: Time,
    /// The log also holds motion or holes.
    pub interrupted: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    Still,
    Moving,
    Missing,
}

/// The longest rest of both sensors.
pub fn longest(gyro: &Series, accelerometer: &Series) -> Result<Rest, TuningError> {
    let bounds = |series: &Series| Some((*series.times().first()?, *series.times().last()?));
    let too_few = |sensor| TuningError::TooFewReadings { sensor, found: 0, expected: 1000 };
    let (gyro_first, gyro_last) = bounds(gyro).ok_or(too_few("gyro"))?;
    let (force_first, force_last) = bounds(accelerometer).ok_or(too_few("accelerometer"))?;
    let (from, to) = (gyro_first.max(force_first), gyro_last.min(force_last));
    let mean_interval =
        gyro.duration_s().max(accelerometer.duration_s()) / gyro.len().min(accelerometer.len()).max(1) as f64;
    let window_s = WINDOW_S.max(WINDOW_INTERVALS * mean_interval);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
    let windows = ((to - from).seconds() / window_s).max(0.0) as usize;
    // Every window of a log has a reading in it, or half of them would be missing.
    let windows = windows.min(gyro.len().max(accelerometer.len()));
    let mut states = judge(gyro, &GYRO, from, window_s, windows)?;
    for (state, other) in
        states.iter_mut().zip(judge(accelerometer, &ACCELEROMETER, from, window_s, windows)?)
    {
        if *state == State::Still {
            *state = other;
        }
    }
    let (start, end) = longest_run(&states);
    let at =
        |window: usize| from + Interval::from_seconds(window as f64 * window_s).unwrap_or(Interval::ZERO);
    let found_s = (end - start) as f64 * window_s;
    if found_s < SHORTEST_REST_S {
        let ended_by = match states.get(end) {
            Some(State::Moving) => format!("motion at {:.1} s", at(end).seconds()),
            Some(State::Missing) => format!("a hole at {:.1} s", at(end).seconds()),
            _ => "the end of the log".to_owned(),
        };
        return Err(TuningError::ShortRest {
            found_s,
            expected_s: SHORTEST_REST_S,
            from_s: at(start).seconds(),
            ended_by,
        });
    }
    // A motion may have begun, too weak to tell, in the window before it was seen.
    let from = if start == 0 { from } else { at(start + 1) };
    let to = if end == states.len() { to } else { at(end - 1) };
    Ok(Rest { from, to, interrupted: end - start < states.len() })
}

fn longest_run(states: &[State]) -> (usize, usize) {
    let (mut best, mut start) = ((0, 0), 0);
    for (window, state) in states.iter().enumerate() {
        if *state != State::Still {
            start = window + 1;
        } else if window + 1 - start > best.1 - best.0 {
            best = (start, window + 1);
        }
    }
    best
}

#[derive(Clone, Copy, Default)]
struct Window {
    count: usize,
    sum: Vector3<f64>,
    squares: f64,
}

impl Window {
    fn mean(&self) -> Vector3<f64> {
        self.sum / self.count.max(1) as f64
    }

    /// Variance, all axes together.
    fn variance(&self) -> f64 {
        (self.squares / self.count.max(1) as f64 - self.mean().norm_squared()).max(0.0)
    }
}

fn judge(
    series: &Series,
    kind: &Kind,
    from: Time,
    window_s: f64,
    count: usize,
) -> Result<Vec<State>, TuningError> {
    let mut windows = vec![Window::default(); count];
    // Readings about their middle: no digits are lost in the squares.
    let middle = series.readings().get(series.len() / 2).copied().unwrap_or_default();
    for (time, reading) in series.times().iter().zip(series.readings()) {
        let at = (*time - from).seconds() / window_s;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked to be in range")]
        if at >= 0.0
            && let Some(window) = windows.get_mut(at as usize)
        {
            window.count += 1;
            window.sum += reading - middle;
            window.squares += (reading - middle).norm_squared();
        }
    }
    let expected = series.len() as f64 / series.duration_s() * window_s;
    let complete = |window: &Window| window.count as f64 > (1.0 - LACKING) * expected && window.count > 2;
    let mut variances: Vec<f64> = windows.iter().filter(|w| complete(w)).map(Window::variance).collect();
    let quiet = robust::quantile(&mut variances, 0.1).unwrap_or(0.0);
    if quiet.sqrt() > kind.never_at_rest {
        let (sensor, unit) = (kind.sensor, kind.unit);
        return Err(TuningError::NoRest { sensor, found: quiet.sqrt(), expected: kind.never_at_rest, unit });
    }
    let loud = (LOUDER * quiet).max(kind.negligible * kind.negligible);
    let jump = (JUMP_SIGMAS * (quiet / expected.max(1.0)).sqrt()).max(kind.negligible);
    let mut before: Option<Vector3<f64>> = None;
    let state = |window: &Window| {
        if !complete(window) {
            before = None;
            return State::Missing;
        }
        let jumped = before.is_some_and(|before| (window.mean() - before).norm() > jump);
        before = Some(window.mean());
        if window.variance() > loud || jumped { State::Moving } else { State::Still }
    };
    Ok(windows.iter().map(state).collect())
}

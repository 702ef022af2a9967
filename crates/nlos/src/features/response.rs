//! Features of an impulse response.

use adit_observation::Reception;

/// Taps that the moments look at, from one before the first path on.
const WINDOW: usize = 80;
/// Taps looked at before the first path, and how near to it they end.
const BEFORE: (usize, usize) = (60, 4);
/// Least number of taps of noise.
const LEAST_BEFORE: usize = 8;

/// Amplitudes of a response and where its first path is.
pub struct Response {
    amplitude: Vec<f64>,
    /// Index of the first path among the taps, with a fraction.
    first: f64,
    /// The same, whole.
    at: usize,
}

impl Response {
    /// The response of a reception; `None` where there is none, or not enough of it before and after the first path.
    pub fn of(reception: &Reception) -> Option<Self> {
        let response = reception.impulse_response.as_ref()?;
        let first = f64::from(reception.first_path_index_tap?) - f64::from(response.first_tap);
        let least = (LEAST_BEFORE + BEFORE.1) as f64;
        if !(least..response.taps.len() as f64 - 4.0).contains(&first) {
            return None;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the taps")]
        let at = first as usize;
        let amplitude: Vec<f64> =
            response.taps.iter().map(|[i, q]| f64::from(*i).hypot(f64::from(*q))).collect();
        let some = amplitude.iter().any(|a| *a > 0.0);
        some.then_some(Self { amplitude, first, at })
    }

    /// The features from the fourteenth on, given the noise that the device tells.
    pub fn features(&self, noise: f64) -> [f64; 17] {
        let Self { amplitude, first, at } = self;
        let at = *at;
        let (peak_at, peak) = amplitude
            .iter()
            .enumerate()
            .fold((0, 0.0), |best, (k, a)| if *a > best.1 { (k, *a) } else { best });
        let before = &amplitude[at.saturating_sub(BEFORE.0)..at - BEFORE.1];
        let quiet = (before.iter().map(|a| a * a).sum::<f64>() / before.len() as f64).sqrt();
        let reaches =
            |share: f64| amplitude.iter().position(|a| *a >= share * peak).unwrap_or(peak_at) as f64;
        // Taps beyond the end are silent.
        let window: [f64; WINDOW] =
            std::array::from_fn(|k| amplitude.get(at - 1 + k).copied().unwrap_or_default());
        let power = window.map(|a| if a > 4.0 * quiet { a * a } else { 0.0 });
        let sum = power.iter().sum::<f64>().max(1.0);
        let moment = |about: f64, order: i32| {
            power.iter().enumerate().map(|(k, p)| (k as f64 - about).powi(order) * p).sum::<f64>() / sum
        };
        let delay = moment(0.0, 1);
        let mean = window.iter().sum::<f64>() / WINDOW as f64;
        let central = |order: i32| window.iter().map(|a| (a - mean).powi(order)).sum::<f64>() / WINDOW as f64;
        let kurtosis = central(4) / central(2).powi(2).max(1e-9);
        let early = |taps: usize| power[..taps].iter().sum::<f64>() / sum;
        let first_maximum = (at..amplitude.len() - 1).find(|k| amplitude[k + 1] <= amplitude[*k]);
        let against = |k: usize| super::decibel(amplitude[k]) - super::decibel(peak);
        [
            (peak_at as f64 - first).max(SHORTEST).ln(),
            (reaches(0.9) - reaches(0.1)).max(SHORTEST).ln(),
            delay,
            moment(delay, 2).sqrt(),
            kurtosis.max(1.0).ln(),
            early(3),
            early(5),
            early(10),
            20.0 * (quiet.max(1.0) / peak).log10(),
            20.0 * (noise / peak).log10(),
            against(first_maximum.unwrap_or(peak_at)),
            against(at),
            against(at + 1),
            against(at + 2),
            super::decibel(quiet),
            super::decibel(peak),
            10.0 * sum.log10(),
        ]
    }
}

/// Fewest taps of which a logarithm is taken.
const SHORTEST: f64 = 0.3;

//! Stamps that come in bursts, made even.
//!
//! A logger behind a serial buffer stamps samples when it empties the buffer: ten in a row within 20 ms, then nothing for a
//! quarter of a second. The sensor sampled evenly all the time. The stamps then only tell the rate: the even clock is their straight line
//! over the sample number. Its constant delay does not matter here, the gyro's fit has a lag of its own.

/// A pause is longer than this many mean intervals.
const PAUSE: f64 = 3.0;
/// Share of the time in pauses from which on stamps come in bursts.
const SHARE_IN_PAUSES: f64 = 0.25;
/// A stamp farther from the line is no jitter: samples are missing, s.
const LARGEST_JITTER_S: f64 = 1.0;
const FEWEST_SAMPLES: usize = 50;

/// The even clock behind stamps in bursts (s); `None` where the stamps can stand as they are.
pub fn evened(stamps: &[f64]) -> Option<Vec<f64>> {
    let (first, last) = (stamps.first()?, stamps.last()?);
    if stamps.len() < FEWEST_SAMPLES {
        return None;
    }
    let mean_interval = (last - first) / (stamps.len() - 1) as f64;
    let pauses = stamps.windows(2).map(|w| w[1] - w[0]).filter(|d| *d > PAUSE * mean_interval);
    if pauses.sum::<f64>() < SHARE_IN_PAUSES * (last - first) {
        return None;
    }
    let middle = 0.5 * (stamps.len() - 1) as f64;
    let mean = stamps.iter().sum::<f64>() / stamps.len() as f64;
    let (mut product, mut square) = (0.0, 0.0);
    for (number, stamp) in stamps.iter().enumerate() {
        let off = number as f64 - middle;
        product += off * (stamp - mean);
        square += off * off;
    }
    let interval = product / square;
    let even: Vec<f64> = (0..stamps.len()).map(|n| mean + interval * (n as f64 - middle)).collect();
    let farthest = even.iter().zip(stamps).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    (farthest <= LARGEST_JITTER_S && interval > 0.0).then_some(even)
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;

    #[test]
    fn bursts_become_even_and_even_stamps_stay() {
        let even: Vec<f64> = (0..1000).map(|i| f64::from(i) * 0.01).collect();
        assert_eq!(evened(&even), None);
        // Ten samples a millisecond apart at the end of every tenth of a second.
        let bursts: Vec<f64> =
            (0..1000).map(|i| f64::from(i / 10) * 0.1 + 0.1 + f64::from(i % 10) * 0.001).collect();
        let restored = evened(&bursts).unwrap();
        for (i, time) in restored.iter().enumerate() {
            let interval = 0.01;
            // The line lies half a burst off at its ends, at most.
            assert!((time - 0.06 - interval * i as f64).abs() < 0.05, "{i}: {time}");
        }
        let steps: Vec<f64> = restored.windows(2).map(|w| w[1] - w[0]).collect();
        assert!(steps.iter().all(|d| (d - 0.01).abs() < 1e-5));
    }
}

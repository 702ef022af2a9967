//! Which transmitters a scan hears: the logistic curve of [`Hearing`], fitted to predicted means.

use adit_estimation::radio::map::Hearing;

/// Strengths tried for the middle, quarters of a dBm.
const MIDDLES: std::ops::RangeInclusive<i32> = -440..=-200;

/// The likeliest curve of pairs (mean strength expected, dBm; heard or not); `None` where everything or nothing is heard.
///
/// By search over middles a quarter of a decibel apart and widths in steps of a fifth.
pub fn fit(pairs: &[(f64, bool)], unsure: f64) -> Option<Hearing> {
    let heard = pairs.iter().filter(|(_, heard)| *heard).count();
    if heard == 0 || heard == pairs.len() {
        return None;
    }
    // In classes of half a decibel, so that the search does not depend on how many there are.
    let mut classes = std::collections::BTreeMap::new();
    for (mean, heard) in pairs {
        #[expect(clippy::cast_possible_truncation, reason = "bounded")]
        let class = (2.0 * mean.clamp(-200.0, 50.0)).round() as i32;
        let count: &mut [f64; 2] = classes.entry(class).or_default();
        count[usize::from(*heard)] += 1.0;
    }
    let widths = (0..12).map(|k| 1.0 * 1.2_f64.powi(k));
    let curves = widths.flat_map(|width_db| {
        MIDDLES.map(move |half| Hearing { half_dbm: 0.25 * f64::from(half), width_db, unsure })
    });
    let likelihood = |curve: &Hearing| -> f64 {
        let of_class = |(class, [missed, heard]): (&i32, &[f64; 2])| {
            let p = curve.probability(0.5 * f64::from(*class));
            heard * p.ln() + missed * (1.0 - p).ln()
        };
        classes.iter().map(of_class).sum()
    };
    curves.map(|curve| (likelihood(&curve), curve)).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, curve)| curve)
}

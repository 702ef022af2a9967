//! Medians and the like: what stays put when some readings are wrong.

/// Standard deviation of a normal distribution over its median absolute deviation.
const MAD_TO_SD: f64 = 1.482_602_218_505_602;

/// The median; the upper of the two middle values of an even number. `None` of nothing.
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    quantile(&mut values, 0.5)
}

/// The value below which a share of the values lies; reorders them.
pub fn quantile(values: &mut [f64], share: f64) -> Option<f64> {
    let last = values.len().checked_sub(1)?;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "an index, clamped to the slice"
    )]
    let index = ((share * values.len() as f64) as usize).min(last);
    Some(*values.select_nth_unstable_by(index, f64::total_cmp).1)
}

/// Standard deviation of the bulk of values about `centre`, by their median absolute deviation.
pub fn spread_about(values: impl Iterator<Item = f64>, centre: f64) -> Option<f64> {
    median(values.map(|v| (v - centre).abs()).collect()).map(|mad| MAD_TO_SD * mad)
}

/// Weight of Tukey's biweight for a residual of `ratio` times the cut.
pub fn biweight(ratio: f64) -> f64 {
    let rest = 1.0 - ratio * ratio;
    if rest > 0.0 { rest * rest } else { 0.0 }
}

/// Cost of Tukey's biweight, 1 from the cut on.
pub fn biweight_cost(ratio: f64) -> f64 {
    let rest = (1.0 - ratio * ratio).max(0.0);
    1.0 - rest * rest * rest
}

/// The biweight's cut over the scale at which it is 95 % efficient for normal errors (Holland & Welsch 1977).
pub const BIWEIGHT_CUT: f64 = 4.685;

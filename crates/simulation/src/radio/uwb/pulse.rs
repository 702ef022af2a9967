//! The pulse as a DW1000's accumulator shows it.
//!
//! Read off the first paths of the recorded set `uwb-cir` (`docs/simulation/radio.md`): half height 1.4 taps before its peak, a tenth
//! 2.4 taps before, and nothing that rings ahead of it, as the raised cosine of the standard's reference pulse (IEEE 802.15.4-2020,
//! §15.4.4) would. The mean of a Gaussian and a `cos²` of that width has this form:
//! `p(t) = ½ exp(−ln 2 (t/h)²) + ½ cos²(πt/4h)` (the second for `|t| < 2h`), `h` = 1.4 taps. Tabled at 1/32 of a tap.

use std::sync::LazyLock;

/// Taps on either side of the peak where the pulse is not 0 to within 1 %.
const HALF_TAPS: u8 = 4;
const WIDTH: usize = 2 * HALF_TAPS as usize + 1;
const STEPS: usize = 32;
/// Half the width at half height, taps.
pub(crate) const HALF_WIDTH_TAPS: f64 = 1.4;

static TABLE: LazyLock<[[f32; WIDTH]; STEPS + 1]> = LazyLock::new(|| {
    std::array::from_fn(|step| {
        let fraction = step as f64 / STEPS as f64;
        #[expect(clippy::cast_possible_truncation, reason = "taps are single precision throughout")]
        std::array::from_fn(|tap| pulse(tap as f64 - f64::from(HALF_TAPS) - fraction) as f32)
    })
});

/// Energy of the pulse over taps: `∫ p² dt` in taps.
pub(crate) static ENERGY: LazyLock<f64> = LazyLock::new(|| {
    let count = 32 * 8;
    let sum: f64 = (-count..=count).map(|i| pulse(f64::from(i) / 32.0).powi(2)).sum();
    sum / 32.0
});

/// The pulse this many taps after its peak.
pub(crate) fn pulse(tap: f64) -> f64 {
    let x = tap / HALF_WIDTH_TAPS;
    let bell = libm::exp(-core::f64::consts::LN_2 * x * x);
    let arch = if x.abs() < 2.0 { libm::cos(core::f64::consts::FRAC_PI_4 * x) } else { 0.0 };
    0.5 * (bell + arch * arch)
}

/// Adds a pulse of complex amplitude `(re, im)` with its peak at `at_tap` to taps; what falls outside is left out.
pub(crate) fn add(taps: &mut [[f32; 2]], at_tap: f32, [re, im]: [f32; 2]) {
    let floor = at_tap.floor();
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "the fraction is 0 to 1, the index is checked"
    )]
    let (first, step) =
        (floor as i64 - i64::from(HALF_TAPS), ((at_tap - floor) * STEPS as f32 + 0.5) as usize);
    let row = &TABLE[step.min(STEPS)];
    if let Ok(first) = usize::try_from(first)
        && let Some(taps) = taps.get_mut(first..first + WIDTH)
    {
        for (tap, value) in taps.iter_mut().zip(row) {
            tap[0] += re * value;
            tap[1] += im * value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pulse_has_the_edge_of_the_recorded_set() {
        // Taps before the peak and height, medians of geometry 46 of `uwb-cir`; its scatter over the geometries is 0.05.
        for (before, height) in
            [(0.0, 1.0), (1.4, 0.53), (1.9, 0.255), (2.4, 0.109), (2.9, 0.03), (3.4, 0.009)]
        {
            assert!((pulse(-before) - height).abs() < 0.05, "{before}: {}", pulse(-before));
        }
        assert!((pulse(1.1) - pulse(-1.1)).abs() < 1e-15);
    }

    #[test]
    fn its_energy_is_the_integral() {
        // ∫ ¼ (g² + 2 g c + c²): g² and c² in closed form, the mixed term by the trapezium rule.
        let h = HALF_WIDTH_TAPS;
        let gauss = h * (core::f64::consts::PI / (2.0 * core::f64::consts::LN_2)).sqrt();
        let arch = 1.5 * h;
        let mixed: f64 = (-2_000..2_000)
            .map(|i| {
                let x = f64::from(i) * 1e-3;
                (-core::f64::consts::LN_2 * x * x).exp()
                    * (core::f64::consts::FRAC_PI_4 * x).cos().powi(2)
                    * 1e-3
                    * h
            })
            .sum();
        let expected = 0.25 * (gauss + 2.0 * mixed + arch);
        assert!((*ENERGY - expected).abs() < 1e-3, "{} {expected}", *ENERGY);
    }

    #[test]
    fn a_pulse_added_between_taps_stands_there() {
        let mut taps = [[0.0_f32; 2]; 32];
        add(&mut taps, 12.25, [2.0, -1.0]);
        for (index, tap) in taps.iter().enumerate() {
            let off = index as f64 - 12.25;
            let expected = if off.abs() <= 4.25 { pulse(off) } else { 0.0 };
            assert!((f64::from(tap[0]) - 2.0 * expected).abs() < 2e-2, "{index}");
            assert!((f64::from(tap[1]) + expected).abs() < 1e-2, "{index}");
        }
        add(&mut taps, -7.0, [1.0, 0.0]);
        add(&mut taps, 31.0, [1.0, 0.0]);
    }
}

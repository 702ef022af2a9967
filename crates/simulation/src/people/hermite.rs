//! The quintic between two states: value, first and second derivative given at both ends, so that a chain of them is C².

use crate::jet::{Jet, JetVector};

/// The quintic from `from` to `to` in `interval_s`, `since_s` after its beginning.
pub(super) fn quintic(from: Jet, to: Jet, interval_s: f64, since_s: f64) -> Jet {
    let (h, u) = (interval_s, since_s / interval_s);
    let slope = from.first * h;
    let bend = 0.5 * from.second * h * h;
    let d = to.value - from.value - slope - bend;
    let e = to.first * h - slope - 2.0 * bend;
    let f = to.second * h * h - 2.0 * bend;
    let cubic = 10.0 * d - 4.0 * e + 0.5 * f;
    let quartic = -15.0 * d + 7.0 * e - f;
    let quint = 6.0 * d - 3.0 * e + 0.5 * f;
    // From the first value on, so that eastings of millions of metres cost no digits of the change.
    let change = u * (slope + u * (bend + u * (cubic + u * (quartic + u * quint))));
    let first = slope + u * (2.0 * bend + u * (3.0 * cubic + u * (4.0 * quartic + u * 5.0 * quint)));
    let second = 2.0 * bend + u * (6.0 * cubic + u * (12.0 * quartic + u * 20.0 * quint));
    Jet { value: from.value + change, first: first / h, second: second / (h * h) }
}

/// The same for a vector.
pub(super) fn quintic_vector(from: &JetVector, to: &JetVector, interval_s: f64, since_s: f64) -> JetVector {
    JetVector(core::array::from_fn(|axis| quintic(from.0[axis], to.0[axis], interval_s, since_s)))
}

/// The quintic step from 0 to 1 in `interval_s`, at rest before and after it: what [`quintic`] is between two rests.
pub(super) fn ease(interval_s: f64, since_s: f64) -> Jet {
    let u = since_s / interval_s;
    if u <= 0.0 {
        return Jet::constant(0.0);
    }
    if u >= 1.0 {
        return Jet::constant(1.0);
    }
    let rate = 1.0 / interval_s;
    Jet {
        value: u * u * u * (10.0 + u * (-15.0 + 6.0 * u)),
        first: 30.0 * u * u * (1.0 - u) * (1.0 - u) * rate,
        second: 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) * rate * rate,
    }
}

/// Derivatives at the middle of three values that a parabola gives (its first and second derivative there).
pub(super) fn through(before: (f64, f64), here: (f64, f64), after: (f64, f64)) -> Jet {
    let (back, ahead) = (here.0 - before.0, after.0 - here.0);
    let (rise, climb) = ((here.1 - before.1) / back, (after.1 - here.1) / ahead);
    Jet {
        value: here.1,
        first: (rise * ahead + climb * back) / (back + ahead),
        second: 2.0 * (climb - rise) / (back + ahead),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quintic_meets_both_ends_with_both_derivatives() {
        let from = Jet { value: 1.0, first: -0.5, second: 2.0 };
        let to = Jet { value: 3.0, first: 0.7, second: -1.0 };
        for (since, expected) in [(0.0, from), (0.8, to)] {
            let found = quintic(from, to, 0.8, since);
            // Rounding of a dozen operations on numbers below 100.
            assert!((found.value - expected.value).abs() < 1e-13);
            assert!((found.first - expected.first).abs() < 1e-12);
            assert!((found.second - expected.second).abs() < 1e-11);
        }
    }

    #[test]
    fn a_parabola_is_reproduced_by_its_own_values() {
        let f = |t: f64| (t, 2.0 + 3.0 * t - 0.7 * t * t);
        let here = through(f(0.1), f(0.4), f(1.1));
        assert!((here.first - (3.0 - 1.4 * 0.4)).abs() < 1e-13);
        assert!((here.second + 1.4).abs() < 1e-13);
    }

    #[test]
    fn easing_is_the_quintic_between_two_rests() {
        let (low, high) = (Jet::constant(0.0), Jet::constant(1.0));
        for i in 0..=10 {
            let since = 0.15 * f64::from(i);
            let (a, b) = (quintic(low, high, 1.5, since), ease(1.5, since));
            assert!((a.value - b.value).abs() < 1e-14 && (a.first - b.first).abs() < 1e-13);
            assert!((a.second - b.second).abs() < 1e-12);
        }
    }
}

//! Smooth transitions from which all motion is composed.
//!
//! [`Window::step`] is the septic `s(x) = x⁴ (35 − 84 x + 70 x² − 20 x³)`: from 0 to 1 with three vanishing derivatives
//! at both ends, so that a position made of it is C³ and the specific force is C¹. Its peak slope is 35/16 at the
//! middle. [`Window::pulse`] is `(4 x (1 − x))⁴`: from 0 through 1 back to 0, C³ as well.
//! `x` runs from 0 to 1 over a window of the phase; outside it both are constant.

use crate::jet::Jet;

/// Part of a phase, as a share of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    start: f64,
    end: f64,
}

impl Window {
    /// From `start` to `end`, `start < end`.
    pub const fn new(start: f64, end: f64) -> Self {
        Self { start, end }
    }

    /// Position in the window, not limited.
    fn inside(self, phase: Jet) -> Jet {
        (phase - Jet::constant(self.start)) * (1.0 / (self.end - self.start))
    }

    /// 0 before the window, 1 after it, the septic step inside.
    pub fn step(self, phase: Jet) -> Jet {
        let jet = self.inside(phase);
        let x = jet.value;
        if x <= 0.0 {
            return Jet::constant(0.0);
        }
        if x >= 1.0 {
            return Jet::constant(1.0);
        }
        let y = 1.0 - x;
        jet.chain(
            x * x * x * x * (35.0 + x * (-84.0 + x * (70.0 - 20.0 * x))),
            140.0 * x * x * x * y * y * y,
            420.0 * x * x * y * y * (1.0 - 2.0 * x),
        )
    }

    /// 0 outside the window, 1 in its middle.
    pub fn pulse(self, phase: Jet) -> Jet {
        let x = self.inside(phase);
        if x.value <= 0.0 || x.value >= 1.0 {
            return Jet::constant(0.0);
        }
        (x * (Jet::constant(1.0) - x) * 4.0).fourth_power()
    }

    /// A [`Self::pulse`] that rings: times `sin(2π · cycles · x)`.
    pub fn ring(self, phase: Jet, cycles: f64) -> Jet {
        let pulse = self.pulse(phase);
        if pulse == Jet::constant(0.0) {
            return pulse;
        }
        let (sin, _) = (self.inside(phase) * (core::f64::consts::TAU * cycles)).sin_cos();
        pulse * sin
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_goes_from_zero_to_one_and_is_steepest_in_the_middle() {
        let window = Window::new(0.2, 0.6);
        assert_eq!(window.step(Jet::linear(0.2, 1.0)), Jet::constant(0.0));
        assert_eq!(window.step(Jet::linear(0.6 + 1e-15, 1.0)), Jet::constant(1.0));
        let middle = window.step(Jet::linear(0.4, 1.0));
        assert!((middle.value - 0.5).abs() < 1e-15);
        assert!((middle.first - 35.0 / 16.0 / 0.4).abs() < 1e-13);
    }

    #[test]
    fn derivatives_agree_with_finite_differences() {
        let window = Window::new(0.1, 0.9);
        let shapes: [fn(Window, Jet) -> Jet; 3] =
            [Window::step, Window::pulse, |window, phase| window.ring(phase, 3.0)];
        let h = 1e-5;
        for shape in shapes {
            for i in 1..100 {
                let x = f64::from(i) / 100.0;
                let at = |x| shape(window, Jet::linear(x, 1.0));
                let (before, now, after) = (at(x - h), at(x), at(x + h));
                // Central differences: error h²/6 times the third derivative, below 2e-6 for the ring.
                assert!((now.first - (after.value - before.value) / (2.0 * h)).abs() < 1e-5);
                assert!((now.second - (after.first - before.first) / (2.0 * h)).abs() < 1e-4);
            }
        }
    }
}

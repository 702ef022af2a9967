//! Second-order jets: a function of time with its exact first and second derivative.
//!
//! A [`Jet`] carries `(f, ḟ, f̈)` through sums, products, sines and cosines by the rules of calculus (forward-mode
//! differentiation), so that truth needs no finite differences and no formula is derived twice by hand.
//! Source: Griewank and Walther, *Evaluating Derivatives*, 2nd ed. 2008, ch. 13 (Taylor coefficients).

use adit_core::nalgebra::Vector3;
use core::ops::{Add, Mul, Neg, Sub};

/// A scalar function of time at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Jet {
    /// The value.
    pub value: f64,
    /// First derivative by time, 1/s of the value's unit.
    pub first: f64,
    /// Second derivative by time, 1/s² of the value's unit.
    pub second: f64,
}

impl Jet {
    /// A function that does not change.
    pub const fn constant(value: f64) -> Self {
        Self { value, first: 0.0, second: 0.0 }
    }

    /// A function that rises evenly: `value` now, `slope` per second.
    pub const fn linear(value: f64, slope: f64) -> Self {
        Self { value, first: slope, second: 0.0 }
    }

    /// `g(f)`, given `g`, `g′` and `g″` at the value of `f` (chain rule, twice).
    #[must_use]
    pub fn chain(self, g: f64, dg: f64, ddg: f64) -> Self {
        Self { value: g, first: dg * self.first, second: ddg * self.first * self.first + dg * self.second }
    }

    /// Sine and cosine of an angle in rad.
    pub fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = libm::sincos(self.value);
        (self.chain(sin, cos, -sin), self.chain(cos, -sin, -cos))
    }

    /// Direction of the vector `(x, y)`, anticlockwise from x, rad in (−π, π]; the vector is not zero.
    #[must_use]
    pub fn atan2(y: Self, x: Self) -> Self {
        let square = x * x + y * y;
        let area = x.value * y.first - y.value * x.first;
        let swept = x.value * y.second - y.value * x.second;
        let first = area / square.value;
        let second = (swept - first * square.first) / square.value;
        Self { value: libm::atan2(y.value, x.value), first, second }
    }

    /// Square root of what is above zero.
    #[must_use]
    pub fn sqrt(self) -> Self {
        let root = libm::sqrt(self.value);
        self.chain(root, 0.5 / root, -0.25 / (root * self.value))
    }

    /// Fourth power.
    #[must_use]
    pub fn fourth_power(self) -> Self {
        let square = self * self;
        square * square
    }
}

impl Add for Jet {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            first: self.first + other.first,
            second: self.second + other.second,
        }
    }
}

impl Sub for Jet {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Jet {
    type Output = Self;
    fn neg(self) -> Self {
        self * -1.0
    }
}

impl Mul for Jet {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            first: self.first * other.value + self.value * other.first,
            second: self.second * other.value + 2.0 * self.first * other.first + self.value * other.second,
        }
    }
}

impl Mul<f64> for Jet {
    type Output = Self;
    fn mul(self, gain: f64) -> Self {
        Self { value: self.value * gain, first: self.first * gain, second: self.second * gain }
    }
}

/// A vector function of time at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JetVector(pub [Jet; 3]);

impl JetVector {
    /// A vector that does not change.
    pub fn constant(v: &Vector3<f64>) -> Self {
        Self([Jet::constant(v.x), Jet::constant(v.y), Jet::constant(v.z)])
    }

    /// `v · f(t)` for a fixed direction `v`.
    pub fn along(v: &Vector3<f64>, f: Jet) -> Self {
        Self([f * v.x, f * v.y, f * v.z])
    }

    /// The values.
    pub fn value(&self) -> Vector3<f64> {
        Vector3::from(self.0.map(|jet| jet.value))
    }

    /// The first derivatives by time.
    pub fn first(&self) -> Vector3<f64> {
        Vector3::from(self.0.map(|jet| jet.first))
    }

    /// The second derivatives by time.
    pub fn second(&self) -> Vector3<f64> {
        Vector3::from(self.0.map(|jet| jet.second))
    }

    /// Turned about the x axis by `angle` (rad, right-handed).
    #[must_use]
    pub fn turned_about_x(self, angle: Jet) -> Self {
        let [x, y, z] = self.0;
        let (s, c) = angle.sin_cos();
        Self([x, c * y - s * z, s * y + c * z])
    }

    /// Turned about the y axis by `angle` (rad, right-handed).
    #[must_use]
    pub fn turned_about_y(self, angle: Jet) -> Self {
        let [x, y, z] = self.0;
        let (s, c) = angle.sin_cos();
        Self([c * x + s * z, y, c * z - s * x])
    }

    /// Turned about the z axis by `angle` (rad, right-handed).
    #[must_use]
    pub fn turned_about_z(self, angle: Jet) -> Self {
        let [x, y, z] = self.0;
        let (s, c) = angle.sin_cos();
        Self([c * x - s * y, s * x + c * y, z])
    }
}

impl Add for JetVector {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let ([a, b, c], [d, e, f]) = (self.0, other.0);
        Self([a + d, b + e, c + f])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_product_of_sine_and_square_has_its_textbook_derivatives() {
        let t = 0.7;
        let time = Jet::linear(t, 1.0);
        let (sin, _) = time.sin_cos();
        let f = sin * time * time;
        let (s, c) = (libm::sin(t), libm::cos(t));
        // Rounding only: five operations on numbers near one.
        assert!((f.value - t * t * s).abs() < 1e-15);
        assert!((f.first - (2.0 * t * s + t * t * c)).abs() < 1e-15);
        assert!((f.second - ((2.0 - t * t) * s + 4.0 * t * c)).abs() < 1e-14);
    }

    #[test]
    fn direction_and_length_of_a_turning_vector_have_their_derivatives() {
        // Turns by 0.3 + 2 t − t² and grows as 1 + t: known by construction.
        let (angle, length) =
            (Jet { value: 0.3, first: 2.0, second: -2.0 }, Jet { value: 1.0, first: 1.0, second: 0.0 });
        let (sin, cos) = angle.sin_cos();
        let (x, y) = (cos * length, sin * length);
        let (direction, norm) = (Jet::atan2(y, x), (x * x + y * y).sqrt());
        for (found, expected) in [(direction, angle), (norm, length)] {
            assert!((found.value - expected.value).abs() < 1e-15);
            assert!((found.first - expected.first).abs() < 1e-14);
            assert!((found.second - expected.second).abs() < 1e-13);
        }
    }

    #[test]
    fn turning_a_vector_keeps_its_length_and_moves_it_square_to_itself() {
        let angle = Jet { value: 0.4, first: 2.0, second: -3.0 };
        let v = JetVector::constant(&Vector3::new(1.0, 2.0, -0.5));
        for turned in [v.turned_about_x(angle), v.turned_about_y(angle), v.turned_about_z(angle)] {
            assert!((turned.value().norm() - v.value().norm()).abs() < 1e-15);
            assert!(turned.value().dot(&turned.first()).abs() < 1e-14);
        }
    }
}

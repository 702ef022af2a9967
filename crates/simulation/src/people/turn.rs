//! Yaw, pitch and roll as a rotation, with three sines in all: the truth is asked for often.

use crate::jet::{Jet, JetVector};
use adit_core::attitude::Attitude;
use adit_core::nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// `Rz(yaw) Ry(pitch) Rx(roll)`, with its derivatives.
#[derive(Debug, Clone, Copy)]
pub(super) struct Turn {
    angles: [Jet; 3],
    /// Sine and cosine of half of each.
    half: [(f64, f64); 3],
    /// Of the whole of each.
    whole: [(Jet, Jet); 3],
}

/// Sine and cosine of half an angle, and of the angle.
fn both(angle: Jet) -> ((f64, f64), (Jet, Jet)) {
    let (s, c) = libm::sincos(0.5 * angle.value);
    let (sin, cos) = (2.0 * s * c, (c - s) * (c + s));
    ((s, c), (angle.chain(sin, cos, -sin), angle.chain(cos, -sin, -cos)))
}

impl Turn {
    pub fn new(yaw: Jet, pitch: Jet, roll: Jet) -> Self {
        let [z, y, x] = [yaw, pitch, roll].map(both);
        Self { angles: [yaw, pitch, roll], half: [z.0, y.0, x.0], whole: [z.1, y.1, x.1] }
    }

    /// A fixed vector, turned.
    pub fn apply(&self, v: &Vector3<f64>) -> JetVector {
        let [(sz, cz), (sy, cy), (sx, cx)] = self.whole;
        let (y, z) = (cx * v.y - sx * v.z, sx * v.y + cx * v.z);
        let (x, z) = (cy * v.x + sy * z, cy * z - sy * v.x);
        JetVector([cz * x - sz * y, sz * x + cz * y, z])
    }

    pub fn attitude(&self) -> Attitude {
        let [(sz, cz), (sy, cy), (sx, cx)] = self.half;
        let (w, x, y, z) = (cz * cy, -sz * sy, cz * sy, sz * cy);
        UnitQuaternion::new_unchecked(Quaternion::new(
            w * cx - x * sx,
            w * sx + x * cx,
            y * cx + z * sx,
            z * cx - y * sx,
        ))
    }

    /// Angular rate in the turned axes, rad/s; the equation stands at `Angles::rate_rad_s` (private module `motion`).
    pub fn rate_rad_s(&self) -> Vector3<f64> {
        let [yaw, pitch, roll] = self.angles.map(|angle| angle.first);
        let [_, (sy, cy), (sx, cx)] = self.whole.map(|(sin, cos)| (sin.value, cos.value));
        Vector3::new(roll - yaw * sy, pitch * cx + yaw * sx * cy, yaw * cx * cy - pitch * sx)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::Angles;

    #[test]
    fn it_is_the_rotation_of_three_angles_one_after_the_other() {
        let yaw = Jet { value: 2.5, first: 0.7, second: -1.0 };
        let pitch = Jet { value: -0.4, first: 1.7, second: 3.0 };
        let roll = Jet { value: 0.9, first: -2.7, second: 0.5 };
        let turn = Turn::new(yaw, pitch, roll);
        let angles = Angles { yaw, pitch, roll };
        // Rounding of a dozen operations.
        assert!((turn.attitude().coords - angles.attitude().coords).norm() < 1e-15);
        assert!((turn.rate_rad_s() - angles.rate_rad_s()).norm() < 1e-14);
        let v = Vector3::new(0.3, -0.2, 0.5);
        let expected = JetVector::constant(&v).turned_about_x(roll).turned_about_y(pitch).turned_about_z(yaw);
        let found = turn.apply(&v);
        assert!((found.value() - expected.value()).norm() < 1e-15);
        assert!((found.first() - expected.first()).norm() < 1e-14);
        assert!((found.second() - expected.second()).norm() < 1e-13);
    }
}

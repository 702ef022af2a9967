//! Dilution of precision: how the errors of ranges grow into those of the place.
//!
//! ```text
//! Q = (Hᵀ H)⁻¹,   rows of H: (u_iᵀ, 1),   u_i from anchor to tag
//! HDOP = √(Q_ee + Q_nn),  VDOP = √Q_uu,  PDOP² = HDOP² + VDOP²,  TDOP = √Q_tt,  GDOP² = PDOP² + TDOP²
//! ```
//!
//! (Langley 1999; Parkinson & Spilker 1996, ch. 5.) Times σ of one range these are standard deviations, all ranges being equally good.
//! Two-way ranges have no clock (no column of ones): GDOP is PDOP. Differences of arrival times have the errors of ranges with a common offset,
//! the clock in m, which is unknown.

use adit_core::nalgebra::{Matrix4, Vector3, Vector4};
use serde::{Deserialize, Serialize};

/// What is unknown beside east and north.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Unknowns {
    /// The height of the tag.
    pub height: bool,
    /// An offset that all ranges share.
    pub clock: bool,
}

/// Dilution of precision at a place.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Dilution {
    /// East and north.
    pub hdop: f64,
    /// Height; 0 where that is known.
    pub vdop: f64,
    /// Common offset; 0 where there is none.
    pub tdop: f64,
}

/// Eigenvalues of `Hᵀ H` that are smaller than this share of the largest are zero: 1 cm in 100 m.
const SINGULAR: f64 = 1e-8;

/// Dilution at a place among anchors, m; `None` where they do not determine it.
pub fn dilution(
    anchors_m: impl IntoIterator<Item = Vector3<f64>>,
    place_m: &Vector3<f64>,
    unknowns: Unknowns,
) -> Option<Dilution> {
    let wanted = Vector4::new(1.0, 1.0, f64::from(unknowns.height), f64::from(unknowns.clock));
    let mut information = Matrix4::zeros();
    for anchor_m in anchors_m {
        let direction = (place_m - anchor_m).try_normalize(1e-9)?;
        let row = direction.push(1.0).component_mul(&wanted);
        information += row * row.transpose();
    }
    // What is known stands for itself.
    let scale = information.trace();
    for known in (0..4).filter(|axis| wanted[*axis] == 0.0) {
        information[(known, known)] = scale;
    }
    if !scale.is_finite() {
        return None;
    }
    let spread = information.symmetric_eigenvalues();
    if spread.min() <= SINGULAR * spread.max() {
        return None;
    }
    let cofactor = information.cholesky()?.inverse().diagonal().component_mul(&wanted);
    Some(Dilution {
        hdop: libm::sqrt(cofactor.x + cofactor.y),
        vdop: libm::sqrt(cofactor.z),
        tdop: libm::sqrt(cofactor.w),
    })
}

impl Dilution {
    /// Position in space.
    pub fn pdop(&self) -> f64 {
        libm::hypot(self.hdop, self.vdop)
    }

    /// Position and common offset.
    pub fn gdop(&self) -> f64 {
        libm::hypot(self.pdop(), self.tdop)
    }
}

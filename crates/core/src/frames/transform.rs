//! The ways from one frame to another: rotations, rigid transforms, and the placement of a mine's grid.

use super::{Body, Enu, Frame, MineGrid, Ned, Position, Vector};
use crate::attitude::{self, Attitude};
use core::marker::PhantomData;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

/// Turns coordinates in `From` into coordinates in `To`. `Rotation<Body, Enu>` is an [`Attitude`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Rotation<From: Frame, To: Frame>(UnitQuaternion<f64>, PhantomData<(From, To)>);

impl<A: Frame, B: Frame> Rotation<A, B> {
    /// The two frames have parallel axes.
    pub fn identity() -> Self {
        Self::from_raw(UnitQuaternion::identity())
    }

    /// Takes the word of the caller that `q` turns coordinates in `A` into coordinates in `B`.
    pub const fn from_raw(q: UnitQuaternion<f64>) -> Self {
        Self(q, PhantomData)
    }

    /// The quaternion.
    pub const fn raw(&self) -> &UnitQuaternion<f64> {
        &self.0
    }

    /// The same arrow, written in `B`.
    pub fn apply(&self, vector: &Vector<A>) -> Vector<B> {
        Vector::from_raw(self.0 * vector.raw())
    }

    /// First this rotation, then `next`.
    #[must_use]
    pub fn then<C: Frame>(&self, next: &Rotation<B, C>) -> Rotation<A, C> {
        Rotation::from_raw(next.0 * self.0)
    }

    /// The way back.
    #[must_use]
    pub fn inverse(&self) -> Rotation<B, A> {
        Rotation::from_raw(self.0.inverse())
    }
}

impl<N: Frame> Rotation<Body, N> {
    /// The same attitude for body axes turned half way about x: forward-right-down ↔ forward-left-up.
    ///
    /// A library that speaks NED mostly means a forward-right-down body as well. [`Rotation::to_enu`] leaves the body
    /// axes alone (right for raw sensor axes); add this turn when what follows wants a z-up body.
    #[must_use]
    pub fn with_body_half_turned_about_x(&self) -> Self {
        Self::from_raw(self.0 * UnitQuaternion::new_unchecked(Quaternion::new(0.0, 1.0, 0.0, 0.0)))
    }
}

/// NED axes into ENU axes: half a turn about the horizontal line to the north-east. Its own inverse.
const fn level_axes_swap() -> UnitQuaternion<f64> {
    use core::f64::consts::FRAC_1_SQRT_2;
    UnitQuaternion::new_unchecked(Quaternion::new(0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0))
}

impl Rotation<Body, Ned> {
    /// Attitude against NED to attitude against ENU, for the same body axes.
    pub fn to_enu(&self) -> Rotation<Body, Enu> {
        self.then(&Rotation::from_raw(level_axes_swap()))
    }
}

impl Rotation<Body, Enu> {
    /// Attitude against ENU to attitude against NED, for the same body axes.
    pub fn to_ned(&self) -> Rotation<Body, Ned> {
        self.then(&Rotation::from_raw(level_axes_swap()))
    }
}

impl From<Attitude> for Rotation<Body, Enu> {
    fn from(attitude: Attitude) -> Self {
        Self::from_raw(attitude)
    }
}

/// Rigid transform of coordinates in `From` into coordinates in `To`: `p_to = R (p_from − origin)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Transform<From: Frame, To: Frame> {
    rotation: Rotation<From, To>,
    origin: Position<From>,
}

impl<A: Frame, B: Frame> Transform<A, B> {
    /// From the turn of the axes and the place of `B`'s origin, written in `A`.
    pub const fn new(rotation: Rotation<A, B>, origin: Position<A>) -> Self {
        Self { rotation, origin }
    }

    /// The turn of the axes.
    pub const fn rotation(&self) -> &Rotation<A, B> {
        &self.rotation
    }

    /// The origin of `B`, written in `A`.
    pub const fn origin(&self) -> &Position<A> {
        &self.origin
    }

    /// The same point, written in `B`.
    pub fn position(&self, position: &Position<A>) -> Position<B> {
        Position::ORIGIN + self.rotation.apply(&(*position - self.origin))
    }

    /// The same arrow, written in `B`; the origin plays no part.
    pub fn vector(&self, vector: &Vector<A>) -> Vector<B> {
        self.rotation.apply(vector)
    }

    /// First this transform, then `next`.
    #[must_use]
    pub fn then<C: Frame>(&self, next: &Transform<B, C>) -> Transform<A, C> {
        let shift = self.rotation.inverse().apply(&(next.origin - Position::ORIGIN));
        Transform::new(self.rotation.then(&next.rotation), self.origin + shift)
    }

    /// The way back.
    #[must_use]
    pub fn inverse(&self) -> Transform<B, A> {
        Transform::new(self.rotation.inverse(), self.position(&Position::ORIGIN))
    }
}

/// Where a mine's survey grid lies in the local ENU frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GridPlacement {
    /// Grid coordinates (with false easting, northing and datum height) of the ENU origin, m.
    pub origin: Position<MineGrid>,
    /// Grid convergence, rad: the true azimuth of grid north, positive when grid north lies east of true north.
    pub convergence_rad: f64,
}

impl GridPlacement {
    /// Grid coordinates to true east, north, up.
    ///
    /// ```
    /// use adit_core::frames::{GridPlacement, Position};
    /// let grid = GridPlacement { origin: Position::new(50_000.0, 20_000.0, 0.0), convergence_rad: 0.02 };
    /// let shaft = Position::new(50_100.0, 20_000.0, -640.0);
    /// let enu = grid.to_enu().position(&shaft);
    /// // Grid east points a little south of true east.
    /// assert!((enu.raw().x - 100.0 * 0.02_f64.cos()).abs() < 1e-9 && enu.raw().y < 0.0);
    /// ```
    pub fn to_enu(&self) -> Transform<MineGrid, Enu> {
        let turn = Vector3::new(0.0, 0.0, -self.convergence_rad);
        Transform::new(Rotation::from_raw(attitude::exp(&turn)), self.origin)
    }

    /// True heading of a heading measured from grid north, in (−π, π] rad.
    pub fn true_heading(&self, grid_heading_rad: f64) -> f64 {
        attitude::angle_difference(grid_heading_rad, -self.convergence_rad)
    }
}

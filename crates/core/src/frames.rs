//! Frames as types: a position, a vector and a rotation know the axes they are written in.
//!
//! A wrong chain does not compile, which is the whole point: z-down logs, mine grids with a twist against north and
//! Earth-fixed coordinates all look like three `f64`. The types cost nothing at run time and are meant for the
//! public door; filter interiors work on [`raw`](Position::raw) nalgebra vectors.
//!
//! | marker | axes | origin |
//! |---|---|---|
//! | [`Enu`] | east, north, up; north is **true** (geodetic) north | a point with known [`Geodetic`](crate::geodesy::Geodetic) coordinates, or any local one |
//! | [`Ned`] | north, east, down | the same point |
//! | [`MineGrid`] | grid east, grid north, height (up) | the mine's survey datum |
//! | [`Body`] | the sensor's own axes | the sensor |
//! | [`Ecef`] | Earth-fixed: x to 0° N 0° E, z to the north pole (WGS-84) | the Earth's centre |
//!
//! A frame of one's own is one line: a unit struct that implements [`Frame`].
//!
//! ```
//! use adit_core::frames::{Body, Enu, Ned, Position, Rotation, Vector};
//! let drift_end = Position::<Ned>::new(120.0, 35.0, 4.0);
//! assert_eq!(Position::<Enu>::from(drift_end), Position::new(35.0, 120.0, -4.0));
//! // What a north-east-down library calls level and facing north:
//! let attitude = Rotation::<Body, Ned>::identity().to_enu();
//! let ahead = attitude.apply(&Vector::new(1.0, 0.0, 0.0));
//! assert!((ahead - Vector::new(0.0, 1.0, 0.0)).norm() < 1e-15);
//! ```
//!
//! Coordinates of different frames do not mix, and a chain has to fit end to end:
//!
//! ```compile_fail,E0308
//! # use adit_core::frames::{Enu, MineGrid, Position};
//! let tag = Position::<MineGrid>::new(1.0, 2.0, 3.0);
//! let exit = Position::<Enu>::new(0.0, 0.0, 0.0);
//! let way_out = exit - tag; // expected `Position<Enu>`, found `Position<MineGrid>`
//! ```
//! ```compile_fail,E0308
//! # use adit_core::frames::{Body, Ecef, Enu, Ned, Rotation};
//! let attitude = Rotation::<Body, Ned>::identity();
//! let chain = attitude.then(&Rotation::<Enu, Ecef>::identity()); // a Ned attitude is not an Enu one
//! ```
//!
//! **Limits.** The type says which axes, not which origin: two `Enu` frames of two mines are one type. Transforms are
//! rigid; the scale factor of a map projection (UTM: up to 0.4 m per km) belongs to whoever reads the survey.
//!
//! The idea of `From → To` types follows the crate `sguaba` (Helsing).

mod transform;

pub use transform::{GridPlacement, Rotation, Transform};

use core::marker::PhantomData;
use core::ops::{Add, Mul, Neg, Sub};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// A set of axes, named by a type.
pub trait Frame: Copy + core::fmt::Debug + PartialEq + 'static {}

macro_rules! frames {
    ($($(#[$doc:meta])+ $name:ident;)+) => {$(
        $(#[$doc])+
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub struct $name;
        impl Frame for $name {}
    )+};
}

frames! {
    /// Local level: x true east, y true north, z up.
    Enu;
    /// Local level: x true north, y true east, z down.
    Ned;
    /// The mine's survey grid: x grid east, y grid north, z up; level, turned against [`Enu`] by the grid convergence.
    MineGrid;
    /// The sensor's own axes, as logged or as turned by its mounting.
    Body;
    /// Earth-centred, Earth-fixed axes of WGS-84.
    Ecef;
}

/// A point in frame `F`, m. Serialises as the bare `[x, y, z]`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Position<F: Frame>(Vector3<f64>, PhantomData<F>);

/// A free vector in frame `F` (displacement, velocity, force, rotation rate), in any unit. Serialises as `[x, y, z]`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Vector<F: Frame>(Vector3<f64>, PhantomData<F>);

macro_rules! triple {
    ($name:ident) => {
        impl<F: Frame> $name<F> {
            /// From coordinates in the order of the frame's axes.
            pub const fn new(x: f64, y: f64, z: f64) -> Self {
                Self(Vector3::new(x, y, z), PhantomData)
            }

            /// Takes the word of the caller that these coordinates are in `F`.
            pub const fn from_raw(coordinates: Vector3<f64>) -> Self {
                Self(coordinates, PhantomData)
            }

            /// The coordinates, in the order of the frame's axes.
            pub const fn raw(&self) -> &Vector3<f64> {
                &self.0
            }
        }

        impl From<$name<Ned>> for $name<Enu> {
            /// Swaps axes: exact.
            fn from(ned: $name<Ned>) -> Self {
                Self::new(ned.0.y, ned.0.x, -ned.0.z)
            }
        }

        impl From<$name<Enu>> for $name<Ned> {
            /// Swaps axes: exact.
            fn from(enu: $name<Enu>) -> Self {
                Self::new(enu.0.y, enu.0.x, -enu.0.z)
            }
        }
    };
}

triple!(Position);
triple!(Vector);

impl<F: Frame> Position<F> {
    /// The frame's own origin.
    pub const ORIGIN: Self = Self::new(0.0, 0.0, 0.0);
}

impl<F: Frame> Vector<F> {
    /// Length, in the unit of the vector.
    pub fn norm(&self) -> f64 {
        self.0.norm()
    }
}

impl<F: Frame> Sub for Position<F> {
    type Output = Vector<F>;
    fn sub(self, from: Self) -> Vector<F> {
        Vector::from_raw(self.0 - from.0)
    }
}

impl<F: Frame> Add<Vector<F>> for Position<F> {
    type Output = Self;
    fn add(self, displacement: Vector<F>) -> Self {
        Self::from_raw(self.0 + displacement.0)
    }
}

impl<F: Frame> Add for Vector<F> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::from_raw(self.0 + other.0)
    }
}

impl<F: Frame> Sub for Vector<F> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::from_raw(self.0 - other.0)
    }
}

impl<F: Frame> Neg for Vector<F> {
    type Output = Self;
    fn neg(self) -> Self {
        Self::from_raw(-self.0)
    }
}

impl<F: Frame> Mul<f64> for Vector<F> {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self::from_raw(self.0 * factor)
    }
}

//! The mine: grid, levels, roadways and their graph, zones, anchors; checked once, asked often.
//!
//! A file ([`mod@file`], with the feature `std`) or a program makes a [`plan::MinePlan`], plain records with units in their names.
//! [`Mine::new`] checks it ([`check()`]) and makes what users ask:
//!
//! | question | answer |
//! |---|---|
//! | where on which roadway is this point? | [`network::Network::nearest`], [`network::Network::within`] |
//! | what is the shortest way, the nearest refuge? | [`network::Network::route`], [`network::Network::nearest_of`] |
//! | is this point air or rock? | [`excavation::Excavation::contains`] |
//! | what is between an anchor and a tag? | [`Mine::sight`] |
//! | which zones, which level? | [`Mine::zones_at`], [`Mine::level_at`], [`plan::Zone::holds`] |
//! | where on Earth is this? | [`Mine::georeference`] |
//!
//! Coordinates are those of the mine's grid ([`adit_core::frames::MineGrid`]), m, z up; centre lines and chambers are given at the
//! **floor**. All but [`mod@file`], [`plan_view`] and [`projection`] is `no_std` with `alloc`.
//!
//! ```
//! use adit_core::frames::Position;
//! use adit_mine::{Mine, plan::{Grid, MinePlan, Roadway, RoadwayKind}};
//! let mut plan = MinePlan::new("one roadway", Grid::Local {});
//! plan.roadways.push(Roadway {
//!     id: "main".into(),
//!     name: None,
//!     level: None,
//!     kind: RoadwayKind::Haulage,
//!     width_m: 5.0,
//!     height_m: 3.0,
//!     max_slope_percent: None,
//!     walkable: true,
//!     points_m: vec![Position::new(0.0, 0.0, 0.0), Position::new(100.0, 0.0, 0.0), Position::new(100.0, 80.0, 0.0)],
//! });
//! let mine = Mine::new(plan)?;
//! let tag = Position::new(40.0, 1.5, 1.0);
//! let foot = mine.network().nearest(&tag).unwrap();
//! assert_eq!((foot.spot.along_m, foot.left_m, foot.above_m), (40.0, 1.5, 1.0));
//! assert!(!mine.sight(&tag, &Position::new(100.0, 40.0, 2.0)).is_clear());
//! # Ok::<(), adit_mine::MineError>(())
//! ```
#![cfg_attr(not(feature = "std"), no_std)]

extern crate alloc;

mod check;
mod error;
pub mod excavation;
pub mod finding;
mod geometry;
mod georeference;
pub mod grid_tie;
mod levels;
mod mine;
pub mod network;
pub mod plan;
mod problem;
mod remedy;
mod summary;
mod zoning;

#[cfg(feature = "std")]
pub mod file;
#[cfg(feature = "std")]
pub mod plan_view;
#[cfg(feature = "std")]
pub mod projection;

pub use check::check;
pub use error::MineError;
pub use georeference::Georeference;
pub use mine::{Mine, Sight};
pub use problem::Problem;
pub use summary::{LevelSummary, Summary, ZoneSummary};

//! The level frame of a site against Earth-centred coordinates.
#![expect(clippy::unwrap_used, reason = "tests")]

use adit_core::geodesy::Geodetic;
use adit_core::level_frame::LevelFrame;
use adit_core::nalgebra::Vector2;
use proptest::prelude::*;

proptest! {
    #[test]
    fn there_and_back(
        latitude in -85.0..85.0_f64, longitude in -180.0..180.0_f64, height in -4000.0..4000.0_f64,
        east in -2e4..2e4_f64, north in -2e4..2e4_f64, up in -2000.0..2000.0_f64,
    ) {
        let origin = Geodetic::from_degrees(latitude, longitude, height).unwrap();
        let frame = LevelFrame::new(origin);
        let point = frame.point(&Vector2::new(east, north), up).unwrap();
        let back = frame.position_m(&point);
        // What the level surface leaves out of its sphere: (d²/2R)(e²) of height, at a slope of d/R: 1 mm at 28 km.
        prop_assert!((back.xy() - Vector2::new(east, north)).norm() < 1.5e-3, "{back}");
        prop_assert!((back.z - up).abs() < 1e-8);
    }

    /// East and north are those of the tangent plane; up is not, and says by how much.
    #[test]
    fn east_and_north_are_those_of_the_tangent_plane(
        latitude in -85.0..85.0_f64, east in -2e4..2e4_f64, north in -2e4..2e4_f64, up in -2000.0..2000.0_f64,
    ) {
        let origin = Geodetic::from_degrees(latitude, 7.0, 100.0).unwrap();
        let frame = LevelFrame::new(origin);
        let point = frame.point(&Vector2::new(east, north), up).unwrap();
        let plane = origin.enu_frame().position(&point.to_ecef());
        let level = frame.position_m(&point);
        prop_assert!((plane.raw().xy() - level.xy()).norm() < 1e-8, "{} {level}", plane.raw());
        let falls = (east * east + north * north) / (2.0 * 6.37e6);
        prop_assert!((level.z - plane.raw().z - falls).abs() < 0.01 * falls + 1e-6);
    }
}

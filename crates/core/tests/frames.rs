//! Frames: known axes, round trips, chains.

#![expect(clippy::unwrap_used, reason = "a test may stop at the first wrong value")]

use adit_core::attitude::{exp, heading};
use adit_core::frames::{
    Body, Ecef, Enu, GridPlacement, MineGrid, Ned, Position, Rotation, Transform, Vector,
};
use adit_core::nalgebra::{UnitQuaternion, Vector3};
use core::f64::consts::FRAC_PI_2;
use proptest::prelude::*;

fn raw() -> impl Strategy<Value = Vector3<f64>> {
    [-1e4..1e4, -1e4..1e4, -1e4..1e4].prop_map(Vector3::from)
}

fn turn() -> impl Strategy<Value = UnitQuaternion<f64>> {
    [-3.0..3.0, -3.0..3.0, -3.0..3.0].prop_map(|v| exp(&Vector3::from(v)))
}

#[test]
fn north_east_down_becomes_east_north_up() {
    assert_eq!(Vector::<Enu>::from(Vector::<Ned>::new(1.0, 2.0, 3.0)), Vector::new(2.0, 1.0, -3.0));
    assert_eq!(Position::<Ned>::from(Position::<Enu>::new(2.0, 1.0, -3.0)), Position::new(1.0, 2.0, 3.0));
}

#[test]
fn a_level_forward_right_down_sensor_that_faces_east_keeps_facing_east() {
    // NED: a yaw of +90° about down takes forward from north to east.
    let ned = Rotation::<Body, Ned>::from_raw(exp(&Vector3::new(0.0, 0.0, FRAC_PI_2)));
    let enu = ned.to_enu();
    assert!((heading(enu.raw()) - FRAC_PI_2).abs() < 1e-15);
    // Its z axis still looks down: the body axes are the sensor's own ...
    assert!((enu.apply(&Vector::new(0.0, 0.0, 1.0)) - Vector::new(0.0, 0.0, -1.0)).norm() < 1e-15);
    // ... until they are turned to forward-left-up.
    let upright = enu.with_body_half_turned_about_x();
    assert!((upright.apply(&Vector::new(0.0, 0.0, 1.0)) - Vector::new(0.0, 0.0, 1.0)).norm() < 1e-15);
    assert!((heading(upright.raw()) - FRAC_PI_2).abs() < 1e-15);
}

#[test]
fn level_forward_left_up_facing_east_is_the_identity_of_enu() {
    let ned = Rotation::<Body, Ned>::from_raw(exp(&Vector3::new(0.0, 0.0, FRAC_PI_2)));
    assert!(ned.to_enu().with_body_half_turned_about_x().raw().angle() < 1e-15);
}

#[test]
fn grid_north_lies_east_of_true_north_by_the_convergence() {
    let grid = GridPlacement { origin: Position::new(5_000.0, 3_000.0, 100.0), convergence_rad: 0.03 };
    let north = grid.to_enu().vector(&Vector::new(0.0, 1.0, 0.0));
    assert!((north - Vector::new(0.03_f64.sin(), 0.03_f64.cos(), 0.0)).norm() < 1e-15);
    // A walker who faces grid north faces a true heading of the convergence.
    let faces_grid_north = Rotation::<Body, MineGrid>::from_raw(exp(&Vector3::new(0.0, 0.0, FRAC_PI_2)));
    let attitude = faces_grid_north.then(grid.to_enu().rotation());
    assert!((heading(attitude.raw()) - grid.true_heading(0.0)).abs() < 1e-15);
    assert!((grid.true_heading(0.0) - 0.03).abs() < 1e-15);
    assert_eq!(grid.to_enu().position(&grid.origin), Position::ORIGIN);
}

#[test]
fn the_origin_of_a_transform_lands_on_zero() {
    let origin = Position::<Enu>::new(10.0, 20.0, 30.0);
    let to_body = Transform::<Enu, Body>::new(Rotation::from_raw(exp(&Vector3::new(0.4, 0.5, 0.6))), origin);
    assert_eq!(to_body.position(&origin), Position::ORIGIN);
    assert_eq!(to_body.origin(), &origin);
}

#[test]
fn typed_coordinates_travel_as_bare_numbers() {
    let position = Position::<MineGrid>::new(1.0, 2.0, -640.5);
    let text = serde_json::to_string(&position).unwrap();
    assert_eq!(text, "[1.0,2.0,-640.5]");
    assert_eq!(serde_json::from_str::<Position<MineGrid>>(&text).unwrap(), position);
    let attitude = Rotation::<Body, Enu>::identity();
    // nalgebra's order: the scalar last.
    assert_eq!(serde_json::to_string(&attitude).unwrap(), "[0.0,0.0,0.0,1.0]");
}

proptest! {
    #[test]
    fn ned_and_back_is_exact(v in raw()) {
        let v = Vector::<Enu>::from_raw(v);
        prop_assert_eq!(Vector::<Enu>::from(Vector::<Ned>::from(v)), v);
    }

    /// Turning a body vector and then swapping axes is swapping the attitude and then turning.
    #[test]
    fn attitude_and_vector_swaps_agree(q in turn(), v in raw()) {
        let ned = Rotation::<Body, Ned>::from_raw(q);
        let v = Vector::<Body>::from_raw(v);
        let difference = ned.to_enu().apply(&v) - Vector::<Enu>::from(ned.apply(&v));
        prop_assert!(difference.norm() < 1e-15 * 10.0 * v.norm());
        prop_assert!(ned.to_enu().to_ned().raw().angle_to(&q) < 1e-15);
    }

    #[test]
    fn the_way_back_leads_back(q in turn(), origin in raw(), p in raw()) {
        let there = Transform::<MineGrid, Enu>::new(Rotation::from_raw(q), Position::from_raw(origin));
        let p = Position::<MineGrid>::from_raw(p);
        // Coordinates up to 5e4 m, and a few 1e-16 of them lost in each of up to four rotations.
        prop_assert!((there.inverse().position(&there.position(&p)) - p).norm() < 1e-10);
        let round = there.then(&there.inverse());
        prop_assert!((round.position(&p) - p).norm() < 1e-10);
    }

    #[test]
    fn a_chain_is_its_links_one_after_the_other(q1 in turn(), o1 in raw(), q2 in turn(), o2 in raw(), p in raw()) {
        let first = Transform::<Body, Enu>::new(Rotation::from_raw(q1), Position::from_raw(o1));
        let second = Transform::<Enu, Ecef>::new(Rotation::from_raw(q2), Position::from_raw(o2));
        let chain: Transform<Body, Ecef> = first.then(&second);
        let p = Position::<Body>::from_raw(p);
        prop_assert!((chain.position(&p) - second.position(&first.position(&p))).norm() < 1e-10);
        let v = Vector::<Body>::from_raw(*p.raw());
        prop_assert!((chain.vector(&v) - second.vector(&first.vector(&v))).norm() < 1e-10);
    }

    #[test]
    fn a_transform_keeps_lengths(q in turn(), origin in raw(), a in raw(), b in raw()) {
        let t = Transform::<MineGrid, Enu>::new(Rotation::from_raw(q), Position::from_raw(origin));
        let (a, b) = (Position::from_raw(a), Position::from_raw(b));
        prop_assert!(((t.position(&a) - t.position(&b)).norm() - (a - b).norm()).abs() < 1e-10);
    }
}

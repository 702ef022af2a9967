//! The magnetic world against integrals of Biot and Savart, identities of Maxwell, and textbook values.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

use adit_core::nalgebra::{Matrix3, Vector3};
use adit_simulation::{Cable, Course, EarthField, FootWalkScenario, MagneticWorld, Motion, Move, SteelBody};
use core::f64::consts::{FRAC_PI_2, PI, TAU};

const NO_EARTH: EarthField = EarthField { norm_ut: 0.0, dip_rad: 0.0, declination_rad: 0.0 };

fn body(moment_a_m2: Vector3<f64>) -> SteelBody {
    SteelBody::new(Course::standing(Vector3::zeros()), moment_a_m2)
}

fn field(body: &SteelBody, x: f64, y: f64, z: f64) -> Vector3<f64> {
    body.field_ut(&NO_EARTH, &Vector3::new(x, y, z), 0.0)
}

/// Biot and Savart: the field at `at` of a current through short straight pieces, µT (`μ₀/4π` is 0.1 µT·m/A).
fn biot_savart(corners: &[Vector3<f64>], current_a: f64, at: &Vector3<f64>) -> Vector3<f64> {
    let pieces = corners.windows(2).map(|ends| {
        let (piece, from) = (ends[1] - ends[0], at - 0.5 * (ends[0] + ends[1]));
        piece.cross(&from) * (0.1 * current_a / from.norm().powi(3))
    });
    pieces.sum()
}

/// Central differences of a field; columns are the derivatives by x, y and z.
fn gradient(field: impl Fn(&Vector3<f64>) -> Vector3<f64>, at: &Vector3<f64>, h: f64) -> Matrix3<f64> {
    let column = |axis: Vector3<f64>| (field(&(at + axis * h)) - field(&(at - axis * h))) / (2.0 * h);
    Matrix3::from_columns(&[column(Vector3::x()), column(Vector3::y()), column(Vector3::z())])
}

/// Points all around, between 1 and 3 m from the origin.
fn places() -> impl Iterator<Item = Vector3<f64>> {
    (0..60).map(|i| {
        let turn = f64::from(i);
        let (radius, height) = (1.0 + f64::from(i % 7) / 3.5, libm::sin(2.4 * turn));
        let level = libm::sqrt(1.0 - height * height);
        Vector3::new(level * libm::cos(turn), level * libm::sin(turn), height) * radius
    })
}

#[test]
fn the_field_of_harbin_is_that_of_the_world_magnetic_model() {
    let enu = EarthField::harbin().enu_ut();
    // East, north and up of WMM2015v2 at 45.776° N 126.68° E, 140 m, 2015.0, by the Python package pygeomag, nT.
    let published = Vector3::new(-4_559.65, 24_340.55, -49_424.08) / 1000.0;
    // The preset is written to 0.001° and 1 nT: 1e-3° of 55 µT is 1 nT, in each of two angles.
    assert!((enu - published).amax() < 2e-3, "{enu}");
}

#[test]
fn norm_dip_and_declination_come_back_from_the_components() {
    let earth = EarthField { norm_ut: 48.0, dip_rad: -0.7, declination_rad: 0.3 };
    let enu = earth.enu_ut();
    // Rounding only.
    assert!((enu.norm() - 48.0).abs() < 1e-13);
    assert!((libm::asin(-enu.z / enu.norm()) + 0.7).abs() < 1e-14);
    assert!((libm::atan2(enu.x, enu.y) - 0.3).abs() < 1e-14, "magnetic north lies east of true north");
}

#[test]
fn steel_has_the_field_of_a_small_current_loop() {
    let (radius_m, turns) = (0.01, 720_u32);
    let loop_of_wire: Vec<Vector3<f64>> = (0..=turns)
        .map(|i| {
            let angle = TAU * f64::from(i) / f64::from(turns);
            Vector3::new(radius_m * libm::cos(angle), radius_m * libm::sin(angle), 0.0)
        })
        .collect();
    let current_a = 1e6;
    let body = body(Vector3::z() * (current_a * PI * radius_m * radius_m));
    for at in places() {
        let (ours, theirs) = (field(&body, at.x, at.y, at.z), biot_savart(&loop_of_wire, current_a, &at));
        // A loop differs from a dipole by 15/8 (a/r)² at most, 2e-4; its polygon by 2e-5.
        assert!((ours - theirs).norm() < 3e-4 * ours.norm(), "{at}");
    }
}

#[test]
fn a_dipole_is_twice_as_strong_on_its_axis_and_falls_with_the_cube() {
    let body = body(Vector3::z() * 500.0);
    let (axis, beside) = (field(&body, 0.0, 0.0, 2.0), field(&body, 2.0, 0.0, 0.0));
    // μ₀/4π 2m/r³ = 0.1 · 1000/8 µT; rounding.
    assert!((axis - Vector3::z() * 12.5).norm() < 1e-13);
    assert!((axis + 2.0 * beside).norm() < 1e-13);
    assert!((field(&body, 0.0, 0.0, 4.0) * 8.0 - axis).norm() < 1e-13);
}

#[test]
fn no_field_has_sources_or_whirls_where_there_is_no_steel_and_no_current() {
    let steel = body(Vector3::new(300.0, -120.0, 450.0));
    let cable = Cable::direct(Vector3::new(4.0, 0.0, 1.0), Vector3::new(0.2, 1.0, -0.1), 300.0);
    let world = MagneticWorld { earth: EarthField::harbin(), steel: vec![steel], cables: vec![cable] };
    for at in places() {
        let gradient = gradient(|p| world.field_ut(p, 0.0), &at, 1e-4);
        // Central differences err by h²/6 times the third derivative: 60 · 90 µT/m³ at 1 m, 1e-5 µT/m.
        let tolerance = 1e-7 * gradient.norm().max(100.0);
        assert!(gradient.trace().abs() < tolerance, "divergence {} at {at}", gradient.trace());
        assert!((gradient - gradient.transpose()).amax() < tolerance, "curl at {at}");
    }
}

#[test]
fn no_flux_is_lost_on_the_skin_of_a_body() {
    let body = body(Vector3::new(30.0, 10.0, -20.0));
    for towards in places().map(|p| p.normalize()) {
        let through = |distance_m: f64| {
            let at = towards * distance_m;
            field(&body, at.x, at.y, at.z).dot(&towards)
        };
        let (inside, outside) = (through(0.3 - 1e-12), through(0.3 + 1e-12));
        // The flux density changes by 3/0.3 m of itself per metre: 1e-11 over the gap.
        assert!((inside - outside).abs() < 1e-9 * inside.abs().max(1.0), "{inside} {outside}");
    }
}

#[test]
fn a_sphere_of_iron_gathers_three_times_the_field_at_its_pole_and_none_at_its_waist() {
    let earth = EarthField { norm_ut: 50.0, dip_rad: -FRAC_PI_2, declination_rad: 0.0 };
    let mut iron = body(Vector3::zeros());
    (iron.radius_m, iron.induced_m3) = (0.5, 3.0 * 4.0 / 3.0 * PI * 0.125);
    let world = MagneticWorld { earth, steel: vec![iron], cables: Vec::new() };
    // Infinite permeability (Jackson 1999, eq. 5.115 and 5.121); the points are 1e-9 m outside.
    let pole = world.field_ut(&Vector3::new(0.0, 0.0, 0.5 + 1e-9), 0.0);
    let waist = world.field_ut(&Vector3::new(0.5 + 1e-9, 0.0, 0.0), 0.0);
    assert!((pole.z - 150.0).abs() < 1e-6, "{pole}");
    assert!(waist.norm() < 1e-6, "{waist}");
}

#[test]
fn a_cable_has_the_field_of_a_long_straight_wire() {
    let along = Vector3::new(1.0, 2.0, -0.5).normalize();
    let through = Vector3::new(0.3, -0.2, 0.1);
    let cable = Cable::direct(through, along * 3.0, 200.0);
    let wire: Vec<Vector3<f64>> =
        (-200_000..=200_000).map(|i| through + along * (f64::from(i) * 0.005)).collect();
    for at in [Vector3::new(2.0, 0.0, 0.0), Vector3::new(0.0, 0.0, 1.5)] {
        let (ours, theirs) = (cable.field_ut(&at, 0.0), biot_savart(&wire, 200.0, &at));
        // 1 km to either side: its ends are missed by (r/L)²/2, 2e-6; the pieces by (5 mm/r)²/24, 4e-7.
        assert!((ours - theirs).norm() < 4e-6 * ours.norm(), "{ours} {theirs}");
    }
    // 2e-7 T·m/A · 200 A / 1 m = 40 µT, the textbook's number.
    let square_to = along.cross(&Vector3::x()).normalize();
    assert!((cable.field_ut(&(through + square_to), 0.0).norm() - 40.0).abs() < 1e-12);
}

#[test]
fn an_alternating_current_turns_the_field_around_every_half_period() {
    let direct = Cable::direct(Vector3::zeros(), Vector3::x(), 100.0);
    let mains = Cable { frequency_hz: 50.0, ..direct };
    let at = Vector3::new(0.0, 1.0, 0.0);
    // Rounding of the phase.
    assert!((mains.field_ut(&at, 7.01) + direct.field_ut(&at, 0.0)).norm() < 1e-9);
    assert!(mains.field_ut(&at, 0.005).norm() < 1e-9);
}

#[test]
fn nothing_is_infinite_even_in_the_middle_of_a_body() {
    let far_too_near = Vector3::zeros();
    let cable = Cable::direct(far_too_near, Vector3::x(), 1000.0);
    assert!(cable.field_ut(&far_too_near, 0.0).norm().abs() < f64::MIN_POSITIVE);
    assert!(field(&body(Vector3::z() * 1e4), 0.0, 0.0, 0.0).norm().is_finite());
}

#[test]
fn a_body_is_as_strong_as_it_was_ordered() {
    let earth = EarthField::harbin();
    let ordered = body(Vector3::z()).with_field_at(&earth, 30.0, 1.5).unwrap();
    assert!((field(&ordered, 0.0, 0.0, 1.5).norm() - 30.0).abs() < 1e-12);
    assert!((field(&ordered, 1.5, 0.0, 0.0).norm() - 15.0).abs() < 1e-12);

    let walk = FootWalkScenario::straight(20.0).walk(3).unwrap();
    let go = Move::Go { to_m: [-30.0, -1.5, 0.6], speed_m_s: 1.5 };
    let course = Course::moving([40.0, -1.5, 0.6], 0.0, &[go]).unwrap();
    let car = SteelBody::new(course, Vector3::new(250.0, 80.0, -400.0));
    let car = car.with_peak_along(&earth, 30.0, &walk).unwrap();
    let met = |step_s: f64| {
        (0..1_000_000)
            .map(|i| f64::from(i) * step_s)
            .take_while(|t| *t <= walk.duration_s())
            .map(|t| car.field_ut(&earth, &walk.at(t).position_m, t).norm())
            .fold(0.0, f64::max)
    };
    // Half a step of 0.1 ms at 5 m/s of foot against car is 0.3 mm of 1.6 m, squared, times 6; and two grids.
    assert!((met(0.000_07) - 30.0).abs() < 1e-4, "{}", met(0.000_07));
}

#[test]
fn a_body_without_moment_or_with_numbers_that_are_none_is_refused() {
    let earth = EarthField::harbin();
    assert!(body(Vector3::zeros()).with_field_at(&earth, 30.0, 1.5).is_err());
    assert!(body(Vector3::z()).with_field_at(&earth, f64::NAN, 1.5).is_err());
    assert!(body(Vector3::z()).with_field_at(&earth, 30.0, 0.0).is_err());
    assert!(Course::moving([0.0; 3], f64::NAN, &[]).is_err());
    assert!(Course::moving([0.0, f64::INFINITY, 0.0], 0.0, &[]).is_err());
    let standstill = Move::Go { to_m: [1.0, 0.0, 0.0], speed_m_s: 0.0 };
    assert!(Course::moving([0.0; 3], 0.0, &[standstill]).is_err());
    let nowhere = Cable::direct(Vector3::zeros(), Vector3::zeros(), 1.0);
    assert!(nowhere.check().is_err());
    assert!(EarthField { norm_ut: f64::NAN, ..earth }.check().is_err());
}

#[test]
fn a_car_waits_goes_stops_and_goes_on() {
    let moves = [
        Move::Go { to_m: [10.0, 0.0, 1.0], speed_m_s: 2.0 },
        Move::Stop { seconds: 20.0 },
        Move::Go { to_m: [10.0, 6.0, 1.0], speed_m_s: 3.0 },
    ];
    let course = Course::moving([0.0, 0.0, 1.0], 100.0, &moves).unwrap();
    for (time_s, x, y, yaw) in [
        (0.0, 0.0, 0.0, 0.0),
        (102.0, 4.0, 0.0, 0.0),
        (105.0, 10.0, 0.0, 0.0),
        (124.9, 10.0, 0.0, 0.0),
        (126.0, 10.0, 3.0, FRAC_PI_2),
        (1e6, 10.0, 6.0, FRAC_PI_2),
    ] {
        let (position_m, yaw_rad) = course.pose(time_s);
        // Rounding of times of 1e2 s.
        assert!((position_m - Vector3::new(x, y, 1.0)).norm() < 1e-12, "{position_m} at {time_s}");
        assert!((yaw_rad - yaw).abs() < 1e-12, "{yaw_rad} at {time_s}");
    }
}

#[test]
fn a_car_that_waits_first_already_looks_where_it_will_go() {
    let moves = [Move::Stop { seconds: 5.0 }, Move::Go { to_m: [0.0, 9.0, 0.0], speed_m_s: 1.0 }];
    let course = Course::moving([0.0; 3], 10.0, &moves).unwrap();
    for time_s in [0.0, 12.0, 17.0] {
        assert!((course.pose(time_s).1 - FRAC_PI_2).abs() < 1e-15, "at {time_s}");
    }
}

#[test]
fn the_permanent_moment_turns_with_the_car_and_the_induced_one_does_not() {
    let corner = [
        Move::Go { to_m: [10.0, 0.0, 0.0], speed_m_s: 1.0 },
        Move::Go { to_m: [10.0, 10.0, 0.0], speed_m_s: 1.0 },
    ];
    let course = Course::moving([0.0; 3], 0.0, &corner).unwrap();
    let earth = EarthField::harbin();
    let mut car = SteelBody::new(course, Vector3::new(100.0, 20.0, -50.0));
    // 2 m ahead of the car, before and after the turn.
    let ahead = |car: &SteelBody| {
        let before = car.field_ut(&earth, &Vector3::new(7.0, 0.0, 0.0), 5.0);
        (before, car.field_ut(&earth, &Vector3::new(10.0, 7.0, 0.0), 15.0))
    };
    let (before, after) = ahead(&car);
    assert!((Vector3::new(-before.y, before.x, before.z) - after).norm() < 1e-12);
    (car.permanent_a_m2, car.induced_m3) = (Vector3::zeros(), 5.0);
    let (before, after) = ahead(&car);
    assert!((before - after).norm() > 1.0, "ahead is now another side of the same moment");
}

#[test]
fn a_car_beside_the_walker_keeps_its_distance_from_the_footprints() {
    let walk = FootWalkScenario::loops(1).walk(2).unwrap();
    let (from_s, until_s) = (10.0, 30.0);
    let course = Course::beside(&walk, [0.0, -1.5, 0.5], from_s, until_s).unwrap();
    for stride in walk.strides().iter().filter(|s| (from_s..until_s).contains(&s.start_s)) {
        let (car_m, yaw_rad) = course.pose(stride.start_s);
        let away = car_m - stride.from.position_m;
        let right = Vector3::new(libm::sin(yaw_rad), -libm::cos(yaw_rad), 0.0);
        // Rounding: a footprint is a knot of the course.
        assert!((yaw_rad - stride.from.yaw_rad).abs() < 1e-9);
        assert!((away - right * 1.5 - Vector3::z() * 0.5).norm() < 1e-9, "{away} at {}", stride.start_s);
    }
    assert_eq!(course.pose(0.0), course.pose(from_s), "it stands before");
    assert_eq!(course.pose(1e5), course.pose(until_s), "and after");
}

//! The field of Earth, steel and cables against field theory, and steel on its course.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

use adit_core::nalgebra::{Matrix3, Vector3};
use adit_simulation::{
    Cable, Course, EarthField, FootWalkScenario, MagneticWorld, Motion, Move, SimulationError, SteelBody,
    Tumble,
};
use core::f64::consts::{PI, TAU};

/// No Earth's field: what is left is the source's.
const NOWHERE: EarthField = EarthField { norm_ut: 0.0, dip_rad: 0.0, declination_rad: 0.0 };

fn steel(moment_a_m2: Vector3<f64>) -> SteelBody {
    SteelBody::new(Course::standing(Vector3::new(0.4, -0.2, 0.1)), moment_a_m2)
}

fn steel_field(body: &SteelBody, from_centre_m: Vector3<f64>) -> Vector3<f64> {
    body.field_ut(&NOWHERE, &(Vector3::new(0.4, -0.2, 0.1) + from_centre_m), 0.0)
}

/// Magnetic field of a current loop around z by the law of Biot and Savart, summed over its pieces, µT.
fn loop_field(radius_m: f64, current_a: f64, at_m: &Vector3<f64>) -> Vector3<f64> {
    let pieces = 720_i32;
    (0..pieces)
        .map(|i| {
            let angle = TAU * f64::from(i) / f64::from(pieces);
            let here = Vector3::new(angle.cos(), angle.sin(), 0.0) * radius_m;
            let piece = Vector3::new(-angle.sin(), angle.cos(), 0.0) * (radius_m * TAU / f64::from(pieces));
            let away = at_m - here;
            piece.cross(&away) * (0.1 * current_a / away.norm().powi(3))
        })
        .sum()
}

/// `∂B_i/∂x_j` by central differences over 0.2 mm, µT/m.
fn gradient(field: impl Fn(&Vector3<f64>) -> Vector3<f64>, at_m: &Vector3<f64>) -> Matrix3<f64> {
    let half = 1e-4;
    let column =
        |axis: Vector3<f64>| (field(&(at_m + axis * half)) - field(&(at_m - axis * half))) / (2.0 * half);
    Matrix3::from_columns(&[column(Vector3::x()), column(Vector3::y()), column(Vector3::z())])
}

/// Divergence and curl over the size of the gradient.
fn divergence_and_curl(field: impl Fn(&Vector3<f64>) -> Vector3<f64>, at_m: &Vector3<f64>) -> (f64, f64) {
    let g = gradient(field, at_m);
    (g.trace() / g.norm(), (g - g.transpose()).norm() / g.norm())
}

#[test]
fn on_the_axis_of_a_dipole_the_field_is_twice_that_square_to_it() {
    // 100 A·m² at 2 m: 1e-7 · 2 · 100/8 T = 2.5 µT on the axis, half of it, and against the moment, at the equator.
    let body = steel(Vector3::new(0.0, 0.0, 100.0));
    for (from_centre_m, expected_ut) in [
        (Vector3::new(0.0, 0.0, 2.0), 2.5),
        (Vector3::new(0.0, 0.0, -2.0), 2.5),
        (Vector3::new(2.0, 0.0, 0.0), -1.25),
        (Vector3::new(0.0, -2.0, 0.0), -1.25),
    ] {
        let field = steel_field(&body, from_centre_m);
        // Rounding.
        assert!((field - Vector3::z() * expected_ut).norm() < 1e-12, "{field}");
    }
}

#[test]
fn a_dipole_is_a_small_current_loop_by_biot_and_savart() {
    let (radius_m, current_a) = (0.02, 1000.0);
    let body = steel(Vector3::z() * (PI * radius_m * radius_m * current_a));
    for at_m in [Vector3::new(0.7, 0.4, 0.6), Vector3::new(-0.3, 1.1, -0.5), Vector3::new(0.0, 0.1, 0.9)] {
        let (dipole, current) = (steel_field(&body, at_m), loop_field(radius_m, current_a, &at_m));
        // The octupole of the loop is at most 3/2 (radius/distance)² of the dipole, on the axis: 7.4e-4 at 0.9 m.
        assert!((dipole - current).norm() < 8e-4 * current.norm(), "{dipole} {current}");
    }
}

#[test]
fn steel_has_no_divergence_and_no_curl_and_the_normal_field_goes_through_its_surface() {
    let mut body = steel(Vector3::new(30.0, -80.0, 50.0));
    body.induced_m3 = 0.7;
    let field = |at_m: &Vector3<f64>| {
        let body = &body;
        body.field_ut(&EarthField::harbin(), &(Vector3::new(0.4, -0.2, 0.1) + at_m), 0.0)
    };
    for at_m in [Vector3::new(0.5, 0.3, 0.2), Vector3::new(-2.0, 1.0, 0.7), Vector3::new(0.1, -6.0, 3.0)] {
        let (divergence, curl) = divergence_and_curl(field, &at_m);
        // Differences of 0.2 mm at 0.6 m: (h/r)² · 20 ≈ 6e-7.
        assert!(divergence.abs() < 2e-6 && curl < 2e-6, "{divergence} {curl}");
    }
    for direction in [Vector3::new(1.0, 2.0, -2.0) / 3.0, Vector3::new(0.6, 0.0, 0.8)] {
        let (inside, outside) = (field(&(direction * (0.3 - 1e-9))), field(&(direction * (0.3 + 1e-9))));
        // 2 nm apart in a field that falls by its third power over 0.3 m: 2e-8.
        assert!((inside - outside).dot(&direction).abs() < 1e-7 * inside.norm());
        assert_eq!(inside, field(&Vector3::new(0.01, 0.0, -0.02)), "even inside");
    }
}

#[test]
fn the_earth_magnetises_steel_along_its_field() {
    // Apparent volume 2 m³ at 50 µT, straight down: 2 · 50e-6/(4π 1e-7) = 79.577 A·m².
    let earth = EarthField { norm_ut: 50.0, dip_rad: PI / 2.0, declination_rad: 0.0 };
    let mut body = steel(Vector3::zeros());
    body.induced_m3 = 2.0;
    let above = body.field_ut(&earth, &Vector3::new(0.4, -0.2, 3.1), 0.0);
    let expected_ut = -2e-7 * 79.577_472 / 27.0 * 1e6;
    // Six digits of the number above.
    assert!((above.z / expected_ut - 1.0).abs() < 1e-7 && above.xy().norm() < 1e-12, "{above}");
}

#[test]
fn a_permanent_moment_turns_with_its_body() {
    let there_and_back = [
        Move::Stop { seconds: 3.0 },
        Move::Go { to_m: [0.0, 10.0, 0.0], speed_m_s: 1.0 },
        Move::Go { to_m: [0.0, 0.0, 0.0], speed_m_s: 2.0 },
    ];
    let course = Course::moving([0.0; 3], 1.0, &there_and_back).unwrap();
    let body = SteelBody::new(course.clone(), Vector3::new(10.0, 0.0, 0.0));
    // Looks north from the first, also while it waits.
    for (time_s, north_m, towards) in
        [(0.0, 0.0, 1.0), (2.0, 0.0, 1.0), (9.0, 5.0, 1.0), (16.5, 5.0, -1.0), (30.0, 0.0, -1.0)]
    {
        let (place, yaw_rad) = course.pose(time_s);
        assert!((place - Vector3::new(0.0, north_m, 0.0)).norm() < 1e-12, "{time_s} s: {place}");
        assert!((yaw_rad - towards * PI / 2.0).abs() < 1e-12, "{time_s} s: {yaw_rad}");
        let north_of_it = body.field_ut(&NOWHERE, &(place + Vector3::y()), time_s);
        assert!((north_of_it - Vector3::y() * (2.0 * towards)).norm() < 1e-12, "{time_s} s: {north_of_it}");
    }
}

#[test]
fn a_cable_obeys_amperes_law_and_the_right_hand_rule() {
    // 20 A: 4 µT at 1 m. Current east, one metre above it: the field points south.
    let cable = Cable::direct(Vector3::new(5.0, 2.0, 1.0), Vector3::x() * 3.0, 20.0);
    let above = cable.field_ut(&Vector3::new(-40.0, 2.0, 2.0), 0.0);
    assert!((above - Vector3::new(0.0, -4.0, 0.0)).norm() < 1e-12, "{above}");

    let slanted = Cable::direct(Vector3::new(0.3, 0.2, 0.1), Vector3::new(1.0, 2.0, 3.0), 50.0);
    let at = |p: &Vector3<f64>| slanted.field_ut(p, 0.0);
    let (divergence, curl) = divergence_and_curl(at, &Vector3::new(-0.4, 0.9, 0.2));
    assert!(divergence.abs() < 2e-6 && curl < 2e-6, "{divergence} {curl}");

    // Around a circle about the axis, ∮ B dl = μ₀ I: 4π 1e-7 · 50 T·m. Inside the conductor, the share within it.
    let thick = Cable { radius_m: 0.5, ..Cable::direct(Vector3::zeros(), Vector3::z(), 50.0) };
    let circulation = |radius_m: f64| -> f64 {
        let pieces = 400_i32;
        (0..pieces)
            .map(|i| {
                let (sin, cos) = (TAU * f64::from(i) / f64::from(pieces)).sin_cos();
                let along = Vector3::new(-sin, cos, 0.0) * (radius_m * TAU / f64::from(pieces));
                thick.field_ut(&Vector3::new(radius_m * cos, radius_m * sin, 7.0), 0.0).dot(&along)
            })
            .sum()
    };
    let whole = 0.4 * PI * 50.0;
    assert!((circulation(1.3) / whole - 1.0).abs() < 1e-12);
    assert!((circulation(0.25) / whole - 0.25).abs() < 1e-12);
}

#[test]
fn an_alternating_current_turns_its_field_around() {
    let cable = Cable { frequency_hz: 50.0, ..Cable::direct(Vector3::zeros(), Vector3::x(), 10.0) };
    let at = |time_s| cable.field_ut(&Vector3::z(), time_s).y;
    assert!((at(0.01) + at(0.0)).abs() < 1e-12 && at(0.005).abs() < 1e-12 && at(0.0) < -1.9);
}

#[test]
fn the_field_at_the_court_has_the_norm_dip_and_declination_of_its_model() {
    let field = MagneticWorld::undisturbed(EarthField::harbin()).field_ut(&Vector3::new(8.0, -3.0, 1.0), 9.0);
    // Components of WMM2015v2 by pygeomag 1.1.0: GeoMag(coefficients_file='wmm/WMM_2015v2.COF').calculate(glat=45.776,
    // glon=126.68, alt=0.14, time=2015.0). Norm and angles are kept to 1 nT and 0.001°, half of it twice in 55 µT: 0.7 nT.
    let model = Vector3::new(-4.559_651_1, 24.340_547_2, -49.424_078_9);
    assert!((field - model).norm() < 1e-3, "{field}");
}

#[test]
fn a_peak_is_met_as_configured_wherever_the_body_goes() {
    let walk = FootWalkScenario::straight(20.0).walk(3).unwrap();
    let drive = [Move::Go { to_m: [30.0, 1.4, 0.5], speed_m_s: 2.0 }];
    let course = Course::moving([-10.0, 1.4, 0.5], 2.0, &drive).unwrap();
    let mut body = SteelBody::new(course, Vector3::new(3.0, 1.0, -2.0));
    body.induced_m3 = 0.1;
    let body = body.with_peak_along(&EarthField::harbin(), 30.0, &walk).unwrap();
    let world = MagneticWorld { steel: vec![body], ..MagneticWorld::default() };
    assert!(walk.duration_s() < 30.0);
    let largest = (0..30_000)
        .map(|i| {
            let time_s = f64::from(i) * 1e-3;
            world.disturbance_ut(&walk.at(time_s).position_m, time_s).norm()
        })
        .fold(0.0, f64::max);
    // Looked for every 5 ms; between two looks foot and car come nearer by at most 2.5 ms · 6 m/s of 1.5 m: 3 · 1 %.
    assert!((30.0 - 1e-9..30.9).contains(&largest), "{largest}");
}

#[test]
fn a_strength_at_a_distance_is_that_on_the_axis() {
    let earth = EarthField::harbin();
    let body = steel(Vector3::new(0.0, 7.0, 0.0)).with_field_at(&NOWHERE, 12.0, 2.5).unwrap();
    assert!((steel_field(&body, Vector3::new(0.0, 2.5, 0.0)).y - 12.0).abs() < 1e-12);
    let inside = steel(Vector3::y()).with_field_at(&earth, 12.0, 0.2).unwrap_err();
    assert_eq!(inside.to_string(), "distance_m is 0.2, expected radius_m (default 0.3) to 1000 m");
    let nothing = steel(Vector3::zeros()).with_field_at(&earth, 12.0, 2.0).unwrap_err();
    assert!(matches!(nothing, SimulationError::Parameter { name: "moment_a_m2", .. }), "{nothing}");
    let far = SteelBody::new(Course::standing(Vector3::new(9e4, 0.0, 0.0)), Vector3::y());
    let far = far.with_peak_along(&earth, 30.0, &Tumble::still(1.0, 1.0)).unwrap_err();
    assert!(matches!(far, SimulationError::Parameter { name: "peak_at_sensor_ut", .. }), "{far}");
}

#[test]
fn a_body_beside_the_walker_keeps_its_place_and_stands_before_and_after() {
    let walk = FootWalkScenario::loops(1).walk(5).unwrap();
    let course = Course::beside(&walk, [0.5, -1.5, 0.4], 8.0, 30.0).unwrap();
    assert_eq!(course.pose(0.0), course.pose(8.0));
    assert_eq!(course.pose(30.0), course.pose(99.0));
    let offset = |time_s: f64| course.pose(time_s).0 - walk.at(time_s).position_m;
    for stride in walk.strides().iter().filter(|stride| (8.0..29.0).contains(&stride.start_s)) {
        // On the ground it is where it should be, turned as the foot is.
        let time_s = stride.start_s + 0.5 * stride.still_s;
        let (sin, cos) = stride.from.yaw_rad.sin_cos();
        let expected = Vector3::new(cos * 0.5 + sin * 1.5, sin * 0.5 - cos * 1.5, 0.4);
        assert!((offset(time_s) - expected).norm() < 1e-9, "{time_s}");
        // While the foot swings it goes evenly.
        let (halfway, _) = course.pose(stride.start_s + stride.still_s + 0.5 * stride.moving_s);
        let (before, after) = (course.pose(time_s).0, course.pose(stride.end_s()).0);
        assert!((halfway - (before + after) / 2.0).norm() < 1e-9);
    }
}

#[test]
fn refuses_what_no_world_has() {
    let good = MagneticWorld {
        steel: vec![steel(Vector3::x())],
        cables: vec![Cable::direct(Vector3::zeros(), Vector3::x(), 1.0)],
        ..MagneticWorld::default()
    };
    good.check().unwrap();
    let refused = |change: &dyn Fn(&mut MagneticWorld)| {
        let mut world = good.clone();
        change(&mut world);
        match world.check().unwrap_err() {
            SimulationError::Parameter { name, .. } => name,
        }
    };
    assert_eq!(refused(&|w| w.earth.norm_ut = 55_000.0), "norm_ut");
    assert_eq!(refused(&|w| w.earth.dip_rad = 63.4), "dip_rad");
    assert_eq!(refused(&|w| w.earth.declination_rad = f64::NAN), "declination_rad");
    assert_eq!(refused(&|w| w.steel[0].permanent_a_m2.y = f64::NAN), "moment_a_m2");
    assert_eq!(refused(&|w| w.steel[0].induced_m3 = -1.0), "induced_m3");
    assert_eq!(refused(&|w| w.steel[0].radius_m = 0.0), "radius_m");
    assert_eq!(refused(&|w| w.cables[0].along = Vector3::zeros()), "along");
    assert_eq!(refused(&|w| w.cables[0].through_m.z = f64::NAN), "through_m");
    assert_eq!(refused(&|w| w.cables[0].current_a = f64::INFINITY), "current_a");
    assert_eq!(refused(&|w| w.cables[0].radius_m = 0.0), "radius_m");
    let course = |at_m, start_s, step| Course::moving(at_m, start_s, &[step]).is_err();
    assert!(course([0.0; 3], 0.0, Move::Go { to_m: [1.0, 0.0, 0.0], speed_m_s: 0.0 }));
    assert!(course([0.0; 3], 0.0, Move::Go { to_m: [f64::NAN, 0.0, 0.0], speed_m_s: 1.0 }));
    assert!(course([f64::NAN, 0.0, 0.0], 0.0, Move::Stop { seconds: 1.0 }));
    assert!(course([0.0; 3], f64::NAN, Move::Stop { seconds: 1.0 }));
    assert!(course([0.0; 3], 0.0, Move::Stop { seconds: -1.0 }));
    let walk = FootWalkScenario::straight(5.0).walk(1).unwrap();
    assert!(Course::beside(&walk, [0.0, 1.0, 0.0], 5.0, 4.0).is_err());
}

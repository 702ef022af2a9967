//! WGS-84 against published values, PROJ, and the exact normal gravity.

#![expect(clippy::unwrap_used, reason = "a test may stop at the first wrong value")]

use adit_core::frames::{Ecef, Position};
use adit_core::geodesy::{
    CRUST_DENSITY_KG_M3, EARTH_RATE_RAD_S, ECCENTRICITY_SQUARED, Geodetic, SEMI_MINOR_AXIS_M,
    earth_rate_rad_s, gravity_at_height_m_s2, gravity_in_rock_m_s2, meridian_radius_m, normal_gravity_m_s2,
    prime_vertical_radius_m,
};
use core::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use proptest::prelude::*;

fn at(latitude_deg: f64, longitude_deg: f64, height_m: f64) -> Geodetic {
    Geodetic::from_degrees(latitude_deg, longitude_deg, height_m).unwrap()
}

fn degrees(deg: f64, min: f64, sec: f64) -> f64 {
    deg + min / 60.0 + sec / 3600.0
}

/// Distance between two points at 7e6 m: an ulp there is 0.9 nm, and a round trip makes a few roundings.
const FEW_ULP_M: f64 = 5e-9;

// Published values; the tolerance is half a unit of the last printed digit.

#[test]
fn derived_constants_are_those_of_tr8350_2_table_3_3() {
    assert!((SEMI_MINOR_AXIS_M - 6_356_752.314_2).abs() < 5e-5);
    assert!((ECCENTRICITY_SQUARED - 6.694_379_990_14e-3).abs() < 5e-15);
    assert!((meridian_radius_m(FRAC_PI_2) - 6_399_593.625_8).abs() < 5e-5, "polar radius of curvature");
    assert!((prime_vertical_radius_m(FRAC_PI_2) - 6_399_593.625_8).abs() < 5e-5);
}

#[test]
fn gravity_at_equator_and_pole_is_that_of_tr8350_2_table_3_4() {
    assert!((normal_gravity_m_s2(0.0) - 9.780_325_335_9).abs() < 5e-11);
    assert!((normal_gravity_m_s2(FRAC_PI_2) - 9.832_184_937_8).abs() < 5e-11);
    assert!((normal_gravity_m_s2(-FRAC_PI_2) - 9.832_184_937_8).abs() < 5e-11);
}

/// EPSG Guidance Note 7-2, method 9602, and the topocentric example of methods 9836 and 9837.
#[test]
fn the_examples_of_the_epsg_guidance_note_come_out() {
    let point = at(degrees(53.0, 48.0, 33.820), degrees(2.0, 7.0, 46.380), 73.0);
    let printed = Position::<Ecef>::new(3_771_793.968, 140_253.342, 5_124_304.349);
    // Half a millimetre per axis, and the angles are printed to 0.001" (31 mm).
    assert!((point.to_ecef() - printed).norm() < 0.035);
    let back = Geodetic::from_ecef(&printed).unwrap();
    assert!((back.latitude_rad - point.latitude_rad).abs() < 2.5e-9, "half of 0.001\"");
    assert!((back.longitude_rad - point.longitude_rad).abs() < 2.5e-9);
    assert!((back.height_m - 73.0).abs() < 1e-3);

    let origin = at(55.0, 5.0, 200.0);
    assert!(
        (origin.to_ecef() - Position::new(3_652_755.305_8, 319_574.679_9, 5_201_547.353_6)).norm() < 1e-4
    );
    let enu = origin.enu_frame().position(&printed);
    assert!((enu - Position::new(-189_013.869, -128_642.040, -4_220.171)).norm() < 1e-3);
}

// Independent implementations.

struct Reference {
    point: Geodetic,
    ecef: Position<Ecef>,
    enu: [f64; 3],
    gravity: f64,
}

/// Made by `reference/geodesy.py` with PROJ and with 40-digit arithmetic.
fn references() -> Vec<Reference> {
    let rows = include_str!("reference/geodesy.csv").lines().skip(1).map(|line| {
        let v: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
        Reference {
            point: at(v[0], v[1], v[2]),
            ecef: Position::new(v[3], v[4], v[5]),
            enu: [v[6], v[7], v[8]],
            gravity: v[9],
        }
    });
    rows.collect()
}

#[test]
fn ecef_and_local_level_agree_with_proj() {
    let to_enu = at(50.92, 13.34, 400.0).enu_frame();
    for r in references() {
        assert!((r.point.to_ecef() - r.ecef).norm() < FEW_ULP_M, "{:?}", r.point);
        // Up to 1.3e7 m away, where an ulp is 1.9 nm.
        let [east, north, up] = r.enu;
        let found = to_enu.position(&r.ecef);
        assert!((found - Position::new(east, north, up)).norm() < 4.0 * FEW_ULP_M, "{:?}", r.point);
    }
}

/// Somigliana's form is exact on the ellipsoid up to the ten digits of its constants. The series in the height leaves
/// out the flattening squared in its gradient (3 f² 2g/a = 1e-10 m/s² per metre, at the equator) and h³ (4 g h³/a³ =
/// 1.5e-7 m/s² at 10 km).
#[test]
fn gravity_agrees_with_the_exact_normal_gravity() {
    for r in references() {
        let Geodetic { latitude_rad, height_m, .. } = r.point;
        let tolerance = if height_m == 0.0 { 2e-10 } else { 7e-7 };
        let found = gravity_at_height_m_s2(latitude_rad, height_m);
        assert!((found - r.gravity).abs() < tolerance, "{:?}: {found} against {}", r.point, r.gravity);
    }
}

// Properties.

#[test]
fn the_poles_have_a_latitude_and_a_height() {
    for sign in [-1.0, 1.0] {
        let pole = Position::<Ecef>::new(0.0, 0.0, sign * (SEMI_MINOR_AXIS_M - 2000.0));
        let found = Geodetic::from_ecef(&pole).unwrap();
        assert_eq!(found.latitude_rad.to_bits(), (sign * FRAC_PI_2).to_bits());
        assert!((found.height_m + 2000.0).abs() < FEW_ULP_M);
    }
}

#[test]
fn the_dateline_joins_east_and_west() {
    let (east, west) = (at(10.0, 180.0, 0.0), at(10.0, -180.0, 0.0));
    assert!((east.to_ecef() - west.to_ecef()).norm() < FEW_ULP_M);
    assert!((Geodetic::from_ecef(&east.to_ecef()).unwrap().longitude_rad.abs() - PI).abs() < 1e-15);
}

#[test]
fn a_point_that_cannot_be_a_mine_is_refused() {
    for (x, y, z) in [(0.0, 0.0, 0.0), (5.9e6, 0.0, 0.0), (f64::NAN, 0.0, 7e6), (f64::INFINITY, 0.0, 0.0)] {
        assert_eq!(Geodetic::from_ecef(&Position::new(x, y, z)), None);
    }
    assert_eq!(Geodetic::from_degrees(90.1, 0.0, 0.0), None);
    assert_eq!(Geodetic::from_degrees(f64::NAN, 0.0, 0.0), None);
    assert_eq!(Geodetic::from_degrees(0.0, f64::INFINITY, 0.0), None);
}

#[test]
fn the_earth_turns_eastward_about_its_axis() {
    let equator = earth_rate_rad_s(0.0);
    assert!((equator.raw().y - EARTH_RATE_RAD_S).abs() < 1e-20);
    for latitude in [-1.0, 0.0, FRAC_PI_4, FRAC_PI_2] {
        let point = Geodetic { latitude_rad: latitude, longitude_rad: 2.0, height_m: 0.0 };
        let axis = point.enu_frame().vector(&adit_core::frames::Vector::new(0.0, 0.0, EARTH_RATE_RAD_S));
        assert!((earth_rate_rad_s(latitude) - axis).norm() < 1e-19);
    }
}

/// Heiskanen & Moritz 1967, §4-3: +0.0848 mGal per metre of depth; G has changed its last digits since.
#[test]
fn gravity_grows_slowly_with_depth_in_rock() {
    let latitude = FRAC_PI_4;
    let at_surface = gravity_in_rock_m_s2(latitude, 500.0, 0.0, CRUST_DENSITY_KG_M3);
    assert_eq!(at_surface.to_bits(), gravity_at_height_m_s2(latitude, 500.0).to_bits());
    let at_depth = gravity_in_rock_m_s2(latitude, -500.0, 1000.0, CRUST_DENSITY_KG_M3);
    assert!(((at_depth - at_surface) / 1000.0 - 0.0848e-5).abs() < 0.0005e-5);
}

proptest! {
    #[test]
    fn ecef_and_back_returns_the_same_point(
        latitude in prop_oneof![-90.0..90.0, Just(90.0), Just(-90.0), 89.999_999..90.0, -1e-9..1e-9],
        longitude in prop_oneof![-180.0..180.0, Just(180.0), Just(-180.0), 179.999_999..180.0],
        height in prop_oneof![-2000.0..10_000.0, -100_000.0..1_000_000.0],
    ) {
        let ecef = at(latitude, longitude, height).to_ecef();
        let back = Geodetic::from_ecef(&ecef).unwrap();
        prop_assert!((back.to_ecef() - ecef).norm() < FEW_ULP_M);
        prop_assert!((back.height_m - height).abs() < FEW_ULP_M);
        prop_assert!((back.latitude_rad - latitude.to_radians()).abs() < 1e-15);
    }

    /// The radii of curvature are what they are made for: metres per radian of latitude and longitude.
    #[test]
    fn a_small_step_in_angle_is_radius_times_angle(latitude in -1.5..1.5_f64, height in -2000.0..10_000.0) {
        let here = Geodetic { latitude_rad: latitude, longitude_rad: 0.3, height_m: height };
        let step = 1e-4; // third-order term: R step³/24 = 3e-7 m, of 640 m
        let towards = |lat: f64, lon: f64| {
            let ahead = Geodetic { latitude_rad: latitude + lat, longitude_rad: 0.3 + lon, ..here }.to_ecef();
            let behind = Geodetic { latitude_rad: latitude - lat, longitude_rad: 0.3 - lon, ..here }.to_ecef();
            here.enu_frame().vector(&(ahead - behind))
        };
        let (north, east) = (towards(step / 2.0, 0.0), towards(0.0, step / 2.0));
        prop_assert!((north.raw().y / step - meridian_radius_m(latitude) - height).abs() < 0.02);
        let parallel = (prime_vertical_radius_m(latitude) + height) * latitude.cos();
        prop_assert!((east.raw().x / step - parallel).abs() < 0.02);
    }
}

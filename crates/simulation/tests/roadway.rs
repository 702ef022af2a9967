//! The level walk on the ellipsoid: what it reads against finite differences in inertial space, its range, its seeds.
#![expect(clippy::unwrap_used, reason = "tests")]

use adit_core::attitude;
use adit_core::geodesy::{EARTH_RATE_RAD_S, Geodetic, gravity_at_height_m_s2};
use adit_core::nalgebra::{UnitQuaternion, Vector3};
use adit_observation::{FixSource, Observation};
use adit_simulation::{
    Emission, FixModel, ImuErrorModel, RoadwayGenerator, RoadwayLeg, RoadwayPlan, RoadwayRanges, RoadwayWalk,
    SimulationError, StartErrors,
};

fn origin() -> Geodetic {
    Geodetic::from_degrees(45.7, 121.0 + 23.0 / 60.0, -300.0).unwrap()
}

fn walk(seed: u64) -> RoadwayWalk {
    let ranges = RoadwayRanges::default();
    RoadwayWalk::new(&RoadwayPlan::random(&ranges, seed).unwrap(), origin(), ranges.duration_s).unwrap()
}

/// Place and body axes in axes that do not turn, at `time_s`.
fn inertial(walk: &RoadwayWalk, time_s: f64) -> (Vector3<f64>, UnitQuaternion<f64>) {
    let state = walk.at(time_s);
    let turned = attitude::exp(&(Vector3::z() * (EARTH_RATE_RAD_S * time_s)));
    let to_earth = state.point.enu_frame().inverse();
    let (level, place) = (to_earth.rotation().raw(), state.point.to_ecef());
    (turned * place.raw(), turned * level * state.attitude)
}

/// Rotation and acceleration against inertial space come out of nothing but places at three times.
#[test]
fn readings_are_the_differences_of_places_in_inertial_space() {
    let walk = walk(1);
    // Times in ramps, turns, on straights and at rest; a step of 10 ms: fourth differences of the path, 2e-5 m/s², and
    // rounding of 6.4e6 m, 1e-9 m, over 1e-4 s².
    let step_s = 0.01;
    for time_s in (1..500).map(|i| f64::from(i) * 1.987) {
        let [(before, attitude_before), (here, attitude), (after, attitude_after)] =
            [-step_s, 0.0, step_s].map(|shift| inertial(&walk, time_s + shift));
        let state = walk.at(time_s);
        let acceleration = (after - 2.0 * here + before) / (step_s * step_s);
        // Gravitation alone: gravity without the centrifugal part.
        let earth = Vector3::z() * EARTH_RATE_RAD_S;
        let up = attitude * state.attitude.inverse() * Vector3::z();
        let gravity = -up * gravity_at_height_m_s2(state.point.latitude_rad, state.point.height_m);
        let gravitation = gravity + earth.cross(&earth.cross(&here));
        let force = attitude.inverse() * (acceleration - gravitation);
        let off = (force - state.inertial.specific_force_m_s2).norm();
        assert!(off < 2e-4, "{time_s} s: {force} and {}", state.inertial.specific_force_m_s2);

        let turned = attitude::log(&(attitude_before.inverse() * attitude_after)) / (2.0 * step_s);
        let off = (turned - state.inertial.angular_rate_rad_s).norm();
        // Third differences of a turn of 90° in 4 s: h²/6 · 3 rad/s³.
        assert!(off < 1e-4, "{time_s} s: {turned} and {}", state.inertial.angular_rate_rad_s);
    }
}

#[test]
fn a_standing_tag_reads_gravity_and_the_rate_of_the_earth() {
    let state = walk(3).at(0.0);
    assert!(state.standing);
    let gravity = gravity_at_height_m_s2(origin().latitude_rad, -300.0);
    assert!((state.inertial.specific_force_m_s2 - Vector3::z() * gravity).norm() < 1e-12);
    let rate = state.attitude * state.inertial.angular_rate_rad_s;
    let (sin, cos) = origin().latitude_rad.sin_cos();
    assert!((rate - Vector3::new(0.0, cos, sin) * EARTH_RATE_RAD_S).norm() < 1e-16);
}

#[test]
fn it_walks_as_people_do_and_stays_level() {
    for seed in 1..20 {
        let walk = walk(seed);
        let (mut standing, mut fastest) = (0, 0.0_f64);
        let mut before = walk.at(0.0);
        for tenth in 1..10_000 {
            let state = walk.at(f64::from(tenth) * 0.1);
            let speed = state.velocity_m_s.norm();
            standing += i32::from(state.standing);
            fastest = fastest.max(speed);
            // Velocity in the level frame of the walker, and the way in that of the origin, 1 km away at most: 2e-4 of it.
            let way = (state.position_m - before.position_m).xy();
            let mean = (state.velocity_m_s + before.velocity_m_s).xy() * 0.05;
            assert!((way - mean).norm() < 6e-4, "seed {seed}, {tenth}: {way} and {mean}");
            assert_eq!((state.point.height_m, state.position_m.z), (-300.0, 0.0));
            // Where it walks, it walks forward.
            let forward = state.attitude * Vector3::x();
            assert!(speed < 0.01 || forward.dot(&state.velocity_m_s) > 0.9999 * speed);
            before = state;
        }
        // The range of speeds of a straight, and what scaled degrees stretch in 1 km.
        assert!((1.0..1.5005).contains(&fastest), "{fastest} m/s");
        assert!((100..6000).contains(&standing), "{standing} samples at rest");
    }
}

#[test]
fn a_corner_is_taken_at_no_less_than_half_a_metre_a_second() {
    let plan = RoadwayPlan {
        heading_rad: 0.0,
        speed_change_s: 2.0,
        turn_s: 4.0,
        legs: vec![
            RoadwayLeg::Straight { length_m: 10.0, speed_m_s: 0.75 },
            RoadwayLeg::Turn { turn_rad: std::f64::consts::FRAC_PI_2 },
            RoadwayLeg::Straight { length_m: 10.0, speed_m_s: 0.75 },
        ],
    };
    let walk = RoadwayWalk::new(&plan, origin(), 60.0).unwrap();
    // 2 s to gather speed, 10 m; then the corner.
    let corner_s = 2.0 + 10.0 / 0.75;
    let middle = walk.at(corner_s + 2.0);
    assert!((middle.velocity_m_s.norm() - 0.75 * std::f64::consts::FRAC_1_SQRT_2).abs() < 1e-4);
    let heading = attitude::heading(&walk.at(corner_s + 4.0).attitude);
    assert!((heading - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    // It ends standing where the plan ends, and stays.
    let (end, later) = (walk.at(40.0), walk.at(60.0));
    assert!(end.standing && end.position_m == later.position_m);
}

fn generator(seed: u64) -> RoadwayGenerator {
    let fixes = FixModel { every_s: 20.0, sigma_m: 0.0608, source: FixSource::Wifi };
    let start = StartErrors { position_m: [25.9, 37.0], attitude_rad: 0.01 };
    RoadwayGenerator::new(walk(seed), &ImuErrorModel::mpu6050(), 10.0, fixes, &start, seed).unwrap()
}

#[test]
fn the_same_seed_gives_the_same_log_and_another_seed_another() {
    let log = |seed| generator(seed).map(|emission| emission.observation()).collect::<Vec<Observation>>();
    let first = log(5);
    assert_eq!(first, log(5));
    assert_ne!(first, log(6));
    assert_eq!(first.iter().filter(|o| matches!(o, Observation::Imu(_))).count(), 10_000);
    assert!(first.windows(2).all(|pair| pair[0].time() <= pair[1].time()));
}

/// Fixes and starts are as far off as their models say: χ² over many.
#[test]
fn fixes_and_starts_are_as_wrong_as_they_say() {
    let (mut squares, mut count, mut turns, mut shifts) = (0.0, 0, 0.0, 0.0);
    for seed in 1..41 {
        let mut generator = generator(seed);
        let first = generator.walk().at(0.0);
        let turn = attitude::log(&(generator.told().attitude * first.attitude.inverse()));
        turns += turn.norm_squared() / 1e-4;
        let shift = generator.told().position_m - first.position_m.xy();
        shifts += (shift.x / 25.9).powi(2) + (shift.y / 37.0).powi(2);
        for emission in generator.by_ref() {
            if let Emission::Fix(fix, truth_m) = emission {
                squares += (fix.level_m - truth_m.xy()).norm_squared() / 0.0608_f64.powi(2);
                count += 1;
                assert_eq!(fix.sigma_m(), Some(0.0608));
            }
        }
    }
    assert_eq!(count, 40 * 50);
    // Means of 4000, 120 and 80 squares of standard normals: within 4 σ of 1.
    let near = |sum: f64, n: f64| (sum / n - 1.0).abs() < 4.0 * (2.0 / n).sqrt();
    assert!(near(squares, 4000.0) && near(turns, 120.0) && near(shifts, 80.0), "{squares} {turns} {shifts}");
}

#[test]
fn ranges_that_are_none_are_refused_by_name() {
    let refused = |change: fn(&mut RoadwayRanges), expected: &str| {
        let mut ranges = RoadwayRanges::default();
        change(&mut ranges);
        let error = RoadwayPlan::random(&ranges, 1).unwrap_err();
        assert!(matches!(error, SimulationError::Parameter { name, .. } if name == expected), "{error}");
    };
    refused(|r| r.speed_m_s = [1.5, 0.5], "speed_m_s");
    refused(|r| r.turn_rad = [0.0, 3.0], "turn_rad");
    refused(|r| r.stop_probability = f64::NAN, "stop_probability");
    refused(|r| r.turn_s = 0.0, "turn_s");
    let pole = Geodetic::from_degrees(89.9, 0.0, 0.0).unwrap();
    let plan = RoadwayPlan::random(&RoadwayRanges::default(), 1).unwrap();
    assert!(RoadwayWalk::new(&plan, pole, 100.0).is_err());
}

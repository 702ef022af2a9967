//! What the proof does with adit, without a standard library. Each check is a sentence; its number is the exit code of
//! the program when it is not true.
#![no_std]

extern crate alloc;

use adit_core::attitude::{heading, level};
use adit_core::frames::{Enu, GridPlacement, Position};
use adit_core::geodesy::{Geodetic, normal_gravity_m_s2};
use adit_core::nalgebra::Vector3;
use adit_core::solution::{Quality, Solution, SolutionCovariance};
use adit_core::time::{Interval, Time};
use adit_core::trajectory::{Pose, Trajectory};
use alloc::string::ToString;
use alloc::vec::Vec;

/// 0 when all hold, else the number of the first that does not.
pub fn first_failed() -> u8 {
    let checks: &[fn() -> Option<bool>] = &[
        a_sensor_on_its_side_is_levelled,
        a_portal_survives_the_way_to_the_earths_centre_and_back,
        gravity_is_that_of_the_equator,
        a_grid_point_finds_its_latitude,
        a_walk_is_interpolated,
        a_walk_out_of_order_is_refused_in_words,
        a_solution_has_a_radius,
        #[cfg(feature = "observation")]
        a_sample_at_rest_is_an_observation,
        #[cfg(feature = "estimation")]
        a_foot_at_rest_stays_where_it_is,
        #[cfg(feature = "estimation")]
        a_tag_is_found_by_its_ranges,
        #[cfg(feature = "mine")]
        a_mine_knows_its_ways_and_its_rock,
    ];
    let failed = checks.iter().position(|check| core::hint::black_box(check)() != Some(true));
    failed.map_or(0, |index| u8::try_from(index + 1).unwrap_or(98))
}

fn a_sensor_on_its_side_is_levelled() -> Option<bool> {
    let force = Vector3::new(0.3, -9.7, 0.2);
    let attitude = level(&force, 0.5)?;
    let up = attitude * force;
    Some(
        (up - Vector3::new(0.0, 0.0, force.norm())).norm() < 1e-12
            && (heading(&attitude) - 0.5).abs() < 1e-12,
    )
}

fn a_portal_survives_the_way_to_the_earths_centre_and_back() -> Option<bool> {
    let portal = Geodetic::from_degrees(50.92, 13.34, -310.0)?;
    let back = Geodetic::from_ecef(&portal.to_ecef())?;
    Some((back.latitude_rad - portal.latitude_rad).abs() < 1e-15 && (back.height_m + 310.0).abs() < 5e-9)
}

fn gravity_is_that_of_the_equator() -> Option<bool> {
    Some((normal_gravity_m_s2(0.0) - 9.780_325_335_9).abs() < 1e-10)
}

fn a_grid_point_finds_its_latitude() -> Option<bool> {
    let grid = GridPlacement { origin: Position::new(5_000.0, 3_000.0, 0.0), convergence_rad: 0.01 };
    let to_ecef = grid.to_enu().then(&Geodetic::from_degrees(50.92, 13.34, 0.0)?.enu_frame().inverse());
    let shaft = Geodetic::from_ecef(&to_ecef.position(&Position::new(5_000.0, 3_000.0, -640.0)))?;
    Some((shaft.height_m + 640.0).abs() < 1e-8 && (shaft.latitude_rad - 50.92_f64.to_radians()).abs() < 1e-14)
}

fn poses(seconds: &[i64]) -> Vec<Pose> {
    let pose = |s: &i64| Pose {
        time: Time::from_nanos(s * 1_000_000_000),
        position_m: Vector3::new(*s as f64, 0.0, 0.0),
        attitude: adit_core::attitude::exp(&Vector3::new(0.0, 0.0, 0.1 * *s as f64)),
    };
    seconds.iter().map(pose).collect()
}

fn a_walk_is_interpolated() -> Option<bool> {
    let walk = Trajectory::new(poses(&[0, 1, 2, 4])).ok()?;
    let pose = walk.at(Time::ZERO + Interval::from_seconds(3.0)?)?;
    Some((pose.position_m.x - 3.0).abs() < 1e-15)
}

fn a_walk_out_of_order_is_refused_in_words() -> Option<bool> {
    let error = Trajectory::new(poses(&[0, 2, 1])).err()?;
    Some(error.to_string() == "pose 2: time 1.000000000 s does not come after 2.000000000 s")
}

fn a_solution_has_a_radius() -> Option<bool> {
    let origin = Position::<Enu>::ORIGIN;
    let solution = Solution {
        time: Time::ZERO,
        position_m: *origin.raw(),
        velocity_m_s: Vector3::zeros(),
        attitude: adit_core::attitude::Attitude::identity(),
        covariance: SolutionCovariance::identity(),
        quality: Quality::Fixed,
    };
    Some((solution.radius_95_m() - 2.4477).abs() < 1e-4)
}

#[cfg(feature = "observation")]
fn a_sample_at_rest_is_an_observation() -> Option<bool> {
    use adit_observation::{ImuSample, Observation};
    let sample = ImuSample {
        time: Time::from_nanos(5_000_000),
        angular_rate_rad_s: Vector3::zeros(),
        specific_force_m_s2: Vector3::new(0.0, 0.0, normal_gravity_m_s2(0.9)),
    };
    Some(Observation::Imu(sample).time() == sample.time && level(&sample.specific_force_m_s2, 0.0).is_some())
}

#[cfg(feature = "estimation")]
fn a_foot_at_rest_stays_where_it_is() -> Option<bool> {
    use adit_estimation::methods::foot_ins::{FootIns, FootInsParams};
    use adit_observation::{ImuSample, Observation};
    let mut method = FootIns::new(FootInsParams::default()).ok()?;
    let mut last = None;
    for sample in 1..=600 {
        let observation = Observation::Imu(ImuSample {
            time: Time::from_nanos(sample * 5_000_000),
            angular_rate_rad_s: Vector3::zeros(),
            specific_force_m_s2: Vector3::new(0.1, -0.2, -normal_gravity_m_s2(0.9)),
        });
        last = method.observe(&observation).ok()?.or(last);
    }
    while let Some(solution) = method.finish_next().ok()? {
        last = Some(solution);
    }
    let last = last?;
    // A millimetre: the tilt is found within the first samples, and the velocity held at zero from then on.
    Some(last.time.seconds() == 3.0 && last.position_m.norm() < 1e-3 && last.radius_95_m() < 1.0)
}

#[cfg(feature = "estimation")]
fn a_tag_is_found_by_its_ranges() -> Option<bool> {
    use adit_estimation::ranging::filter::weighting::Weighting;
    use adit_estimation::ranging::filter::{FilterParams, RangeFilter};
    use adit_estimation::ranging::listener::Link;
    use adit_estimation::ranging::{RangeModel, Ranged};
    let anchors = [[2.0, 0.2, 3.2], [18.0, 0.2, 2.0], [22.0, 15.8, 3.2], [6.0, 15.8, 2.0]].map(Vector3::from);
    let mut filter = RangeFilter::new(FilterParams::default(), Weighting::default()).ok()?;
    let tag = Vector3::new(12.0, 8.0, 1.5);
    for tick in 0..400 {
        let anchor = tick % 4;
        let model = RangeModel { offset_m: 0.0, scale: 1.0, sigma_m: 0.08 };
        let ranged = Ranged { position_m: anchors[anchor], model, range_m: (tag - anchors[anchor]).norm() };
        let time = Time::from_nanos(25_000_000 * i64::try_from(tick).ok()?);
        filter.observe(&Link { time, anchor, ranged, line_of_sight: None }, 0);
    }
    // The prior of the height, 1.6 m, against ranges without error.
    Some((filter.solution()?.position_m - tag).norm() < 0.1)
}

#[cfg(feature = "mine")]
fn a_mine_knows_its_ways_and_its_rock() -> Option<bool> {
    use adit_mine::Mine;
    use adit_mine::network::Travel;
    use adit_mine::plan::{Grid, MinePlan, Roadway, RoadwayKind};
    let roadway = |id: &str, points: &[[f64; 2]]| Roadway {
        id: id.into(),
        name: None,
        level: None,
        kind: RoadwayKind::Drift,
        width_m: 4.0,
        height_m: 3.0,
        max_slope_percent: None,
        walkable: true,
        points_m: points.iter().map(|p| Position::new(p[0], p[1], 0.0)).collect(),
    };
    let mut plan = MinePlan::new("proof", Grid::Local {});
    plan.roadways.push(roadway("main", &[[0.0, 0.0], [100.0, 0.0]]));
    plan.roadways.push(roadway("side", &[[60.0, 0.0], [60.0, 80.0]]));
    let mine = Mine::new(plan).ok()?;
    let (start, end) = (Position::new(10.0, 1.0, 1.0), Position::new(61.0, 70.0, 1.0));
    let network = mine.network();
    let (from, to) = (network.nearest(&start)?.spot, network.nearest(&end)?.spot);
    let length_m = network.route(&from, &to, Travel::OnFoot)?.length_m;
    Some((length_m - 120.0).abs() < 1e-12 && !mine.sight(&start, &end).is_clear())
}

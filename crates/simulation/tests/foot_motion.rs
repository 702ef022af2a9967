//! The closed-form motion of the foot: its derivatives, its contacts with the floor, its figures.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

use adit_core::attitude;
use adit_core::nalgebra::Vector3;
use adit_simulation::{Foot, FootWalk, FootWalkScenario, Gait, Leg, Motion, WalkPlan};
use core::f64::consts::FRAC_PI_2;

/// A bit of everything.
fn varied_walk() -> FootWalk {
    let legs = vec![
        Leg::Stand { seconds: 2.0 },
        Leg::Straight { length_m: 6.0 },
        Leg::Arc { radius_m: 2.0, turn_rad: 2.0 },
        Leg::Gait(Gait::slow()),
        Leg::Ramp { length_m: 5.0, slope_rad: 0.15 },
        Leg::Turn { turn_rad: -1.5 },
        Leg::Gait(Gait::stairs()),
        Leg::Stairs { risers: 5, rise_m: 0.17, tread_m: 0.29 },
        Leg::Stairs { risers: 4, rise_m: -0.17, tread_m: 0.29 },
        Leg::Stand { seconds: 1.0 },
        Leg::Gait(Gait::run()),
        Leg::Straight { length_m: 10.0 },
        Leg::Stand { seconds: 1.0 },
    ];
    FootWalk::new(&WalkPlan { gait: Gait::walk(), heading_rad: 0.3, legs }, Foot::instep(), 7).unwrap()
}

fn times(walk: &FootWalk, step_s: f64) -> impl Iterator<Item = f64> {
    let end_s = walk.duration_s();
    (0..).map(move |i| f64::from(i) * step_s).take_while(move |t| *t < end_s)
}

#[test]
fn derivatives_agree_with_finite_differences() {
    let walk = varied_walk();
    let h = 1e-5;
    for t in times(&walk, 0.003_7) {
        let (before, now, after) = (walk.at(t - h), walk.at(t), walk.at(t + h));
        let velocity = (after.position_m - before.position_m) / (2.0 * h);
        let acceleration = (after.velocity_m_s - before.velocity_m_s) / (2.0 * h);
        let rate = attitude::log(&(before.attitude.inverse() * after.attitude)) / (2.0 * h);
        // Central differences err by h²/6 times the third derivative: jerk < 1e4 m/s³, its rate < 1e6 m/s⁴;
        // rounding of a position of 20 m adds 4e-15/h.
        assert!((velocity - now.velocity_m_s).norm() < 1e-6, "velocity at {t}");
        assert!((acceleration - now.acceleration_m_s2).norm() < 1e-3, "acceleration at {t}");
        assert!((rate - now.angular_rate_rad_s).norm() < 1e-5, "rate at {t}");
    }
}

#[test]
fn nothing_jumps_where_stance_and_swing_meet() {
    let walk = varied_walk();
    let flat_and_moving = walk.strides().iter().flat_map(|s| [s.start_s, s.start_s + s.still_s]);
    for t in flat_and_moving {
        let (before, after) = (walk.at(t - 1e-9), walk.at(t + 1e-9));
        assert!((after.position_m - before.position_m).norm() < 1e-8);
        assert!((after.velocity_m_s - before.velocity_m_s).norm() < 1e-6);
        assert!((after.acceleration_m_s2 - before.acceleration_m_s2).norm() < 1e-3);
        assert!(before.attitude.angle_to(&after.attitude) < 1e-7);
    }
}

#[test]
fn a_foot_in_stance_has_no_velocity_at_all() {
    let walk = FootWalkScenario::straight(20.0).walk(1).unwrap();
    let mut still = 0;
    for state in times(&walk, 0.005).map(|t| walk.at(t)).filter(|s| s.stance) {
        assert_eq!(state.velocity_m_s, Vector3::zeros());
        assert_eq!(state.angular_rate_rad_s, Vector3::zeros());
        still += 1;
    }
    assert!(still > 1000);
}

#[test]
fn a_running_or_restless_foot_is_not_still_in_stance() {
    for gait in [Gait::run(), Gait::restless_walk()] {
        let mut scenario = FootWalkScenario::straight(20.0);
        scenario.plan.gait = gait;
        let walk = scenario.walk(1).unwrap();
        for stride in walk.strides().iter().skip(1) {
            let middle = walk.at(stride.start_s + 0.5 * stride.still_s);
            assert!(middle.stance);
            let speed = middle.velocity_m_s.norm();
            assert!((0.01..0.3).contains(&speed), "{speed} m/s");
        }
    }
}

#[test]
fn the_heel_rises_about_a_ball_that_stands_and_lands_on_a_heel_that_stands() {
    let walk = varied_walk();
    let foot = Foot::instep();
    for stride in walk.strides() {
        let contact = |share: f64, point: &Vector3<f64>| {
            let state = walk.at(stride.start_s + stride.still_s + share * stride.moving_s);
            state.position_m + state.attitude * point
        };
        let ball = contact(0.0, &foot.ball_m);
        let heel = contact(1.0, &foot.heel_m);
        for i in 0..10 {
            let share = f64::from(i) / 10.0;
            // Rounding of coordinates of some ten metres.
            assert!((contact(0.15 * share, &foot.ball_m) - ball).norm() < 1e-13);
            assert!((contact(0.97 + 0.03 * share, &foot.heel_m) - heel).norm() < 1e-13);
        }
    }
}

#[test]
fn the_shoe_stays_above_a_level_floor() {
    let foot = Foot::instep();
    for gait in [Gait::walk(), Gait::slow(), Gait::run()] {
        let mut scenario = FootWalkScenario::straight(20.0);
        scenario.plan.gait = gait;
        let walk = scenario.walk(3).unwrap();
        let lowest = |point: Vector3<f64>| {
            times(&walk, 0.005)
                .map(|t| walk.at(t))
                .map(|s| (s.position_m + s.attitude * point).z - point.z)
                .fold(f64::INFINITY, f64::min)
        };
        // A sole gives way by some millimetres.
        assert!(lowest(foot.ball_m) > -0.01, "ball {}", lowest(foot.ball_m));
        assert!(lowest(foot.heel_m) > -0.01, "heel {}", lowest(foot.heel_m));
    }
}

#[test]
fn legs_end_where_they_should() {
    let plan = |legs| WalkPlan { gait: Gait::walk(), heading_rad: FRAC_PI_2, legs };
    let end = |legs| {
        let walk = FootWalk::new(&plan(legs), Foot::instep(), 5).unwrap();
        walk.at(walk.duration_s() + 1.0)
    };
    let close = |a: Vector3<f64>, x, y, z| assert!((a - Vector3::new(x, y, z)).norm() < 1e-12, "{a}");

    let straight = end(vec![Leg::Straight { length_m: 10.0 }]);
    close(straight.position_m, 10.0, 0.0, 0.0);
    assert!((attitude::heading(&straight.attitude) - FRAC_PI_2).abs() < 1e-12);

    let right_turn = end(vec![Leg::Arc { radius_m: 3.0, turn_rad: FRAC_PI_2 }]);
    close(right_turn.position_m, 3.0, -3.0, 0.0);
    assert!((attitude::heading(&right_turn.attitude).abs() - FRAC_PI_2 * 2.0).abs() < 1e-12);

    let ramp = end(vec![Leg::Ramp { length_m: 10.0, slope_rad: 0.1 }]);
    close(ramp.position_m, 10.0, 0.0, 10.0 * libm::tan(0.1));
    let toes = ramp.attitude * Vector3::x();
    assert!((toes.z - libm::sin(0.1)).abs() < 1e-12, "toes point up the slope");

    let stairs = end(vec![Leg::Stairs { risers: 7, rise_m: 0.17, tread_m: 0.3 }]);
    close(stairs.position_m, 2.1, 0.0, 1.19);
}

/// Figures of the strides of a long straight walk, medians and peaks as a camera and a gyro would see them.
struct Figures {
    stance_share: f64,
    peak_rate_deg_s: f64,
    peak_speed_m_s: f64,
    rise_m: f64,
    peak_force_m_s2: f64,
    speed_m_s: f64,
}

fn figures(gait: Gait, still_below_rad_s: f64) -> Figures {
    let mut scenario = FootWalkScenario::straight(60.0);
    scenario.plan.gait = Gait { variation: 0.0, ..gait };
    let walk = scenario.walk(1).unwrap();
    let stride = walk.strides()[10];
    let states: Vec<_> = (0..2000)
        .map(|i| walk.at(stride.start_s + f64::from(i) / 2000.0 * (stride.end_s() - stride.start_s)))
        .collect();
    let peak = |f: &dyn Fn(&adit_simulation::MotionState) -> f64| states.iter().map(f).fold(0.0, f64::max);
    let quiet = states.iter().filter(|s| s.angular_rate_rad_s.norm() < still_below_rad_s).count();
    Figures {
        stance_share: f64::from(u32::try_from(quiet).unwrap()) / 2000.0,
        peak_rate_deg_s: peak(&|s| s.angular_rate_rad_s.norm().to_degrees()),
        peak_speed_m_s: peak(&|s| s.velocity_m_s.xy().norm()),
        rise_m: peak(&|s| s.position_m.z),
        peak_force_m_s2: peak(&|s| (s.acceleration_m_s2 + Vector3::z() * 9.81).norm()),
        speed_m_s: walk.length_m() / (walk.duration_s() - 6.0),
    }
}

/// Bands of the medians of recorded walks (foot-vicon, foot-hallway; see the head of `foot_motion`).
#[test]
fn a_walk_has_the_figures_of_recorded_walks() {
    let walk = figures(Gait::walk(), 0.6);
    assert!((0.22..0.32).contains(&walk.stance_share), "stance share {}", walk.stance_share);
    assert!((400.0..550.0).contains(&walk.peak_rate_deg_s), "rate {}", walk.peak_rate_deg_s);
    assert!((3.1..4.1).contains(&walk.peak_speed_m_s), "speed {}", walk.peak_speed_m_s);
    assert!((0.06..0.13).contains(&walk.rise_m), "rise {}", walk.rise_m);
    assert!((29.0..45.0).contains(&walk.peak_force_m_s2), "force {}", walk.peak_force_m_s2);
    assert!((1.2..1.4).contains(&walk.speed_m_s), "mean speed {}", walk.speed_m_s);
}

#[test]
fn a_run_has_the_figures_of_recorded_runs() {
    let run = figures(Gait::run(), 2.0);
    assert!((0.1..0.36).contains(&run.stance_share), "stance share {}", run.stance_share);
    assert!((500.0..800.0).contains(&run.peak_rate_deg_s), "rate {}", run.peak_rate_deg_s);
    assert!((4.5..6.0).contains(&run.peak_speed_m_s), "speed {}", run.peak_speed_m_s);
    assert!((0.08..0.15).contains(&run.rise_m), "rise {}", run.rise_m);
    assert!((60.0..90.0).contains(&run.peak_force_m_s2), "force {}", run.peak_force_m_s2);
    assert!((1.9..2.4).contains(&run.speed_m_s), "mean speed {}", run.speed_m_s);
}

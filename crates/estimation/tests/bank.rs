//! The bank of hypotheses on roadways: what holds for any walk, and walks of half an hour without infrastructure.
#![expect(clippy::unwrap_used, reason = "tests")]

#[path = "support/roadways.rs"]
mod roadways;
#[path = "support/trial.rs"]
mod trial;

use adit_core::frames::Position;
use adit_core::nalgebra::{Matrix2, Vector2, Vector3};
use adit_estimation::place::bank::{Bank, BankParams, Hypothesis, Place};
use adit_estimation::place::roadways::Roadways;
use adit_estimation::place::state::{Back, State};
use adit_mine::Mine;
use adit_mine::plan::{Grid, MinePlan, Roadway, RoadwayKind};
use roadways::{Carrier, Walker};
use std::path::Path;
use std::sync::Arc;
use trial::{Trial, follow, params, radius_m, walk};

fn two_levels() -> (Mine, Arc<Roadways>) {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../mines/two-level.toml");
    let (mine, _) = adit_mine::file::open(Path::new(file)).unwrap();
    let roadways = Arc::new(Roadways::new(&mine));
    (mine, roadways)
}

fn steady() -> Walker {
    Walker { goes_on: 0.85, ..Walker::default() }
}

#[test]
fn weights_sum_to_one_and_the_bank_stays_small() {
    let (mine, roadways) = two_levels();
    let carrier = Carrier::poor_waist();
    for seed in 1..=10 {
        let walk = walk(&mine, &carrier, &steady(), seed);
        follow(&walk, Some(&roadways), params(&carrier), seed, |bank, estimate, _, _| {
            let sum: f64 = bank.hypotheses().iter().map(Hypothesis::weight).sum();
            // Eight exponentials of logarithms, each right to a few units in the last place.
            assert!((sum - 1.0).abs() < 1e-12, "{sum}");
            assert!((1..=8).contains(&bank.hypotheses().len()));
            // Eight of fourteen states, each with its covariance.
            assert!(bank.bytes() <= 14 * 1024, "{} bytes", bank.bytes());
            assert!(estimate.share <= 1.0 + 1e-12);
        });
    }
}

#[test]
fn the_reported_place_is_in_the_air() {
    let (mine, roadways) = two_levels();
    for carrier in [Carrier::foot(), Carrier::poor_waist()] {
        for seed in 1..=20 {
            let walk = walk(&mine, &carrier, &steady(), seed);
            follow(&walk, Some(&roadways), params(&carrier), seed, |_, estimate, _, walked_m| {
                let place = Position::from_raw(estimate.position_m);
                if estimate.place == Place::Off {
                    return;
                }
                let clearance = mine.excavation().clearance(&place).unwrap();
                // Floors of roadways that meet differ by centimetres at their corners.
                assert!(
                    clearance.distance_m() < 0.1,
                    "seed {seed} at {walked_m} m: {clearance:?} {:?}",
                    estimate.place
                );
            });
        }
    }
}

#[test]
fn no_jump_is_larger_than_the_radius_stated_before_it() {
    let (mine, roadways) = two_levels();
    for carrier in [Carrier::foot(), Carrier::waist(), Carrier::poor_waist()] {
        for seed in 1..=40 {
            let walk = walk(&mine, &carrier, &steady(), seed);
            let trial = follow(&walk, Some(&roadways), params(&carrier), seed, |_, _, _, _| {});
            assert!(trial.jump <= 1.0, "seed {seed}: {}", trial.jump);
        }
    }
}

#[test]
fn a_bank_that_was_written_and_read_goes_on_as_if_nothing_had_been() {
    let (mine, roadways) = two_levels();
    let carrier = Carrier::poor_waist();
    let walk = walk(&mine, &carrier, &Walker::default(), 3);
    let mut whole = Bank::new(params(&carrier), Some(Arc::clone(&roadways)));
    whole.start(walk.reckoned.start.clone());
    let mut split = whole.clone();
    for (index, stretch) in walk.reckoned.stretches.iter().enumerate() {
        whole.walk(stretch);
        split.walk(stretch);
        if index % 7 == 0 {
            whole.estimate();
            split.estimate();
        }
        if index % 61 == 0 {
            let text = serde_json::to_string(&split).unwrap();
            split = serde_json::from_str(&text).unwrap();
            split.attach(Some(Arc::clone(&roadways)));
        }
        assert_eq!(whole.hypotheses(), split.hypotheses());
        // Room for branches is given up and taken again: it is no part of the state.
        assert!(whole.bytes().max(split.bytes()) <= 9 * 1024);
    }
    assert_eq!(whole.estimate(), split.estimate());
}

#[test]
fn without_roadways_the_bank_is_one_filter() {
    let (mine, _) = two_levels();
    let carrier = Carrier::foot();
    let walk = walk(&mine, &carrier, &Walker::default(), 1);
    let mut bank = Bank::new(params(&carrier), None);
    let mut alone: State = walk.reckoned.start.clone();
    bank.start(alone.clone());
    for (index, stretch) in walk.reckoned.stretches.iter().enumerate() {
        bank.walk(stretch);
        alone.walk(stretch);
        if index % 100 == 50 {
            let place = walk.way[index + 1].xy();
            let see = |state: &State| state.see_place(&place, &Matrix2::identity(), &Vector3::zeros());
            bank.take(see, 9.0).unwrap();
            alone.take(&see(&alone), 9.0).unwrap();
        }
        assert_eq!(bank.hypotheses().len(), 1);
        assert_eq!(bank.best().unwrap().state, alone);
    }
    assert!(!bank.is_lost());
}

/// Walks of one kind, and the end of each as a share of its way, ascending.
fn trials(
    mine: &Mine,
    roadways: &Arc<Roadways>,
    carrier: &Carrier,
    walker: &Walker,
) -> (Vec<Trial>, Vec<f64>) {
    let trials: Vec<Trial> = (1..=60)
        .map(|seed| {
            follow(&walk(mine, carrier, walker, seed), Some(roadways), params(carrier), seed, |_, _, _, _| {})
        })
        .collect();
    let mut ends: Vec<f64> = trials.iter().map(|trial| trial.end_m / trial.walked_m).collect();
    ends.sort_by(f64::total_cmp);
    (trials, ends)
}

fn mean(trials: &[Trial], of: fn(&Trial) -> f64) -> f64 {
    trials.iter().map(of).sum::<f64>() / trials.len() as f64
}

#[test]
fn a_foot_ends_within_half_a_percent_of_its_way() {
    let (mine, roadways) = two_levels();
    for carrier in [Carrier::foot(), Carrier::poor_foot()] {
        for walker in [Walker::default(), steady()] {
            let (trials, ends) = trials(&mine, &roadways, &carrier, &walker);
            // 0.5 % is the goal of the issue; all sixty keep it.
            assert!(ends[59] <= 0.005, "worst {:.4}", ends[59]);
            assert!(mean(&trials, |trial| trial.inside) >= 0.95);
            // A walk of 2.3 km passes some thirty junctions.
            assert!(mean(&trials, |trial| trial.wrong) <= 0.002);
        }
    }
}

#[test]
fn a_belt_ends_within_two_and_a_half_percent_of_its_way() {
    let (mine, roadways) = two_levels();
    for walker in [Walker::default(), steady()] {
        let (trials, ends) = trials(&mine, &roadways, &Carrier::waist(), &walker);
        // 2.5 % is the goal of the issue; all sixty keep it.
        assert!(ends[59] <= 0.025, "worst {:.4}", ends[59]);
        assert!(mean(&trials, |trial| trial.inside) >= 0.95);
    }
}

/// A mine of roadways, each 4 m wide and 3 m high.
fn drawn(lines: &[&[[f64; 3]]]) -> (Mine, Arc<Roadways>) {
    let mut plan = MinePlan::new("drawn", Grid::Local {});
    for (index, line) in lines.iter().enumerate() {
        plan.roadways.push(Roadway {
            id: format!("r{index}"),
            name: None,
            level: None,
            kind: RoadwayKind::Drift,
            width_m: 4.0,
            height_m: 3.0,
            max_slope_percent: None,
            walkable: true,
            points_m: line.iter().map(|p| Position::new(p[0], p[1], p[2])).collect(),
        });
    }
    let mine = Mine::unchecked(plan);
    let roadways = Arc::new(Roadways::new(&mine));
    (mine, roadways)
}

/// Walks straight through points with a carrier that errs by a constant factor and turn; gives the bank.
fn led(
    roadways: &Arc<Roadways>,
    start: State,
    points: &[[f64; 3]],
    (factor, turn): (f64, f64),
    params: BankParams,
) -> Bank {
    use adit_estimation::place::state::{HeadingError, Stretch};
    let mut bank = Bank::new(params, Some(Arc::clone(roadways)));
    bank.start(start);
    let (sin, cos) = f64::sin_cos(turn);
    for pair in points.windows(2) {
        let (a, b) = (Vector3::from(pair[0]), Vector3::from(pair[1]));
        let steps = ((b - a).norm() / 0.7).ceil();
        let moved = (b - a) / steps;
        let level = Vector2::new(cos * moved.x - sin * moved.y, sin * moved.x + cos * moved.y) / factor;
        let up_m = if params.level_way { 0.0 } else { moved.z };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
        for _ in 0..steps as usize {
            bank.walk(&Stretch {
                way_m: level.push(up_m),
                drifting: 0.5,
                turned_rad: 0.0,
                along_m2: 1e-4,
                across_m2: 1e-4,
                up_m2: 1e-4,
                about_m2: 0.0,
                heading: HeadingError::Gyro { walk_rad2: 1e-6 },
                turn_rad2: 0.0,
                drift2: 0.0,
                iron_rad2: 0.0,
                factor2: 0.0,
                barometer_m2: 0.0,
            });
        }
    }
    bank
}

fn started(at: [f64; 3], sigma_m: f64, up_m: f64, factor: f64) -> State {
    use adit_estimation::place::state::{DRIFT, EAST, FACTOR, HEADING, NORTH, TURN, UP, Vector};
    let mut sigmas = Vector::zeros();
    (sigmas[EAST], sigmas[NORTH], sigmas[UP]) = (sigma_m, sigma_m, up_m);
    (sigmas[TURN], sigmas[HEADING], sigmas[DRIFT], sigmas[FACTOR]) = (0.05, 0.01, 1e-4, factor);
    let mut state = State::new(&sigmas.component_mul(&sigmas));
    state.position_m = Vector3::from(at);
    state
}

#[test]
fn the_length_of_a_step_is_learnt_at_corners() {
    let (_, roadways) = drawn(&[&[
        [0.0, 0.0, 0.0],
        [200.0, 0.0, 0.0],
        [200.0, 200.0, 0.0],
        [0.0, 200.0, 0.0],
        [0.0, 0.0, 0.0],
    ]]);
    let way = [[0.0, 0.0, 0.0], [200.0, 0.0, 0.0], [200.0, 200.0, 0.0], [0.0, 200.0, 0.0], [0.0, 0.0, 0.0]];
    let params = BankParams { tag_height_m: 0.0, ..BankParams::default() };
    let mut bank = led(&roadways, started([0.0, 0.0, 0.0], 0.5, 0.5, 0.1), &way, (1.08, 0.04), params);
    let best = bank.best().unwrap().clone();
    // Four corners, each known by the half width of 2 m, 200 m apart.
    assert!((best.state.factor - 1.08).abs() < 0.01, "{}", best.state.factor);
    assert!((best.state.turn_rad - 0.04).abs() < 0.02, "{}", best.state.turn_rad);
    let estimate = bank.estimate().unwrap();
    assert!(estimate.position_m.xy().norm() < 3.0, "{}", estimate.position_m);
    assert!(!estimate.lost);
}

#[test]
fn of_parallel_headings_the_length_of_the_way_tells_the_right_one() {
    let headings: Vec<[[f64; 3]; 2]> =
        (1..=6).map(|i| [[f64::from(i) * 40.0, 0.0, 0.0], [f64::from(i) * 40.0, 80.0, 0.0]]).collect();
    let main = [[0.0, 0.0, 0.0], [300.0, 0.0, 0.0]];
    let mut lines: Vec<&[[f64; 3]]> = vec![&main];
    lines.extend(headings.iter().map(<[[f64; 3]; 2]>::as_slice));
    let (_, roadways) = drawn(&lines);
    let params = BankParams { tag_height_m: 0.0, ..BankParams::default() };
    // Told 8 m short after 160 m, with a factor known by 4 %: 6 m.
    let way = [[0.0, 0.0, 0.0], [160.0, 0.0, 0.0], [160.0, 70.0, 0.0]];
    let mut bank = led(&roadways, started([0.0, 0.0, 0.0], 0.5, 0.5, 0.04), &way, (1.05, 0.0), params);
    let estimate = bank.estimate().unwrap();
    assert!((estimate.position_m.x - 160.0).abs() < 3.0, "{}", estimate.position_m);
    assert!(estimate.share > 0.95);
    // With 30 % nobody can tell, and the radius says so.
    let mut unsure = led(&roadways, started([0.0, 0.0, 0.0], 0.5, 0.5, 0.3), &way, (1.05, 0.0), params);
    let estimate = unsure.estimate().unwrap();
    assert!(estimate.hypotheses > 1);
    assert!(radius_m(&estimate) > 30.0, "{}", radius_m(&estimate));
}

#[test]
fn of_a_fork_the_way_tells_the_branch() {
    let branch = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        [[100.0, 0.0, 0.0], [100.0 + 150.0 * cos, 150.0 * sin, 0.0]]
    };
    let (main, [left, right]) = ([[0.0, 0.0, 0.0], [100.0, 0.0, 0.0]], [branch(15.0), branch(-15.0)]);
    let (_, roadways) = drawn(&[&main, &left, &right]);
    let params = BankParams { tag_height_m: 0.0, ..BankParams::default() };
    for taken in [left, right] {
        let way = [main[0], main[1], taken[1]];
        // The heading is off by half of the fork's angle.
        let mut bank = led(&roadways, started([0.0, 0.0, 0.0], 0.5, 0.5, 0.03), &way, (1.02, 0.06), params);
        let estimate = bank.estimate().unwrap();
        assert!((estimate.position_m - Vector3::from(taken[1])).xy().norm() < 6.0, "{}", estimate.position_m);
        assert!(estimate.share > 0.99);
    }
}

#[test]
fn a_ramp_between_two_levels_gives_the_height_at_the_belt() {
    let upper = [[0.0, 0.0, 30.0], [200.0, 0.0, 30.0]];
    let ramp = [[200.0, 0.0, 30.0], [200.0, 120.0, 15.0], [80.0, 120.0, 0.0], [80.0, 0.0, 0.0]];
    let lower = [[0.0, 0.0, 0.0], [200.0, 0.0, 0.0]];
    let (_, roadways) = drawn(&[&upper, &ramp, &lower]);
    let params = BankParams { level_way: true, ..BankParams::default() };
    let way = [upper[0], ramp[0], ramp[1], ramp[2], ramp[3], [10.0, 0.0, 0.0]];
    let mut bank = led(&roadways, started([0.0, 0.0, 31.0], 0.5, 0.5, 0.05), &way, (1.04, 0.03), params);
    let estimate = bank.estimate().unwrap();
    assert!((estimate.position_m - Vector3::new(10.0, 0.0, 1.0)).norm() < 4.0, "{}", estimate.position_m);
}

#[test]
fn of_two_levels_the_height_tells_the_right_one() {
    let lines = [[[0.0, 0.0, 30.0], [200.0, 0.0, 30.0]], [[0.0, 0.0, 0.0], [200.0, 0.0, 0.0]]];
    let (_, roadways) = drawn(&[&lines[0], &lines[1]]);
    let mut bank = Bank::new(BankParams::default(), Some(Arc::clone(&roadways)));
    bank.start(started([100.0, 1.0, 14.0], 2.0, 30.0, 0.05));
    let places: Vec<Place> = bank.hypotheses().iter().map(|known| known.place).collect();
    assert_eq!(places, [Place::Piece(0), Place::Piece(1)]);
    // A barometer, wrong by 3 m, some times.
    for _ in 0..3 {
        bank.take(|state| state.see_height(28.0, 3.0, &Vector3::zeros()), 9.0);
    }
    assert_eq!(bank.best().unwrap().place, Place::Piece(0));
    assert!(bank.best().unwrap().weight() > 0.999);
}

#[test]
fn who_is_where_no_roadway_is_makes_the_bank_say_so() {
    let (_, roadways) = drawn(&[&[[0.0, 0.0, 0.0], [300.0, 0.0, 0.0]]]);
    let params = BankParams { tag_height_m: 0.0, ..BankParams::default() };
    // A heading that was driven since the map was drawn.
    let way = [[0.0, 0.0, 0.0], [100.0, 0.0, 0.0], [100.0, 80.0, 0.0]];
    let start = || started([0.0, 0.0, 0.0], 0.5, 0.5, 0.02);
    let soon = led(&roadways, start(), &[way[0], way[1], [100.0, 20.0, 0.0]], (1.0, 0.0), params);
    assert!(soon.is_lost());
    let mut bank = led(&roadways, start(), &way, (1.0, 0.0), params);
    assert!(bank.is_lost());
    let estimate = bank.estimate().unwrap();
    let off_m = (estimate.position_m - Vector3::new(100.0, 80.0, 0.0)).xy().norm();
    assert!(off_m <= radius_m(&estimate), "{off_m} of {}", radius_m(&estimate));
}

/// Ranges to anchors about a place, which err by a decimetre.
fn range_from(bank: &mut Bank, anchors: &[Vector3<f64>], place: &Vector3<f64>) {
    for (index, anchor) in anchors.iter().enumerate() {
        let range_m = (anchor - place).norm() + if index % 2 == 0 { 0.1 } else { -0.1 };
        bank.take(|state| state.see_range(anchor, (range_m, 0.1), &Back::default()), 9.0);
    }
}

#[test]
fn who_took_the_cage_is_found_again_by_three_rounds_of_ranges() {
    let (_, roadways) = two_levels();
    let (upper, lower) = (Vector3::new(5450.0, 2970.0, 114.35), Vector3::new(5450.0, 2975.0, 54.35));
    let mut bank = Bank::new(BankParams::default(), Some(Arc::clone(&roadways)));
    bank.start(started([upper.x, upper.y, upper.z], 0.5, 0.5, 0.05));
    let level = bank.best().unwrap().place;
    let anchors =
        [[5447.0, 2999.0, 57.0], [5453.0, 2950.0, 57.0], [5470.0, 3001.0, 57.0], [5447.0, 2940.0, 56.0]]
            .map(Vector3::from);
    // What went before is doubted only when eight measurements contradict it: two rounds; a third tells the place.
    for _ in 0..3 {
        range_from(&mut bank, &anchors, &lower);
        bank.estimate();
    }
    let estimate = bank.estimate().unwrap();
    assert_ne!(estimate.place, level);
    assert!((estimate.position_m - lower).norm() < 1.0, "{}", estimate.position_m);
}

#[test]
fn a_spiral_ramp_whose_turns_lie_above_each_other_is_climbed() {
    let (radius_m, sides) = (20.0, 12);
    let corner = |index: i32| {
        let (sin, cos) = (f64::from(index) / f64::from(sides) * core::f64::consts::TAU).sin_cos();
        [radius_m * cos, radius_m * sin, 1.2 * f64::from(index)]
    };
    let spiral: Vec<[f64; 3]> = (0..=3 * sides).map(corner).collect();
    let top = spiral[spiral.len() - 1];
    let (below, above) = ([[radius_m, -150.0, 0.0], spiral[0]], [top, [radius_m, 150.0, top[2]]]);
    let (_, roadways) = drawn(&[&below, &spiral, &above]);
    let mut way = vec![below[0]];
    way.extend(&spiral);
    way.push(above[1]);
    for (level_way, height_m) in [(true, 1.0), (false, 0.1)] {
        let params = BankParams { level_way, tag_height_m: height_m, ..BankParams::default() };
        let start = started([radius_m, -150.0, height_m], 0.5, 0.3, 0.05);
        let mut bank = led(&roadways, start, &way, (1.05, 0.03), params);
        let estimate = bank.estimate().unwrap();
        let off = estimate.position_m - Vector3::new(radius_m, 150.0, top[2] + height_m);
        assert!(off.norm() < 6.0, "{off} of {}", estimate.share);
        assert!(!estimate.lost);
    }
}

#[test]
fn who_works_in_a_chamber_is_held_to_it_and_leaves_it_again() {
    let (_, roadways) = two_levels();
    let params = BankParams { tag_height_m: 0.0, ..BankParams::default() };
    let to = [[5200.0, 3005.0, 112.6], [5200.0, 3035.0, 112.6], [5212.0, 3036.0, 112.6]];
    let work: Vec<[f64; 3]> =
        (0..200).map(|i| [5210.0 + 2.0 * f64::from(i % 2), 3034.0 + f64::from(i % 4), 112.6]).collect();
    let back = [[5200.0, 3036.0, 112.6], [5200.0, 3068.0, 112.6], [5240.0, 3068.0, 112.7]];
    let start = || started([5200.0, 3005.0, 112.6], 0.5, 0.5, 0.02);
    let way: Vec<[f64; 3]> = to.iter().chain(&work).copied().collect();
    let mut inside = led(&roadways, start(), &way, (1.0, 0.02), params);
    let estimate = inside.estimate().unwrap();
    assert!(matches!(estimate.place, Place::Chamber(_)), "{estimate:?}");
    assert!(
        (estimate.position_m.xy() - Vector2::from([5211.0, 3036.0])).norm() < 5.0,
        "{}",
        estimate.position_m
    );
    let whole: Vec<[f64; 3]> = way.iter().chain(&back).copied().collect();
    let mut after = led(&roadways, start(), &whole, (1.0, 0.02), params);
    let estimate = after.estimate().unwrap();
    assert!((estimate.position_m - Vector3::from(back[2])).norm() < 4.0, "{}", estimate.position_m);
    assert!(matches!(estimate.place, Place::Piece(_)));
}

//! People in a mine: calculus, continuity, feet that do not slide, air and not rock, determinism.

use crate::common::{crawlway, two_level};
use adit_core::attitude;
use adit_core::frames::Position;
use adit_core::nalgebra::Vector3;
use adit_mine::Mine;
use adit_simulation::people::{
    Activity, Belt, Body, Errand, Pace, Person, PersonSpec, Place, Population, PopulationSpec, ShiftSpec,
    VehicleSpec,
};
use adit_simulation::{Foot, Motion, SimulationError};

fn roadway(id: &str, along_m: f64) -> Place {
    Place::Roadway { id: id.into(), along_m, left_m: 0.0 }
}

/// Walks, runs, crawls, works, turns, rides a vehicle, walks on.
fn errands() -> PersonSpec {
    PersonSpec {
        body: Body::default(),
        drawn: false,
        start: roadway("l300-haulage", 40.0),
        errands: vec![
            Errand::Stand { seconds: 20.0 },
            Errand::Go { to: roadway("l300-panel-1", 60.0), pace: Pace::Walk, speed_m_s: None },
            Errand::Work { seconds: 30.0 },
            Errand::Turn { turn_rad: 3.0 },
            Errand::Go { to: roadway("l300-panel-1", 100.0), pace: Pace::Run, speed_m_s: None },
            Errand::Go { to: roadway("l300-panel-1", 92.0), pace: Pace::Crawl, speed_m_s: None },
            Errand::Stand { seconds: 2.0 },
            Errand::Ride { vehicle: 0, to_stop: 2 },
            Errand::Go {
                to: Place::Zone { id: "l360-refuge-2".into() },
                pace: Pace::Walk,
                speed_m_s: Some(1.9),
            },
            Errand::Stand { seconds: 10.0 },
        ],
    }
}

fn spec() -> PopulationSpec {
    PopulationSpec {
        persons: vec![errands()],
        vehicles: vec![VehicleSpec::on("ore")],
        ..PopulationSpec::default()
    }
}

fn somebody() -> Person {
    Population::new(&two_level(), &spec(), 5).unwrap().person(0).unwrap().unwrap()
}

fn shift(people: u32, duration_s: f64) -> PopulationSpec {
    PopulationSpec {
        people,
        shift: ShiftSpec { duration_s, ..ShiftSpec::default() },
        vehicles: vec![VehicleSpec::on("ore"), VehicleSpec::on("ore")],
        ..PopulationSpec::default()
    }
}

/// Times over the whole motion that fall on no round number, near episodes densely.
fn times(person: &Person) -> Vec<f64> {
    let end = person.duration_s();
    let mut times: Vec<f64> = (0..20_000).map(|i| end * (f64::from(i) + 0.37) / 20_000.0).collect();
    for (start, _) in person.episodes() {
        times.extend((-150..150).map(|i| start + 0.011 * f64::from(i) + 1e-4));
    }
    times.retain(|t| (1e-3..end - 1e-3).contains(t));
    times
}

fn derivatives_agree(motion: &impl Motion, times: &[f64], largest: (f64, f64, f64)) {
    let h = 2e-5;
    let mut worst = (0.0_f64, 0.0_f64, 0.0_f64);
    for &t in times {
        let (before, here, after) = (motion.at(t - h), motion.at(t), motion.at(t + h));
        let velocity = (after.position_m - before.position_m) / (2.0 * h);
        let acceleration = (after.velocity_m_s - before.velocity_m_s) / (2.0 * h);
        let rate = attitude::log(&(before.attitude.inverse() * after.attitude)) / (2.0 * h);
        worst.0 = worst.0.max((velocity - here.velocity_m_s).norm());
        worst.1 = worst.1.max((acceleration - here.acceleration_m_s2).norm());
        worst.2 = worst.2.max((rate - here.angular_rate_rad_s).norm());
    }
    assert!(worst.0 < largest.0 && worst.1 < largest.1 && worst.2 < largest.2, "{worst:?}");
}

#[test]
fn derivatives_agree_with_differences_in_every_mode() {
    let person = somebody();
    let times = times(&person);
    // Central differences over 20 µs leave h²/6 of the next but one derivative: jerks of 2e4 m/s³ where a quick heel strikes, the
    // second derivative of acceleration below 1e8 m/s⁵; positions of 6 km round to 1e-12 m, 2e-8 m/s.
    for belt in [Belt::back(), Belt::right()] {
        derivatives_agree(&person.waist(belt), &times, (1e-5, 2e-2, 1e-5));
    }
    derivatives_agree(&person.foot(Foot::instep(), true), &times, (1e-5, 2e-2, 1e-4));
}

#[test]
fn nothing_jumps_where_one_mode_becomes_another() {
    let person = somebody();
    let (waist, foot) = (person.waist(Belt::front()), person.foot(Foot::instep(), false));
    let mut crossed = 0;
    for (start, _) in person.episodes().skip(1) {
        crossed += 1;
        let (waist, foot) =
            ([-1e-7, 1e-7].map(|dt| waist.at(start + dt)), [-1e-7, 1e-7].map(|dt| foot.at(start + dt)));
        for [before, after] in [waist, foot] {
            // 0.2 µs at speeds below 5 m/s, jerks below 3000 m/s³, angular accelerations below 500 rad/s².
            assert!((after.position_m - before.position_m).norm() < 1e-6, "at {start}");
            assert!((after.velocity_m_s - before.velocity_m_s).norm() < 1e-5, "at {start}");
            assert!((after.acceleration_m_s2 - before.acceleration_m_s2).norm() < 1e-3, "at {start}");
            assert!(attitude::log(&(before.attitude.inverse() * after.attitude)).norm() < 1e-6, "at {start}");
            assert!((after.angular_rate_rad_s - before.angular_rate_rad_s).norm() < 2e-4, "at {start}");
        }
    }
    assert!(crossed > 15, "{crossed} episodes");
}

#[test]
fn the_errands_are_run_in_order() {
    use Activity::{Board, Crawl, Ride, Run, Stand, Walk, Work};
    let person = somebody();
    let mut order: Vec<Activity> = person.episodes().map(|(_, activity)| activity).collect();
    order.dedup();
    let expected =
        [Stand, Walk, Work, Walk, Run, Walk, Crawl, Stand, Walk, Stand, Board, Ride, Board, Walk, Stand];
    assert_eq!(order, expected);
}

#[test]
fn a_foot_that_stands_does_not_slide() {
    let person = somebody();
    for left in [true, false] {
        let foot = person.foot(Foot::instep(), left);
        let mut stood = 0;
        for t in times(&person) {
            let state = foot.at(t);
            let riding = person.at(t).activity == Activity::Ride;
            if state.stance && !riding && person.at(t).activity != Activity::Run {
                stood += 1;
                assert_eq!(state.velocity_m_s, Vector3::zeros(), "at {t}");
                assert_eq!(state.angular_rate_rad_s, Vector3::zeros(), "at {t}");
            }
        }
        assert!(stood > 1000);
    }
}

#[test]
fn the_pelvis_stays_between_the_feet() {
    let person = somebody();
    let waist = person.waist(Belt { offset_m: Vector3::zeros(), ..Belt::front() });
    let feet = [true, false].map(|left| person.foot(Foot::instep(), left));
    let mut worst = 0.0_f64;
    for t in times(&person) {
        let at = person.at(t);
        if !matches!(at.activity, Activity::Walk | Activity::Stand) {
            continue;
        }
        let middle = 0.5 * (feet[0].at(t).position_m + feet[1].at(t).position_m);
        let off = (waist.at(t).position_m - middle).xy();
        worst = worst.max(off.norm());
    }
    // In swing the middle of the feet runs up to a quarter of a step (0.17 m) ahead or behind, the sensors sit 2 cm before the
    // soles' middle, hips sway by 2 cm, and a kneeling foot has its toes 0.1 m behind.
    assert!(worst < 0.4, "{worst}");
}

#[test]
fn coarse_and_fine_agree() {
    let person = somebody();
    let waist = person.waist(Belt { offset_m: Vector3::zeros(), ..Belt::front() });
    let mut worst = (0.0_f64, 0.0_f64);
    for t in times(&person) {
        let (at, fine) = (person.at(t), waist.at(t));
        let off = fine.position_m - at.floor_m;
        let sway = if at.activity == Activity::Work { 0.15 } else { 0.0 };
        worst.0 = worst.0.max(off.xy().norm() - sway);
        if matches!(at.activity, Activity::Walk | Activity::Stand | Activity::Ride) {
            worst.1 = worst.1.max((off.z - person.waist_height_m(t)).abs());
        }
    }
    // Steps vary by 3 % of 0.7 m, hips sway by 2 cm, and the quintics cut corners of starts and stops by some cm.
    assert!(worst.0 < 0.15, "{worst:?}");
    // Kneeling down and getting up count as standing for a while: from 0.51 m to 1.0 m.
    assert!(worst.1 < 0.6, "{worst:?}");
}

#[test]
fn everybody_is_in_the_air_and_not_in_the_rock() {
    let mine = two_level();
    let population = Population::new(&mine, &shift(6, 4.0 * 3600.0), 11).unwrap();
    let inside = |at: Vector3<f64>| mine.excavation().contains(&Position::from_raw(at));
    let mut sampled = 0_u32;
    for index in 0..population.len() {
        let person = population.person(index).unwrap().unwrap();
        let (waist, foot) = (person.waist(Belt::right()), person.foot(Foot::instep(), true));
        let mut t = 0.0;
        while t < person.duration_s() {
            let at = person.at(t);
            // The middle of the body, a body's half width around it at hip height, the sensors themselves.
            assert!(inside(at.floor_m + Vector3::z() * 0.1), "{index} at {t}: {:?}", at.floor_m);
            for (dx, dy) in [(0.3, 0.0), (-0.3, 0.0), (0.0, 0.3), (0.0, -0.3)] {
                let side = at.floor_m + Vector3::new(dx, dy, 0.9);
                assert!(inside(side), "{index} at {t} beside {:?} {:?}", at.floor_m, at.activity);
            }
            assert!(inside(waist.at(t).position_m), "waist of {index} at {t}");
            assert!(inside(foot.at(t).position_m), "foot of {index} at {t}: {:?}", at.activity);
            sampled += 1;
            t += 0.83;
        }
    }
    assert!(sampled > 100_000);
}

#[test]
fn arrivals_are_those_of_speed_and_way() {
    let mine = two_level();
    let network = mine.network();
    let population = Population::new(&mine, &spec(), 5).unwrap();
    let person = population.person(0).unwrap().unwrap();
    let place = |t: f64| network.nearest(&Position::from_raw(person.floor_m(t))).unwrap().spot;
    let episodes: Vec<_> = person.episodes().collect();
    let (start, _) = episodes[episodes.iter().position(|(_, a)| *a == Activity::Walk).unwrap()];
    let (end, _) = *episodes.iter().find(|(_, a)| *a == Activity::Work).unwrap();
    let route = network.route(&place(start), &place(end), adit_mine::network::Travel::OnFoot).unwrap();
    let expected = route.length_m / Body::default().walk_m_s;
    // Keeping right and rounding corners change the way by a few metres; two turns and the half steps at the ends take some seconds.
    assert!((end - start - expected).abs() < 0.03 * expected + 6.0, "{} for {expected}", end - start);
}

#[test]
fn a_person_does_not_depend_on_how_many_there_are() {
    let mine = two_level();
    let few = Population::new(&mine, &shift(3, 7200.0), 9).unwrap();
    let many = Population::new(&mine, &shift(300, 7200.0), 9).unwrap();
    let other = Population::new(&mine, &shift(3, 7200.0), 10).unwrap();
    let at = |population: &Population, t: f64| {
        let person = population.person(2).unwrap().unwrap();
        (person.at(t), person.waist(Belt::back()).at(t), person.foot(Foot::instep(), true).at(t))
    };
    for t in [100.0, 2000.5, 5555.5] {
        assert_eq!(at(&few, t), at(&many, t));
        assert_ne!(at(&few, t), at(&other, t));
    }
    assert!(few.person(3).is_none());
}

#[test]
fn shares_of_activity_come_out_as_asked() {
    let mine = two_level();
    let mut spec = shift(4, 6.0 * 3600.0);
    spec.vehicles.clear();
    spec.shift.workplaces = 1;
    let population = Population::new(&mine, &spec, 3).unwrap();
    for index in 0..4 {
        let person = population.person(index).unwrap().unwrap();
        let works = |(_, a): &(f64, Activity)| *a == Activity::Work;
        let episodes: Vec<_> = person.episodes().collect();
        let first = episodes.iter().position(works).unwrap();
        let last = episodes.len() - episodes.iter().rev().position(works).unwrap();
        let (from, until) = (episodes[first].0, episodes[last].0);
        let worked: f64 =
            (first..last).filter(|i| works(&episodes[*i])).map(|i| episodes[i + 1].0 - episodes[i].0).sum();
        let share = worked / (until - from);
        // One stretch of 3 min in 2 h and more.
        assert!((share - 0.55).abs() < 0.04, "{index}: {share}");
        assert!(person.duration_s() < 6.2 * 3600.0, "home in time: {}", person.duration_s());
    }
}

#[test]
fn an_errand_is_gone_at_the_speed_it_names() {
    let mine = two_level();
    let go =
        |along_m, speed_m_s| Errand::Go { to: roadway("l300-haulage", along_m), pace: Pace::Walk, speed_m_s };
    let errands = vec![go(300.0, Some(2.0)), go(40.0, Some(1.0)), go(300.0, None)];
    let person =
        PersonSpec { body: Body::default(), drawn: false, start: roadway("l300-haulage", 40.0), errands };
    let spec = PopulationSpec { persons: vec![person], ..PopulationSpec::default() };
    let person = Population::new(&mine, &spec, 1).unwrap().person(0).unwrap().unwrap();
    let episodes: Vec<_> = person.episodes().collect();
    let going: Vec<f64> = episodes
        .windows(2)
        .filter(|pair| pair[0].1 == Activity::Walk && pair[1].0 - pair[0].0 > 60.0)
        .map(|pair| {
            (person.at(pair[1].0).floor_m - person.at(pair[0].0).floor_m).norm() / (pair[1].0 - pair[0].0)
        })
        .collect();
    // The first and the last step are half as long: 1 of 500.
    for (found, expected) in going.iter().zip([2.0, 1.0, 1.25]) {
        assert!((found / expected - 1.0).abs() < 0.01, "{going:?}");
    }
    assert_eq!(going.len(), 3);
}

#[test]
fn low_roadways_are_crawled() {
    let mine: Mine = crawlway();
    let errands = vec![Errand::Go { to: roadway("b", 30.0), pace: Pace::Walk, speed_m_s: None }];
    let person = PersonSpec { body: Body::default(), drawn: false, start: roadway("a", 2.0), errands };
    let spec = PopulationSpec { persons: vec![person], ..PopulationSpec::default() };
    let person = Population::new(&mine, &spec, 1).unwrap().person(0).unwrap().unwrap();
    let waist = person.waist(Belt::back());
    let mut crawled = 0;
    for i in 0..2000 {
        let t = person.duration_s() * f64::from(i) / 2000.0;
        let at = person.at(t);
        let inside = |p: Vector3<f64>| mine.excavation().contains(&Position::from_raw(p));
        assert!(inside(waist.at(t).position_m), "at {t}");
        if (22.0..38.0).contains(&at.floor_m.x) {
            assert_eq!(at.activity, Activity::Crawl);
            crawled += 1;
            // The trunk is level: body x points down.
            let forward = waist.at(t).attitude.transform_vector(&-Vector3::x());
            assert!(forward.z < -0.8, "at {t}: {forward:?}");
        }
    }
    assert!(crawled > 200);
}

#[test]
fn what_is_wrong_is_named() {
    let mine = two_level();
    let refused = |person: PersonSpec| {
        let spec = PopulationSpec {
            persons: vec![person],
            vehicles: vec![VehicleSpec::on("ore")],
            ..PopulationSpec::default()
        };
        Population::new(&mine, &spec, 1).unwrap().person(0).unwrap().unwrap_err()
    };
    let unknown = refused(PersonSpec { start: roadway("nowhere", 0.0), ..errands() });
    let expected =
        SimulationError::Unknown { name: "start", found: "nowhere".into(), expected: "the id of a roadway" };
    assert_eq!(unknown, expected);
    let too_far = refused(PersonSpec { start: roadway("ramp", 1e5), ..errands() });
    assert!(matches!(too_far, SimulationError::Parameter { name: "along_m", found: 1e5, .. }));
    let giant = refused(PersonSpec { body: Body { height_m: 3.0, ..Body::default() }, ..errands() });
    assert!(matches!(giant, SimulationError::Parameter { name: "height_m", found: 3.0, .. }));
    let no_stop = refused(PersonSpec { errands: vec![Errand::Ride { vehicle: 0, to_stop: 9 }], ..errands() });
    assert!(matches!(no_stop, SimulationError::Parameter { name: "to_stop", found: 9.0, .. }));
    let up_the_ladder = Place::Roadway { id: "ladderway".into(), along_m: 100.0, left_m: 0.0 };
    let no_way = refused(PersonSpec {
        errands: vec![Errand::Go { to: up_the_ladder, pace: Pace::Walk, speed_m_s: None }],
        ..errands()
    });
    assert!(matches!(no_way, SimulationError::Unknown { name: "to", .. }));
    let spec = PopulationSpec { vehicles: vec![VehicleSpec::on("tram")], ..PopulationSpec::default() };
    let no_route = Population::new(&mine, &spec, 1).unwrap_err();
    assert!(matches!(no_route, SimulationError::Unknown { name: "route", .. }));
}

#[test]
fn who_is_home_stays_there() {
    let mine = two_level();
    let population = Population::new(&mine, &shift(12, 1500.0), 4).unwrap();
    let idle = PersonSpec { errands: Vec::new(), ..errands() };
    let alone = PopulationSpec { persons: vec![idle], ..PopulationSpec::default() };
    let idle = Population::new(&mine, &alone, 4).unwrap().person(0).unwrap().unwrap();
    for person in (0..12).map(|index| population.person(index).unwrap().unwrap()).chain([idle]) {
        let (waist, foot) = (person.waist(Belt::front()), person.foot(Foot::instep(), true));
        let end_s = waist.duration_s().max(foot.duration_s());
        let home = [waist.at(end_s), foot.at(end_s)].map(|state| state.position_m);
        for late_s in [0.001, 0.4, 1.0, 7.7, 1e4, 1e9] {
            let later = [waist.at(end_s + late_s), foot.at(end_s + late_s)];
            assert_eq!(home, later.map(|state| state.position_m));
            assert!(later.iter().all(|state| state.acceleration_m_s2.norm() == 0.0), "at rest");
            let off = (person.floor_m(end_s + late_s) - home[0]).xy().norm();
            assert!(off < 0.5, "{off} m from home");
        }
        // Every moment about the end, where the last step is.
        assert!(
            (0..400).all(|nth| waist.at(end_s - 2.0 + f64::from(nth) * 0.01).position_m.norm().is_finite())
        );
    }
}

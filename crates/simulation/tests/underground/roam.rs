//! Walks to drawn places: where they lead, how long they last, what two seeds have in common.

use crate::common::two_level;
use adit_core::frames::Position;
use adit_core::nalgebra::Vector3;
use adit_mine::Mine;
use adit_mine::network::{Spot, Travel};
use adit_simulation::people::{
    Activity, Belt, Body, Errand, Person, PersonSpec, Place, Population, PopulationSpec, Roam,
};
use adit_simulation::{Foot, Motion, SimulationError};

/// As it is without a word in a scenario.
fn about(level: &str, until_s: f64) -> Roam {
    Roam {
        until_s,
        levels: vec![level.to_owned()],
        reach_m: f64::INFINITY,
        speed_share: [0.9, 1.1],
        stop_share: 0.5,
        stop_s: [5.0, 45.0],
        work_share: 0.5,
    }
}

fn somebody(mine: &Mine, ways: Vec<Roam>, drawn: bool, seed: u64) -> Result<Person, SimulationError> {
    let start = Place::Roadway { id: "l300-haulage".into(), along_m: 500.0, left_m: 0.0 };
    let errands = ways.into_iter().map(Errand::Roam).collect();
    let person = PersonSpec { body: Body::default(), drawn, start, errands };
    let spec = PopulationSpec { persons: vec![person], ..PopulationSpec::default() };
    Population::new(mine, &spec, seed)?.person(0).unwrap()
}

/// One level, then the other.
fn both(mine: &Mine, seed: u64) -> Person {
    somebody(mine, vec![about("l300", 900.0), about("l360", 3000.0)], true, seed).unwrap()
}

/// Where a body stands, as a spot of the network.
fn spot(mine: &Mine, at: Vector3<f64>) -> Spot {
    mine.network().nearest(&Position::from_raw(at)).unwrap().spot
}

#[test]
fn the_way_leads_over_the_ramp_to_the_other_level_and_differs_from_seed_to_seed() {
    let mine = two_level();
    let mut ends = Vec::new();
    for seed in 1..=8 {
        let person = both(&mine, seed);
        let heights: Vec<f64> = (0..300).map(|t| person.floor_m(10.0 * f64::from(t)).z).collect();
        // Floors rise from 112.0 m and from 52.0 m by 0.3 % over 950 m.
        let on_first = |z: &f64| (111.0..117.0).contains(z);
        let on_second = |z: &f64| (51.0..57.5).contains(z);
        assert!(heights[..90].iter().all(on_first), "seed {seed}");
        let down = heights.iter().position(on_second).unwrap();
        assert!(heights[down..].iter().all(on_second), "seed {seed}: it stays there");
        // 483 m of ramp at 1.7 m/s at most are 284 s.
        let on_ramp = heights.iter().filter(|z| !on_first(z) && !on_second(z)).count();
        assert!(on_ramp > 20, "seed {seed}: {on_ramp}");
        ends.push(person.floor_m(899.0));
        assert_eq!(person.at(1234.5), both(&mine, seed).at(1234.5));
    }
    for (index, end) in ends.iter().enumerate() {
        assert!(ends[..index].iter().all(|other| (other - end).norm() > 1.0), "{ends:?}");
    }
}

#[test]
fn most_of_the_time_is_walked_and_nothing_begins_after_its_end() {
    let mine = two_level();
    let mut stops = (0, 0);
    for seed in 1..=20 {
        let person = both(&mine, seed);
        let episodes: Vec<_> = person.episodes().collect();
        // The last way, a turn at its beginning at most before it, and two seconds of rest.
        let after: Vec<_> = episodes.iter().filter(|(start_s, _)| *start_s > 3000.0).collect();
        assert!(after.len() <= 2, "seed {seed}: {after:?}");
        let walked: f64 = episodes
            .windows(2)
            .filter(|pair| pair[0].1 == Activity::Walk)
            .map(|pair| pair[1].0 - pair[0].0)
            .sum();
        // Ways of 200 s and more on average, stops of 25 s after half of them.
        assert!(walked / person.duration_s() > 0.75, "seed {seed}: {walked} of {}", person.duration_s());
        for (_, activity) in &episodes[..episodes.len() - 1] {
            stops.0 += u32::from(*activity == Activity::Work);
            stops.1 += u32::from(*activity == Activity::Stand);
        }
    }
    // Half of some 50 stops each: five standard deviations of the difference are 35.
    let (works, stands) = stops;
    assert!(works + stands > 35 && works.abs_diff(stands) < 35, "{stops:?}");
}

#[test]
fn ways_are_as_short_as_asked() {
    let mine = two_level();
    let near = Roam { reach_m: 250.0, stop_share: 1.0, work_share: 0.0, ..about("l360", 4000.0) };
    let person = somebody(&mine, vec![near], false, 3).unwrap();
    let stops: Vec<Spot> = person
        .episodes()
        .filter(|(_, activity)| *activity == Activity::Stand)
        .map(|(start_s, _)| spot(&mine, person.floor_m(start_s + 0.1)))
        .collect();
    assert!(stops.len() > 20, "{}", stops.len());
    // The first way leads from level to level.
    let first = mine.network().route(&spot(&mine, person.floor_m(0.0)), &stops[0], Travel::OnFoot).unwrap();
    assert!(first.length_m > 900.0, "{}", first.length_m);
    for pair in stops.windows(2) {
        let way = mine.network().route(&pair[0], &pair[1], Travel::OnFoot).unwrap();
        // At a junction the nearest edge to a body beside the centre line may be the other one: half a roadway's width at both ends.
        assert!(way.length_m < 250.0 + 5.0, "{}", way.length_m);
    }
}

#[test]
fn who_is_drawn_differs_and_who_is_given_does_not() {
    let mine = two_level();
    let body = |drawn, seed| *somebody(&mine, vec![about("l300", 60.0)], drawn, seed).unwrap().body();
    assert_eq!(body(false, 1), Body::default());
    assert_eq!(body(false, 1), body(false, 2));
    assert_ne!(body(true, 1).height_m.to_bits(), body(true, 2).height_m.to_bits());
    assert_ne!(body(true, 1).walk_m_s.to_bits(), body(true, 2).walk_m_s.to_bits());
}

#[test]
fn everybody_stays_in_the_air() {
    let mine = two_level();
    let inside = |at: Vector3<f64>| mine.excavation().contains(&Position::from_raw(at));
    for seed in 1..=3 {
        let person = both(&mine, seed);
        let (waist, foot) = (person.waist(Belt::front()), person.foot(Foot::instep(), false));
        for i in 0..4000 {
            let t = person.duration_s() * (f64::from(i) + 0.37) / 4000.0;
            let floor_m = person.floor_m(t);
            for (dx, dy) in [(0.0, 0.0), (0.3, 0.0), (-0.3, 0.0), (0.0, 0.3), (0.0, -0.3)] {
                assert!(inside(floor_m + Vector3::new(dx, dy, 0.9)), "seed {seed} at {t}: {floor_m:?}");
            }
            assert!(inside(waist.at(t).position_m) && inside(foot.at(t).position_m), "seed {seed} at {t}");
        }
    }
}

#[test]
fn what_is_wrong_is_named() {
    let mine = two_level();
    let good = about("l300", 60.0);
    let refused = |roam: Roam| somebody(&mine, vec![roam], false, 1).unwrap_err();
    for (name, found, roam) in [
        ("until_s", -1.0, Roam { until_s: -1.0, ..good.clone() }),
        ("reach_m", 0.5, Roam { reach_m: 0.5, ..good.clone() }),
        ("speed_share", 0.1, Roam { speed_share: [0.1, 1.0], ..good.clone() }),
        ("speed_share", 0.9, Roam { speed_share: [1.0, 0.9], ..good.clone() }),
        ("stop_share", 1.5, Roam { stop_share: 1.5, ..good.clone() }),
        ("stop_s", 0.0, Roam { stop_s: [0.0, 1.0], ..good.clone() }),
        ("stop_s", 2.0, Roam { stop_s: [5.0, 2.0], ..good.clone() }),
        ("work_share", -0.5, Roam { work_share: -0.5, ..good.clone() }),
    ] {
        let told = match refused(roam) {
            SimulationError::Parameter { name, found, .. } => Some((name, found)),
            SimulationError::Unknown { .. } => None,
        };
        assert_eq!(told, Some((name, found)));
    }
    let expected = "the id of a level";
    let unknown = SimulationError::Unknown { name: "levels", found: "l999".into(), expected };
    assert_eq!(refused(about("l999", 60.0)), unknown);
    // No roadway of the surface but the decline, which is none of its own.
    let nowhere = refused(Roam { levels: vec!["surface".into()], ..good });
    assert!(matches!(nowhere, SimulationError::Unknown { name: "levels", .. }), "{nowhere:?}");
}

//! Radio in a mine: what blocks, what bends, what stays the same, what fails when.
#![expect(clippy::unwrap_used, reason = "a test may stop")]

use adit_core::frames::Position;
use adit_core::nalgebra::Vector3;
use adit_mine::Mine;
use adit_mine::plan::{
    AccessPoint, Anchor, Door, DoorKind, Grid, Level, MinePlan, Pillar, Roadway, RoadwayKind,
};
use adit_simulation::radio::{
    Antenna, Dead, LinkClass, MultipathSpec, Obstacle, Outage, RadioSpec, RadioWorld, RangeDetail,
    RangeOutcome, RssiSpec, Shape, Surroundings, UwbSpec,
};

/// A straight roadway of 100 m east and one of 60 m north from its end, 4 m wide.
fn plan() -> MinePlan {
    let mut plan = MinePlan::new("an L", Grid::Local {});
    plan.levels.push(Level { id: "l".into(), name: None, elevation_m: 0.0 });
    plan.roadways.push(Roadway {
        id: "r".into(),
        name: None,
        level: Some("l".into()),
        kind: RoadwayKind::Haulage,
        width_m: 4.0,
        height_m: 3.0,
        max_slope_percent: None,
        walkable: true,
        points_m: [(0.0, 0.0), (100.0, 0.0), (100.0, 60.0)].map(|(x, y)| Position::new(x, y, 0.0)).into(),
    });
    for (id, x, y) in [("a1", 50.0, 1.9), ("a2", 101.9, 8.0), ("a3", 80.0, -1.9)] {
        plan.anchors.push(Anchor {
            id: id.into(),
            position_m: Position::new(x, y, 2.5),
            range_offset_m: Some(0.0),
            antenna_delay_ns: None,
            tx_power_dbm: None,
        });
    }
    for (id, x, y) in [("w1", 10.0, 1.9), ("w2", 101.9, 50.0)] {
        plan.access_points.push(AccessPoint {
            id: id.into(),
            radio: adit_mine::plan::Radio::Wifi,
            mac: None,
            position_m: Position::new(x, y, 2.5),
            tx_power_dbm: None,
            path_loss: None,
        });
    }
    plan
}

/// No randomness but the noise of the receiver and the echoes.
fn calm() -> RadioSpec {
    let uwb = UwbSpec {
        shadowing_sigma_db: 0.0,
        noise_m: 0.0,
        power_bias: 0.0,
        missed: 0.0,
        outliers: 0.0,
        obstruction_excess_m: 0.0,
        multipath: MultipathSpec { echoes_db: -30.0, early_db: -40.0, ..MultipathSpec::default() },
        ..UwbSpec::default()
    };
    let wifi = RssiSpec {
        shadowing_sigma_db: 0.0,
        rician_k_db: 100.0,
        noise_db: 0.0,
        missed: 0.0,
        step_db: 0.0,
        sensitivity_dbm: -120.0,
        ..RssiSpec::wifi()
    };
    RadioSpec { uwb, wifi, ..RadioSpec::default() }
}

fn free(x: f64, y: f64) -> Antenna {
    Antenna { position_m: Vector3::new(x, y, 1.3), facing_rad: None }
}

fn ranges(world: &RadioWorld, antenna: &Antenna, obstacles: &[Obstacle]) -> Vec<RangeOutcome> {
    let mut out = Vec::new();
    let around = Surroundings { obstacles, conveyors_run: false };
    world.tag(1).ranges(world, 1.0, antenna, &around, &mut out);
    out
}

fn of<'o>(outcomes: &'o [RangeOutcome], anchor: &str) -> Option<&'o RangeOutcome> {
    outcomes.iter().find(|o| o.sample.anchor.as_str() == anchor)
}

#[test]
fn a_clear_link_is_line_of_sight_and_its_range_the_distance() {
    let mine = Mine::new(plan()).unwrap();
    let world = RadioWorld::new(mine.clone(), &calm(), &[], 1).unwrap();
    let antenna = free(40.0, 0.0);
    let outcomes = ranges(&world, &antenna, &[]);
    let a1 = of(&outcomes, "a1").unwrap();
    assert_eq!(a1.truth.class, LinkClass::Los);
    let distance = (Vector3::new(50.0, 1.9, 2.5) - antenna.position_m).norm();
    assert!((a1.truth.distance_m - distance).abs() < 1e-12 && (a1.truth.way_m - distance).abs() < 1e-12);
    // 0.2 tap of the leading edge: 6 cm.
    assert!((a1.sample.range_m - distance).abs() < 0.06, "{} {distance}", a1.sample.range_m);
    // −14.3 dBm + 2 dB − free space at 1 m of 6.4896 GHz (48.69 dB) − 18 log₁₀ d.
    let expected = -12.3 - 48.69 - 18.0 * distance.log10();
    assert!((a1.truth.power_dbm - expected).abs() < 0.3, "{} {expected}", a1.truth.power_dbm);
}

#[test]
fn round_a_corner_the_range_is_the_shortest_way_inside_the_roadway() {
    let mine = Mine::new(plan()).unwrap();
    let world = RadioWorld::new(mine.clone(), &calm(), &[], 1).unwrap();
    let antenna = free(94.0, 0.0);
    let outcomes = ranges(&world, &antenna, &[]);
    let a2 = of(&outcomes, "a2").unwrap();
    assert_eq!(a2.truth.class, LinkClass::Ndp);
    assert!(a2.truth.blockers.rock);
    // The inner corner of two roadways of 4 m is at (98, 2), 1.5 m above the floor.
    let corner = Vector3::new(98.0, 2.0, 1.5);
    let way = (Vector3::new(101.9, 8.0, 2.5) - corner).norm() + (corner - antenna.position_m).norm();
    assert!((a2.truth.way_m - way).abs() < 1e-9, "{} {way}", a2.truth.way_m);
    assert!((a2.sample.range_m - way).abs() < 0.3, "{} {way}", a2.sample.range_m);
    assert!(a2.truth.way_m > a2.truth.distance_m + 0.3);
    // Far from the corner the bend's loss leaves nothing.
    assert!(of(&ranges(&world, &free(50.0, 0.0), &[]), "a2").is_none());
}

#[test]
fn people_vehicles_pillars_and_the_wearer_block() {
    let mut plan = plan();
    plan.pillars.push(Pillar {
        id: "p".into(),
        level: "l".into(),
        height_m: None,
        outline_m: vec![[64.0, -1.0], [66.0, -1.0], [66.0, 1.0], [64.0, 1.0]],
    });
    let mine = Mine::new(plan).unwrap();
    let world = RadioWorld::new(mine.clone(), &calm(), &[], 1).unwrap();
    let anchor = Vector3::new(50.0, 1.9, 2.5);
    let here = Vector3::new(40.0, 0.0, 1.3);
    let clear = ranges(&world, &Antenna { position_m: here, facing_rad: None }, &[]);
    let half_way = here + (anchor - here) * 0.1;
    let person = Obstacle::person(Vector3::new(half_way.x, half_way.y, 0.0));
    let blocked = ranges(&world, &Antenna { position_m: here, facing_rad: None }, &[person]);
    let (clear, blocked) = (of(&clear, "a1").unwrap(), of(&blocked, "a1").unwrap());
    assert_eq!((clear.truth.blockers.people, blocked.truth.blockers.people), (0, 1));
    assert_ne!(blocked.truth.class, LinkClass::Los);
    assert!(blocked.truth.power_dbm < clear.truth.power_dbm - 5.0);

    let truck = Obstacle {
        foot_m: Vector3::new(45.0, 0.9, 0.0),
        height_m: 2.6,
        shape: Shape::Box {
            half_length_m: 3.0,
            half_width_m: 1.0,
            heading_rad: core::f64::consts::FRAC_PI_2,
        },
    };
    let behind = ranges(&world, &Antenna { position_m: here, facing_rad: None }, &[truck]);
    assert!(of(&behind, "a1").is_none_or(|o| o.truth.blockers.vehicles == 1));

    // Facing west, away from the anchor in the east, the wearer is in between.
    let west = Antenna { position_m: here, facing_rad: Some(-core::f64::consts::FRAC_PI_2) };
    let worn = ranges(&world, &west, &[]);
    assert!(of(&worn, "a1").unwrap().truth.blockers.wearer);
    let east = Antenna { position_m: here, facing_rad: Some(core::f64::consts::FRAC_PI_2) };
    assert!(!of(&ranges(&world, &east, &[]), "a1").unwrap().truth.blockers.wearer);

    let pillar = ranges(&world, &free(70.0, 0.0), &[]);
    assert_eq!(of(&pillar, "a3").unwrap().truth.blockers.pillars, 0);
    assert!(of(&pillar, "a1").is_none_or(|o| o.truth.blockers.pillars == 1));
}

#[test]
fn a_closed_door_takes_what_its_entry_says() {
    let scan = |door: Option<Option<f64>>| {
        let mut plan = plan();
        plan.doors.extend(door.map(|attenuation_db| Door {
            id: "d".into(),
            kind: DoorKind::Ventilation,
            level: "l".into(),
            closed: true,
            pressure_step_pa: None,
            attenuation_db,
            ends_m: [[20.0, -2.0], [20.0, 2.0]],
        }));
        let mine = Mine::new(plan).unwrap();
        let world = RadioWorld::new(mine.clone(), &calm(), &[], 1).unwrap();
        let mut out = Vec::new();
        world.tag(1).scan(&world, 1.0, &free(40.0, 0.0), &Surroundings::default(), &mut out);
        out.iter().find(|s| s.transmitter.as_str() == "w1").unwrap().rssi_dbm
    };
    let open = scan(None);
    assert!((open - scan(Some(Some(7.5))) - 7.5).abs() < 1e-9);
    assert!((open - scan(Some(None)) - RssiSpec::wifi().door_loss_db).abs() < 1e-9);
}

#[test]
fn signal_strength_follows_the_model_and_loses_a_corner() {
    let mine = Mine::new(plan()).unwrap();
    let spec = calm();
    let world = RadioWorld::new(mine.clone(), &spec, &[], 1).unwrap();
    let at = |x: f64, y: f64, id: &str| {
        let mut out = Vec::new();
        world.tag(1).scan(&world, 1.0, &free(x, y), &Surroundings::default(), &mut out);
        out.iter().find(|s| s.transmitter.as_str() == id).map(|s| s.rssi_dbm)
    };
    let distance: f64 = (Vector3::new(30.0, 0.0, 1.3) - Vector3::new(10.0, 1.9, 2.5)).norm();
    // 18 dBm − free space at 1 m of 2.44 GHz (40.19 dB) − 22 log₁₀ d.
    let expected = 18.0 - 40.19 - 22.0 * distance.log10();
    assert!((at(30.0, 0.0, "w1").unwrap() - expected).abs() < 0.01);
    // Round the bend: one right angle.
    let corner = Vector3::new(98.0, 2.0, 1.5);
    let here = Vector3::new(70.0, 0.0, 1.3);
    let way: f64 = (Vector3::new(101.9, 50.0, 2.5) - corner).norm() + (here - corner).norm();
    let mean = 18.0 - 40.19 - 22.0 * 30.0_f64.log10() - 17.0 * (way / 30.0).log10();
    let loss = mean - at(70.0, 0.0, "w2").unwrap();
    // Behind the corner fading has no constant part: one draw of Rayleigh fading around the bend's 15 + 6 dB.
    assert!((loss - 21.0).abs() < 15.0, "{loss}");
}

#[test]
fn the_same_place_has_the_same_shadow_for_everybody_and_at_any_time() {
    let mine = Mine::new(plan()).unwrap();
    let mut spec = calm();
    spec.wifi = RssiSpec { shadowing_sigma_db: 6.0, ..spec.wifi };
    let world = RadioWorld::new(mine.clone(), &spec, &[], 1).unwrap();
    let heard = |person: u64, time_s: f64, x: f64| {
        let mut out = Vec::new();
        world.tag(person).scan(&world, time_s, &free(x, 0.0), &Surroundings::default(), &mut out);
        out.iter().find(|s| s.transmitter.as_str() == "w1").unwrap().rssi_dbm
    };
    assert!((heard(1, 0.0, 33.0) - heard(9, 7200.0, 33.0)).abs() < 1e-3);
    assert!((heard(1, 0.0, 33.0) - heard(1, 0.0, 33.1)).abs() < 2.0);
    let other = RadioWorld::new(mine.clone(), &spec, &[], 2).unwrap();
    let mut out = Vec::new();
    other.tag(1).scan(&other, 0.0, &free(33.0, 0.0), &Surroundings::default(), &mut out);
    assert!((out[0].rssi_dbm - heard(1, 0.0, 33.0)).abs() > 0.01);
}

#[test]
fn ranges_are_the_same_whatever_is_told_beside_them_and_whoever_else_is_simulated() {
    let mine = Mine::new(plan()).unwrap();
    let world = RadioWorld::new(mine.clone(), &RadioSpec::default(), &[], 7).unwrap();
    let walk = |person: u64, detail: RangeDetail| {
        let mut tag = world.tag(person).with_detail(detail);
        let mut out = Vec::new();
        for step in 0..300 {
            let time_s = f64::from(step) * 0.1;
            tag.ranges(
                &world,
                time_s,
                &free(30.0 + 0.1 * f64::from(step), 0.3),
                &Surroundings::default(),
                &mut out,
            );
        }
        out
    };
    let bare = walk(3, RangeDetail::Range);
    let full = walk(3, RangeDetail::ImpulseResponse);
    assert!(bare.len() > 250, "{}", bare.len());
    assert_eq!(bare.len(), full.len());
    for (bare, full) in bare.iter().zip(&full) {
        assert_eq!(bare.sample.range_m.to_bits(), full.sample.range_m.to_bits());
        assert_eq!(bare.truth, full.truth);
        assert!(bare.sample.reception.is_none());
        let reception = full.sample.reception.as_ref().unwrap();
        assert_eq!(reception.impulse_response.as_ref().unwrap().taps.len(), 200);
    }
    let _ = walk(4, RangeDetail::Diagnostics);
    assert_eq!(full, walk(3, RangeDetail::ImpulseResponse));
    assert_ne!(bare, walk(4, RangeDetail::Range));
}

#[test]
fn an_outage_is_exact_and_takes_only_what_it_names() {
    let mine = Mine::new(plan()).unwrap();
    let outages = [
        Outage { from_s: 10.0, until_s: Some(20.0), dead: Dead::Device("a1".into()) },
        Outage { from_s: 30.0, until_s: None, dead: Dead::Everything },
    ];
    let world = RadioWorld::new(mine.clone(), &calm(), &outages, 1).unwrap();
    let mut tag = world.tag(1);
    let mut heard = |time_s: f64| {
        let mut out = Vec::new();
        tag.ranges(&world, time_s, &free(60.0, 0.0), &Surroundings::default(), &mut out);
        let mut names: Vec<String> = out.iter().map(|o| o.sample.anchor.to_string()).collect();
        names.sort();
        names
    };
    assert_eq!(heard(9.999), ["a1", "a3"]);
    assert_eq!(heard(10.0), ["a3"]);
    assert_eq!(heard(19.999), ["a3"]);
    assert_eq!(heard(20.0), ["a1", "a3"]);
    assert!(heard(30.0).is_empty());
    assert!(heard(1e6).is_empty());
    let level = [Outage { from_s: 0.0, until_s: None, dead: Dead::Level("l".into()) }];
    let dark = RadioWorld::new(mine.clone(), &calm(), &level, 1).unwrap();
    assert!(ranges(&dark, &free(60.0, 0.0), &[]).is_empty());
}

#[test]
fn nonsense_is_refused_by_name() {
    let mine = Mine::new(plan()).unwrap();
    let refused = |spec: &RadioSpec, outages: &[Outage]| {
        RadioWorld::new(mine.clone(), spec, outages, 1).map(|_| ()).unwrap_err().to_string()
    };
    let mut spec = RadioSpec::default();
    spec.uwb.missed = 1.5;
    assert_eq!(refused(&spec, &[]), "missed is 1.5, expected a share from 0 to 1");
    spec = RadioSpec::default();
    spec.wifi.exponent = f64::NAN;
    assert!(refused(&spec, &[]).contains("exponent is NaN"));
    let backwards = Outage { from_s: 5.0, until_s: Some(5.0), dead: Dead::Everything };
    assert!(refused(&RadioSpec::default(), &[backwards]).contains("until_s is 5"));
    assert!(toml_like(r#"{"uwb": {"misspelt": 1.0}}"#).is_err());
    assert!(toml_like(r#"{"uwb": {"missed": 0.1}, "wifi": {"noise_db": 2.0}}"#).is_ok());
}

fn toml_like(text: &str) -> Result<RadioSpec, serde_json::Error> {
    serde_json::from_str(text)
}

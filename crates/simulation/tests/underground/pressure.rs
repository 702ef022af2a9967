//! Air of a mine and barometers in it.

use crate::common::two_level;
use adit_core::frames::Position;
use adit_core::nalgebra::Vector3;
use adit_mine::Mine;
use adit_mine::plan::{Door, DoorKind, Grid, Level, MinePlan, Roadway, RoadwayKind};
use adit_simulation::people::{Belt, Body, Errand, Pace, PersonSpec, Place, Population, PopulationSpec};
use adit_simulation::pressure::{AirColumn, AirSpec, Barometer, BarometerModel, MineAir};

/// A rectangle of 100 m × 60 m; a door that holds 200 Pa in the middle of its south side, and 150 Pa behind it to the west.
fn ring(ends_m: [[f64; 2]; 2]) -> Mine {
    let roadway = |id: &str, from: [f64; 2], to: [f64; 2]| Roadway {
        id: id.into(),
        name: None,
        level: Some("l".into()),
        kind: RoadwayKind::Drift,
        width_m: 4.0,
        height_m: 3.0,
        max_slope_percent: None,
        walkable: true,
        points_m: vec![Position::new(from[0], from[1], 0.0), Position::new(to[0], to[1], 0.0)],
    };
    let mut plan = MinePlan::new("ring", Grid::Local {});
    plan.levels.push(Level { id: "l".into(), name: None, elevation_m: 0.0 });
    plan.roadways = vec![
        roadway("south", [0.0, 0.0], [100.0, 0.0]),
        roadway("east", [100.0, 0.0], [100.0, 60.0]),
        roadway("north", [100.0, 60.0], [0.0, 60.0]),
        roadway("west", [0.0, 60.0], [0.0, 0.0]),
    ];
    plan.doors.push(Door {
        id: "d".into(),
        kind: DoorKind::Ventilation,
        level: "l".into(),
        closed: true,
        pressure_step_pa: Some(200.0),
        attenuation_db: None,
        ends_m,
    });
    Mine::new(plan).unwrap()
}

/// Behind (left of first to second end) is west.
const WEST: [[f64; 2]; 2] = [[50.0, -2.0], [50.0, 2.0]];
const EAST: [[f64; 2]; 2] = [[50.0, 2.0], [50.0, -2.0]];

#[test]
fn the_column_is_the_standard_atmosphere_above_and_below_the_sea() {
    // ISO 2533:1975, table 1 (geopotential heights): 1000 m, 89 874.6 Pa; −1000 m, 113 929 Pa.
    let column = AirColumn::default();
    assert!((column.pressure_pa(1000.0) - 89_874.6).abs() < 0.5, "{}", column.pressure_pa(1000.0));
    assert!((column.pressure_pa(-1000.0) - 113_929.0).abs() < 1.0, "{}", column.pressure_pa(-1000.0));
    // dp/dz = −ρ g = −p g / (R T), for any lapse rate.
    for lapse_k_m in [0.0, 1e-9, 0.0065, -0.01] {
        let column = AirColumn { lapse_k_m, ..column };
        let slope = (column.pressure_pa(-499.0) - column.pressure_pa(-501.0)) / 2.0;
        let expected = -column.pressure_pa(-500.0) * 9.80665 / (287.052_87 * column.temperature_k(-500.0));
        assert!((slope / expected - 1.0).abs() < 1e-8, "{lapse_k_m}");
    }
}

#[test]
fn a_door_holds_its_step_and_the_way_round_loses_it() {
    for (ends, sign) in [(WEST, 1.0), (EAST, -1.0)] {
        let air = MineAir::new(&ring(ends), &AirSpec::default(), 1).unwrap();
        let at = |x: f64, y: f64| air.ventilation().pressure_pa(&Vector3::new(x, y, 1.0));
        // West of the door less east of it.
        assert!((at(45.0, 0.0) - at(55.0, 0.0) - sign * 200.0).abs() < 0.1);
        // No air moves in the roadway with the door; the 220 m round it lose evenly.
        assert!((at(2.5, 0.0) - at(45.0, 0.0)).abs() < 0.1);
        let lost = at(0.0, 30.0) - at(100.0, 30.0);
        assert!((lost - sign * 200.0 * 160.0 / 220.0).abs() < 0.2, "{lost}");
        // Half-way through the door the step is half done.
        let middle = at(50.0, 0.0) - 0.5 * (at(45.0, 0.0) + at(55.0, 0.0));
        assert!(middle.abs() < 0.1);
    }
}

#[test]
fn a_mine_without_doors_has_still_air() {
    let air = MineAir::new(&crate::common::crawlway(), &AirSpec::default(), 1).unwrap();
    assert_eq!(air.ventilation().pressure_pa(&Vector3::new(30.0, 0.0, -299.0)), 0.0);
}

#[test]
fn doors_of_the_shipped_mine_step_by_what_its_file_says() {
    let mine = two_level();
    let air = MineAir::new(&mine, &AirSpec::default(), 1).unwrap();
    for door in &mine.plan().doors {
        let [a, b] = door.ends_m;
        let (low, _) = mine.band_m(&door.level).unwrap();
        let z = mine.plan().levels.iter().find(|level| level.id == door.level).unwrap().elevation_m;
        assert!(z > low);
        let (x, y) = (0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]));
        // Ends run east: behind is north.
        let side = |dy: f64| air.ventilation().pressure_pa(&Vector3::new(x, y + dy, z + 1.0));
        assert!((side(3.0) - side(-3.0) - 180.0).abs() < 1.0, "{}: {}", door.id, side(3.0) - side(-3.0));
    }
}

fn through_the_door() -> PersonSpec {
    let place = |along_m| Place::Roadway { id: "south".into(), along_m, left_m: 0.0 };
    PersonSpec {
        body: Body::default(),
        drawn: false,
        start: place(20.0),
        errands: vec![
            Errand::Stand { seconds: 20.0 },
            Errand::Go { to: place(80.0), pace: Pace::Walk, speed_m_s: None },
            Errand::Stand { seconds: 30.0 },
        ],
    }
}

#[test]
fn somebody_who_passes_a_door_feels_the_step_and_others_a_pulse() {
    let mine = ring(WEST);
    let spec = PopulationSpec { persons: vec![through_the_door()], ..PopulationSpec::default() };
    let person = Population::new(&mine, &spec, 1).unwrap().person(0).unwrap().unwrap();
    let mut air = MineAir::new(&mine, &AirSpec::default(), 1).unwrap();
    let passages = air.passages_of(&person);
    assert_eq!(passages.len(), 1);
    let passed_s = passages[0].time_s;
    assert!((person.floor_m(passed_s).x - 50.0).abs() < 0.05);
    air.open_doors(passages);

    let readings: Vec<_> =
        Barometer::new(person.waist(Belt::back()), &air, &BarometerModel::ideal(), 1).unwrap().collect();
    let mean = |from: f64, to: f64| {
        let inside = readings.iter().filter(|(sample, _)| (from..to).contains(&sample.time.seconds()));
        let all: Vec<f64> = inside.map(|(_, truth)| truth.ventilation_pa).collect();
        all.iter().sum::<f64>() / all.len() as f64
    };
    // West is behind the door: 200 Pa more; the standing walker bobs by nothing that counts.
    assert!((mean(5.0, 15.0) - mean(passed_s + 20.0, passed_s + 30.0) - 200.0).abs() < 0.5);
    // Who stands 10 m before the door: 60 % of half the step, less what 10 m of 60 m take away.
    let beside = Vector3::new(40.0, 0.0, 1.0);
    let pulse = air.pressure_pa(&beside, passed_s) - air.pressure_pa(&beside, passed_s - 30.0);
    assert!((pulse + 0.6 * 100.0 * (-10.05_f64 / 60.0).exp()).abs() < 1.0, "{pulse}");
    assert_eq!(air.pressure_pa(&beside, passed_s + 30.0), air.pressure_pa(&beside, passed_s - 30.0));
}

#[test]
fn readings_have_the_noise_offset_and_steps_of_their_model() {
    let mine = ring(WEST);
    let stand = PersonSpec { errands: vec![Errand::Stand { seconds: 3600.0 }], ..through_the_door() };
    let spec = PopulationSpec { persons: vec![stand], ..PopulationSpec::default() };
    let person = Population::new(&mine, &spec, 1).unwrap().person(0).unwrap().unwrap();
    let air = MineAir::new(&mine, &AirSpec::default(), 1).unwrap();
    let model = BarometerModel { response_s: 0.0, ..BarometerModel::bmp280() };
    let mut offsets = Vec::new();
    for seed in 0..40 {
        let readings: Vec<_> =
            Barometer::new(person.waist(Belt::back()), &air, &model, seed).unwrap().take(2000).collect();
        let noise: Vec<f64> =
            readings.iter().map(|(s, t)| s.pressure_pa - t.pressure_pa - t.bias_pa).collect();
        let rms = (noise.iter().map(|n| n * n).sum::<f64>() / noise.len() as f64).sqrt();
        // 1.3 Pa and the rounding to 0.16 Pa; five standard errors of 2000 draws.
        let expected = (1.3_f64 * 1.3 + 0.16 * 0.16 / 12.0).sqrt();
        assert!((rms / expected - 1.0).abs() < 5.0 / 4000.0_f64.sqrt(), "{rms}");
        assert!(
            readings
                .iter()
                .all(|(s, _)| (s.pressure_pa / 0.16 - (s.pressure_pa / 0.16).round()).abs() < 1e-6)
        );
        offsets.push(readings[0].1.bias_pa);
    }
    let rms = (offsets.iter().map(|n| n * n).sum::<f64>() / 40.0).sqrt();
    // 50 Pa and 3 Pa, 40 draws: 11 % standard error, thrice.
    assert!((rms / 50.1 - 1.0).abs() < 0.34, "{rms}");
}

#[test]
fn the_weather_is_slow_begins_at_nothing_and_is_fixed_by_the_seed() {
    let mine = ring(WEST);
    let spec = AirSpec { weather_rms_pa: 300.0, ..AirSpec::default() };
    let [a, b, other] = [1, 1, 2].map(|seed| MineAir::new(&mine, &spec, seed).unwrap());
    assert_eq!(a.weather_pa(0.0), 0.0);
    assert_eq!(a.weather_pa(5000.0), b.weather_pa(5000.0));
    assert!((a.weather_pa(5000.0) - other.weather_pa(5000.0)).abs() > 0.1);
    // Steepest when all five agree: 5 · √2 · 300 Pa · 2π / √Σ period².
    let steepest = (0..10_000)
        .map(|i| f64::from(i) * 30.0)
        .map(|t| (a.weather_pa(t + 1.0) - a.weather_pa(t)).abs())
        .fold(0.0, f64::max);
    assert!(steepest < 0.056, "{steepest}");
}

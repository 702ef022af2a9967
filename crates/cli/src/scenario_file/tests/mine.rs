//! Mistakes in scenarios of everybody in a mine: each told with its line and what to do.

use super::{mistake, parse};
use adit_simulation::Emission;

const GOOD: &str = r#"kind = "mine"
seed = 3
sensor = "mpu6050"
rate_hz = 100.0
[mine]
file = "../../mines/two-level.toml"
duration_s = 20.0
truth_hz = 10.0
conveyors_s = [[2.0, 8.0]]
[mine.population]
people = 3
vehicles = [{ route = "ore", speed_m_s = 3.0 }]
[[mine.population.persons]]
start = { zone = { id = "portal" } }
errands = [
    { stand = { seconds = 2.0 } },
    { go = { to = { roadway = { id = "l300-haulage", along_m = 10.0 } }, pace = "run" } }, { roam = { until_s = 25.0, levels = ["l300"], reach_m = 90.0 } },
]
[mine.population.shift]
portal = "portal"
workplaces = 1
[mine.population.body]
walk_m_s = 1.2
[mine.tag]
mount = "belt-left"
barometer = "bmp280"
barometer_hz = 5.0
silent_s = [[3.0, 4.0]]
radio = { scan_hz = 1.0, ranging_hz = 10.0, detail = "range" }
[mine.air]
weather_rms_pa = 100.0
[mine.radio.uwb]
exponent = 1.9
noise_m = 0.05
[mine.radio.wifi]
shadowing_sigma_db = 4.0
[[mine.outages]]
from_s = 5.0
until_s = 7.0
dead = { level = "l300" }
[mine.delivery.clock]
rate_sigma_ppm = 10.0
[mine.delivery.link]
lost_good = 0.01
most_delay_s = 2.0
[magnetic]
sensor = "hmc5883l"
"#;

#[test]
fn every_mistake_in_a_mine_is_told_with_its_line_and_what_to_do() {
    assert!(parse(GOOD).unwrap().generate(1).is_ok());
    let mut wrongly_told = Vec::new();
    for (right, wrong, line, told) in [
        ("kind = \"mine\"", "kind = \"pit\"", 1, "unknown variant `pit`, expected one of `foot-walk`"),
        (
            "kind = \"mine\"",
            "kind = \"foot-walk\"",
            5,
            "`mine` has no use in kind = \"foot-walk\": remove it",
        ),
        (
            "rate_hz = 100.0",
            "rate_hz = 100.0\ngait = \"walk\"",
            5,
            "`gait` has no use in kind = \"mine\": remove it",
        ),
        ("\"mpu6050\"", "\"mpu\"", 3, "unknown sensor \"mpu\", expected ideal, adis16448"),
        ("two-level.toml", "two-levels.toml", 6, "the mine of this scenario cannot be used: "),
        ("duration_s = 20.0", "duration_s = -20.0", 7, "duration_s is -20, expected 0.1 to 1e6 s"),
        ("duration_s = 20.0\n", "", 5, "missing field `duration_s`"),
        ("duration_s = 20.0", "duration_min = 20.0", 7, "unknown field `duration_min`, expected one of"),
        ("truth_hz = 10.0", "truth_hz = 500.0", 8, "truth_hz is 500, expected above 0, at most rate_hz"),
        (
            "[[2.0, 8.0]]",
            "[[8.0, 2.0]]",
            9,
            "conveyors_s is 2, expected an end no earlier than the beginning",
        ),
        ("people = 3", "people = -3", 11, "invalid value: integer `-3`, expected u32"),
        ("route = \"ore\"", "route = \"coal\"", 12, "route is \"coal\", expected the id of a vehicle route"),
        ("speed_m_s = 3.0", "speed_m_s = 300.0", 12, "speed_m_s is 300, expected 0.1 to 30 m/s"),
        ("zone = { id = \"portal\" }", "zone = { id = \"gate\" }", 14, "start is \"gate\", expected"),
        ("seconds = 2.0", "minutes = 2.0", 16, "unexpected keys in table: minutes, available keys: seconds"),
        ("id = \"l300-haulage\"", "id = \"l300\"", 17, "to is \"l300\", expected"),
        ("along_m = 10.0", "along_m = 1e5", 17, "along_m is 100000, expected"),
        (
            "pace = \"run\"",
            "pace = \"hop\"",
            17,
            "unknown variant `hop`, expected one of `walk`, `run`, `crawl`",
        ),
        ("portal = \"portal\"", "portal = \"exit\"", 20, "portal is \"exit\", expected"),
        ("workplaces = 1", "workplaces = 0", 21, "workplaces is 0, expected 1 to 1000"),
        ("walk_m_s = 1.2", "walk_m_s = 12.0", 23, "walk_m_s is 12, expected 0.3 to 3.2 m/s"),
        ("\"belt-left\"", "\"pocket\"", 25, "unknown variant `pocket`, expected one of `belt-front`"),
        ("\"bmp280\"", "\"bmp\"", 26, "unknown barometer \"bmp\", expected ideal, bmp280, bmp388"),
        ("barometer_hz = 5.0", "barometer_hz = 0.0", 27, "rate_hz is 0, expected 0.001 to 1000 Hz"),
        ("[[3.0, 4.0]]", "[[3.0, 2.0]]", 28, "silent_s is 2, expected an end no earlier than the beginning"),
        (
            "ranging_hz = 10.0",
            "ranging_hz = -1.0",
            29,
            "ranging_hz is -1, expected 0 to 1000 Hz, 0 for never",
        ),
        ("detail = \"range\"", "detail = \"all\"", 29, "unknown variant `all`, expected one of `range`"),
        ("weather_rms_pa = 100.0", "weather_rms_pa = -1.0", 31, "weather_rms_pa is -1, expected"),
        ("exponent = 1.9", "exponent = 19.0", 33, "exponent is 19, expected 0.1 to 10"),
        ("noise_m = 0.05", "noise = 0.05", 34, "unknown field `noise`, expected one of"),
        (
            "shadowing_sigma_db = 4.0",
            "shadowing_sigma_db = nan",
            36,
            "shadowing_sigma_db is NaN, expected 0 to 100 dB",
        ),
        ("until_s = 7.0", "until_s = 3.0", 39, "until_s is 3, expected later than from_s"),
        (
            "level = \"l300\"",
            "level = \"l999\"",
            40,
            "dead is \"l999\", expected the id of a level of the mine",
        ),
        (
            "level = \"l300\"",
            "device = \"a-0\"",
            40,
            "dead is \"a-0\", expected the id of a device of the mine",
        ),
        ("level = \"l300\"", "share = 10.0", 40, "share is 10, expected a share from 0 to 1"),
        (
            "rate_sigma_ppm = 10.0",
            "rate_sigma_ppm = 1e9",
            42,
            "rate_sigma_ppm is 1000000000, expected 0 to 10000 ppm",
        ),
        ("lost_good = 0.01", "lost_good = 1.01", 44, "lost_good is 1.01, expected a share from 0 to 1"),
        ("most_delay_s = 2.0", "most_delay_s = -2.0", 45, "most_delay_s is -2, expected"),
        (
            "sensor = \"hmc5883l\"",
            "sensor = \"ideal\"\n[[magnetic.steel]]\nat_m = [1.0, 2.0, 3.0]\nmoment_a_m2 = [1.0, 0.0, 0.0]\npeak_at_sensor_ut = 3.0",
            48,
            "peak_at_sensor_ut is that of one sensor, here are many: give peak",
        ),
    ] {
        let error = mistake(GOOD, right, wrong);
        if !error.starts_with(&format!("walk.toml:{line}: {told}")) {
            wrongly_told.push(format!("{wrong}: {error}"));
        }
    }
    assert!(wrongly_told.is_empty(), "{wrongly_told:#?}");
}

#[test]
fn every_mistake_in_a_walk_to_drawn_places_is_told_too() {
    for (right, wrong, line, told) in [
        ("until_s = 25.0", "until = 25.0", 17, "unknown field `until`, expected one of `until_s`"),
        ("[\"l300\"]", "[\"l400\"]", 17, "levels is \"l400\", expected the id of a level"),
        ("[\"l300\"]", "[\"surface\"]", 17, "levels is \"surface\", expected levels with places that can"),
        ("reach_m = 90.0", "reach_m = 0.9", 17, "reach_m is 0.9, expected 1 m or more"),
        ("reach_m = 90.0", "stop_share = 9.0", 17, "stop_share is 9, expected 0 to 1"),
    ] {
        let error = mistake(GOOD, right, wrong);
        assert!(error.starts_with(&format!("walk.toml:{line}: {told}")), "{wrong}: {error}");
    }
}

#[test]
fn a_mistake_in_the_mine_of_a_scenario_is_told_with_the_line_of_the_mine() {
    let folder = tempfile::tempdir().unwrap();
    let broken = std::fs::read_to_string("../../mines/haulage.toml")
        .unwrap()
        .replace("width_m = 4.8", "width_cm = 480.0");
    let line = 1 + broken[..broken.find("width_cm").unwrap()].matches('\n').count();
    let path = folder.path().join("broken.toml");
    std::fs::write(&path, broken).unwrap();
    let error = mistake(GOOD, "../../mines/two-level.toml", &path.display().to_string());
    let told = format!("walk.toml:6: the mine of this scenario cannot be used: {}:{line}: ", path.display());
    assert!(error.starts_with(&told), "{error}");
    assert!(error.contains("rename it to `width_m`"), "{error}");
}

#[test]
fn nobody_is_no_workforce() {
    let alone = GOOD.replace("people = 3", "people = 0");
    let persons = alone.find("[[mine.population.persons]]").unwrap();
    let shift = alone.find("[mine.population.shift]").unwrap();
    let nobody = format!("{}{}", &alone[..persons], &alone[shift..]);
    let error = format!("{:#}", parse(&nobody).unwrap().generate(1).err().unwrap());
    assert!(error.starts_with("walk.toml:5: nobody is in the mine: give `people` or `persons`"), "{error}");
}

#[test]
fn a_log_holds_every_sensor_that_the_scenario_names() {
    let mut kinds = [0_u32; 5];
    for emission in parse(GOOD).unwrap().generate(1).unwrap().emissions {
        match emission {
            Emission::Imu(..) => kinds[0] += 1,
            Emission::Magnetic(..) => kinds[1] += 1,
            Emission::Pressure(..) => kinds[2] += 1,
            Emission::Signal(_) => kinds[3] += 1,
            Emission::Range(..) => kinds[4] += 1,
            Emission::Fix(..) | Emission::Sighting(_) => {}
        }
    }
    assert_eq!(kinds[0], 2000, "20 s at 100 Hz");
    assert_eq!(kinds[2], 95, "20 s at 5 Hz, one of them silent");
    assert!(kinds[1] > 1400 && kinds[3] > 5 && kinds[4] > 50, "{kinds:?}");
}

#[test]
fn who_is_left_with_the_imu_alone_has_nothing_else_and_all_else_stays_the_same() {
    let right_clock = "offset_sigma_s = 0.0\nrate_sigma_ppm = 0.0\nrate_walk_ppm = 0.0";
    let good = GOOD.replace("rate_sigma_ppm = 10.0", right_clock);
    let log = |text: &str| -> Vec<Emission> {
        let everybody = parse(text).unwrap().everybody(1).unwrap();
        everybody.person(0).unwrap().emissions.collect()
    };
    let (all, some) =
        (log(&good.replace("[[3.0, 4.0]]", "[]")), log(&good.replace("[[3.0, 4.0]]", "[[5.5, 7.25]]")));
    let own = |e: &&Emission| matches!(e, Emission::Magnetic(..) | Emission::Pressure(..));
    let hushed = |e: &&Emission| own(e) && (5.5..7.25).contains(&e.observation().time().seconds());
    // 75 Hz and 5 Hz for 1.75 s.
    let left_out = all.iter().filter(hushed).count();
    assert!((131 + 8..=132 + 9).contains(&left_out), "{left_out}");
    assert!(all.iter().filter(|e| !hushed(e)).eq(some.iter()));
}

//! Scenario files, good and bad.
#![expect(clippy::unwrap_used, reason = "tests")]

use super::*;

fn parse(text: &str) -> Result<Scenario> {
    Scenario::parse(Path::new("walk.toml"), text)
}

const SHORT: &str = "kind = \"foot-walk\"\nsensor = \"ideal\"\ngait = \"walk\"\nheading_deg = 0.0\n";

fn emissions(text: &str) -> Vec<Emission> {
    parse(text).unwrap().generate(1).unwrap().emissions.collect()
}

#[test]
fn the_scenario_that_ships_is_the_demo_walk() {
    let ours = Scenario::demo().unwrap().foot_walk().unwrap();
    let theirs = FootWalkScenario::demo_walk();
    assert_eq!(ours.plan.gait, theirs.plan.gait);
    assert_eq!(format!("{:.9?}", ours.plan.legs), format!("{:.9?}", theirs.plan.legs));
    assert!((ours.plan.heading_rad - theirs.plan.heading_rad).abs() < 1e-12);
    assert_eq!((ours.foot, ours.imu, ours.rate_hz), (theirs.foot, theirs.imu, theirs.rate_hz));
}

#[test]
fn a_file_may_bring_its_own_gaits_and_sensors() {
    let text = format!(
        "{SHORT}legs = [{{ stand = {{ seconds = 1.0 }} }}]\n[sensors.ideal]\nstamp_jitter_s = 0.001\n"
    );
    let samples = emissions(&text);
    assert_eq!(samples.len(), 200);
    let late = |emission: &Emission| match emission {
        Emission::Imu(sample, truth) => (sample.time - truth.time).nanos(),
        Emission::Magnetic(..) => 0,
    };
    assert!(
        samples.iter().any(|emission| late(emission) != 0),
        "the jitter of the file, not the preset's none"
    );
}

/// The error of a scenario that cannot be simulated.
fn refusal(text: &str) -> String {
    match parse(text).and_then(|scenario| scenario.generate(1)) {
        Ok(_) => format!("taken: {text}"),
        Err(error) => error.to_string(),
    }
}

const TUMBLE: &str = "kind = \"tumble\"\nsensor = \"ideal\"\n[tumble]\nrest_s = 1.0\nmoving_s = 10.0\n";

#[test]
fn a_walk_that_cannot_be_is_told_with_its_line() {
    let legs = "legs = [{ straight = { length_m = 5.0 } }]\n";
    for (text, expected) in [
        (format!("{SHORT}legs = []\n"), "5: this lasts 0 s, less than one sample: add to `legs`"),
        (SHORT.to_owned(), "1: kind = \"foot-walk\" needs `legs`: add it"),
        (
            format!(
                "{SHORT}legs = [\n{{ stand = {{ seconds = 1.0 }} }},\n{{ stand = {{ seconds = -1.0 }} }}]\n"
            ),
            "7: seconds is -1, expected 0 to 1e6 s",
        ),
        (
            format!("{SHORT}legs = [{{ turn = {{ turn_deg = 1e6 }} }}]\n"),
            "5: turn_deg is 1000000 (17453.293 rad), expected -100 to 100 rad",
        ),
        (
            format!("{SHORT}legs = [{{ gait = \"hop\" }}]\n"),
            "5: unknown gait \"hop\", expected walk, slow, run, stairs",
        ),
        (format!("{SHORT}{legs}rate_hz = 1.0\n"), "6: rate_hz is 1, expected 10 to 10000 Hz"),
        (format!("{SHORT}{legs}latitude_deg = 91.0\n"), "6: latitude_deg is 91, expected -90 to 90 degrees"),
        (
            format!("{SHORT}{legs}[sensors.mine]\n# range = 1\n[sensors.mine.gyro]\nrange = -3.0\n"),
            "6: range is -3, expected a number above 0",
        ),
        (
            format!("{SHORT}{legs}[tumble]\nrest_s = 1.0\nmoving_s = 1.0\n"),
            "6: `tumble` has no use in kind = \"foot-walk\": remove it",
        ),
    ] {
        assert_eq!(refusal(&text), format!("walk.toml:{expected}"));
    }
}

#[test]
fn a_tumble_that_cannot_be_is_told_with_its_line() {
    for (text, expected) in [
        (TUMBLE.replace("10.0", "0.0"), "5: moving_s is 0, expected 0.1 to 1e6 s"),
        (format!("{TUMBLE}ramp_s = 6.0\n"), "6: ramp_s is 6, expected 0.001 s to half of moving_s"),
        (
            format!("{TUMBLE}roll = {{ rate_deg_s = 1e6 }}\n"),
            "6: roll is 17453.292519943294, expected -100 to 100 rad and rad/s (5730 degrees)",
        ),
        (
            format!(
                "kind = \"tumble\"\nheading_deg = 3.0\n{}",
                TUMBLE.trim_start_matches("kind = \"tumble\"\n")
            ),
            "2: `heading_deg` has no use in kind = \"tumble\": remove it",
        ),
        ("kind = \"tumble\"\nsensor = \"ideal\"\n".to_owned(), "1: kind = \"tumble\" needs `tumble`: add it"),
    ] {
        assert_eq!(refusal(&text), format!("walk.toml:{expected}"));
    }
    let unknown = refusal(&format!("{TUMBLE}yaw = {{ rate = 1.0 }}\n"));
    assert!(
        unknown.starts_with("walk.toml:6: unknown field `rate`, expected one of `start_deg`"),
        "{unknown}"
    );
}

#[test]
fn a_magnetometer_that_cannot_be_is_told_with_its_line() {
    for (table, expected) in [
        (
            "sensor = \"compass\"",
            "7: unknown magnetometer \"compass\", expected ideal, xsens-mti-g, hmc5883l, adis16448",
        ),
        ("sensor = \"ideal\"\nrate_hz = 0.0", "8: rate_hz is 0, expected 0.1 to 10000 Hz"),
        (
            "sensor = \"ideal\"\nhard_iron_ut = [0.0, nan, 0.0]",
            "8: hard_iron_ut is NaN, expected -1e6 to 1e6 µT",
        ),
        (
            "sensor = \"ideal\"\nsoft_iron = [\n[1.0, 0.0, 0.0],\n[0.0, 1.0, 0.0],\n[0.0, 1.0, 0.0]]",
            "8: soft_iron is 0, expected a determinant of 0.001 to 1000",
        ),
        (
            "sensor = \"own\"\n[magnetometers.own]\nintegration_s = 0.01\nlatency_s = -1.0",
            "10: latency_s is -1, expected 0 to 10 s",
        ),
        (
            "sensor = \"ideal\"\nfield = { norm_ut = 55.3, dip_deg = 634.0, declination_deg = 0.0 }",
            "8: dip_deg is 634 (11.065 rad), expected -90 to 90 degrees",
        ),
    ] {
        assert_eq!(refusal(&format!("{TUMBLE}[magnetic]\n{table}\n")), format!("walk.toml:{expected}"));
    }
}

#[test]
fn steel_and_cables_that_cannot_be_are_told_with_their_line() {
    for (table, expected) in [
        (
            "at_m = [1.0, 0.0, 0.0]",
            "8: steel needs a moment: moment_a_m2 = [forward, left, up], or induced_m3",
        ),
        (
            "induced_m3 = 1.0",
            "8: steel needs a place: at_m = [east, north, up], or beside = { offset_m, from_s, until_s }",
        ),
        (
            "beside = { offset_m = [0.0, 1.0, 0.0], from_s = 0.0, until_s = 5.0 }\ninduced_m3 = 1.0",
            "8: nobody walks here: give at_m = [east, north, up] in place of beside",
        ),
        (
            "at_m = [1.0, 0.0, 0.0]\ninduced_m3 = 1.0\nstart_s = 4.0",
            "8: start_s is the start of a course: add course, or remove start_s",
        ),
        (
            "at_m = [1.0, 0.0, 0.0]\ninduced_m3 = 1.0\npeak_at_sensor_ut = 1.0\npeak = { ut = 1.0, distance_m = 1.0 }",
            "8: steel has one strength: remove peak or peak_at_sensor_ut",
        ),
        (
            "at_m = [1.0, 0.0, 0.0]\ninduced_m3 = 1.0\npeak = { ut = -1.0, distance_m = 1.0 }",
            "11: ut is -1, expected 0 to 1e6 µT",
        ),
        (
            "at_m = [1.0, 0.0, 0.0]\nmoment_a_m2 = [0.0, 0.0, 0.0]\npeak_at_sensor_ut = 30.0",
            "10: moment_a_m2 is 0, expected a direction to make stronger: moment_a_m2 or induced_m3 above 0",
        ),
        (
            "at_m = [1.0, 0.0, 0.0]\ninduced_m3 = 1.0\ncourse = [\n  { stop = { seconds = 1.0 } },\n  { go = { to_m = [1.0, 0.0, 0.0], speed_m_s = 0.0 } },\n]",
            "13: speed_m_s is 0, expected 0.01 to 100 m/s",
        ),
        (
            "at_m = [1.0, 0.0, 0.0]\ninduced_m3 = 1.0\nradius_m = 0.0",
            "11: radius_m is 0, expected 0.001 to 100 m",
        ),
    ] {
        let text = format!("{TUMBLE}[magnetic]\nsensor = \"ideal\"\n[[magnetic.steel]]\n{table}\n");
        assert_eq!(refusal(&text), format!("walk.toml:{expected}"));
    }
    let cable =
        "[[magnetic.cables]]\nthrough_m = [0.0, 0.0, 2.0]\nalong = [0.0, 0.0, 0.0]\ncurrent_a = 200.0\n";
    let refused = refusal(&format!("{TUMBLE}[magnetic]\nsensor = \"ideal\"\n{cable}"));
    assert_eq!(refused, "walk.toml:10: along is 0, expected a direction of length 1e-6 to 1e6");
}

/// A shipped file.
fn shipped(name: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    std::fs::read_to_string(folder.join(name)).unwrap()
}

#[test]
fn steel_is_all_that_its_scenarios_add_to_the_walk_of_s3() {
    // 20 seeds of 900 s are too long for a test: the entries say it, all but the steel.
    let plain = parse(&shipped("s3.toml")).unwrap().foot_walk().unwrap();
    for name in ["s3-steel.toml", "s3-steel-stop.toml", "s3-steel-beside.toml"] {
        let text = shipped(name);
        let steel = parse(&text).unwrap();
        assert_eq!(steel.foot_walk().unwrap(), plain, "{name}");
        let without = parse(&text[..text.find("[[magnetic.steel]]").unwrap()]).unwrap();
        let pair = [&without, &parse(&shipped("s3.toml")).unwrap()].map(|scenario| {
            scenario.generate(3).unwrap().emissions.take(20_000).map(|e| e.observation()).collect::<Vec<_>>()
        });
        assert_eq!(pair[0], pair[1], "{name}");
    }
}

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

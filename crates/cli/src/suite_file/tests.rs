#![expect(clippy::unwrap_used, clippy::panic, reason = "tests")]
use super::*;

const SUITE: &str = r#"kind = "suite"
title = "Two"
data = "sets"
runs = [{ name = "first", method = "foot-ins" }]

[[parts]]
name = "simulated"
about = "A walk."
scenario = "walk.toml"
keep = ["marg-ins"]
figure = "rmse-2d"
settings = { first = { window = 3 } }

[[parts]]
name = "recorded"
about = "Walks."
align = "se3"
figure = "end-3d"
runs = [{ method = "marg-ins", only = ["imu", "magnetic"] }, { name = "again", method = "marg-ins" }]
table = ["again"]

[parts.set]
folder = "walks"
logs = ["imu", "ranges"]
within = "ranges"
names = ["lab_*"]
"#;

const WALK: &str = r#"kind = "foot-walk"
sensor = "ideal"
gait = "walk"
heading_deg = 0.0
legs = [{ stand = { seconds = 1.0 } }]
[compare]
align = "start"
runs = [{ method = "foot-ins" }, { method = "marg-ins" }]
"#;

fn read(text: &str) -> Result<Suite> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("walk.toml"), WALK).unwrap();
    let file = folder.path().join("all.toml");
    std::fs::write(&file, text).unwrap();
    assert!(Suite::is_one(&file) || text.is_empty());
    assert!(!Suite::is_one(&folder.path().join("walk.toml")));
    Suite::read(&file)
}

#[test]
fn parts_say_what_is_run_and_how_it_is_judged() {
    let suite = read(SUITE).unwrap();
    let [simulated, recorded] = &suite.parts[..] else { panic!("two parts") };
    let names = |part: &Part| part.contest.contenders.iter().map(|c| c.name.clone()).collect::<Vec<_>>();
    assert_eq!(names(simulated), ["first", "marg-ins"]);
    assert_eq!(simulated.contest.contenders[0].config["window"].as_integer(), Some(3));
    assert_eq!(simulated.contest.align, Some(Alignment::Start));
    assert!(matches!(simulated.source, PartSource::Simulated(_, _, SEEDS)));
    assert_eq!(names(recorded), ["first", "marg-ins", "again"]);
    assert_eq!(recorded.table(), [("marg-ins".to_owned(), "again".to_owned())]);
    assert_eq!(simulated.table().len(), 2);
    assert_eq!(recorded.contest.align, Some(Alignment::Se3));
    let PartSource::Recorded(set) = &recorded.source else { panic!("a set") };
    assert_eq!((set.within.as_deref(), set.truth.as_deref()), (Some("ranges"), Some("truth")));
}

#[test]
fn mistakes_have_a_line() {
    for (from, to, expected) in [
        (
            "keep = [\"marg-ins\"]",
            "keep = [\"ahrs\"]",
            ":10: no contender is called \"ahrs\", expected foot-ins, marg-ins",
        ),
        ("table = [\"again\"]", "table = [\"once\"]", ":20: no contender is called \"once\""),
        ("first = { window", "last = { window", ":12: no contender is called \"last\""),
        ("name = \"recorded\"", "name = \"simulated\"", ":15: two parts are called \"simulated\""),
        ("name = \"again\", ", "", ":19: two runs are called \"marg-ins\""),
        (
            "scenario = \"walk.toml\"\n",
            "",
            ":7: part \"simulated\": expected one of `scenario`, `set`, `survey`",
        ),
        ("within = \"ranges\"", "within = \"rssi\"", ":25: within is \"rssi\", expected one of imu, ranges"),
        ("lab_*", "*lab_*", ":26: \"*lab_*\": expected a name with one * at most"),
        ("figure = \"end-3d\"", "figure = \"end-4d\"", ":18: unknown variant `end-4d`"),
        ("folder = \"walks\"", "folder = \"walks\"\nfirst_fix_sigma_m = 0.0", ":24: first_fix_sigma_m is 0"),
        ("folder = \"walks\"", "folder = \"walks\"\nclosed = true\ntruth = \"t\"", ":25: `truth` has no use"),
        ("align = \"se3\"", "keep = [\"a\"]", ":17: `keep` chooses among the contenders of a scenario"),
        ("\"magnetic\"]", "\"magnets\"]", ":19: unknown variant `magnets`"),
        ("about = \"Walks.\"", "abut = \"Walks.\"", ":16: unknown field `abut`"),
        ("walk.toml", "none.toml", "none.toml: cannot read it"),
    ] {
        assert!(SUITE.contains(from), "{from}");
        let error = read(&SUITE.replacen(from, to, 1)).err().unwrap().to_string();
        assert!(error.contains(expected), "{to}: {error}");
    }
}

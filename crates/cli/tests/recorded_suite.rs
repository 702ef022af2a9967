//! The recorded parts of `scenarios/everything.toml`, where the recordings are at hand: each method within what it is known to reach.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;
#[path = "common/recorded.rs"]
#[expect(dead_code, reason = "every test binary uses its own part")]
mod recorded;

use common::{Outcome, adit};
use serde_json::Value;

/// Part, method, and a limit that is a quarter above what was measured (docs/results/README.md).
const LIMITS: [(&str, &str, &str, f64); 7] = [
    ("foot-hallway", "foot-hallway", "foot-ins", 0.20),
    ("foot-loops", "foot-loops", "foot-ins", 0.21),
    ("uwb-imu-walk", "uwb-imu-walk", "uwb-rkf", 0.23),
    ("uwb-imu-rig", "uwb-imu-rig, level", "uwb-rkf", 0.16),
    ("uwb-outdoor", "uwb-outdoor", "uwb-rkf", 0.57),
    ("uwb-person", "uwb-person", "uwb-rkf", 0.15),
    ("ble-tracks", "ble-tracks", "wifi", 1.81),
];

#[test]
fn recorded_parts_are_within_their_limits() {
    let at_hand: Vec<_> = LIMITS.iter().filter(|(set, ..)| recorded::folder(set).is_some()).collect();
    if at_hand.is_empty() {
        return;
    }
    // Of the suite only these parts and these methods.
    let file = format!("{}/../../scenarios/everything.toml", env!("CARGO_MANIFEST_DIR"));
    let mut suite: toml::Table = toml::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
    let wanted = |name: &toml::Value| at_hand.iter().any(|(_, part, ..)| name.as_str() == Some(part));
    suite["parts"].as_array_mut().unwrap().retain(|part| wanted(&part["name"]));
    suite["data"] = recorded::folder(at_hand[0].0).unwrap().parent().unwrap().to_str().unwrap().into();
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("some.toml"), toml::to_string(&suite).unwrap()).unwrap();
    let args = ["compare", "some.toml", "--json", "all.json", "--methods", "foot-ins,uwb-rkf,wifi"];
    let Outcome { code, stderr, .. } = adit(folder.path(), &args);
    assert_eq!(code, 0, "{stderr}");
    let report: Value =
        serde_json::from_str(&std::fs::read_to_string(folder.path().join("all.json")).unwrap()).unwrap();
    let parts = report["parts"].as_array().unwrap();
    for (_, name, method, limit) in at_hand {
        let part = parts.iter().find(|part| part["name"] == *name).unwrap();
        let merit = &part["merit"][part["table"][*method].as_str().unwrap()];
        assert_eq!(merit["runs"], part["seeds"], "{name}");
        assert!(merit["mean"].as_f64().unwrap() < *limit, "{name}: {merit}");
    }
}

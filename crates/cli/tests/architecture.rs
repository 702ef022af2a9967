//! Which crate may use which: the table of the design, held as data.
#![expect(clippy::unwrap_used, reason = "tests")]

use cargo_metadata::{DependencyKind, MetadataCommand, Package};

/// Rooms and what each may use, in the direction in which data flows. Rooms that are not built yet stand here too: the
/// table is the plan.
const EDGES: [(&str, &[&str]); 11] = [
    ("core", &[]),
    ("mine", &["core"]),
    ("observation", &["core"]),
    ("estimation", &["core", "observation", "mine"]),
    ("nlos", &["core", "observation"]),
    ("tuning", &["core", "observation", "estimation"]),
    ("simulation", &["core", "mine", "observation"]),
    ("evaluation", &["core"]),
    ("tracking", &["core", "mine"]),
    (
        "server",
        &[
            "core",
            "mine",
            "observation",
            "estimation",
            "nlos",
            "tuning",
            "simulation",
            "evaluation",
            "tracking",
        ],
    ),
    (
        "cli",
        &[
            "core",
            "mine",
            "observation",
            "estimation",
            "nlos",
            "tuning",
            "simulation",
            "evaluation",
            "tracking",
            "server",
        ],
    ),
];

fn rooms() -> Vec<Package> {
    let manifest = concat!(env!("CARGO_MANIFEST_DIR"), "/../../Cargo.toml");
    MetadataCommand::new().manifest_path(manifest).no_deps().exec().unwrap().packages
}

fn room(package: &str) -> Option<&str> {
    package.strip_prefix("adit-")
}

#[test]
fn rooms_use_only_what_the_design_allows() {
    for package in rooms() {
        let name = room(&package.name).unwrap();
        let planned = EDGES.iter().find(|(room, _)| *room == name);
        assert!(planned.is_some(), "crate {} is not a room of the design", package.name);
        let (_, allowed) = planned.unwrap();
        // Tests may compare with any room (an estimator with simulated truth): what they use is not in the product.
        let shipped = package.dependencies.iter().filter(|d| d.kind != DependencyKind::Development);
        for used in shipped.filter_map(|d| room(&d.name)) {
            assert!(
                allowed.contains(&used),
                "{} uses adit-{used}, the design allows {allowed:?}",
                package.name
            );
        }
    }
}

#[test]
fn only_the_command_line_uses_anyhow() {
    for package in rooms().iter().filter(|p| room(&p.name) != Some("cli")) {
        let used =
            package.dependencies.iter().any(|d| d.name == "anyhow" && d.kind == DependencyKind::Normal);
        assert!(!used, "{} uses anyhow, expected an error enum of its own", package.name);
    }
}

#[test]
fn every_room_takes_the_lints_of_the_workspace() {
    for package in rooms() {
        let manifest = std::fs::read_to_string(&package.manifest_path).unwrap();
        assert!(manifest.contains("[lints]\nworkspace = true"), "{}", package.manifest_path);
    }
}

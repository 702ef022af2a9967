//! Each mistake put into a sound file gives one finding: the right rule, on the right line, with a remedy, and nothing else.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use adit_mine::file::Notice;
use common::checked;
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// A small mine with something of everything, and nothing wrong with it.
const SOUND: &str = include_str!("common/sound.toml");

/// Its grid.
const GRID: &str = r#"[grid]
kind = "control-points"
points = [
    { id = "k1", grid_m = [0.0, 0.0, 10.0], latitude_deg = 50.92, longitude_deg = 13.34, height_m = 53.0 },
    { id = "k2", grid_m = [703.19, 0.05, 11.0], latitude_deg = 50.92, longitude_deg = 13.35, height_m = 54.0 },
    { id = "k3", grid_m = [0.0, 1112.48, 12.0], latitude_deg = 50.93, longitude_deg = 13.34, height_m = 55.0 },
]"#;

/// Puts `to` in the place of `from`, which stands once, and expects `rule` on the line of `marker`.
struct Mistake {
    rule: &'static str,
    from: &'static str,
    to: &'static str,
    marker: &'static str,
    says: &'static str,
}

const fn mistake(
    rule: &'static str,
    from: &'static str,
    to: &'static str,
    marker: &'static str,
    says: &'static str,
) -> Mistake {
    Mistake { rule, from, to, marker, says }
}

const MISTAKES: [Mistake; 72] = [
    // Text and shape.
    mistake("syntax", "snap_m = 0.1", "snap_m = = 0.1", "snap_m =", ""),
    mistake("syntax", "snap_m = 0.1", "snap_m = 0.1\nsnap_m = 0.2", "snap_m = 0.2", "duplicate key"),
    mistake(
        "unknown-key",
        "capacity = 20",
        "capasity = 20\ncapacity = 20",
        "capasity",
        "did you mean `capacity`?",
    ),
    mistake("unknown-key", "range_m = 6.0", "range_m = 6.0\ncolour = 3", "colour", "expected one of"),
    mistake("wrong-unit", "width_m = 4.0", "width_cm = 400", "width_cm", "rename it to `width_m`"),
    mistake("wrong-unit", "width_m = 4.0", "width = 4.0", "width =", "rename it to `width_m`"),
    mistake(
        "wrong-unit",
        "exit_tolerance_m = 1.0",
        "exit_tolerance_ft = 3.0",
        "exit_tolerance_ft",
        "`exit_tolerance_m`",
    ),
    mistake("missing-key", "width_m = 4.0\n", "", "[[roadways]]\nid = \"side\"", "add `width_m = …`"),
    mistake("missing-key", "id = \"a1\"\n", "", "[[anchors]]\nposition_m = [20.0", "add `id = …`"),
    mistake("missing-key", "kind = \"refuge\"\n", "", "[[zones]]\nid = \"refuge\"", "add `kind = …`"),
    mistake(
        "wrong-type",
        "width_m = 4.0",
        "width_m = \"4 m\"",
        "width_m = \"4 m\"",
        "found \"4 m\", expected a number",
    ),
    mistake("wrong-type", "[20.0, 2.3, 2.5]", "[20.0, 2.3]", "[20.0, 2.3]", "expected a list of 3"),
    mistake("wrong-type", "capacity = 20", "capacity = 20.5", "20.5", "expected a whole number"),
    mistake("unknown-word", "kind = \"haulage\"", "kind = \"tunnel\"", "tunnel", "crosscut"),
    mistake(
        "unknown-word",
        "kind = \"control-points\"",
        "kind = \"gps\"",
        "gps",
        "local, epsg, control-points",
    ),
    mistake(
        "not-finite",
        "height_m = 3.5\nmax",
        "height_m = inf\nmax",
        "height_m = inf",
        "expected a finite number",
    ),
    mistake("not-finite", "[40.0, 2.3, 2.5]", "[40.0, nan, 2.5]", "nan", "expected a finite number"),
    mistake("unknown-format", "format = 1", "format = 2", "format = 2", "newer adit"),
    // Values.
    mistake("out-of-range", "width_m = 4.0", "width_m = 0.0", "width_m = 0.0", "above 0"),
    mistake("out-of-range", "exit_tolerance_m = 1.0", "exit_tolerance_m = -1.0", "-1.0", "0 or more"),
    mistake("out-of-range", "snap_m = 0.1", "snap_m = 50.0", "snap_m", "5 m at most"),
    mistake("far-coordinate", "[60.0, -2.3, 2.5]", "[60000000.0, -2300.0, 2500.0]", "60000000", "in metres"),
    mistake("bad-id", "id = \"a2\"", "id = \" a2\"", "id = \" a2\"", "choose a short printable id"),
    mistake(
        "duplicate-id",
        "id = \"a2\"",
        "id = \"a1\" # again",
        "again",
        "also that of anchor 1 in `anchors`",
    ),
    mistake("duplicate-id", "id = \"belt\"", "id = \"main\" # again", "again", "also that of roadway 1"),
    mistake(
        "unknown-reference",
        "id = \"side\"\nlevel = \"top\"",
        "id = \"side\"\nlevel = \"Top\"",
        "\"Top\"",
        "did you mean \"top\"?",
    ),
    mistake(
        "unknown-reference",
        "roadways = [\"main\", \"side\"]",
        "roadways = [\"main\", \"aside\"]",
        "aside",
        "no roadway \"aside\"",
    ),
    mistake(
        "unknown-reference",
        "roadways = [\"main\", \"ramp\", \"bottom\"]",
        "roadways = [\"main\", \"ramp\", \"sump\"]",
        "sump",
        "no roadway",
    ),
    mistake("bad-mac", "02:00:00:00:00:01", "02:00:00:00:01", "02:00", "twelve hexadecimal digits"),
    mistake("duplicate-mac", "020000000002", "02-00-00-00-00-01", "02-00", "also that of access point ap1"),
    mistake(
        "half-path-loss",
        "exponent = 1.8",
        "exponent = 1.8, breakpoint_m = 30.0",
        "breakpoint_m",
        "or neither",
    ),
    // The grid.
    mistake(
        "missing-grid",
        "[grid]\nkind = \"control-points\"\npoints = [",
        "[roadway_defaults]\npoints = [",
        "format = 1",
        "",
    ),
    mistake(
        "not-projected",
        GRID,
        "[grid]\nkind = \"epsg\"\ncode = 4326",
        "code =",
        "project to a system in metres",
    ),
    mistake("no-projection", GRID, "[grid]\nkind = \"epsg\"\ncode = 99", "code =", "not in the registry"),
    mistake("no-projection", GRID, "[grid]\nkind = \"epsg\"\ncode = 2227", "code =", "expected metres"),
    mistake("off-projection", GRID, "[grid]\nkind = \"epsg\"\ncode = 2154", "code =", "zone number"),
    mistake("no-tie", "longitude_deg = 13.35", "longitude_deg = 13350.0", "13350", "not on the Earth"),
    mistake(
        "large-residual",
        "[703.19, 0.05, 11.0]",
        "[703.19, 0.05, 11.5]",
        "11.5",
        "from where the fit puts it",
    ),
    // Roadways.
    mistake(
        "too-few-points",
        "[[400.0, 200.0, -39.0], [300.0, 200.0, -40.0]]",
        "[[400.0, 200.0, -39.0]]",
        "points_m = [[400.0, 200.0, -39.0]]",
        "expected 2 or more",
    ),
    mistake(
        "zero-length-segment",
        "    [100.0, 0.0, 0.5],\n",
        "    [100.0, 0.0, 0.5],\n    [100.0, 0.0, 0.5], # twice\n",
        "twice",
        "same place",
    ),
    mistake(
        "steeper-than-given",
        "[200.0, 0.0, 1.0],\n]",
        "[200.0, 0.0, 1.0],\n    [200.0, -30.0, 4.0],\n]",
        "[200.0, -30.0",
        "slope 10.0 %, expected 1 %",
    ),
    mistake(
        "too-steep",
        "[[100.0, 0.0, 0.5], [100.0, 60.0, 0.5]]",
        "[[100.0, 0.0, 0.5], [100.0, 20.0, 9.5], [100.0, 60.0, 0.5]]",
        "9.5",
        "slope 45 %",
    ),
    mistake(
        "off-level",
        "[[400.0, 200.0, -39.0], [300.0, 200.0, -40.0]]",
        "[[400.0, 200.0, -39.0], [300.0, 200.0, -10.0]]",
        "-10.0]]",
        "nearer to level top",
    ),
    mistake(
        "duplicate-line",
        "[[chambers]]",
        "[[roadways]]\nid = \"twin\"\nwidth_m = 4.0\nheight_m = 3.0\npoints_m = [[100.0, 60.0, 0.5], [100.0, 0.0, 0.5]] # twin\n\n[[chambers]]",
        "# twin",
        "roadway side",
    ),
    mistake(
        "overlap",
        "[[chambers]]",
        "[[roadways]]\nid = \"over\"\nwidth_m = 4.0\nheight_m = 3.0\npoints_m = [[20.0, 0.5, 0.1], [80.0, 0.5, 0.4], [100.0, 0.0, 0.5]]# over\n\n[[chambers]]",
        "# over",
        "inside roadway main",
    ),
    mistake(
        "crosses-without-junction",
        "[[chambers]]",
        "[[roadways]]\nid = \"cross\"\nwidth_m = 4.0\nheight_m = 3.0\npoints_m = [[100.0, 60.0, 0.5], [40.0, 30.0, 0.5], [40.0, -30.0, 0.5]]\n\n[[chambers]]",
        "[40.0, -30.0",
        "at (40.00, 0.00)",
    ),
    mistake(
        "near-miss",
        "[[100.0, 0.0, 0.5], [100.0, 60.0, 0.5]]",
        "[[100.0, 0.0, 0.5], [100.0, 60.0, 0.5]]\n\n[[roadways]]\nid = \"short\"\nwidth_m = 3.0\nheight_m = 3.0\npoints_m = [[150.0, 1.2, 0.75], [150.0, 30.0, 0.75]]",
        "[150.0, 1.2",
        "ends 1.20 m from the centre line of roadway main",
    ),
    mistake(
        "disconnected",
        "points_m = [[400.0, 200.0, -39.0], [300.0, 200.0, -40.0]]",
        "points_m = [[400.0, 230.0, -39.0], [300.0, 230.0, -40.0]]\n\n[[roadways]]\nid = \"bottom-2\"\nwidth_m = 5.0\nheight_m = 3.5\npoints_m = [[400.0, 200.0, -39.0], [420.0, 200.0, -39.0]]",
        "[[roadways]]\nid = \"bottom\"",
        "nearest: roadway ramp, 30.0 m away",
    ),
    // Junctions.
    mistake(
        "junction-off",
        "position_m = [100.0, 0.0, 0.5]\nroadways = [\"main\", \"side\"]",
        "position_m = [100.0, 0.0, 0.5]\nroadways = [\"main\", \"side\", \"ramp\"]",
        "\"ramp\"]",
        "100.00 m from the centre line of roadway ramp",
    ),
    mistake(
        "junction-of-one",
        "position_m = [100.0, 0.0, 0.5]\nroadways = [\"main\", \"side\"]",
        "position_m = [50.0, 0.0, 0.25]",
        "[[junctions]]\nid = \"fork\"",
        "roadways that meet here: 1",
    ),
    // Outlines.
    mistake(
        "self-crossing",
        "[[-4.0, -4.0], [8.0, -4.0], [8.0, 4.0], [-4.0, 4.0]]",
        "[[-4.0, -4.0], [8.0, 4.0], [8.0, -4.0], [-4.0, 4.0]]",
        "[[-4.0",
        "put its corners in order",
    ),
    mistake(
        "no-area",
        "[[150.0, -0.5], [151.0, -0.5], [151.0, 0.5], [150.0, 0.5]]",
        "[[150.0, -0.5], [150.0001, -0.5], [150.0001, -0.4]]",
        "[[150.0, -0.5]",
        "encloses",
    ),
    mistake(
        "too-few-points",
        "[[-4.0, -4.0], [8.0, -4.0], [8.0, 4.0], [-4.0, 4.0]]",
        "[[-4.0, -4.0], [8.0, -4.0]]",
        "[[-4.0",
        "expected 3 or more",
    ),
    // Zones.
    mistake(
        "empty-zone",
        "[[vehicle_routes]]",
        "[[zones]]\nid = \"lost\"\nkind = \"key\"\nlevel = \"deep\"\noutline_m = [[0.0, 0.0], [9.0, 0.0], [9.0, 9.0]] # lost\n\n[[vehicle_routes]]",
        "# lost",
        "no roadway or chamber of level deep",
    ),
    mistake(
        "unknown-reference",
        "kind = \"refuge\"\nlevel = \"top\"",
        "kind = \"refuge\"\nlevel = \"attic\"",
        "attic",
        "no level \"attic\"",
    ),
    mistake(
        "refuge-unreachable",
        "id = \"side\"\n",
        "id = \"side\"\nwalkable = false\n",
        "[[zones]]\nid = \"refuge\"",
        "no roadway that can be walked leads here from any portal",
    ),
    mistake("no-capacity", "capacity = 20\n", "", "[[zones]]\nid = \"refuge\"", "how many people"),
    mistake("no-portal", "kind = \"portal\"", "kind = \"key\"", "format = 1", "add one at each way out"),
    // Devices.
    mistake(
        "in-rock",
        "[20.0, 2.3, 2.5]",
        "[20.0, 5.0, 2.5]",
        "[20.0, 5.0",
        "2.50 m beyond the wall of roadway main",
    ),
    mistake("in-rock", "[40.0, 2.3, 2.5]", "[300.0, 80.0, 2.5]", "[300.0, 80.0", "beyond the wall of"),
    mistake(
        "above-roof",
        "[20.0, 2.3, 2.5]",
        "[20.0, 2.3, 5.6]",
        "5.6",
        "2.00 m above the roof of roadway main",
    ),
    mistake(
        "below-floor",
        "[5.0, 0.0, 2.5]",
        "[5.0, 0.0, -2.475]",
        "-2.475",
        "2.50 m below the floor of roadway main",
    ),
    mistake(
        "same-place",
        "[60.0, -2.3, 2.5]",
        "[20.0, 2.3, 2.5] # both",
        "# both",
        "same place as anchor a1",
    ),
    mistake("in-pillar", "[60.0, -2.3, 2.5]", "[150.5, 0.0, 2.5]", "[150.5", "inside pillar stump"),
    // Works.
    mistake(
        "works-in-rock",
        "[[150.0, -0.5], [151.0, -0.5], [151.0, 0.5], [150.0, 0.5]]",
        "[[150.0, -9.5], [151.0, -9.5], [151.0, -8.5], [150.0, -8.5]]",
        "-9.5",
        "pillar stands in rock",
    ),
    mistake(
        "works-in-rock",
        "[[98.0, 20.0], [102.0, 20.0]]",
        "[[58.0, 20.0], [62.0, 20.0]]",
        "[[58.0",
        "door stands in rock",
    ),
    mistake(
        "door-too-narrow",
        "[[98.0, 20.0], [102.0, 20.0]]",
        "[[99.0, 20.0], [101.0, 20.0]]",
        "[[99.0",
        "spans 2.00 m of roadway side, which is 4 m wide",
    ),
    mistake("in-rock", "[190.0, -1.5, 2.0]", "[190.0, -6.5, 2.0]", "-6.5", "beyond the wall of roadway main"),
    mistake(
        "broken-route",
        "[\"main\", \"ramp\", \"bottom\"]",
        "[\"main\", \"bottom\"]",
        "[\"main\", \"bottom\"]",
        "does not meet roadway bottom",
    ),
    mistake("out-of-range", "speed_m_s = 4.0", "speed_m_s = 0.0", "speed_m_s", "above 0"),
    mistake("wrong-unit", "speed_m_s = 4.0", "speed_km_h = 15.0", "speed_km_h", "rename it to `speed_m_s`"),
    mistake(
        "wrong-type",
        "roadways = [\"main\", \"side\"]",
        "roadways = \"main\"",
        "roadways = \"main\"",
        "expected a list",
    ),
];

fn rule(notice: &Notice) -> String {
    serde_json::to_value(&notice.finding.problem).unwrap()["rule"].as_str().unwrap().to_owned()
}

#[test]
fn the_sound_mine_is_sound() {
    let checked = checked(SOUND);
    assert!(checked.notices.is_empty(), "{}", shown(&checked.notices));
    assert!(checked.mine.is_some());
}

fn shown(notices: &[Notice]) -> String {
    notices.iter().fold(String::new(), |text, notice| text + "\n" + &notice.to_string())
}

#[test]
fn every_mistake_is_told_once_with_its_line_and_a_remedy() {
    let mut wrong = String::new();
    for Mistake { rule: expected, from, to, marker, says } in &MISTAKES {
        assert_eq!(SOUND.matches(from).count(), 1, "{from} stands once in the sound file");
        let text = SOUND.replace(from, to);
        let at = text.rfind(marker).unwrap();
        let line = 1 + text[..at].matches('\n').count() as u64;
        let mut notices = checked(&text).notices;
        // A `[grid]` under another name is also an unknown key.
        if *expected == "missing-grid" {
            notices.retain(|notice| rule(notice) != "unknown-key");
        }
        let found: Vec<(String, u64)> = notices.iter().map(|n| (rule(n), n.line)).collect();
        let message = notices.first().map(ToString::to_string).unwrap_or_default();
        let first_line = *marker == "format = 1";
        let right_line = found.first().is_some_and(|(_, l)| *l == line || first_line && *l == 1);
        let start = format!("mine.toml:{}: ", if first_line { 1 } else { line });
        if found.len() != 1
            || found[0].0 != *expected
            || !right_line
            || !message.contains(says)
            || !message.starts_with(&start)
        {
            let notices = shown(&notices);
            writeln!(wrong, "--- {expected} on line {line}, saying {says}: {from} -> {to}{notices}").unwrap();
        }
        if message.contains('\n') || !message.contains("; ") {
            writeln!(wrong, "--- not one line with a remedy: {message}").unwrap();
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn the_mistakes_are_of_many_kinds() {
    let rules: BTreeSet<&str> = MISTAKES.iter().map(|m| m.rule).collect();
    assert!(rules.len() >= 40, "{} kinds: {rules:?}", rules.len());
}

#[test]
fn all_mistakes_of_a_file_are_told_at_once_in_order_of_line() {
    let chosen = [
        "expected one of",
        "expected a whole number",
        "also that of roadway 1",
        "also that of access point ap1",
        "slope 10.0 %, expected 1 %",
        "put its corners in order",
        "2.00 m above the roof of roadway main",
        "door stands in rock",
        "does not meet roadway bottom",
    ];
    let mut text = SOUND.to_owned();
    let mut expected: BTreeSet<&str> = BTreeSet::new();
    for says in chosen {
        let Mistake { rule, from, to, .. } = MISTAKES.iter().find(|m| m.says == says).unwrap();
        assert_eq!(text.matches(from).count(), 1, "{from}");
        text = text.replace(from, to);
        expected.insert(rule);
    }
    let notices = checked(&text).notices;
    let found: BTreeSet<String> = notices.iter().map(rule).collect();
    let found: BTreeSet<&str> = found.iter().map(String::as_str).collect();
    assert_eq!(found, expected, "{}", shown(&notices));
    assert_eq!(notices.len(), chosen.len(), "{}", shown(&notices));
    assert!(notices.is_sorted_by_key(|notice| notice.line));
}

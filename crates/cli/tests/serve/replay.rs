//! `adit replay`: a log into a running server comes out where `adit track` has it.

use crate::served::{Served, adit};
use serde_json::Value;
use std::fmt::Write as _;
use std::path::Path;
use std::process::Output;

/// As in `mines/lab.toml`.
const ANCHORS: [(&str, [f64; 3]); 4] =
    [("a1", [2.0, 0.2, 3.2]), ("a2", [18.0, 0.2, 2.0]), ("a3", [22.0, 15.8, 3.2]), ("a4", [6.0, 15.8, 2.0])];
const METHOD: &str = "[solver]\nheight_m = 1.1\nheight_sigma_m = 0.0\n";

/// Ranges of a tag that goes through the laboratory, off by up to 20 cm.
fn walk() -> String {
    let mut log = String::from("time_s,anchor_id,range_m\n");
    for epoch in 0..300_u32 {
        let time = 0.1 * f64::from(epoch);
        let (x, y) = (3.0 + 0.5 * time, 3.0 + 3.0 * (0.2 * time).sin());
        for (index, (id, [east, north, up])) in (1_u32..).zip(ANCHORS) {
            let off = 0.2 * f64::from(epoch * 37 * index % 101) / 101.0;
            let range = (x - east).hypot(y - north).hypot(1.1 - up) + off;
            writeln!(log, "{time:.1},{id},{range:.3}").unwrap();
        }
    }
    log
}

fn replay(url: &str, token: &str, log: &Path, flags: &[&str]) -> Output {
    let mut command = adit();
    command.arg("replay").arg(log).args(["--to", url, "--json", "-"]).args(flags).env("ADIT_TOKEN", token);
    command.output().unwrap()
}

fn told(output: &Output) -> Value {
    let text = String::from_utf8_lossy(&output.stdout);
    let report = serde_json::Deserializer::from_str(&text).into_iter::<Value>().next();
    report.unwrap_or_else(|| panic!("{text}{}", String::from_utf8_lossy(&output.stderr))).unwrap()
}

#[tokio::test]
async fn a_replayed_log_comes_out_where_track_has_it() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let lab = concat!(env!("CARGO_MANIFEST_DIR"), "/../../mines/lab.toml");
    std::fs::write(at("log.csv"), walk()).unwrap();
    std::fs::write(at("method.toml"), METHOD).unwrap();
    let config = format!(
        "[site]\nmine = \"{lab}\"\n[[profiles]]\nname = \"lab\"\ntags = [\"*\"]\nmethod = \"uwb-ls\"\nconfig = \"method.toml\"\n"
    );
    std::fs::write(at("adit.toml"), config).unwrap();
    let tracked = adit()
        .current_dir(folder.path())
        .args([
            "track",
            "log.csv",
            "--method",
            "uwb-ls",
            "--mine",
            lab,
            "--config",
            "method.toml",
            "-o",
            "walk.tum",
        ])
        .output()
        .unwrap();
    assert!(tracked.status.success(), "{}", String::from_utf8_lossy(&tracked.stderr));
    let tum = std::fs::read_to_string(at("walk.tum")).unwrap();
    let poses: Vec<Vec<f64>> = tum
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| line.split_whitespace().map(|cell| cell.parse().unwrap()).collect())
        .collect();

    let served = Served::start(folder.path(), Some(&at("adit.toml")), "127.0.0.1:0");
    let token = served.token().await;
    for (tag, flags, batches) in [
        ("T-1", &["--speed", "20"][..], 30),
        ("T-2", &["--speed", "200", "--gateway", "north 7"], 30),
        ("T-3", &["--speed", "100", "--keep-times"], 30),
    ] {
        let output = replay(&served.url, &token, &at("log.csv"), &[&["--tag", tag], flags].concat());
        let report = told(&output);
        assert!(output.status.success(), "{report}");
        let counts = ["batches", "acknowledged", "repeated", "refused", "observations"];
        assert_eq!(
            counts.map(|name| report[name].as_u64().unwrap()),
            [batches, batches, 0, 0, 1200],
            "{report}"
        );
        let moved_s = report["moved_s"].as_f64().unwrap();
        assert_eq!(flags.contains(&"--keep-times"), moved_s == 0.0, "{report}");
        let mut fixes = Vec::new();
        // What is written behind the live state comes a moment later.
        for _ in 0..100 {
            fixes = served.track(&token, tag).await;
            if fixes.len() >= 30 {
                break;
            }
            tokio::time::sleep(std::time::Duration::from_millis(50)).await;
        }
        assert!(fixes.len() >= 30, "{tag}: {} fixes", fixes.len());
        for (time, [x, y, z]) in fixes {
            let nearest = poses.iter().min_by(|a, b| {
                let away = |pose: &Vec<f64>| (pose[0] + moved_s - time).abs();
                away(a).total_cmp(&away(b))
            });
            let pose = nearest.unwrap();
            // Stamps are stored to the ms, positions to the cm; epochs are 0.1 s apart.
            assert!((pose[0] + moved_s - time).abs() < 0.002, "{tag}: {time} is no epoch");
            let off = (x - pose[1]).hypot(y - pose[2]).hypot(z - pose[3]);
            assert!(off < 0.01, "{tag} at {:.1} s: {off} m from the track", pose[0]);
        }
    }
}

#[tokio::test]
async fn what_cannot_be_replayed_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let served = Served::start(folder.path(), None, "127.0.0.1:0");
    let token = served.token().await;
    let (log, none) = (folder.path().join("log.csv"), folder.path().join("none.csv"));
    std::fs::write(&log, walk()).unwrap();
    std::fs::write(&none, "time_s,anchor_id,range_m\n").unwrap();
    let fails = |log: &Path, token: &str, flags: &[&str]| {
        let output = replay(&served.url, token, log, flags);
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, told) = fails(&log, "adit_t_nobody", &["--tag", "T-1", "--speed", "1000"]);
    assert!(code == Some(1) && told.contains("401"), "{told}");
    let (code, told) = fails(&log, &token, &["--tag", "T-1", "--speed", "1000", "--gateway", "a+b"]);
    assert!(code == Some(1) && told.contains("30 batches were refused: 422"), "{told}");
    let (code, told) = fails(&none, &token, &["--tag", "T-1"]);
    assert!(code == Some(1) && told.contains("none.csv"), "{told}");
    let (code, told) = fails(&log, &token, &["--tag", "T-1", "--speed", "0"]);
    assert!(code == Some(2) && told.contains("0.1 to 10000"), "{told}");
}

//! `adit mine`: what is wrong with a mine, what is in it, and other forms of it.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{Outcome, adit, files};
use std::path::{Path, PathBuf};

fn shipped(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../mines").join(name);
    path.canonicalize().unwrap().to_str().unwrap().to_owned()
}

#[test]
fn help_reads_as_it_should() {
    for args in [&["mine", "--help"][..], &["mine", "check", "--help"], &["mine", "convert", "--help"]] {
        let name = format!("help_{}", args[..args.len() - 1].join("_"));
        insta::assert_snapshot!(name, adit(Path::new("."), args).stdout);
    }
}

#[test]
fn a_sound_mine_is_summed_up() {
    let Outcome { code, stdout, stderr } =
        adit(Path::new("."), &["mine", "check", &shipped("two-level.toml")]);
    assert_eq!((code, stderr.as_str()), (0, ""));
    insta::assert_snapshot!("check_two_level", stdout);
}

#[test]
fn errors_and_warnings_are_told_a_line_each_and_the_exit_code_is_1() {
    let folder = tempfile::tempdir().unwrap();
    let lab = std::fs::read_to_string(shipped("lab.toml")).unwrap();
    let bad =
        lab.replace("[2.0, 0.2, 3.2]", "[2.0, -7.2, 3.2]").replace("kind = \"portal\"", "kind = \"key\"");
    std::fs::write(folder.path().join("lab.toml"), bad.replace("height_m = 2.2", "hight_m = 2.2")).unwrap();
    let args = ["mine", "check", "lab.toml", "--plot", "lab.svg"];
    let Outcome { code, stdout, stderr } = adit(folder.path(), &args);
    assert_eq!((code, stdout.as_str()), (1, ""));
    insta::assert_snapshot!("check_bad_lab", stderr);
    assert_eq!(files(folder.path()), [PathBuf::from("lab.toml")]);

    let Outcome { code, stdout, stderr } = adit(folder.path(), &["mine", "check", "lab.toml", "--json"]);
    assert_eq!((code, stderr.as_str()), (1, "adit: lab.toml: 2 errors, 1 warning\n"));
    let report: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!(report["errors"].as_array().unwrap().len(), 2);
    assert_eq!(report["errors"][0]["problem"]["rule"], "unknown-key");
    assert_eq!(report["errors"][0]["place"], "pillars[2].hight_m");
    assert_eq!(report["warnings"][0]["problem"]["rule"], "no-portal");
    assert!(report["summary"].is_null());
}

#[test]
fn a_mine_is_written_in_other_forms_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let lab = shipped("lab.toml");
    let done = |args: &[&str]| {
        let Outcome { code, stderr, stdout } = adit(folder.path(), args);
        assert_eq!((code, stderr.as_str()), (0, ""), "{args:?}");
        stdout
    };
    done(&["mine", "convert", &lab, "-o", "lab.geojson"]);
    done(&["mine", "convert", "lab.geojson", "-o", "lab.json"]);
    done(&["mine", "convert", "lab.json", "-o", "lab.toml"]);
    let direct = done(&["mine", "convert", &lab, "-o", "-"]);
    assert_eq!(std::fs::read_to_string(folder.path().join("lab.toml")).unwrap(), direct);
    let summary = done(&["mine", "check", "lab.toml", "--plot", "lab.svg"]);
    assert!(summary.ends_with("findings    no errors, no warnings\n"), "{summary}");
    assert!(std::fs::read_to_string(folder.path().join("lab.svg")).unwrap().starts_with("<svg"));

    let Outcome { code, stderr, .. } = adit(folder.path(), &["mine", "convert", &lab, "-o", "lab.dxf"]);
    assert_eq!(
        (code, stderr.as_str()),
        (1, "adit: lab.dxf: unknown form of a mine, expected .toml, .json or .geojson\n")
    );
}

#[test]
fn a_file_that_is_not_there_or_no_mine_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let Outcome { code, stderr, .. } = adit(folder.path(), &["mine", "check", "none.toml"]);
    assert_eq!(code, 1);
    assert!(stderr.starts_with("adit: none.toml: cannot read it: No such file"), "{stderr}");
    std::fs::write(folder.path().join("noise"), b"\x00\xff\xfe").unwrap();
    let Outcome { code, stderr, .. } = adit(folder.path(), &["mine", "check", "noise"]);
    assert_eq!(code, 1);
    assert!(stderr.starts_with("noise:1: error: not UTF-8 text"), "{stderr}");
}

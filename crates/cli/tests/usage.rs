//! Wrong usage is told in one line with exit code 2; help tells what there is.

mod common;

use common::{Outcome, adit};
use std::path::Path;

fn run(args: &[&str]) -> Outcome {
    adit(Path::new("."), args)
}

#[test]
fn wrong_usage_is_one_line_and_exit_code_2() {
    let cases: [(&[&str], &str); 18] = [
        (
            &["track", "walk.csv", "--method", "sonar", "-o", "walk.tum"],
            "[possible values: fused, foot-ins, marg-ins, reduced-ins-wifi, full-ins-wifi, pdr, wifi, pdr-wifi, uwb-ls, uwb-pdr, uwb-ekf, uwb-rkf, uwb-aekf, ahrs]",
        ),
        (&["track", "walk.csv", "-o", "walk.tum"], "--method <METHOD>"),
        (&["track", "--method", "foot-ins", "-o", "walk.tum"], "<LOG>"),
        (
            &["track", "a", "--method", "foot-ins", "-o", "b", "--lag", "-3"],
            "expected seconds from 0.1 to 60",
        ),
        (&["track", "a", "--method", "foot-ins", "-o", "b", "--lag", "3", "--smooth"], "cannot be used with"),
        (&["track", "a", "--method", "foot-ins", "-o", "-", "--json", "-"], "cannot both go to stdout"),
        (
            &["track", "a", "--method", "marg-ins", "-o", "b", "--lag", "3"],
            "marg-ins has no smoother: --lag cannot be used with it",
        ),
        (
            &["track", "a", "--method", "marg-ins", "-o", "b", "--smooth"],
            "marg-ins has no smoother: --smooth cannot be used with it",
        ),
        (
            &["track", "a", "--method", "wifi", "-o", "b"],
            "wifi needs the radio of the site: --mine MINE (places of access points and anchors) or --radio MODEL",
        ),
        (
            &["track", "a", "--method", "foot-ins", "-o", "b", "--mine", "m.toml"],
            "foot-ins makes no use of the radio of a site: --mine cannot be used with it",
        ),
        (&["eval", "a", "--truth", "b", "--align", "sim3"], "expected none, start, se2 or se3"),
        (&["tune", "foot-ins", "-o", "t.toml"], "--train <LOG>..."),
        (
            &["tune", "foot-ins", "--train", "a", "-o", "t.toml", "--budget", "19"],
            "--budget 19 is less than one generation of --agents 20",
        ),
        (
            &["tune", "pdr", "--train", "a", "-o", "t.toml", "--parameters", "noise.sonar"],
            "noise.sonar is no noise parameter of pdr, expected some of noise.step_share, ",
        ),
        (&["tune", "pdr", "--train", "a", "-o", "-", "--resume"], "--resume needs a file for -o"),
        (
            &["tune", "pdr", "--train", "a", "-o", "t.toml", "--optimizer", "luck"],
            "[possible values: cmaes, scaba, bat, sca]",
        ),
        (&["tune", "wifi", "--train", "a", "-o", "t.toml"], "wifi has no noise parameters to tune"),
        (&["dig"], "unrecognized subcommand 'dig'"),
    ];
    for (args, expected) in cases {
        let Outcome { code, stdout, stderr } = run(args);
        assert_eq!((code, stdout.as_str()), (2, ""), "{args:?}");
        assert!(stderr.starts_with("adit: ") && stderr.contains(expected), "{args:?}: {stderr}");
        assert_eq!(stderr.lines().count(), 1, "{args:?}: {stderr}");
    }
}

#[test]
fn no_verb_shows_the_verbs() {
    let Outcome { code, stderr, .. } = run(&[]);
    assert_eq!(code, 2);
    assert!(stderr.contains("Commands:") && stderr.contains("Examples:"), "{stderr}");
}

#[test]
fn version_and_help_go_to_stdout() {
    let version = run(&["--version"]);
    assert_eq!((version.code, version.stdout.trim()), (0, concat!("adit ", env!("CARGO_PKG_VERSION"))));
    let help = run(&["--help"]);
    assert_eq!((help.code, help.stderr.as_str()), (0, ""));
}

#[test]
fn help_reads_as_it_should() {
    for verb in
        ["demo", "simulate", "track", "eval", "compare", "tune", "serve", "load", "replay", "store", "audit"]
    {
        insta::assert_snapshot!(format!("help_{verb}"), run(&[verb, "--help"]).stdout);
    }
    insta::assert_snapshot!("help", run(&["--help"]).stdout);
}

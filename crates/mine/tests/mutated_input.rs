//! Valid mines of every form with bits flipped, ends cut, pieces moved and numbers swapped: no panic, and a mine or clear
//! messages. The short run of the fuzz target `mine` that needs nothing but stable Rust.
//!
//! A second of mutations from a fixed seed; `ADIT_MUTATION_SECONDS` makes it longer, `ADIT_SEEDS` stores the valid files.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;
#[path = "../../../fuzz/src/mine.rs"]
mod parser;

use adit_mine::file::{to_geojson, to_json};
use common::shipped;
use parser::check_mine;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::time::{Duration, Instant};

/// What mutations like to put in place of text.
const TOKENS: [&str; 20] = [
    "nan",
    "-inf",
    "1e308",
    "-1e-320",
    "0",
    "-0.0",
    "99999999999999999999",
    "[",
    "]",
    "{",
    "}",
    "\"",
    "\n",
    "=",
    "null",
    "lab",
    "[[zones]]\n",
    "width_m",
    ",",
    "\u{feff}",
];

fn seeds() -> Vec<Vec<u8>> {
    let lab = std::fs::read(shipped("lab.toml")).unwrap();
    let plan = adit_mine::file::open(&shipped("lab.toml")).unwrap().0.plan().clone();
    let csv = "anchor_id,x_m,y_m,z_m\nA1,0.5,0,2.5\nA2,10,0,2.5\n";
    vec![
        lab,
        std::fs::read(shipped("haulage.toml")).unwrap(),
        to_json(&plan).unwrap().into_bytes(),
        to_geojson(&plan).unwrap().into_bytes(),
        csv.as_bytes().to_vec(),
    ]
}

fn mutate(random: &mut ChaCha8Rng, bytes: &mut Vec<u8>, other: &[u8]) {
    for _ in 0..random.random_range(1..4) {
        let at = random.random_range(0..=bytes.len());
        let end = (at + random.random_range(0..40)).min(bytes.len());
        match random.random_range(0..7) {
            0 => bytes.truncate(at),
            1 if at < bytes.len() => bytes[at] ^= 1 << random.random_range(0..8),
            2 => {
                bytes.drain(at..end);
            }
            3 => {
                let from = random.random_range(0..other.len());
                let to = (from + random.random_range(0..300)).min(other.len());
                bytes.splice(at..at, other[from..to].iter().copied());
            }
            // A digit for another: what parses goes on into geometry and checks.
            4 | 5 => {
                let digits: Vec<usize> = (0..bytes.len()).filter(|i| bytes[*i].is_ascii_digit()).collect();
                if !digits.is_empty() {
                    bytes[digits[random.random_range(0..digits.len())]] = random.random_range(b'0'..=b'9');
                }
            }
            _ => {
                let token = TOKENS[random.random_range(0..TOKENS.len())].bytes();
                bytes.splice(at..(at + 3).min(end), token);
            }
        }
    }
}

#[test]
fn mutated_mines_are_answered() {
    let seeds = seeds();
    for seed in &seeds {
        assert!(check_mine(seed), "a seed is a mine");
    }
    if let Some(folder) = std::env::var_os("ADIT_SEEDS") {
        let folder = std::path::Path::new(&folder).join("mine");
        std::fs::create_dir_all(&folder).unwrap();
        for (number, seed) in seeds.iter().enumerate() {
            std::fs::write(folder.join(number.to_string()), seed).unwrap();
        }
    }
    let seconds = std::env::var("ADIT_MUTATION_SECONDS").ok().and_then(|s| s.parse().ok()).unwrap_or(1.0);
    let end = Instant::now() + Duration::from_secs_f64(seconds);
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let (mut runs, mut mines) = (0, 0);
    while Instant::now() < end {
        let mut bytes = seeds[random.random_range(0..seeds.len())].clone();
        let other = &seeds[random.random_range(0..seeds.len())];
        mutate(&mut random, &mut bytes, other);
        mines += usize::from(check_mine(&bytes));
        runs += 1;
    }
    println!("{runs} mutations, {mines} of them still mines");
    assert!(runs > 20 && mines > 0 && mines < runs);
}

const HEAD: &str = "name = \"m\"\n[grid]\nkind = \"local\"\n[[levels]]\nid = \"l\"\nelevation_m = 0\n";

fn repeated(count: u32, entry: impl Fn(u32) -> String) -> String {
    (0..count).map(entry).collect::<Vec<_>>().concat()
}

#[test]
fn an_error_after_a_thousand_warnings_is_still_an_error() {
    let zones = repeated(1500, |number| {
        let outline = "outline_m = [[0, 0], [1, 0], [1, 1]]";
        format!("[[zones]]\nid = \"z{number}\"\nkind = \"refuge\"\nlevel = \"l\"\n{outline}\n")
    });
    let text = format!("{HEAD}{zones}[[anchors]]\nid = \"z7\"\nposition_m = [0, 0, 1]\n");
    let checked = adit_mine::file::parse(std::path::Path::new("m.toml"), text.as_bytes());
    assert_eq!((checked.errors().count(), checked.notices.len()), (1, 1000));
    assert!(checked.mine.is_none());
}

#[test]
fn large_degenerate_files_are_answered_in_time() {
    let started = Instant::now();
    let keys = repeated(200_000, |i| format!("\"k{i}\": 0,"));
    let corners = repeated(100_000, |i| format!("[{i}.0, {}.0],", i % 7));
    let apart = repeated(3000, |i| {
        let x = 40 * i;
        format!(
            "[[roadways]]\nid = \"r{i}\"\nwidth_m = 3\nheight_m = 3\npoints_m = [[{x}, 0, 0], [{x}, 9, 0]]\n"
        )
    });
    let polygon = "{\"type\": \"Polygon\", \"coordinates\": [[[0,0],[1,0],[0,0]]]}";
    let feature = format!("{{\"properties\": {{{keys} \"feature\": \"zone\"}}, \"geometry\": {polygon}}}");
    for text in [
        format!("{{{keys} \"k\": 0}}"),
        format!("{{\"type\": \"FeatureCollection\", \"features\": [{feature}]}}"),
        format!("{HEAD}[[zones]]\nid = \"z\"\nkind = \"key\"\nlevel = \"l\"\noutline_m = [{corners}]\n"),
        format!("{HEAD}{apart}"),
    ] {
        assert!(!check_mine(text.as_bytes()));
    }
    // Some seconds; minutes and hours where something grows with the square of the file.
    assert!(started.elapsed() < Duration::from_mins(1), "{:?}", started.elapsed());
}

//! Writes how fast and in how much memory everybody of a mine is simulated, as Markdown: `shift_results ADIT SHIFT.toml OUT.md`.
//!
//! `adit simulate` on one thread, the log written to disk; peak memory as Linux tells it (`VmHWM`). Called by `ci/results.sh`.

use anyhow::{Context, Result, bail, ensure};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// What is run: hours, people written, what is told of a range.
const RUNS: [(f64, &str, &str); 4] = [
    (1.0, "1", "diagnostics"),
    (8.0, "1", "diagnostics"),
    (8.0, "121", "diagnostics"),
    (1.0, "1", "impulse-response"),
];

struct Measured {
    took_s: f64,
    peak_mib: f64,
    log_mib: f64,
    told: String,
}

fn main() -> Result<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [adit, shift, out] = arguments.as_slice() else {
        bail!("usage: shift_results ADIT SHIFT.toml OUT.md")
    };
    let text = fs::read_to_string(shift).with_context(|| shift.display().to_string())?;
    let mines = shift.canonicalize()?.parent().and_then(Path::parent).context("a folder")?.join("mines");
    let mut table = "| hours | person | of a range | samples and the rest | time, s | × real time | log, MiB | peak memory, MiB |\n\
                     |---:|---:|---|---|---:|---:|---:|---:|\n"
        .to_owned();
    for (hours, person, detail) in RUNS {
        let folder = TempDir::new()?;
        let scenario = folder.path().join("shift.toml");
        let changed = replaced(&text, "../mines", mines.to_str().context("a path that is text")?)?;
        let changed = replaced(
            &changed,
            "duration_s = 28800.0\n# Poses",
            &format!("duration_s = {}\n# Poses", hours * 3600.0),
        )?;
        fs::write(&scenario, replaced(&changed, "\"diagnostics\"", &format!("\"{detail}\""))?)?;
        let Measured { took_s, peak_mib, log_mib, told } = measure(adit, &scenario, person, folder.path())?;
        let speed = hours * 3600.0 / took_s;
        writeln!(
            table,
            "| {hours} | {person} | {detail} | {told} | {took_s:.1} | {speed:.0} | {log_mib:.0} | {peak_mib:.0} |"
        )?;
    }
    fs::write(out, table).with_context(|| out.display().to_string())
}

fn replaced(text: &str, from: &str, to: &str) -> Result<String> {
    ensure!(text.matches(from).count() == 1, "{from:?} stands once in the scenario");
    Ok(text.replace(from, to))
}

fn measure(adit: &Path, scenario: &Path, person: &str, folder: &Path) -> Result<Measured> {
    let out = folder.join("out");
    let begun = Instant::now();
    let mut running = Command::new(adit)
        .args([
            "simulate".as_ref(),
            scenario,
            "-o".as_ref(),
            out.as_path(),
            "--people".as_ref(),
            person.as_ref(),
        ])
        .env("RAYON_NUM_THREADS", "1")
        .stdout(Stdio::piped())
        .spawn()
        .context("adit cannot be run")?;
    let mut peak_kib = 0_u64;
    let status = loop {
        // The peak so far; the last look is at most 20 ms before the end.
        let status = fs::read_to_string(format!("/proc/{}/status", running.id())).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kib = line.and_then(|rest| rest.trim().trim_end_matches("kB").trim().parse().ok());
        peak_kib = peak_kib.max(kib.unwrap_or(0));
        if let Some(status) = running.try_wait()? {
            break status;
        }
        std::thread::sleep(Duration::from_millis(20));
    };
    let took_s = begun.elapsed().as_secs_f64();
    ensure!(status.success(), "adit simulate failed");
    let output = running.wait_with_output()?;
    let told = String::from_utf8(output.stdout)?;
    let kinds: Vec<&str> = told.lines().filter_map(|line| line.trim().strip_prefix("with ")).collect();
    let person: usize = person.parse()?;
    let log = out.join(format!("p{person:03}")).join("log.mcap");
    let log_mib = fs::metadata(&log).with_context(|| log.display().to_string())?.len() as f64 / 1_048_576.0;
    Ok(Measured { took_s, peak_mib: peak_kib as f64 / 1024.0, log_mib, told: kinds.join("; ") })
}

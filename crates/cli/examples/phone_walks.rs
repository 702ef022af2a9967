//! Runs `adit track --method pdr` over the recorded walks with a phone, and writes the errors at the waypoints as Markdown.
//!
//! `phone_walks ADIT DATA OUT.md` takes the program, the folder of the sets and the file to write. `ci/results.sh` calls it.
//!
//! The phone has a file for each sensor, on stamps of their own. Accelerometer and magnetometer are interpolated at the stamps of the
//! gyro; the joined log is tracked with one setting, with the magnetometer and without. Errors are those of `adit eval --align se2`: at the
//! waypoints, after one rotation and shift of the whole path.

use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use adit_observation::csv_log::{CsvLogWriter, Sensors};
use adit_observation::{ImuSample, MagneticSample, Observation, SensorRows};
use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const SET: &str = "phone-walks";
const WAYPOINTS: &str = "_waypoints_truth.csv";

fn main() -> Result<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [adit, data, out] = arguments.as_slice() else { bail!("usage: phone_walks ADIT DATA OUT.md") };
    let folder = data.join(SET);
    if !folder.is_dir() {
        println!("SKIPPED (no test data): {SET}");
        return Ok(());
    }
    let entries = fs::read_dir(&folder)?.map(|entry| Ok(entry?.file_name()));
    let names = entries.collect::<Result<Vec<_>>>()?;
    let walk = |name: &std::ffi::OsString| name.to_str()?.strip_suffix(WAYPOINTS).map(str::to_owned);
    let mut walks: Vec<String> = names.iter().filter_map(walk).collect();
    walks.sort();

    let mut text = String::from(
        "| walk | steps | way, m | nine axes: RMSE / median / max, m | six axes |\n|---|---:|---:|---:|---:|\n",
    );
    for walk in walks {
        let scratch = tempfile::tempdir()?;
        let truth = scratch.path().join("truth.csv");
        fs::write(&truth, truth_of(&folder.join(format!("{walk}{WAYPOINTS}")))?)?;
        let mut cells = Vec::new();
        let mut told = (0.0, 0.0);
        for sensors in [Sensors::ImuMagnetic, Sensors::Imu] {
            let log = scratch.path().join("joined_imu.csv");
            join(&folder, &walk, sensors, &log)?;
            let (errors, steps, way_m) = judge(adit, &log, &truth)?;
            told = (steps, way_m);
            cells.push(errors);
        }
        writeln!(text, "| {walk} | {} | {:.1} | {} |", told.0, told.1, cells.join(" | "))?;
    }
    fs::write(out, text).with_context(|| out.display().to_string())
}

/// Time and vector of every row of the log of one sensor.
fn sensor(folder: &Path, walk: &str, name: &str) -> Result<Vec<(Time, Vector3<f64>)>> {
    let files = [".csv.gz", ".csv"].map(|end| folder.join(format!("{walk}_{name}{end}")));
    let file = files.iter().find(|file| file.exists()).with_context(|| format!("no {name} of {walk}"))?;
    let sample = |row: adit_observation::csv_log::Row| {
        let value = row.angular_rate_rad_s.or(row.specific_force_m_s2).or(row.field_ut);
        Ok((row.time, value.context("empty row")?))
    };
    SensorRows::open(file)?.map(|row| sample(row?)).collect()
}

/// Joined by straight lines; `None` outside.
fn at(samples: &[(Time, Vector3<f64>)], time: Time) -> Option<Vector3<f64>> {
    let after = samples.partition_point(|(stamp, _)| *stamp < time);
    let (later, to) = samples.get(after)?;
    let (earlier, from) = samples.get(after.checked_sub(1)?)?;
    let share = (time - *earlier).seconds() / (*later - *earlier).seconds();
    Some(from + (to - from) * share)
}

fn join(folder: &Path, walk: &str, sensors: Sensors, log: &Path) -> Result<()> {
    let [gyro, acc, mag] = ["gyro", "acc", "mag"].map(|name| sensor(folder, walk, name));
    let (gyro, acc, mag) = (gyro?, acc?, mag?);
    let mut writer = CsvLogWriter::create(log, sensors)?;
    for (time, angular_rate_rad_s) in gyro {
        let (Some(specific_force_m_s2), Some(field_ut)) = (at(&acc, time), at(&mag, time)) else { continue };
        writer.push(&Observation::Imu(ImuSample { time, angular_rate_rad_s, specific_force_m_s2 }))?;
        if sensors == Sensors::ImuMagnetic {
            writer.push(&Observation::Magnetic(MagneticSample { time, field_ut }))?;
        }
    }
    writer.finish().context("joined log")
}

/// The waypoints as a truth on one level.
fn truth_of(waypoints: &Path) -> Result<String> {
    let text = fs::read_to_string(waypoints).with_context(|| waypoints.display().to_string())?;
    let mut truth = String::from("time_s,x_m,y_m,z_m\n");
    for line in text.lines().skip(1) {
        let mut fields = line.split(',');
        let mut next = || fields.next().context("short line");
        writeln!(truth, "{},{},{},0", next()?, next()?, next()?)?;
    }
    Ok(truth)
}

/// Errors, steps and way of one log.
fn judge(adit: &Path, log: &Path, truth: &Path) -> Result<(String, f64, f64)> {
    let (path, json) = (log.with_extension("tum"), log.with_extension("json"));
    let mut track = Command::new(adit);
    run(track.arg("track").arg(log).args(["--method", "pdr", "-o"]).arg(&path).arg("--json").arg(&json))?;
    let report: Value = serde_json::from_slice(&fs::read(&json)?)?;
    let mut eval = Command::new(adit);
    eval.arg("eval").arg(&path).arg("--truth").arg(truth).args(["--align", "se2", "--json"]);
    let errors: Value = serde_json::from_slice(&run(&mut eval)?)?;
    let number =
        |value: &Value, name: &str| value[name].as_f64().with_context(|| format!("no number {name}"));
    let [rmse, median, max] = ["rmse_2d_m", "median_2d_m", "max_2d_m"].map(|name| number(&errors, name));
    let shown = format!("{:.2} / {:.2} / {:.2}", rmse?, median?, max?);
    let told = &report["method_report"];
    Ok((shown, number(told, "steps")?, number(told, "distance_m")?))
}

/// What a command prints.
fn run(command: &mut Command) -> Result<Vec<u8>> {
    let output = command.output().with_context(|| format!("{command:?}"))?;
    ensure!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr).trim());
    Ok(output.stdout)
}

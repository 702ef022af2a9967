//! Runs `adit track --method pdr` over the recorded walks with a phone, and writes the errors at the waypoints as Markdown.
//!
//! `phone_walks ADIT DATA OUT.md` takes the program, the folder of the sets and the file to write. `ci/results.sh` calls it.
//!
//! The phone has a file for each sensor, on stamps of their own. Accelerometer and magnetometer are interpolated at the stamps of the
//! gyro; the joined log is tracked with one setting, with the magnetometer and without. Errors are those of `adit eval --align se2`: at the
//! waypoints, after one rotation and shift of the whole path.
//!
//! A second table is in the frame of the building, nothing aligned: the phone is declared as held with its top edge forward, the first waypoint
//! is told as a fix (or not), and signal strengths come with it: BLE by the places of the beacons and the path loss that `adit` takes for one that is
//! not calibrated, Wi-Fi by a map that `adit calibrate fingerprint` makes of the other walks, tracked through their waypoints. Every walk of the folder goes
//! through the same commands.

use adit_core::nalgebra::{Vector2, Vector3};
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
    for walk in &walks {
        let scratch = tempfile::tempdir()?;
        let truth = scratch.path().join("truth.csv");
        fs::write(&truth, truth_of(&folder.join(format!("{walk}{WAYPOINTS}")))?)?;
        let mut cells = Vec::new();
        let mut told = (0.0, 0.0);
        for sensors in [Sensors::ImuMagnetic, Sensors::Imu] {
            let log = scratch.path().join("joined_imu.csv");
            join(&folder, walk, sensors, &log)?;
            let (errors, steps, way_m) = judge(adit, &log, &truth)?;
            told = (steps, way_m);
            cells.push(errors);
        }
        writeln!(text, "| {walk} | {} | {:.1} | {} |", told.0, told.1, cells.join(" | "))?;
    }
    text += &in_the_building(adit, &folder, &walks)?;
    fs::write(out, text).with_context(|| out.display().to_string())
}

/// How a phone is held that is looked at, and the declination of Nuremberg in 2023.
const HELD: &str = "[mounting]\nlocation = \"hand\"\nrotation = \"x-right, y-forward, z-up\"\n\n[frame]\nmagnetic_declination_deg = 4.2\n";
/// A phone in the hand is this high over the floor; the place of beacons has no height but their floor.
const SETTINGS: &str = "[radio.locator]\nheight_m = 1.2\n";
/// From floor to floor, and of a beacon over its floor, m.
const HEIGHTS_M: (f64, f64) = (4.0, 2.5);
/// How well the place of a waypoint is known, m.
const WAYPOINT_SIGMA_M: f64 = 0.3;
/// The floor of all walks.
const FLOOR: f64 = -2.0;

/// Errors at the waypoints but the first, in the frame of the building, as a table.
pub fn in_the_building(adit: &Path, folder: &Path, walks: &[String]) -> Result<String> {
    let scratch = tempfile::tempdir()?;
    let file = |name: &str| scratch.path().join(name);
    fs::write(file("site.toml"), beacons(folder)?)?;
    fs::write(file("settings.toml"), SETTINGS)?;
    for walk in walks {
        join(folder, walk, Sensors::ImuMagnetic, &file(&format!("{walk}_imu.csv")))?;
        fs::write(file(&format!("{walk}_imu.toml")), HELD)?;
        let waypoints = waypoints(folder, walk)?;
        fs::write(file(&format!("{walk}_fixes.csv")), fixes(&waypoints))?;
        fs::write(file(&format!("{walk}_start.csv")), fixes(&waypoints[..1]))?;
        // The way through all waypoints, where the Wi-Fi of this walk was heard.
        fs::copy(folder.join(format!("{walk}_wifi.csv")), file(&format!("{walk}_rssi.csv")))?;
        let logs = [file(&format!("{walk}_imu.csv")), file(&format!("{walk}_fixes.csv"))];
        track(adit, &logs, &[], &file(&format!("{walk}_truth.tum")))?;
    }
    let mut text = String::from("\n| in the frame of the building: median / 75 %, m |");
    for walk in walks {
        write!(text, " {walk} |")?;
    }
    text += " all |\n|---|";
    text += &"---:|".repeat(walks.len() + 1);
    text.push('\n');
    for (name, start, ble, wifi) in [
        ("first waypoint told, no radio", true, false, false),
        ("first waypoint told, BLE", true, true, false),
        ("first waypoint told, Wi-Fi map of the others", true, false, true),
        ("no waypoint told, BLE", false, true, false),
        ("no waypoint told, BLE and Wi-Fi map of the others", false, true, true),
    ] {
        write!(text, "| {name} |")?;
        let mut all = Vec::new();
        for walk in walks {
            let mut logs = vec![file(&format!("{walk}_imu.csv"))];
            let mut known: Vec<(&str, PathBuf)> = vec![("--config", file("settings.toml"))];
            if start {
                logs.push(file(&format!("{walk}_start.csv")));
            }
            if ble {
                logs.push(folder.join(format!("{walk}_ble.csv")));
                known.push(("--mine", file("site.toml")));
            }
            if wifi {
                logs.push(folder.join(format!("{walk}_wifi.csv")));
                let map = file(&format!("{walk}_map.json"));
                if !map.exists() {
                    let others = walks.iter().filter(|other| *other != walk);
                    let mut calibrate = Command::new(adit);
                    calibrate.args(["calibrate", "fingerprint"]);
                    run(calibrate
                        .args(others.map(|other| file(&format!("{other}_rssi.csv"))))
                        .arg("-o")
                        .arg(&map))?;
                }
                known.push(("--radio", map));
            }
            let path = file("path.tum");
            track(adit, &logs, &known, &path)?;
            let path = adit_observation::truth::read(&path)?.trajectory;
            let error =
                |(time, place): &(Time, Vector2<f64>)| Some((path.at(*time)?.position_m.xy() - place).norm());
            let errors: Vec<f64> = waypoints(folder, walk)?.iter().skip(1).filter_map(error).collect();
            write!(text, " {} |", quartiles(errors.clone()))?;
            all.extend(errors);
        }
        writeln!(text, " {} |", quartiles(all))?;
    }
    Ok(text)
}

fn track(adit: &Path, logs: &[PathBuf], known: &[(&str, PathBuf)], out: &Path) -> Result<()> {
    let mut track = Command::new(adit);
    track.arg("track").args(logs).args(["--method", "pdr", "-o"]).arg(out);
    for (flag, file) in known {
        track.arg(flag).arg(file);
    }
    run(&mut track).map(drop)
}

/// Beacons of the building as a mine file.
fn beacons(folder: &Path) -> Result<String> {
    let file = folder.join("beacons.csv");
    let text = fs::read_to_string(&file).with_context(|| file.display().to_string())?;
    let mut site = String::from("name = \"museum\"\ngrid = { kind = \"local\" }\n");
    for line in text.lines().skip(1) {
        let [id, x, y, floor] = line.split(',').collect::<Vec<_>>()[..] else { bail!("{line}: four fields") };
        let up = HEIGHTS_M.0 * (floor.trim().parse::<f64>()? - FLOOR) + HEIGHTS_M.1;
        writeln!(site, "[[access_points]]\nid = \"{id}\"\nradio = \"ble\"\nposition_m = [{x}, {y}, {up}]")?;
    }
    Ok(site)
}

/// Time and place of every waypoint.
fn waypoints(folder: &Path, walk: &str) -> Result<Vec<(Time, Vector2<f64>)>> {
    let file = folder.join(format!("{walk}{WAYPOINTS}"));
    let text = fs::read_to_string(&file).with_context(|| file.display().to_string())?;
    let waypoint = |line: &str| {
        let numbers =
            line.split(',').take(3).map(|field| Ok(field.parse()?)).collect::<Result<Vec<f64>>>()?;
        let [seconds, x, y] = numbers[..] else { bail!("{line}: three numbers") };
        Ok((Time::from_seconds(seconds).context("no time")?, Vector2::new(x, y)))
    };
    text.lines().skip(1).map(waypoint).collect()
}

fn fixes(waypoints: &[(Time, Vector2<f64>)]) -> String {
    let row = |(time, place): &(Time, Vector2<f64>)| {
        format!("{time},{},{},{WAYPOINT_SIGMA_M},survey\n", place.x, place.y)
    };
    let rows: String = waypoints.iter().map(row).collect();
    format!("time_s,fix_east_m,fix_north_m,fix_sigma_m,fix_source\n{rows}")
}

/// Median and third quartile, by straight lines between ranks.
fn quartiles(mut errors: Vec<f64>) -> String {
    errors.sort_by(f64::total_cmp);
    let at = |share: f64| {
        let rank = share * (errors.len().max(1) - 1) as f64;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a rank in the list")]
        let low = rank.floor() as usize;
        let (a, b) = (errors.get(low), errors.get(low + 1).or(errors.get(low)));
        a.zip(b).map_or(f64::NAN, |(a, b)| a + (b - a) * rank.fract())
    };
    format!("{:.2} / {:.2}", at(0.5), at(0.75))
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

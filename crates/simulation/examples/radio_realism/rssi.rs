//! Signal strengths: slope, scatter, correlation in space, scatter in time; recorded, and simulated at the same places.

use super::Outcome;
use super::rows::Rows;
use super::stats::{deviation, line, median, quantile};
use adit_core::frames::Position;
use adit_core::nalgebra::Vector3;
use adit_mine::Mine;
use adit_mine::plan::{AccessPoint, Chamber, Grid, MinePlan, PathLoss, Radio, Roadway, RoadwayKind};
use adit_simulation::radio::{Antenna, RadioSpec, RadioWorld, Surroundings};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

/// Readings of one transmitter at one place.
struct Cell {
    place_m: [f64; 2],
    readings: Vec<f64>,
}

/// What readings show of one transmitter.
struct Shown {
    at_1m_dbm: f64,
    exponent: f64,
    scatter_db: f64,
    in_time_db: f64,
    correlation: [f64; 3],
}

/// Distances at which the correlation in space is told, m.
const LAGS_M: [f64; 3] = [0.6, 1.8, 4.8];

/// All sets.
pub fn table(data: &Path) -> Outcome<String> {
    let mut text = String::from(
        "| signal strength, medians over transmitters | source | exponent | scatter about the line, dB | in time at one place, dB | correlation at 0.6, 1.8, 4.8 m |\n|---|---|---|---|---|---|\n",
    );
    for hall in ["corridor", "office", "lecture_theatre"] {
        let (recorded, simulated) = grid(data, hall)?;
        for (source, shown) in [("recorded", recorded), ("simulated", simulated)] {
            text += &row(&format!("`rssi-corridor` {hall}"), source, &shown);
        }
    }
    text += &floors(data)?;
    text += &tracks(data)?;
    Ok(text)
}

fn row(set: &str, source: &str, shown: &[Shown]) -> String {
    let middle = |of: &dyn Fn(&Shown) -> f64| median(&shown.iter().map(of).collect::<Vec<_>>());
    let spread = |of: &dyn Fn(&Shown) -> f64| {
        let values: Vec<f64> = shown.iter().map(of).collect();
        format!("{:.1} ({:.1} to {:.1})", median(&values), quantile(&values, 0.0), quantile(&values, 1.0))
    };
    let correlation: Vec<String> =
        (0..3).map(|lag| format!("{:.2}", middle(&|s| s.correlation[lag]))).collect();
    format!(
        "| {set} | {source} | {} | {} | {:.1} | {} |\n",
        spread(&|s| s.exponent),
        spread(&|s| s.scatter_db),
        middle(&|s| s.in_time_db),
        correlation.join(", ")
    )
}

fn shown(cells: &[Cell], at_m: [f64; 2]) -> Option<Shown> {
    if cells.len() < 20 {
        return None;
    }
    let means: Vec<f64> =
        cells.iter().map(|c| c.readings.iter().sum::<f64>() / c.readings.len() as f64).collect();
    let decades: Vec<f64> = cells
        .iter()
        .map(|c| (c.place_m[0] - at_m[0]).hypot(c.place_m[1] - at_m[1]).max(0.5).log10())
        .collect();
    let (at_1m_dbm, slope, residuals) = line(&decades, &means);
    let scatter_db = deviation(&residuals);
    let correlation = LAGS_M.map(|lag| {
        let (mut sum, mut count) = (0.0, 0.0);
        for (i, a) in cells.iter().enumerate() {
            for (j, b) in cells.iter().enumerate().skip(i + 1) {
                let apart = (a.place_m[0] - b.place_m[0]).hypot(a.place_m[1] - b.place_m[1]);
                if (apart - lag).abs() < 0.1 {
                    sum += residuals[i] * residuals[j];
                    count += 1.0;
                }
            }
        }
        sum / count / (scatter_db * scatter_db)
    });
    let times: Vec<f64> = cells.iter().map(|c| deviation(&c.readings)).collect();
    Some(Shown { at_1m_dbm, exponent: -slope / 10.0, scatter_db, in_time_db: median(&times), correlation })
}

/// The grids of `rssi-corridor`, 60 scans a cell.
fn grid(data: &Path, hall: &str) -> Outcome<(Vec<Shown>, Vec<Shown>)> {
    let folder = data.join("rssi-corridor");
    let points = Rows::read(&folder.join(format!("{hall}_access_points.csv")))?;
    let scans = Rows::read(&folder.join(format!("{hall}_train.csv.gz")))?;
    let (mut recorded, mut simulated) = (Vec::new(), Vec::new());
    for point in 0..points.len() {
        let at_m = ["x_m", "y_m"].map(|name| points.number(point, name));
        let column = format!("{}_rssi_dBm", points.text(point, "ap"));
        let mut cells: BTreeMap<String, Cell> = BTreeMap::new();
        for scan in 0..scans.len() {
            let place_m = ["x_m", "y_m"].map(|name| scans.number(scan, name));
            let rssi = scans.number(scan, &column);
            if rssi.is_finite() {
                let cell =
                    cells.entry(format!("{place_m:?}")).or_insert(Cell { place_m, readings: Vec::new() });
                cell.readings.push(rssi);
            }
        }
        let cells: Vec<Cell> = cells.into_values().collect();
        let Some(found) = shown(&cells, at_m) else { continue };
        let again = simulate(at_m, &cells, &found, point as u64)?;
        simulated.extend(shown(&again, at_m));
        recorded.push(found);
    }
    Ok((recorded, simulated))
}

/// The same cells in a hall without walls, with the line of the recorded readings as path loss.
fn simulate(at_m: [f64; 2], cells: &[Cell], recorded: &Shown, seed: u64) -> Outcome<Vec<Cell>> {
    let mut plan = MinePlan::new("a hall", Grid::Local {});
    plan.chambers.push(Chamber {
        id: "hall".into(),
        name: None,
        floor_m: 0.0,
        height_m: 4.0,
        outline_m: vec![[-60.0, -60.0], [100.0, -60.0], [100.0, 100.0], [-60.0, 100.0]],
    });
    plan.roadways.push(Roadway {
        id: "path".into(),
        name: None,
        level: None,
        kind: RoadwayKind::Drift,
        width_m: 2.0,
        height_m: 3.0,
        max_slope_percent: None,
        walkable: true,
        points_m: vec![Position::new(0.0, 0.0, 0.0), Position::new(30.0, 0.0, 0.0)],
    });
    plan.access_points.push(AccessPoint {
        id: "ap".into(),
        radio: Radio::Wifi,
        mac: None,
        position_m: Position::new(at_m[0], at_m[1], 1.4),
        tx_power_dbm: None,
        path_loss: Some(PathLoss {
            rssi_at_1m_dbm: recorded.at_1m_dbm,
            exponent: recorded.exponent.max(0.1),
            breakpoint_m: None,
            exponent_beyond: None,
        }),
    });
    let mine = Mine::unchecked(plan);
    let world = RadioWorld::new(mine.clone(), &RadioSpec::default(), &[], seed)?;
    let mut tag = world.tag(seed);
    let (mut out, mut time_s) = (Vec::new(), 0.0);
    let mut again = Vec::new();
    for cell in cells {
        let mut readings = Vec::new();
        let antenna =
            Antenna { position_m: Vector3::new(cell.place_m[0], cell.place_m[1], 1.2), facing_rad: None };
        for _ in 0..60 {
            time_s += 1.0;
            out.clear();
            tag.scan(&world, time_s, &antenna, &Surroundings::default(), &mut out);
            readings.extend(out.iter().map(|s| s.rssi_dbm));
        }
        if !readings.is_empty() {
            again.push(Cell { place_m: cell.place_m, readings });
        }
    }
    Ok(again)
}

/// Slopes and scatter of `rssi-floors`, one reading a place: walls in between, which nothing here models.
fn floors(data: &Path) -> Outcome<String> {
    let folder = data.join("rssi-floors");
    let mut text = String::new();
    for building in ["hcxy", "cetc331"] {
        let points = Rows::read(&folder.join(format!("{building}_access_points.csv")))?;
        let places = Rows::read(&folder.join(format!("{building}_train.csv")))?;
        let mut found = Vec::new();
        for point in 0..points.len() {
            let at_m = ["x_m", "y_m"].map(|name| points.number(point, name));
            let id = points.text(point, "id_2g4");
            let column = format!("{id}_rssi_dBm");
            if id.is_empty() || !places.header().contains(&column) {
                continue;
            }
            let here = |row: &usize| places.text(*row, "floor") == points.text(point, "floor");
            let cells: Vec<Cell> = (0..places.len())
                .filter(here)
                .map(|row| Cell {
                    place_m: ["x_m", "y_m"].map(|name| places.number(row, name)),
                    readings: vec![places.number(row, &column)],
                })
                .filter(|cell| cell.readings[0].is_finite())
                .collect();
            found.extend(shown(&cells, at_m));
        }
        let of = |f: &dyn Fn(&Shown) -> f64| found.iter().map(f).collect::<Vec<_>>();
        let (exponent, scatter) = (of(&|s| s.exponent), of(&|s| s.scatter_db));
        let _ = writeln!(
            text,
            "| `rssi-floors` {building}, through walls | recorded | {:.1} ({:.1} to {:.1}) | {:.1} ({:.1} to {:.1}) | – | – |",
            median(&exponent),
            quantile(&exponent, 0.1),
            quantile(&exponent, 0.9),
            median(&scatter),
            quantile(&scatter, 0.1),
            quantile(&scatter, 0.9)
        );
    }
    Ok(text)
}

/// Slope and scatter of `ble-tracks`, all receivers together.
fn tracks(data: &Path) -> Outcome<String> {
    let folder = data.join("ble-tracks");
    let receivers = Rows::read(&folder.join("receivers.csv"))?;
    let (mut decades, mut values) = (Vec::new(), Vec::new());
    for track in ["straight_01", "straight_03", "straight_05", "rectangular_without_rotation"] {
        let readings = Rows::read(&folder.join(format!("{track}_rssi.csv")))?;
        let truth = Rows::read(&folder.join(format!("{track}_truth.csv")))?;
        let times = truth.numbers("time_s");
        for row in 0..readings.len() {
            let time_s = readings.number(row, "time_s");
            let at = times.partition_point(|t| *t < time_s).min(times.len() - 1);
            let receiver = (0..receivers.len())
                .find(|r| receivers.text(*r, "receiver") == readings.text(row, "receiver"));
            let Some(receiver) = receiver else { continue };
            let square: f64 = ["x_m", "y_m", "z_m"]
                .iter()
                .map(|name| (truth.number(at, name) - receivers.number(receiver, name)).powi(2))
                .sum();
            decades.push(square.sqrt().max(0.5).log10());
            values.push(readings.number(row, "rssi_dBm"));
        }
    }
    let (_, slope, residuals) = line(&decades, &values);
    Ok(format!(
        "| `ble-tracks`, {} packets | recorded | {:.1} | {:.1} | – | – |\n",
        values.len(),
        -slope / 10.0,
        deviation(&residuals)
    ))
}

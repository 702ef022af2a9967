//! Range errors, recorded and simulated on the same distances. Errors count from the median of the line-of-sight ranges of their own source:
//! antenna delays differ from device to device.

use super::Outcome;
use super::responses::{Response, exchanges, flat};
use super::rows::Rows;
use super::sites::{Class, Site};
use super::stats::{kolmogorov_smirnov, median, quantile};
use adit_simulation::radio::RadioSpec;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

/// Errors by class.
type Errors = BTreeMap<&'static str, Vec<f64>>;

/// All sets one under the other.
pub fn table(data: &Path, recorded: &[Response], simulated: &[Response]) -> Outcome<String> {
    let mut text = String::from(
        "| range error, m | class | source | median | 5 % | 95 % | middle half | tail index | KS |\n|---|---|---|---|---|---|---|---|---|\n",
    );
    let by_class = |responses: &[Response]| {
        let mut errors = Errors::new();
        for response in responses {
            errors.entry(response.class.name()).or_default().push(response.error_m);
        }
        errors
    };
    text += &rows("`uwb-cir`", by_class(recorded), by_class(simulated));
    let (recorded, sites) = industrial(data)?;
    let mut hall = flat();
    hall.uwb.multipath.echoes_db = 0.0;
    hall.uwb.multipath.early_db = -3.0;
    let mut simulated = Errors::new();
    for (seed, site) in (1_000..).zip(&sites) {
        for response in exchanges(site, &hall, seed, 10)? {
            let class = if site.class == Class::Los { "LOS" } else { "NLOS" };
            simulated.entry(class).or_default().push(response.error_m);
        }
    }
    text += &rows("`uwb-industrial`", recorded, simulated);
    text += "\n";
    text += &outdoor(data)?;
    text += "\n";
    text += &person(data)?;
    Ok(text)
}

fn rows(set: &str, recorded: Errors, simulated: Errors) -> String {
    let centred = |mut errors: Errors| {
        let zero = errors.get("LOS").map_or(0.0, |los| median(los));
        for error in errors.values_mut().flatten() {
            *error -= zero;
        }
        errors
    };
    let (recorded, simulated) = (centred(recorded), centred(simulated));
    let mut text = String::new();
    for (class, errors) in &recorded {
        let other = simulated.get(class).map_or(&[][..], Vec::as_slice);
        for (source, errors) in [("recorded", errors.as_slice()), ("simulated", other)] {
            let _ = writeln!(
                text,
                "| {set} | {class} | {source} | {:.2} | {:.2} | {:.2} | {:.2} | {:.1} | {} |",
                median(errors),
                quantile(errors, 0.05),
                quantile(errors, 0.95),
                quantile(errors, 0.75) - quantile(errors, 0.25),
                tail_index(errors),
                if source == "simulated" {
                    format!("{:.2}", kolmogorov_smirnov(&recorded[class], errors))
                } else {
                    String::new()
                },
            );
        }
    }
    text
}

/// Tail index α of Hill (1975) from the largest tenth: small is heavy, above 4 hardly heavier than normal.
fn tail_index(errors: &[f64]) -> f64 {
    let mut sorted: Vec<f64> = errors.iter().copied().filter(|e| e.is_finite()).collect();
    sorted.sort_by(|a, b| b.total_cmp(a));
    let count = sorted.len() / 10;
    let Some(border) = sorted.get(count).filter(|b| **b > 0.0) else { return f64::NAN };
    count as f64 / sorted[..count].iter().map(|e| (e / border).ln()).sum::<f64>()
}

/// Errors of the hall, and one site per link: NLOS links have pillars of all widths.
fn industrial(data: &Path) -> Outcome<(Errors, Vec<Site>)> {
    let rows = Rows::read(&data.join("uwb-industrial/ranges.csv.gz"))?;
    let (mut errors, mut sites) = (Errors::new(), BTreeMap::new());
    for row in 0..rows.len() {
        let number = |name| rows.number(row, name);
        let nlos = number("nlos") > 0.5;
        let error = number("range_m") - number("true_range_m");
        errors.entry(if nlos { "NLOS" } else { "LOS" }).or_default().push(error);
        let group = format!("{} {} {nlos}", rows.text(row, "tag_location_id"), rows.text(row, "anchor_id"));
        let count = sites.len();
        sites.entry(group.clone()).or_insert_with(|| Site {
            group,
            class: if !nlos {
                Class::Los
            } else if count % 2 == 0 {
                Class::Nlos
            } else {
                Class::Ndp
            },
            anchor_m: ["anchor_x_m", "anchor_y_m", "anchor_z_m"].map(number),
            tag_m: ["tag_x_m", "tag_y_m", "tag_z_m"].map(number),
        });
    }
    Ok((errors, sites.into_values().collect()))
}

/// Powers and errors over distance in the open, line of sight.
fn outdoor(data: &Path) -> Outcome<String> {
    let rows = Rows::read(&data.join("uwb-outdoor/static_ranges.csv.gz"))?;
    let mut open: RadioSpec = flat();
    // Hardly any echo in the open; what the set's radios send fits a channel at 4 GHz.
    open.uwb.multipath.echoes_db = -9.0;
    open.uwb.multipath.early_db = -9.0;
    open.uwb.frequency_ghz = 3.9936;
    open.uwb.shadowing_sigma_db = 0.5;
    let mut text = String::from(
        "| `uwb-outdoor`, LOS, medians | distance, m | received power, dBm | received − first path, dB | range error against 4 m, m |\n|---|---|---|---|---|\n",
    );
    let mut zero = [f64::NAN; 2];
    for distance in [4.0, 10.0, 20.0, 40.0, 60.0] {
        let of = |row: &usize| {
            rows.number(*row, "nlos") < 0.5
                && rows.number(*row, "tag_height_m") > 0.9
                && (rows.number(*row, "true_range_m") - distance).abs() < 1.1
        };
        let found: Vec<usize> = (0..rows.len()).filter(of).collect();
        let take = |f: &dyn Fn(usize) -> f64| median(&found.iter().map(|row| f(*row)).collect::<Vec<_>>());
        let rx = take(&|row| rows.number(row, "rx_power_dBm"));
        let difference =
            take(&|row| rows.number(row, "rx_power_dBm") - rows.number(row, "first_path_power_dBm"));
        let error = take(&|row| rows.number(row, "range_m") - rows.number(row, "true_range_m"));
        let site = |seed: u64| Site {
            group: String::new(),
            class: Class::Los,
            anchor_m: [0.0, 0.0, 1.5],
            tag_m: [distance, 0.1 * seed as f64, 1.5],
        };
        let mut simulated = Vec::new();
        for seed in 0..20 {
            simulated.extend(exchanges(&site(seed), &open, seed, 5)?);
        }
        let take = |f: &dyn Fn(&Response) -> f64| median(&simulated.iter().map(f).collect::<Vec<_>>());
        let told = [
            (rx, difference, error),
            (take(&|r| r.rx_power_dbm), take(&|r| r.features[7]), take(&|r| r.error_m)),
        ];
        for (which, (rx, difference, error)) in told.into_iter().enumerate() {
            if zero[which].is_nan() {
                zero[which] = error;
            }
            let source = ["recorded", "simulated"][which];
            let _ = writeln!(
                text,
                "| {source} | {distance:.0} | {rx:.1} | {difference:.1} | {:.2} |",
                error - zero[which]
            );
        }
    }
    Ok(text)
}

/// By how much a person in the way lengthens a range.
fn person(data: &Path) -> Outcome<String> {
    let folder = data.join("uwb-person");
    let anchors = Rows::read(&folder.join("anchors.csv"))?;
    let place = |anchor: usize| -> Option<[f64; 2]> {
        let row = (0..anchors.len()).find(|row| {
            anchors.text(*row, "setup") == "lab"
                && anchors.text(*row, "anchor").ends_with(&anchor.to_string())
        })?;
        Some(["x_m", "y_m"].map(|name| anchors.number(row, name)))
    };
    let error = |run: &str, anchor: usize| -> Outcome<f64> {
        let ranges = Rows::read(&folder.join(format!("lab_{run}_ranges.csv")))?;
        let truth = Rows::read(&folder.join(format!("lab_{run}_truth.csv")))?;
        let at = ["x_m", "y_m"].map(|name| median(&truth.numbers(name)));
        let anchor_at = place(anchor).ok_or("no such anchor")?;
        let distance = (at[0] - anchor_at[0]).hypot(at[1] - anchor_at[1]);
        Ok(median(&ranges.numbers(&format!("range_a{anchor}_m"))) - distance)
    };
    let mut shifts = Vec::new();
    for (run, anchor) in [("4vba0", 0), ("4vba12", 1), ("4vba2s", 2), ("4vba32", 3)] {
        shifts.push(error(run, anchor)? - error("4vnm", anchor)?);
    }
    let mut simulated = Vec::new();
    for seed in 0..60_u64 {
        let site = |class| Site {
            group: String::new(),
            class,
            anchor_m: [0.0, 0.0, 1.6],
            tag_m: [3.0 + 0.02 * seed as f64, 0.05 * seed as f64, 1.2],
        };
        let error = |class| -> Outcome<f64> {
            let errors: Vec<f64> =
                exchanges(&site(class), &flat(), seed, 9)?.iter().map(|r| r.error_m).collect();
            Ok(median(&errors))
        };
        let shift = error(Class::Nlos)? - error(Class::Los)?;
        simulated.extend(shift.is_finite().then_some(shift));
    }
    let listed: Vec<String> = shifts.iter().map(|s| format!("{s:.2}")).collect();
    Ok(format!(
        "| a person in the way lengthens a range by, m | |\n|---|---|\n| `uwb-person`, four anchors of the laboratory | {} |\n| simulated, obstacles 0.3 to 1.3 m wide: median (10 %, 90 %) | {:.2} ({:.2}, {:.2}) |\n",
        listed.join(", "),
        median(&simulated),
        quantile(&simulated, 0.1),
        quantile(&simulated, 0.9),
    ))
}

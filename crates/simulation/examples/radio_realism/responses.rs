//! Channel impulse responses: what can be measured of one, recorded and simulated.

use super::Outcome;
use super::rows::Rows;
use super::sites::{Class, Site, room};
use super::stats::{kolmogorov_smirnov, median, quantile};
use adit_core::nalgebra::Vector3;
use adit_simulation::radio::{Antenna, RadioSpec, RadioWorld, RangeDetail, Surroundings, UwbSpec};
use std::fmt::Write as _;
use std::io::Read;
use std::path::Path;

/// Names of the features, in order.
pub const FEATURES: [&str; 9] = [
    "first path to peak, taps",
    "rise 10 % to 90 % of the peak, taps",
    "mean excess delay, taps",
    "rms delay spread, taps",
    "kurtosis of the amplitude",
    "energy of the first 5 taps, share",
    "noise before the first path / peak, dB",
    "received − first path power, dB",
    "preamble symbols",
];

/// Rooms with other echoes and other pillars for each recorded geometry.
const ROOMS: u64 = 8;

/// What one response shows.
#[derive(Debug, Clone)]
pub struct Response {
    pub group: String,
    pub class: Class,
    pub features: [f64; 9],
    pub rx_power_dbm: f64,
    pub error_m: f64,
    /// Amplitude against the largest, from 10 taps before the first path.
    pub shape: Vec<f64>,
}

/// Features of 200 taps with the first path at this index among them.
fn features(amplitude: &[f64], first: f64, difference_db: f64, symbols: f64) -> Option<[f64; 9]> {
    let at = first.floor();
    if !(12.0..120.0).contains(&at) {
        return None;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "12 to 120")]
    let at = at as usize;
    let (peak_tap, peak) = amplitude
        .iter()
        .copied()
        .enumerate()
        .fold((0, 0.0), |best, now| if now.1 > best.1 { now } else { best });
    let before = &amplitude[..at - 4];
    let quiet = (before.iter().map(|a| a * a).sum::<f64>() / before.len() as f64).sqrt();
    let rise = |share: f64| amplitude.iter().position(|a| *a >= share * peak).unwrap_or(0) as f64;
    let window = &amplitude[at - 1..(at + 79).min(amplitude.len())];
    let power = |a: &f64| if *a > 4.0 * quiet { a * a } else { 0.0 };
    let sum: f64 = window.iter().map(power).sum();
    let moment = |about: f64, order: i32| -> f64 {
        window.iter().enumerate().map(|(k, a)| (k as f64 - about).powi(order) * power(a)).sum::<f64>() / sum
    };
    let mean = moment(0.0, 1);
    let average = window.iter().sum::<f64>() / window.len() as f64;
    let central =
        |order: i32| window.iter().map(|a| (a - average).powi(order)).sum::<f64>() / window.len() as f64;
    let early: f64 = amplitude[at - 1..at + 4].iter().map(power).sum();
    Some([
        peak_tap as f64 - first,
        rise(0.9) - rise(0.1),
        mean,
        moment(mean, 2).sqrt(),
        central(4) / central(2).powi(2),
        early / sum,
        20.0 * (quiet / peak).log10(),
        difference_db,
        symbols,
    ])
}

/// The responses of `uwb-cir`.
pub fn recorded(data: &Path) -> Outcome<Vec<Response>> {
    let folder = data.join("uwb-cir");
    let rows = Rows::read(&folder.join("meta.csv.gz"))?;
    let mut bytes = Vec::new();
    flate2::read::GzDecoder::new(std::fs::File::open(folder.join("cir_i16le.bin.gz"))?)
        .read_to_end(&mut bytes)?;
    let response = |(row, block): (usize, &[u8])| {
        let amplitude: Vec<f64> = block
            .chunks_exact(4)
            .map(|b| {
                f64::from(i16::from_le_bytes([b[0], b[1]])).hypot(f64::from(i16::from_le_bytes([b[2], b[3]])))
            })
            .collect();
        let number = |name| rows.number(row, name);
        let first = number("first_path_index_tap") - 700.0;
        let difference = number("rx_power_dBm") - number("first_path_power_dBm");
        // Some rows have an absurd power.
        let features = features(&amplitude, first, difference, number("preamble_count"))
            .filter(|f| (-1.0..40.0).contains(&f[7]))?;
        Some(Response {
            group: rows.text(row, "geometry_id").to_owned(),
            class: Class::ALL.into_iter().find(|c| c.name() == rows.text(row, "label"))?,
            features,
            rx_power_dbm: number("rx_power_dBm"),
            error_m: number("range_m") - number("true_range_m"),
            shape: shape(&amplitude, first),
        })
    };
    Ok(bytes.chunks_exact(800).enumerate().filter_map(response).collect())
}

/// Amplitudes against the largest, from 10 taps before the first path on.
fn shape(amplitude: &[f64], first: f64) -> Vec<f64> {
    let peak = amplitude.iter().copied().fold(0.0, f64::max);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "12 to 120")]
    let start = (first - 10.0).max(0.0) as usize;
    amplitude.iter().skip(start).take(80).map(|a| a / peak).collect()
}

/// What a flat does to UWB: stronger and earlier echoes than a roadway, and no bends.
pub fn flat() -> RadioSpec {
    let mut spec = RadioSpec {
        uwb: UwbSpec { missed: 0.0, outliers: 0.0, ..UwbSpec::default() },
        ..RadioSpec::default()
    };
    spec.uwb.multipath.echoes_db = -1.5;
    spec.uwb.multipath.early_db = 0.0;
    spec.uwb.multipath.early_ns = 2.5;
    spec.uwb.obstruction_excess_m = 0.0;
    spec.uwb.antenna_gain_db = 0.0;
    spec.uwb.multipath.blocked_echo_loss = 0.65;
    spec.uwb.most_way_m = 100.0;
    spec
}

/// Responses of rooms like these, each site in [`ROOMS`] rooms, `count` of each, the tag swaying by a centimetre.
pub fn simulated(sites: &[Site], count: u32) -> Outcome<Vec<Response>> {
    let mut responses = Vec::new();
    for (number, site) in (0..).zip(sites) {
        for room in 0..ROOMS {
            let site = Site { group: format!("{} in room {room}", site.group), ..site.clone() };
            responses.extend(exchanges(&site, &flat(), number * ROOMS + room, count)?);
        }
    }
    Ok(responses)
}

/// Exchanges with one site's anchor in a room of its own.
pub fn exchanges(site: &Site, spec: &RadioSpec, seed: u64, count: u32) -> Outcome<Vec<Response>> {
    let golden = 0.618_034 * seed as f64;
    let mine = room(site, golden.fract())?;
    let world = RadioWorld::new(mine.clone(), spec, &[], seed)?;
    let mut tag = world.tag(seed).with_detail(RangeDetail::ImpulseResponse);
    let (mut responses, mut out) = (Vec::new(), Vec::new());
    for epoch in 0..count {
        let time_s = f64::from(epoch);
        let sway = Vector3::new((1.3 * time_s).sin(), (0.7 * time_s).cos(), 0.0) * 0.005;
        let antenna = Antenna { position_m: Vector3::from(site.tag_m) + sway, facing_rad: None };
        out.clear();
        tag.ranges(&world, time_s, &antenna, &Surroundings::default(), &mut out);
        for outcome in &out {
            let Some(reception) = &outcome.sample.reception else { continue };
            let Some(response) = &reception.impulse_response else { continue };
            let number = |value: Option<f32>| value.map_or(f64::NAN, f64::from);
            let amplitude: Vec<f64> =
                response.taps.iter().map(|[i, q]| f64::from(*i).hypot(f64::from(*q))).collect();
            let first = number(reception.first_path_index_tap) - 700.0;
            let rx_power_dbm = number(reception.rx_power_dbm);
            let difference = rx_power_dbm - number(reception.first_path_power_dbm);
            let symbols = reception.preamble_count.map_or(f64::NAN, f64::from);
            let Some(features) = features(&amplitude, first, difference, symbols) else { continue };
            responses.push(Response {
                group: site.group.clone(),
                class: site.class,
                features,
                rx_power_dbm,
                error_m: outcome.sample.range_m - outcome.truth.distance_m,
                shape: shape(&amplitude, first),
            });
        }
    }
    Ok(responses)
}

/// The values of one feature in one class.
pub fn values(responses: &[Response], class: Class, feature: usize) -> Vec<f64> {
    responses.iter().filter(|r| r.class == class).map(|r| r.features[feature]).collect()
}

/// Medians, tenths and distances, feature by feature.
pub fn table(recorded: &[Response], simulated: &[Response]) -> String {
    let mut text = String::from(
        "| `uwb-cir`: median (10 %, 90 %) | class | recorded | simulated | KS | KS of two halves of the recorded geometries |\n|---|---|---|---|---|---|\n",
    );
    for (number, name) in FEATURES.iter().enumerate() {
        for class in Class::ALL {
            let (a, b) = (values(recorded, class, number), values(simulated, class, number));
            let told =
                |v: &[f64]| format!("{:.2} ({:.2}, {:.2})", median(v), quantile(v, 0.1), quantile(v, 0.9));
            let mut groups: Vec<&str> =
                recorded.iter().filter(|r| r.class == class).map(|r| r.group.as_str()).collect();
            groups.sort_unstable();
            groups.dedup();
            let half = |odd: usize| -> Vec<f64> {
                let of = |r: &&Response| {
                    groups.iter().position(|g| *g == r.group).is_some_and(|p| p % 2 == odd)
                        && r.class == class
                };
                recorded.iter().filter(of).map(|r| r.features[number]).collect()
            };
            let _ = writeln!(
                text,
                "| {name} | {} | {} | {} | {:.2} | {:.2} |",
                class.name(),
                told(&a),
                told(&b),
                kolmogorov_smirnov(&a, &b),
                kolmogorov_smirnov(&half(0), &half(1)),
            );
        }
    }
    text
}

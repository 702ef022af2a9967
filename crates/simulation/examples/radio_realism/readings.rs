//! What the receiver's model takes from the recorded responses: where the first path's index stands, and the scale of the powers.

use super::Outcome;
use super::rows::Rows;
use super::stats::quantile;
use std::fmt::Write as _;
use std::io::Read;
use std::path::Path;

/// Constant A of the manual for 64 MHz, dB.
const SCALE_DB: f64 = 121.74;

/// Medians and tenths of both.
pub fn table(data: &Path) -> Outcome<String> {
    let folder = data.join("uwb-cir");
    let rows = Rows::read(&folder.join("meta.csv.gz"))?;
    let mut bytes = Vec::new();
    flate2::read::GzDecoder::new(std::fs::File::open(folder.join("cir_i16le.bin.gz"))?)
        .read_to_end(&mut bytes)?;
    let (mut heights, mut powers) = ([const { Vec::new() }; 3], Vec::new());
    for (row, block) in bytes.chunks_exact(800).enumerate() {
        let amplitude: Vec<f64> = block
            .chunks_exact(4)
            .map(|b| {
                f64::from(i16::from_le_bytes([b[0], b[1]])).hypot(f64::from(i16::from_le_bytes([b[2], b[3]])))
            })
            .collect();
        let number = |name| rows.number(row, name);
        let symbols = number("preamble_count");
        let energy: f64 = amplitude.iter().map(|a| a * a).sum();
        powers.push(number("rx_power_dBm") - (10.0 * (energy / (symbols * symbols)).log10() - SCALE_DB));
        let first = number("first_path_index_tap") - 700.0;
        if !(15.0..150.0).contains(&first) {
            continue;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "15 to 150")]
        let tap = first as usize;
        let here = amplitude[tap] + first.fract() * (amplitude[tap + 1] - amplitude[tap]);
        let next = amplitude[tap + 1..tap + 4].iter().copied().fold(0.0, f64::max);
        let threshold = number("noise_threshold") / next;
        let third = usize::from(threshold > 0.1) + usize::from(threshold > 0.16);
        heights[third].push(here / next);
    }
    let told = |values: &[f64]| {
        format!("{:.2} ({:.2}, {:.2})", quantile(values, 0.5), quantile(values, 0.1), quantile(values, 0.9))
    };
    let mut text = String::from("| read off `uwb-cir` | median (10 %, 90 %) |\n|---|---|\n");
    for (values, of) in heights.iter().zip(["below 0.10", "0.10 to 0.16", "above 0.16"]) {
        let _ = writeln!(
            text,
            "| amplitude at the first path's index / next maximum, threshold {of} of that | {} |",
            told(values)
        );
    }
    let _ = writeln!(
        text,
        "| received power told − by the manual's formula from the taps, dB | {} |",
        told(&powers)
    );
    Ok(text)
}

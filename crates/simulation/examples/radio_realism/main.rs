//! How realistic simulated radio is: `radio_realism DATA OUT.md FIGURE.svg` compares it with recorded sets and writes tables and a figure.
//!
//! Sets: `uwb-cir`, `uwb-industrial`, `uwb-outdoor`, `uwb-person`, `rssi-corridor`, `rssi-floors`, `ble-tracks`. Recorded and simulated numbers
//! pass through the same code. Called by `ci/results.sh`.

mod classes;
mod figure;
mod ranges;
mod readings;
mod responses;
mod rows;
mod rssi;
mod sites;
mod stats;

use std::error::Error;
use std::path::PathBuf;

/// Whatever goes wrong ends the program.
pub type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> Outcome<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [data, out, picture] = arguments.as_slice() else {
        return Err("usage: radio_realism DATA OUT.md FIGURE.svg".into());
    };
    if !data.is_dir() {
        println!("SKIPPED (no test data): {}", data.display());
        return Ok(());
    }
    let recorded = responses::recorded(data)?;
    let simulated = responses::simulated(&sites::apartment(data)?, 20)?;
    let mut text = readings::table(data)?;
    text += "\n";
    text += &responses::table(&recorded, &simulated);
    text += "\n";
    text += &classes::table(&recorded, &simulated);
    text += "\n";
    text += &ranges::table(data, &recorded, &simulated)?;
    text += "\n";
    text += &rssi::table(data)?;
    std::fs::write(out, &text)?;
    std::fs::write(picture, figure::draw(&recorded, &simulated))?;
    print!("{text}");
    Ok(())
}

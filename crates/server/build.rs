//! Builds the server anew when the console was built anew.

use std::path::Path;

fn main() {
    let built = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../web/dist"));
    // A folder that is not there cannot be watched: cargo would build anew each time. Where it cannot be made, it does.
    let _ = std::fs::create_dir_all(built);
    println!("cargo::rerun-if-changed={}", built.display());
}

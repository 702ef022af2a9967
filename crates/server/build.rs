//! The console (`web/dist`, built by npm) goes into the library: cargo looks whether it has changed, also where there was none before.

fn main() {
    let built = concat!(env!("CARGO_MANIFEST_DIR"), "/../../web/dist");
    // Of a folder that is not there cargo would think that it changes all the time.
    if let Err(error) = std::fs::create_dir_all(built) {
        println!("cargo:warning={built}: {error}");
    }
    println!("cargo:rerun-if-changed={built}");
}

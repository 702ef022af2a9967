//! Compiles the protobuf schemas in `proto/` to Rust and to the descriptor set that MCAP files carry; no `protoc` needed.

use std::env;
use std::error::Error;
use std::fs;
use std::path::PathBuf;

const FOLDER: &str = "../../proto";
const SCHEMAS: [&str; 10] = [
    "adit/v1/vector3.proto",
    "adit/v1/imu.proto",
    "adit/v1/acceleration.proto",
    "adit/v1/magnetic.proto",
    "adit/v1/pressure.proto",
    "adit/v1/position_fix.proto",
    "adit/v1/radio.proto",
    "adit/v1/signal.proto",
    "adit/v1/range.proto",
    "adit/v1/sighting.proto",
];
/// What gateways send; no file carries it.
const PACKETS: &str = "adit/v1/batch.proto";

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed={FOLDER}");
    if env::var_os("CARGO_FEATURE_STD").is_none() {
        return Ok(());
    }
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or("OUT_DIR is not set")?);

    let mut compiler = protox::Compiler::new([FOLDER])?;
    compiler.include_imports(true).include_source_info(false).open_files(SCHEMAS)?;
    fs::write(out.join("adit_v1.descriptors"), compiler.encode_file_descriptor_set())?;

    // With comments, which become the documentation of the generated types.
    let descriptors = protox::compile(SCHEMAS.into_iter().chain([PACKETS]), [FOLDER])?;
    prost_build::Config::new()
        .compile_well_known_types()
        .include_file("schemas.rs")
        .compile_fds(descriptors)?;
    Ok(())
}

//! The JSON Schema of a mine file: `cargo run -p adit-mine --example mine_schema > schema/mine.schema.json`.
#![expect(clippy::print_stdout, reason = "an example that prints")]

fn main() {
    println!("{:#}", adit_mine::file::schema());
}

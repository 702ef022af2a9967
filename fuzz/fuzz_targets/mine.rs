#![no_main]

#[path = "../src/mine.rs"]
mod mine;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    mine::check_mine(bytes);
});

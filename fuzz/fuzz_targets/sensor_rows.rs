#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    adit_fuzz::check(adit_fuzz::parse_sensor_rows(bytes));
});

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| fixpair_fuzz::same::noise::run(data));

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| fixpair_fuzz::rooms::statistics::run(data));

//! libFuzzer's loop around [`palpate_fuzz::calibration`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| drop(palpate_fuzz::calibration(bytes)));

//! libFuzzer's loop around [`palpate_fuzz::readings`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| palpate_fuzz::readings(bytes));

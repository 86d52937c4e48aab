//! libFuzzer's loop around [`palpate_fuzz::frame`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| drop(palpate_fuzz::frame(bytes)));

//! libFuzzer's loop around [`palpate_fuzz::config`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| drop(palpate_fuzz::config(bytes)));

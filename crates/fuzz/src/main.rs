//! Runs libFuzzer on the fuzz target that the environment variable `FUZZ_READER` names.
#![no_main]

use std::sync::LazyLock;

use palpate_fuzz::{TARGETS, Target};

static TARGET: LazyLock<&Target> = LazyLock::new(|| {
    let name = std::env::var("FUZZ_READER").unwrap_or_default();
    let target = TARGETS.iter().find(|target| target.name == name);
    target.unwrap_or_else(|| panic!("FUZZ_READER=`{name}` is not the name of a reader"))
});

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| drop((TARGET.run)(bytes)));

//! The program under test.

use std::env;
use std::path::PathBuf;

use anyhow::Result;
use xshell::{Shell, cmd};

/// Where cargo puts what it builds.
pub(crate) fn target_dir(shell: &Shell) -> PathBuf {
    let target = env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
    shell.current_dir().join(target)
}

/// Builds the release binary and says where it lies.
pub(crate) fn build(shell: &Shell) -> Result<PathBuf> {
    cmd!(shell, "cargo build --release -p palpate")
        .quiet()
        .run()?;
    let binary = format!("palpate{}", env::consts::EXE_SUFFIX);
    Ok(target_dir(shell).join("release").join(binary))
}

//! Checks whether the tools that the tasks need are installed. Missing tools of Rust are installed with cargo or
//! rustup. Missing programs of the system are only reported.

use anyhow::{Context, Result};
use xshell::{Shell, cmd};

/// Compilation target for which palpate's libraries must compile. It has no threads, no vector instructions and no C
/// library.
pub(crate) const WASM: &str = "wasm32-unknown-unknown";
pub(crate) const DENY: &str = "cargo-deny";

/// Tools that are installed if they are missing: a command, the text that it prints if the tool is installed, and the
/// command that installs the tool.
const INSTALLED: [[&str; 3]; 3] = [
    [
        "cargo fmt --version",
        "rustfmt",
        "rustup component add rustfmt",
    ],
    [
        "cargo clippy --version",
        "clippy",
        "rustup component add clippy",
    ],
    [
        "rustup target list --installed",
        WASM,
        "rustup target add wasm32-unknown-unknown",
    ],
];

/// Optional programs: the program, a text about the check that is skipped without it, and the command that installs it.
/// `cargo xtask` does not install optional programs. For example, building cargo-deny would take longer than most
/// checks.
const OPTIONAL: [[&str; 3]; 3] = [
    [
        "valgrind",
        "instructions are not counted",
        "apt-get install valgrind",
    ],
    [
        "python3",
        "the Python package is not tested",
        "apt-get install python3-venv",
    ],
    [
        DENY,
        "licences are not checked",
        "cargo install cargo-deny --locked",
    ],
];

/// Installs missing tools of Rust, and reports missing programs of the system.
///
/// # Errors
/// An error if an installation fails.
pub(crate) fn prepare(shell: &Shell) -> Result<()> {
    for [probe, shows, install] in INSTALLED {
        if output(shell, probe).is_some_and(|text| text.contains(shows)) {
            continue;
        }
        println!("installing a missing tool: {install}");
        let (program, arguments) = words(install);
        cmd!(shell, "{program} {arguments...}")
            .run()
            .with_context(|| format!("`{probe}` does not show {shows}; try `{install}`"))?;
    }
    for [program, skipped, install] in OPTIONAL {
        if !has(shell, program) {
            println!("{skipped}: {program} is missing ({install})");
        }
    }
    // Fetch the crates for all platforms, so that licences can be checked without a network.
    cmd!(shell, "cargo fetch --quiet --locked").run()?;
    Ok(())
}

pub(crate) fn has(shell: &Shell, program: &str) -> bool {
    output(shell, &format!("{program} --version")).is_some()
}

fn output(shell: &Shell, command: &str) -> Option<String> {
    let (program, arguments) = words(command);
    let run = cmd!(shell, "{program} {arguments...}").quiet();
    run.ignore_stderr().read().ok()
}

fn words(command: &str) -> (&str, Vec<&str>) {
    let mut words = command.split(' ');
    (words.next().unwrap_or_default(), words.collect())
}

//! `palpate-replica ARCH CELLS TRIALS CONFIG...`: prints the tables of each config after a line `# NAME`.
#![allow(clippy::print_stdout, clippy::print_stderr)]

use std::path::Path;
use std::process::ExitCode;

use palpate::Arch;
use palpate_replica::{Extent, tables};

/// Status where the processor lacks the instructions that are asked for.
const LACKING: u8 = 3;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [arch, cells, trials, configs @ ..] = &arguments[..] else {
        eprintln!("usage: palpate-replica widest|scalar|v3|v4 CELLS TRIALS CONFIG...");
        return ExitCode::from(2);
    };
    let (Ok(cells), Ok(trials)) = (cells.parse(), trials.parse()) else {
        eprintln!("error: CELLS and TRIALS are whole numbers, not {cells} and {trials}");
        return ExitCode::from(2);
    };
    let arch = match arch_named(arch) {
        Ok(Some(arch)) => arch,
        Ok(None) => {
            eprintln!("this processor has no instructions {arch}");
            return ExitCode::from(LACKING);
        }
        Err(known) => {
            eprintln!("error: ARCH is one of {known}, not {arch}");
            return ExitCode::from(2);
        }
    };
    for config in configs {
        if let Err(message) = print(Path::new(config), Extent { cells, trials }, arch) {
            eprintln!("error: {config}: {message}");
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}

fn print(config: &Path, extent: Extent, arch: Arch) -> Result<(), String> {
    let text = std::fs::read_to_string(config).map_err(|error| error.to_string())?;
    let name = config.file_stem().unwrap_or_default().to_string_lossy();
    let tables = tables(&name, &text, extent, arch)?;
    print!("# {name}\n{tables}");
    Ok(())
}

/// Instructions of a name, where the processor has them.
///
/// # Errors
/// The names that there are on this kind of processor.
fn arch_named(name: &str) -> Result<Option<Arch>, &'static str> {
    match name {
        "widest" => Ok(Some(Arch::new())),
        "scalar" => Ok(Some(Arch::Scalar)),
        #[cfg(target_arch = "x86_64")]
        "v3" => Ok(pulp::x86::V3::try_new().map(Arch::V3)),
        #[cfg(target_arch = "x86_64")]
        "v4" => Ok(pulp::x86::V4::try_new().map(Arch::V4)),
        _ if cfg!(target_arch = "x86_64") => Err("widest, scalar, v3, v4"),
        _ => Err("widest, scalar"),
    }
}

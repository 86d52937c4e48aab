//! Tables of shortened studies as text, which must be equal on every host.

#[cfg(target_arch = "wasm32")]
mod exports;

use std::sync::atomic::AtomicBool;

use palpate::{Arch, RunOptions, Runner, Simulation, parse};

/// Extent to which a study is run.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    /// Most cells, spread over the study.
    pub cells: usize,
    /// Most trials of a cell.
    pub trials: u64,
}

/// Tables of a study that is cut short: cells, failures and, where the config asks for one, the map.
///
/// # Errors
/// A message, where the config is not valid or cannot be run.
pub fn tables(name: &str, config: &str, extent: Extent, arch: Arch) -> Result<String, String> {
    let mut study = parse(name, config).map_err(|error| error.to_string())?;
    let sweeps_trials = study.paths.iter().any(|path| path == "trials");
    if !sweeps_trials && study.config.trials > extent.trials {
        let shortened = study.override_trials(extent.trials);
        shortened.map_err(|error| error.to_string())?;
    }
    let stride = study.cell_count().div_ceil(extent.cells.max(1)).max(1);
    let cells = (0..study.cell_count()).step_by(stride);
    let runner = Runner::new(&RunOptions::default()).map_err(|error| error.to_string())?;
    let simulation = Simulation::new(&study, cells, &runner).map_err(|error| error.to_string())?;
    let ran = simulation
        .with_arch(arch)
        .run(&AtomicBool::new(false), &|_| ());
    let ran = ran.map_err(|error| error.to_string())?;
    let map = ran.map.map_or_else(String::new, |map| map.table.to_csv());
    Ok([ran.cells.to_csv(), ran.failures.to_csv(), map].concat())
}

//! Studies of a fingertip that explores a surface: load a config, run its cells, get the tables.
//!
//! Nothing here prints, exits, reads a clock or writes a file, and it runs where there are no threads (WebAssembly). The
//! program of this name (feature `cli`) adds arguments, files and a terminal.
//!
//! ```
//! let text = r#"
//! name = "a-ball"
//! length_unit = "mm"
//! seed = 1
//! trials = 100
//! [scene]
//! kind = "roll"
//! probe = { kind = "sphere", radius = 10.0 }
//! object = { kind = "sphere", radius = 30.0 }
//! motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
//! noise = { angular_velocity = { kind = "uniform", fraction = 0.05 } }
//! "#;
//! let study = palpate::config::parse("a-ball.toml", text)?;
//! let simulation = palpate::Simulation::new(&study, 0..study.cells.len())?;
//! let ran = simulation.run(&palpate::RunOptions::default(), &|_| ())?;
//! assert!(ran.cells().to_csv().starts_with("cell,quantity,unit,truth,"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod simulation;
mod tables;
mod trial;

pub use palpate_scene::{Arch, Scene};
pub use palpate_study::{Table, config};
pub use palpate_sweep::{CellStatistics, RunOptions, SweepError};
pub use simulation::{Map, Ran, Simulation};
pub use trial::SceneTrial;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;

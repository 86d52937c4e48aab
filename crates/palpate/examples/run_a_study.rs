//! Runs a study of three balls, and prints the error of their estimated curvature.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use palpate::{RunOptions, Runner, Simulation};

const STUDY: &str = r#"
name = "balls"
length_unit = "mm"
trials = 2000

[scene]
kind = "roll"
probe = { kind = "sphere", radius = 10.0 }
object = { kind = "sphere", radius = 20.0 }
motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
sensor = { kind = "pads", pitch = 0.1, offset = "random" }

[[sweep]]
path = "scene.object.radius"
values = [20.0, 40.0, 80.0]
"#;

fn main() -> Result<(), Box<dyn Error>> {
    let study = palpate::parse("balls.toml", STUDY)?;
    let runner = Runner::new(&RunOptions::default())?;
    let simulation = Simulation::new(&study, 0..study.cell_count(), &runner)?;

    // Another thread may set this flag to end the run.
    let cancelled = AtomicBool::new(false);
    let done = AtomicU64::new(0);
    let progress = |finished| {
        done.fetch_add(finished, Ordering::Relaxed);
    };
    let ran = simulation.run(&cancelled, &progress)?;
    println!("{} of {} trials", done.into_inner(), study.trials());

    for (cell, statistics) in study.cells().zip(&ran.statistics) {
        let radius = &cell.coordinates[0];
        let curvature = statistics.quantities[0];
        let error = curvature.relative_rms_error.ok_or("a ball is not flat")?;
        println!("radius {radius} mm: curvature to {:.1} %", 100.0 * error);
    }
    Ok(())
}

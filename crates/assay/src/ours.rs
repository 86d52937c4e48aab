//! Costs and errors of palpate on the tasks of its peers, on the same inputs: a line of JSON per rung, as the peers
//! print it.

mod figure;
mod glides;
mod patches;
mod presses;
mod rolls;
mod sights;

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;

use anyhow::{Context, Result, bail};
use serde_json::json;

use crate::hot;
use figure::{FRAMES, Figure, MANY, PATCHES};

/// Writes what the peers read: `few.csv`, `many.csv`, and frames with the places of their discs.
///
/// # Errors
/// If they cannot be written.
pub fn write_inputs(directory: &Path) -> Result<()> {
    fs::create_dir_all(directory)?;
    let mut few = table(directory, "few.csv", "patch,x,y,z")?;
    for patch in 0..PATCHES {
        for contact in hot::patches::few(patch) {
            let [x, y, z] = contact.position.coords.into();
            writeln!(few, "{patch},{x},{y},{z}")?;
        }
    }
    few.flush()?;
    let mut many = table(directory, "many.csv", "x,y,z")?;
    for contact in hot::patches::many(MANY) {
        let [x, y, z] = contact.position.coords.into();
        writeln!(many, "{x},{y},{z}")?;
    }
    many.flush()?;
    for size in FRAMES {
        let (frame, discs) = hot::camera::frame(size);
        fs::write(directory.join(format!("frame-{size}.rgb")), frame.as_raw())?;
        let mut truth = table(directory, &format!("frame-{size}.csv"), "x,y,hue_deg")?;
        for disc in discs {
            let [x, y] = disc.centroid_px;
            writeln!(truth, "{x},{y},{}", 360.0 * disc.hue_turns)?;
        }
        truth.flush()?;
    }
    Ok(())
}

fn table(directory: &Path, name: &str, header: &str) -> Result<BufWriter<File>> {
    let path = directory.join(name);
    let file = File::create(&path).with_context(|| format!("cannot write {}", path.display()))?;
    let mut table = BufWriter::new(file);
    writeln!(table, "{header}")?;
    Ok(table)
}

/// Times a group of tasks: a line of JSON per rung. Where a rung has a tolerance, it is the loosest that errs by at
/// most what `error_at_most` says of the task, or 1e-12.
///
/// # Errors
/// If there is no such group, or a rung cannot do its task.
pub fn lines(group: &str, error_at_most: &[(String, f64)]) -> Result<Vec<String>> {
    let figures = match group {
        "rolling-long" => rolls::long(error_at_most)?,
        "rolling-short" => rolls::short()?,
        "ep1-trial" => rolls::ep1()?,
        "ep2-few" => patches::few()?,
        "ep2-many" => patches::many()?,
        "python-glide" => glides::recorded()?,
        "press-contact" => presses::contact()?,
        "image" => sights::frames()?,
        _ => bail!("no group of tasks `{group}`"),
    };
    let line = |figure: Figure| {
        json!({
            "task": figure.task, "peer": figure.rung, "version": env!("CARGO_PKG_VERSION"),
            "time_us": figure.time_us, "error": figure.error,
        })
        .to_string()
    };
    Ok(figures.into_iter().map(line).collect())
}

//! Costs and errors of palpate on the tasks of its peers, on the same inputs: a line of JSON per rung, as the peers
//! print it.

mod glides;
mod patches;
mod presses;
mod rolls;

use std::fs::{self, File};
use std::hint::black_box;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result, bail};
use serde_json::json;

use crate::hot;
use crate::measured::Evaluation;

/// Number of patches with few contacts.
const PATCHES: u64 = 200;
/// Number of contacts of the large patch.
const MANY: usize = 100_000;
/// Side lengths of the frames, px.
const FRAMES: [usize; 2] = [640, 1024];
/// How long an evaluation is timed.
const PATIENCE: Duration = Duration::from_millis(200);

/// Cost and error of one rung on one task.
struct Figure {
    /// Name of the task, which the peers use too.
    task: String,
    rung: String,
    time_us: f64,
    /// Error as the peers define it for the task.
    error: f64,
}

impl Figure {
    /// Times `run`, which repeats the task `times` times.
    fn measured<T>(
        task: impl Into<String>,
        rung: impl Into<String>,
        error: f64,
        times: usize,
        run: impl FnMut() -> T + 'static,
    ) -> Self {
        let rung = rung.into();
        let spread = Evaluation::new(rung.clone(), run).time(PATIENCE);
        Self {
            task: task.into(),
            rung,
            time_us: spread.median * 1e-3 / times as f64,
            error,
        }
    }
}

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
        "image" => frames()?,
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

/// Finds the markers of frames with a dark background. The error is infinite if the number of markers found is wrong.
fn frames() -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for size in FRAMES {
        let (frame, discs) = hot::camera::frame(size);
        let mut finder = hot::camera::finder(size)?;
        let found = finder.find(&frame)?.markers;
        let error = match found.len() == discs.len() {
            true => hot::camera::errors(&found, &discs)[0],
            false => f64::INFINITY,
        };
        let task = format!("image, {size} px, 77 markers");
        figures.push(Figure::measured(task, "find", error, 1, move || {
            finder.find(black_box(&frame))
        }));
    }
    Ok(figures)
}

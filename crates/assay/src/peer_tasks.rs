//! Costs and errors of palpate on tasks that other programs (its peers) also solve, with the same inputs. The output is
//! one line of JSON per model, in the format of the peers' output.

mod contact_tasks;
mod roll_tasks;

use std::fs::{self, File};
use std::hint::black_box;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result, bail};
use palpate_press::{Body, PressError};
use serde_json::json;

use crate::timing::Evaluation;
use crate::workloads::marker_presses::markers;
use crate::workloads::{camera_frames, ep2_contacts};

/// Number of patches in the tasks that have few contacts per patch.
const PATCHES: u64 = 200;
/// Number of contacts in the task with one large patch.
const MANY: usize = 100_000;
/// Side lengths of the frames, px.
const FRAMES: [usize; 2] = [640, 1024];
const PATIENCE: Duration = Duration::from_millis(200);

const PRESS_TASK: &str = "press, contact and pressure";
const RADIUS: f64 = 20.0;
const DEPTH: f64 = 1.4;
const YOUNG: f64 = 1.0;
/// Number of points along a side of the square grid of the peer program Tamaas.
const POINTS: usize = 256;
/// Side (mm) of the square grid of the peer program Tamaas.
const SIDE: f64 = 16.0;

struct Figure {
    /// Name of the task, as in the output of the peer programs.
    task: String,
    rung: String,
    time_us: f64,
    /// Error of the model, defined like the errors of the peer programs.
    error: f64,
}

impl Figure {
    /// Measures the time of one task. Each call of `run` performs the task `times` times, so the time of a call is
    /// divided by `times`.
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

/// Writes the input files of the peers: `few.csv` and `many.csv` with contacts, and frames with the positions of their
/// discs.
///
/// # Errors
/// An error if a file cannot be written.
pub fn write_inputs(directory: &Path) -> Result<()> {
    fs::create_dir_all(directory)?;
    let mut few = table(directory, "few.csv", "patch,x,y,z")?;
    for patch in 0..PATCHES {
        for contact in ep2_contacts::few(patch) {
            let [x, y, z] = contact.position.coords.into();
            writeln!(few, "{patch},{x},{y},{z}")?;
        }
    }
    few.flush()?;
    let mut many = table(directory, "many.csv", "x,y,z")?;
    for contact in ep2_contacts::many(MANY) {
        let [x, y, z] = contact.position.coords.into();
        writeln!(many, "{x},{y},{z}")?;
    }
    many.flush()?;
    for size in FRAMES {
        let (frame, discs) = camera_frames::frame(size);
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

/// Measures the run times of a group of tasks, and returns one line of JSON per model. `error_at_most` contains the
/// largest allowed error of each task; for all other tasks, the largest allowed error is 1e-12. A model with a
/// tolerance uses the largest tolerance with which its error is within this limit.
///
/// # Errors
/// An error if no group of tasks has this name, or if a model fails on its task.
pub fn lines(group: &str, error_at_most: &[(String, f64)]) -> Result<Vec<String>> {
    let figures = match group {
        "rolling-long" => roll_tasks::long(error_at_most)?,
        "rolling-short" => roll_tasks::short()?,
        "ep1-trial" => roll_tasks::ep1()?,
        "ep2-few" => contact_tasks::few()?,
        "ep2-many" => contact_tasks::many()?,
        "python-glide" => contact_tasks::recorded()?,
        "press-contact" => contacts()?,
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

/// Measures the detection of markers in frames with a dark background. If the number of detected markers is wrong, the
/// reported error is infinite.
fn frames() -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for size in FRAMES {
        let (frame, discs) = camera_frames::frame(size);
        let mut finder = camera_frames::finder(size);
        let found = finder.find(&frame)?.markers;
        let error = match found.len() == discs.len() {
            true => camera_frames::errors(&found, &discs)[0],
            false => f64::INFINITY,
        };
        let task = format!("image, {size} px, 77 markers");
        figures.push(Figure::measured(task, "find", error, 1, move || {
            finder.find(black_box(&frame))
        }));
    }
    Ok(figures)
}

/// Measures the contact of a ball with a half-space: force, pressure, and the displacements at the points of the peer
/// program's grid or at a sensor's markers.
fn contacts() -> Result<Vec<Figure>> {
    let surface = Body::half_space(0.0, 0.0)?;
    let contact = surface.press(1.0 / RADIUS, DEPTH)?;
    // By Hertz's theory, the force is 2/3 π a² times the peak pressure, where a is the contact radius. The reference
    // for a follows from this equation, with the exact force and the contact's peak pressure.
    let peak = contact.peak_pressure(YOUNG).context("no pressure")?;
    let force = 4.0 / 3.0 * RADIUS.sqrt() * libm::pow(DEPTH, 1.5);
    let radius = (1.5 * force / (std::f64::consts::PI * peak)).sqrt();
    let error = (contact.radius / radius - 1.0).abs();

    let along = |index: usize| (index as f64 + 0.5) * SIDE / POINTS as f64 - 0.5 * SIDE;
    let grid: Vec<f64> = (0..POINTS * POINTS)
        .map(|index| libm::hypot(along(index / POINTS), along(index % POINTS)))
        .collect();
    let markers = markers()?;
    let below = Body::half_space(0.5, 2.0)?;
    Ok(vec![
        Figure::measured(
            PRESS_TASK,
            "half-space, 256 x 256 points moved",
            error,
            1,
            move || solve(&surface, &grid),
        ),
        Figure::measured(
            PRESS_TASK,
            "half-space, 77 markers moved",
            error,
            1,
            move || {
                let contact = below.press(1.0 / RADIUS, black_box(DEPTH))?;
                let pressure = (contact.force(YOUNG), contact.peak_pressure(YOUNG));
                Ok::<_, PressError>((pressure, markers.displacements(&contact, [0.0, 0.0])))
            },
        ),
    ])
}

type Contact = (Option<f64>, Option<f64>, Vec<f64>);

/// Computes the contact of the ball with `body`, and the displacements at the points of `grid`.
fn solve(body: &Body, grid: &[f64]) -> Result<Contact, PressError> {
    let contact = body.press(1.0 / RADIUS, black_box(DEPTH))?;
    let moved = grid.iter().map(|&r| contact.displacement(r).normal);
    let pressure = contact.peak_pressure(YOUNG);
    Ok((contact.force(YOUNG), pressure, moved.collect()))
}

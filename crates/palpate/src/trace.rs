//! One pass of a cell, written down.

use image::RgbImage;
use palpate_scene::press::PressFailure;
use palpate_scene::{Scene, Scenes, roll};
use palpate_study::Table;
use palpate_study::config::{ConfigError, Study};
use thiserror::Error;

use crate::error::{CellError, known_cell};

/// Truth of one pass, and what the sensor says of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Table `trace.csv`: the true contacts, or markers.
    pub contacts: Table,
    /// Table `readings.csv`, in the form that estimates from recorded readings accept.
    pub readings: Table,
    /// Pictures of a camera; `None` without one.
    pub seen: Option<SeenPress>,
    /// Words for what was followed: "404 contacts of 4 probes".
    pub what: String,
}

/// Pictures of a press that a camera took.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenPress {
    /// Table `markers.csv`: the sight of each marker.
    pub markers: Table,
    /// Frames at rest and pressed, if they were rendered.
    pub frames: Option<[RgbImage; 2]>,
}

/// Pass that cannot be followed.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TraceError {
    /// Cell without a scene.
    #[error(transparent)]
    Cell(#[from] CellError),
    /// Roll that ends early or that the sensor cannot read.
    #[error(transparent)]
    Roll(#[from] roll::TraceError),
    /// Press that does not come about or cannot be seen.
    #[error(transparent)]
    Press(#[from] PressFailure),
}

impl From<ConfigError> for TraceError {
    fn from(error: ConfigError) -> Self {
        Self::Cell(error.into())
    }
}

/// Follows one pass of a cell: noiseless, or as in trial number `trial`.
///
/// ```
/// let text = r#"
/// name = "a-ball"
/// length_unit = "mm"
/// [scene]
/// kind = "roll"
/// probe = { kind = "sphere", radius = 10.0 }
/// object = { kind = "sphere", radius = 30.0 }
/// motion = { rate_rad_per_s = 0.1, duration_s = 1.0, directions_deg = [0.0, 90.0] }
/// "#;
/// let study = palpate::parse("a-ball.toml", text)?;
/// let trace = palpate::trace(&study, 0, None)?;
/// assert_eq!(trace.what, "202 contacts of 2 probes");
/// assert!(palpate::trace(&study, 1, None).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`TraceError`].
pub fn trace(study: &Study, cell: usize, trial: Option<u64>) -> Result<Trace, TraceError> {
    known_cell(study, cell)?;
    let unit = study.config.length_unit;
    Ok(match study.scene(cell)? {
        Scene::Roll(roll) => {
            let trace = roll.trace(trial, unit)?;
            let probes = counted(&trace.readings, "probe");
            Trace {
                what: format!("{} of {probes}", counted(&trace.contacts, "contact")),
                contacts: trace.contacts,
                readings: trace.readings,
                seen: None,
            }
        }
        Scene::Glide(glide) => {
            let trace = glide.trace(trial, unit);
            let fingers = number_of(glide.fingers(), "finger");
            Trace {
                what: format!("{} of {fingers}", counted(&trace.contacts, "contact")),
                contacts: trace.contacts,
                readings: trace.readings,
                seen: None,
            }
        }
        Scene::Press(press) => {
            let trace = press.trace(trial, unit)?;
            let told = press.told_indentation(trial);
            let camera = press
                .px_per_rad()
                .map_or(String::new(), |f| format!(", seen with {f:.3} px per rad"));
            let read = match trace.readings.rows.len() {
                all if all == trace.contacts.rows.len() => String::new(),
                some => format!("{some} of "),
            };
            let markers = counted(&trace.contacts, "marker");
            let unit = unit.as_str();
            Trace {
                what: format!("{read}{markers} under an indentation told as {told} {unit}{camera}"),
                contacts: trace.contacts,
                readings: trace.readings,
                seen: trace.seen.map(|seen| SeenPress {
                    markers: seen.markers,
                    frames: seen.frames,
                }),
            }
        }
        Scene::Fingertip(_) => {
            let message = "a fingertip touches nothing: there is no pass to follow";
            return Err(study.error_at(0, "scene.kind", message).into());
        }
    })
}

fn counted(table: &Table, what: &str) -> String {
    number_of(table.rows.len(), what)
}

fn number_of(count: usize, what: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {what}{plural}")
}

//! Tables of true values and readings from one simulation of a scene.

use image::RgbImage;
use palpate_rolling::RollError;
use palpate_sensing::BeyondPads;
use palpate_study::Table;
use palpate_study::config::ConfigError;
use thiserror::Error;

use crate::press::PressFailure;

/// True values and sensor readings of one simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Table of true contacts or markers. Columns of a roll: `probe,t_s,object_x…,probe_x…,normal_x…,arc_length`.
    /// Columns of a glide: `finger,x,y,z,normal_x,normal_y,normal_z,tip_x,tip_y,tip_z`, where `tip` is the centre of
    /// the fingertip. Columns of a press: `marker,x,y,radial_position,normal_displacement,tangential_x,tangential_y`,
    /// where `radial_position` is the distance from the contact.
    pub contacts: Table,
    /// Table of readings, in a format that `palpate estimate` can read.
    pub readings: Table,
    /// Camera readings of a press; `None` if the press has no camera.
    pub camera: Option<CameraTrace>,
    /// Summary of the simulation as text, such as "404 contacts of 4 probes".
    pub what: String,
}

/// Camera readings of a press.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraTrace {
    /// Table of the markers' tracks:
    /// `marker,x_px,y_px,hue_turns,dx_px,dy_px,dhue_turns,status,mean_hue_turns,dmean_hue_turns`.
    pub markers: Table,
    /// The frame at rest and the pressed frame; `None` if no frames were rendered.
    pub frames: Option<[RgbImage; 2]>,
}

/// Reason why a simulation of a scene was not completed.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TraceError {
    /// The config has an invalid field, or the study has no cell with this number.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The simulation of a roll ended early.
    #[error("probe {probe}: {error}")]
    Roll {
        /// Index of the probe whose roll ended early, from 0.
        probe: usize,
        /// Reason why the roll ended early, with the time and the position of the end.
        error: RollError,
    },
    /// The sensor cannot read the contact of a probe.
    #[error("probe {probe}: {error}")]
    Sensor {
        /// Index of the probe whose contact cannot be read, from 0.
        probe: usize,
        /// Reason why the sensor cannot read the contact.
        error: BeyondPads,
    },
    /// The press is impossible, or the camera cannot image it.
    #[error(transparent)]
    Press(#[from] PressFailure),
    /// The object and the sensor have no contact in this scene.
    #[error("the scene has no contact, so there is no trial to trace")]
    Untouched,
}

/// Number and noun as text, such as "2 probes". `noun` is in the singular.
pub(crate) fn counted(count: usize, noun: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {noun}{plural}")
}

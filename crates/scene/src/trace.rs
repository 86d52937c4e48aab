//! Tables of one pass of a scene.

use image::RgbImage;
use palpate_rolling::RollError;
use palpate_sensing::BeyondPads;
use palpate_study::Table;
use thiserror::Error;

use crate::press::PressFailure;

/// True values and sensor readings of one pass.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// True contacts or markers. For a roll `probe,t_s,object_x…,probe_x…,normal_x…,arc_length`; for a glide
    /// `finger,x,y,z,normal_x,normal_y,normal_z,tip_x,tip_y,tip_z`, where `tip` is the tip's centre; for a press
    /// `marker,x,y,radial_position,normal_displacement,tangential_x,tangential_y`, where `radial_position` is the
    /// distance from the contact.
    pub contacts: Table,
    /// Readings, in the form that `estimate` accepts.
    pub readings: Table,
    /// Camera readings of a press; `None` without a camera.
    pub camera: Option<CameraTrace>,
    /// Summary of the pass, such as "404 contacts of 4 probes".
    pub what: String,
}

/// Camera readings of a press.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraTrace {
    /// The track of each marker: `marker,x_px,y_px,hue_turns,dx_px,dy_px,dhue_turns,status,mean_hue_turns,
    /// dmean_hue_turns`.
    pub markers: Table,
    /// The frames at rest and pressed, if they were rendered.
    pub frames: Option<[RgbImage; 2]>,
}

/// A pass that could not be completed.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TraceError {
    /// A roll ended early.
    #[error("probe {probe}: {error}")]
    Roll {
        /// Index of the probe, from 0.
        probe: usize,
        /// Reason, with the time and the place.
        error: RollError,
    },
    /// The sensor cannot read a contact.
    #[error("probe {probe}: {error}")]
    Sensor {
        /// Index of the probe, from 0.
        probe: usize,
        /// Reason in words.
        error: BeyondPads,
    },
    /// The press is impossible, or the camera cannot image it.
    #[error(transparent)]
    Press(#[from] PressFailure),
    /// The scene has no contact.
    #[error("the scene has no contact, so there is no pass to record")]
    Untouched,
}

/// A count with its noun, such as "2 probes"; `noun` is the singular.
pub(crate) fn counted(count: usize, noun: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {noun}{plural}")
}

//! One pass of a scene, written down.

use image::RgbImage;
use palpate_rolling::RollError;
use palpate_sensing::BeyondPads;
use palpate_study::Table;
use thiserror::Error;

use crate::press::PressFailure;

/// Truth of one pass, and what the sensor says of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Truth: contacts, or markers. Of a roll `probe,t_s,object_x…,probe_x…,normal_x…,arc_length`; of a glide
    /// `finger,x,y,z,normal_x,normal_y,normal_z,tip_x,tip_y,tip_z`, the tip being its centre; of a press
    /// `marker,x,y,radial_position,normal_displacement,tangential_x,tangential_y`, the radial position counted from the
    /// contact.
    pub contacts: Table,
    /// Readings, in the form that `estimate` accepts.
    pub readings: Table,
    /// Pictures of a camera; `None` without one.
    pub seen: Option<SeenPress>,
    /// Words for what was followed: "404 contacts of 4 probes".
    pub what: String,
}

/// Pictures of a press that a camera took.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenPress {
    /// The sight of each marker: `marker,x_px,y_px,hue_turns,dx_px,dy_px,dhue_turns,status`.
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
        /// Which probe, from 0.
        probe: usize,
        /// Reason, with the time and the place.
        error: RollError,
    },
    /// The sensor cannot read a contact.
    #[error("probe {probe}: {error}")]
    Sensor {
        /// Which probe, from 0.
        probe: usize,
        /// Reason in words.
        error: BeyondPads,
    },
    /// There is no press, or none to be seen.
    #[error(transparent)]
    Press(#[from] PressFailure),
    /// Nothing is touched.
    #[error("a fingertip touches nothing: there is no pass to follow")]
    Untouched,
}

/// Number of things in words, `what` being one of them.
pub(crate) fn counted(count: usize, what: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {what}{plural}")
}

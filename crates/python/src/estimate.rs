//! Computes estimates from arrays of readings.

mod batch;
mod glide;
mod press;
mod roll;
mod settings;

pub(crate) use batch::Batch;
pub(crate) use glide::{GlideEstimate, estimate_glide};

pub(crate) use press::{PressEstimate, estimate_press};
pub(crate) use roll::{RollEstimate, estimate_roll};
pub(crate) use settings::{given, length_unit, like};

//! Implements the command `palpate estimate`.

mod force;
mod glide;
mod like;
mod press;
mod roll;
mod summary;
mod table;

pub(crate) use force::force;
pub(crate) use glide::glide;
pub(crate) use like::Like;
pub(crate) use press::{picture_options, press, press_options};
pub(crate) use roll::roll;
pub(crate) use table::{table, warn};

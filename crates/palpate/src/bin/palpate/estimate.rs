//! `palpate estimate`.

mod glide;
mod like;
mod press;
mod roll;

pub(crate) use glide::glide;
pub(crate) use press::{press, press_options};
pub(crate) use roll::roll;

//! The spherical colour-marker sensor, forward: where its markers lie.

mod error;
mod layout;

pub use error::LayoutError;
pub use layout::{Layout, MOST_MARKERS};

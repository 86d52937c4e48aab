//! The spherical colour-marker sensor, forward: where its markers lie, and the flat pattern that its skin is cut from.

mod error;
mod layout;
mod pattern;

pub use error::LayoutError;
pub use layout::{Layout, MOST_MARKERS};
pub use pattern::{
    CuttingSheet, Discs, FEWEST_GORES, FlatPlace, FoldStrain, MOST_GORES, MOST_SAMPLES, Pattern,
    PatternError,
};

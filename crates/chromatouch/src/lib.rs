//! The spherical colour-marker sensor, forward: where its markers lie, the flat pattern that its skin is cut from, and
//! what its camera sees of displaced markers.

mod error;
mod layout;
mod optics;
mod pattern;
mod spacing;

pub use error::LayoutError;
pub use layout::{Layout, MOST_MARKERS};
pub use optics::{
    Blemishes, Camera, Colours, Departure, DiscDepths, DiscMotion, LARGEST_FRAME, Lens,
    MarkerArray, MarkerMotion, MarkerSlopes, OddTerms, Optics, OpticsError, Pose, Seams,
    SeenMarker,
};
pub use pattern::{
    CuttingSheet, Discs, FEWEST_GORES, FlatPlace, FoldStrain, MOST_GORES, MOST_SAMPLES, Pattern,
    PatternError,
};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;

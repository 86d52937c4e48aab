//! Simulation of the spherical colour-marker sensor: the layout of its markers, the flat pattern of its skin, and the
//! image of displaced markers in its camera.

mod error;
mod layout;
mod optics;
mod pattern;

pub use error::LayoutError;
pub use layout::Layout;
pub use optics::{
    Blemishes, Camera, Colours, Departure, DiscDepths, DiscMotion, Lens, MarkerArray, MarkerMotion,
    MarkerSlopes, OddTerms, Optics, OpticsError, Pose, Seams, SeenMarker,
};
pub use pattern::{CuttingSheet, Discs, FoldStrain, Pattern, PatternError};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;

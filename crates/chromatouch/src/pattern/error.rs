//! Errors of flat patterns.

use palpate_statistics::Number;
use strum::IntoStaticStr;
use thiserror::Error;

use super::{FEWEST_GORES, MOST_GORES};
use crate::LayoutError;

/// Reason why a flat pattern is impossible.
#[derive(Clone, Debug, Error, IntoStaticStr, PartialEq)]
#[strum(serialize_all = "kebab-case")]
pub enum PatternError {
    /// A setting is out of its range, or the layout is impossible.
    #[error(transparent)]
    #[strum(transparent)]
    Layout(#[from] LayoutError),
    /// There are too few gores. They would be so wide that folding stretches them to more than twice their length.
    #[error("gores is {gores}; it must be at least {FEWEST_GORES}{}", stretched(*.strain))]
    TooFewGores {
        /// Requested number of gores.
        gores: u32,
        /// Largest strain of a skin that is folded from this number of gores; `None` for 0 gores.
        strain: Option<f64>,
    },
    /// There are more gores than allowed.
    #[error("gores is {gores}; a pattern has at most {MOST_GORES}")]
    TooManyGores {
        /// Requested number of gores.
        gores: u32,
    },
    /// A marker is beyond the equator, where the gores end.
    #[error("marker {marker} lies {polar_deg:.4} degrees from the apex; the gores end at 90")]
    BeyondTheEquator {
        /// Index of the marker in the layout, from 0.
        marker: usize,
        /// Polar angle of the marker, degrees.
        polar_deg: f64,
    },
    /// The discs of two markers overlap on the flat pattern.
    #[error(
        "the discs of markers {first} and {second} overlap: their diameter is {diameter}, their \
         distance is {distance}",
        diameter = Number(*diameter), distance = Number(*distance)
    )]
    DiscsOverlap {
        /// Index of one marker in the layout, from 0.
        first: usize,
        /// Index of the other marker in the layout, from 0.
        second: usize,
        /// Distance (length) between the centres of the two markers' discs on the flat pattern.
        distance: f64,
        /// Diameter of the larger disc of each marker, length.
        diameter: f64,
    },
    /// A disc would be cut, because it crosses the edge of its gore. The disc at the apex is an exception.
    #[error(
        "the disc of marker {marker} would be cut: its diameter is {diameter}, but its centre is \
         only {distance} inside the gore's edge",
        diameter = Number(*diameter), distance = Number(*distance)
    )]
    DiscAcrossEdge {
        /// Index of the marker in the layout, from 0.
        marker: usize,
        /// Distance (length) from the disc's centre to the nearest edge of the gore.
        distance: f64,
        /// Diameter of the larger disc of the marker, length.
        diameter: f64,
    },
    /// The drawing is too small or too large for a file in millimetres.
    #[error(
        "the sphere's radius would be {radius_mm} mm; a drawing needs from {least} to {most}",
        radius_mm = Number(*radius_mm), least = Number(*least), most = Number(*most)
    )]
    NotDrawable {
        /// Radius of the sphere, mm.
        radius_mm: f64,
        /// Smallest allowed radius of the sphere in a drawing, mm.
        least: f64,
        /// Largest allowed radius of the sphere in a drawing, mm.
        most: f64,
    },
}

fn stretched(strain: Option<f64>) -> String {
    strain.map_or_else(String::new, |strain| {
        format!(
            " (folding would stretch gores of this width by up to {:.0} %)",
            100.0 * strain
        )
    })
}

impl PatternError {
    /// The stable name of this kind of error.
    pub fn name(&self) -> &'static str {
        self.into()
    }
}

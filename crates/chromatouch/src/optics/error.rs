//! Errors of the optics: impossible sensors and impossible motions of markers.

use palpate_statistics::{BadSetting, Number};
use strum::{IntoStaticStr, VariantNames};
use thiserror::Error;

/// Largest allowed absolute value of the coefficients k3 and k5 of a lens.
pub(super) const MOST_TERM: f64 = 100.0;

/// Reason why an image of the markers cannot be computed.
#[derive(Clone, Debug, Error, IntoStaticStr, PartialEq, VariantNames)]
#[strum(serialize_all = "kebab-case")]
pub enum OpticsError {
    /// A setting is out of its range.
    #[error(transparent)]
    BadSetting(#[from] BadSetting),
    /// With these coefficients k3 and k5, the distance from the image's centre does not increase with the angle from
    /// the axis everywhere in the field of view. Rays at two angles would then share one image point.
    #[error(
        "with k3 = {} and k5 = {} the image radius increases only up to {reach_deg:.4} degrees \
         from the axis, but the field ends at {field_deg:.4} degrees; {}",
        Number(*k3), Number(*k5), remedy(*least_k3)
    )]
    FoldedLens {
        /// Coefficient k3 of the third power of the angle in the lens's map.
        k3: f64,
        /// Coefficient k5 of the fifth power of the angle in the lens's map.
        k5: f64,
        /// Largest angle (degrees) from the axis up to which the distance from the image's centre increases with the
        /// angle.
        reach_deg: f64,
        /// Angle between the axis and the rim of the image circle, degrees.
        field_deg: f64,
        /// Smallest k3 for which the distance from the image's centre increases with the angle up to the rim of the
        /// image circle.
        least_k3: f64,
    },
    /// A disc would lie at or beyond the sensor's centre, or outside the sensor's skin.
    #[error(
        "the {disc} discs would lie {depth} under a skin of radius {radius}; it must be at least 0 and less than the radius",
        depth = Number(*depth), radius = Number(*radius)
    )]
    BadDepth {
        /// Colour of the disc with the wrong depth.
        disc: &'static str,
        /// Depth of the disc under the skin (length).
        depth: f64,
        /// Radius of the skin (length).
        radius: f64,
    },
    /// A marker would be half a turn or more away from the apex, or its place is not finite.
    #[error("marker {marker} is at ({}, {}) from the apex; its distance must be less than half a \
         turn, {limit}",
        Number(place[0]), Number(place[1]), limit = Number(*limit))]
    OffTheSkin {
        /// Index of the marker with the wrong place, from 0.
        marker: usize,
        /// Position of the marker on the skin (length), as the layout states it.
        place: [f64; 2],
        /// Half the circumference of the skin (length): the largest distance from the apex.
        limit: f64,
    },
    /// There are more markers than allowed.
    #[error("there would be {markers} markers; at most {limit} are possible")]
    TooManyMarkers {
        /// Number of markers of the sensor.
        markers: usize,
        /// Largest allowed number of markers of a sensor.
        limit: usize,
    },
    /// The discs of two markers overlap as viewed from the centre of the sensor.
    #[error(
        "the discs of markers {first} and {second} overlap: their diameter is {diameter}, their \
         distance is {distance}",
        diameter = Number(*diameter), distance = Number(*distance)
    )]
    DiscsOverlap {
        /// Index of one of the two markers, from 0.
        first: usize,
        /// Index of the other marker, from 0.
        second: usize,
        /// Distance between the centres of the two overlapping discs (length).
        distance: f64,
        /// Diameter of the two overlapping discs (length). The check uses the colour whose discs have the larger
        /// angular radius.
        diameter: f64,
    },
    /// The number of displacements that the caller passed differs from the number of markers.
    #[error(
        "the number of displacements is {motions}; it must be the number of markers, {markers}"
    )]
    WrongCount {
        /// Number of displacements that the caller passed.
        motions: usize,
        /// Number of markers of the sensor.
        markers: usize,
    },
    /// The motion of a disc is not finite, or is at least as long as the disc's distance from the sensor's centre.
    #[error(
        "the {disc} disc of marker {marker} would move by {motion}; the motion must be less than \
         its distance from the centre, {distance}",
        motion = Number(*motion), distance = Number(*distance)
    )]
    ImpossibleMotion {
        /// Index of the marker with the impossible motion, from 0.
        marker: usize,
        /// Colour of the disc with the impossible motion.
        disc: &'static str,
        /// Length of the impossible motion. It is the displacement of the disc normal to the skin or along it, or the
        /// displacement of the disc's edge.
        motion: f64,
        /// The disc's distance (length) from the sensor's centre at rest.
        distance: f64,
    },
}

impl OpticsError {
    pub(super) fn unless(
        holds: bool,
        setting: &'static str,
        value: f64,
        expected: &'static str,
    ) -> Result<f64, Self> {
        Ok(BadSetting::unless(holds, setting, value, expected)?)
    }

    /// Name of the wrong setting in the config, if a setting is the reason.
    pub const fn setting(&self) -> Option<&'static str> {
        match self {
            Self::BadSetting(BadSetting { setting, .. }) => Some(setting),
            Self::BadDepth { .. } => Some("separation"),
            Self::FoldedLens { .. } => Some("k3"),
            _ => None,
        }
    }
}

/// Text that recommends the smallest valid k3. The value is rounded up, so that the displayed value is valid too.
fn remedy(least_k3: f64) -> String {
    match least_k3 <= MOST_TERM {
        true => format!(
            "with this k5 and this field, k3 must be at least {:.4}",
            (least_k3 * 1e4).ceil() / 1e4
        ),
        false => "with this k5 and this field, no k3 is large enough".to_owned(),
    }
}

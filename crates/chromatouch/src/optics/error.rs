//! Errors of the optics: impossible sensors and impossible motions of markers.

use palpate_statistics::{BadSetting, Number};
use strum::{IntoStaticStr, VariantNames};
use thiserror::Error;

/// Largest absolute value of an odd term of a lens.
pub(super) const MOST_TERM: f64 = 100.0;

/// Reason why there is no image of the markers.
#[derive(Clone, Debug, Error, IntoStaticStr, PartialEq, VariantNames)]
#[strum(serialize_all = "kebab-case")]
pub enum OpticsError {
    /// A setting is out of its range.
    #[error(transparent)]
    BadSetting(#[from] BadSetting),
    /// With these odd terms, the distance from the image's centre decreases with the angle within the field, so that
    /// two angles would have the same image.
    #[error(
        "with k3 = {} and k5 = {} the image radius grows only up to {reach_deg:.4} degrees from the axis, and \
         the field ends at {field_deg:.4}; {}",
        Number(*k3), Number(*k5), remedy(*least_k3)
    )]
    FoldedLens {
        /// Term of the third power.
        k3: f64,
        /// Term of the fifth power.
        k5: f64,
        /// Largest angle up to which the image radius grows, degrees.
        reach_deg: f64,
        /// Angle at the rim of the image circle, degrees.
        field_deg: f64,
        /// Smallest k3 with which the image radius grows up to the rim.
        least_k3: f64,
    },
    /// A disc would lie at or beyond the sensor's centre, or outside its skin.
    #[error(
        "the {disc} discs would lie {depth} under a skin of radius {radius}; it must be at least 0 and less than the radius",
        depth = Number(*depth), radius = Number(*radius)
    )]
    BadDepth {
        /// Which disc of a marker.
        disc: &'static str,
        /// Its depth, length.
        depth: f64,
        /// Radius of the skin, length.
        radius: f64,
    },
    /// A marker would lie half a turn or more from the apex, or its place is not finite.
    #[error("marker {marker} lies at ({}, {}) from the apex; it must be less than half a turn away, {limit}",
        Number(place[0]), Number(place[1]), limit = Number(*limit))]
    OffTheSkin {
        /// Index of the marker, from 0.
        marker: usize,
        /// Place of the marker, length.
        place: [f64; 2],
        /// Half the way around the skin, length.
        limit: f64,
    },
    /// There are more markers than the limit.
    #[error("there would be {markers} markers; at most {limit} are possible")]
    TooManyMarkers {
        /// Number of markers.
        markers: usize,
        /// Largest allowed number.
        limit: usize,
    },
    /// Two discs overlap in the view from the centre.
    #[error(
        "the discs of markers {first} and {second} are {diameter} across and {distance} apart: they would overlap",
        diameter = Number(*diameter), distance = Number(*distance)
    )]
    DiscsOverlap {
        /// One marker, from 0.
        first: usize,
        /// The other.
        second: usize,
        /// Distance between the centres of their discs, length.
        distance: f64,
        /// Diameter of those discs, length. Only the discs of the colour with the larger angular size are compared.
        diameter: f64,
    },
    /// The number of motions differs from the number of markers.
    #[error("there are motions of {motions} markers, and {markers} markers")]
    WrongCount {
        /// Number of motions.
        motions: usize,
        /// Number of markers.
        markers: usize,
    },
    /// The motion of a disc is as long as its distance from the centre or longer, or is not finite.
    #[error(
        "the {disc} disc of marker {marker} would move by {motion} at {distance} from the centre",
        motion = Number(*motion), distance = Number(*distance)
    )]
    ImpossibleMotion {
        /// Index of the marker, from 0.
        marker: usize,
        /// Colour of the disc.
        disc: &'static str,
        /// Normal motion, tangential motion, or motion of the disc's edge, length.
        motion: f64,
        /// The disc's distance from the centre at rest, length.
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

    /// The stable name of this kind of error.
    pub fn name(&self) -> &'static str {
        self.into()
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

/// Advice on the smallest valid k3. It is rounded up, so that the printed value is valid too.
fn remedy(least_k3: f64) -> String {
    match least_k3 <= MOST_TERM {
        true => format!(
            "with this k5 and this field, k3 must be at least {:.4}",
            (least_k3 * 1e4).ceil() / 1e4
        ),
        false => "with this k5 and this field, no k3 is large enough".to_owned(),
    }
}

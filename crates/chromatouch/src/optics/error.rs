//! Sensors that no camera can look at, and motions that no marker can make.

use palpate_statistics::{BadSetting, Number};
use strum::{IntoStaticStr, VariantNames};
use thiserror::Error;

/// Largest size of an odd term of a lens.
pub(super) const MOST_TERM: f64 = 100.0;

/// Why a camera sees nothing.
#[derive(Clone, Debug, Error, IntoStaticStr, PartialEq, VariantNames)]
#[strum(serialize_all = "kebab-case")]
pub enum OpticsError {
    /// A setting is out of its range.
    #[error(transparent)]
    BadSetting(#[from] BadSetting),
    /// A lens whose odd terms let the image turn back within its field: angles beyond would be seen twice.
    #[error(
        "with k3 = {} and k5 = {} the lens sees angles once up to {reach_deg:.4} degrees from its axis, and its field ends at {field_deg:.4}; {}",
        Number(*k3), Number(*k5), remedy(*least_k3)
    )]
    FoldedLens {
        /// Term of the third power.
        k3: f64,
        /// Term of the fifth power.
        k5: f64,
        /// Angle up to which the image grows, degrees.
        reach_deg: f64,
        /// Angle that its rim is meant to show, degrees.
        field_deg: f64,
        /// Least term of the third power with which the image grows up to there.
        least_k3: f64,
    },
    /// A disc would lie at or beyond the sensor's centre, or outside its skin.
    #[error(
        "the {disc} discs would lie {depth} under a skin of radius {radius}; {expected}",
        depth = Number(*depth), radius = Number(*radius)
    )]
    BadDepth {
        /// Which disc of a marker.
        disc: &'static str,
        /// Its depth, length.
        depth: f64,
        /// Radius of the skin, length.
        radius: f64,
        /// Allowed depths, in words.
        expected: &'static str,
    },
    /// A marker would lie half a turn or more from the apex, or at no number.
    #[error("marker {marker} lies at ({}, {}) from the apex; it must be less than half a turn away, {limit}",
        Number(place[0]), Number(place[1]), limit = Number(*limit))]
    OffTheSkin {
        /// Which marker, from 0.
        marker: usize,
        /// Its place, length.
        place: [f64; 2],
        /// Half the way around the skin, length.
        limit: f64,
    },
    /// More markers than can be worked with.
    #[error("there would be {markers} markers; at most {limit} are possible")]
    TooManyMarkers {
        /// How many there would be.
        markers: usize,
        /// The most that there may be.
        limit: usize,
    },
    /// Two discs cover each other as seen from the centre.
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
        /// Diameter of those discs, length: the pair that looks larger from the centre.
        diameter: f64,
    },
    /// The number of motions is not that of the markers.
    #[error("there are motions of {motions} markers, and {markers} markers")]
    WrongCount {
        /// How many motions there are.
        motions: usize,
        /// How many markers.
        markers: usize,
    },
    /// A disc would move by its distance from the centre or more, or by no number.
    #[error(
        "the {disc} disc of marker {marker} would move by {motion} at {distance} from the centre",
        motion = Number(*motion), distance = Number(*distance)
    )]
    ImpossibleMotion {
        /// Which marker, from 0.
        marker: usize,
        /// Which of its discs.
        disc: &'static str,
        /// The normal or tangential motion, or that of its edge, length.
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

    /// The setting that is wrong, as in the config, if it is one.
    pub const fn setting(&self) -> Option<&'static str> {
        match self {
            Self::BadSetting(BadSetting { setting, .. }) => Some(setting),
            Self::BadDepth { .. } => Some("separation"),
            Self::FoldedLens { .. } => Some("k3"),
            _ => None,
        }
    }
}

/// Advice on the term of the third power that would be right, rounded up so that it is.
fn remedy(least_k3: f64) -> String {
    match least_k3 <= MOST_TERM {
        true => format!(
            "for this field k3 must be at least {:.4} beside this k5",
            (least_k3 * 1e4).ceil() / 1e4
        ),
        false => "for this field no k3 is large enough beside this k5".to_owned(),
    }
}

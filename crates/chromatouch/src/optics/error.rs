//! Sensors that no camera can look at, and motions that no marker can make.

use thiserror::Error;

/// Why a camera sees nothing.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum OpticsError {
    /// A setting is out of its range.
    #[error("{setting} is {value}; it must be {expected}")]
    BadSetting {
        /// Name of the setting, as in the config.
        setting: &'static str,
        /// Its value.
        value: f64,
        /// Allowed values, in words.
        expected: &'static str,
    },
    /// A disc would lie at or beyond the sensor's centre, or outside its skin.
    #[error("the {disc} discs would lie {depth} under a skin of radius {radius}; {expected}")]
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
    #[error(
        "marker {marker} lies at ({}, {}) from the apex; it must be less than half a turn away, {limit}",
        place[0], place[1]
    )]
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
        "the discs of markers {first} and {second} are {diameter} across and {distance} apart: they would overlap"
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
        "the {disc} disc of marker {marker} would move by {motion} at {distance} from the centre"
    )]
    ImpossibleMotion {
        /// Which marker, from 0.
        marker: usize,
        /// Which of its discs.
        disc: &'static str,
        /// The normal or tangential motion, length.
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
        if holds {
            return Ok(value);
        }
        Err(Self::BadSetting {
            setting,
            value,
            expected,
        })
    }

    /// The stable name of this kind of error.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::BadSetting { .. } => "bad-setting",
            Self::BadDepth { .. } => "bad-depth",
            Self::OffTheSkin { .. } => "off-the-skin",
            Self::TooManyMarkers { .. } => "too-many-markers",
            Self::DiscsOverlap { .. } => "discs-overlap",
            Self::WrongCount { .. } => "wrong-count",
            Self::ImpossibleMotion { .. } => "impossible-motion",
        }
    }

    /// The setting that is wrong, as in the config, if it is one.
    pub const fn setting(&self) -> Option<&'static str> {
        match self {
            Self::BadSetting { setting, .. } => Some(setting),
            Self::BadDepth { .. } => Some("separation"),
            _ => None,
        }
    }
}

//! Errors of marker layouts.

use palpate_statistics::{BadSetting, Number};
use strum::IntoStaticStr;
use thiserror::Error;

/// Reason why a marker layout is impossible.
#[derive(Clone, Debug, Error, IntoStaticStr, PartialEq)]
#[strum(serialize_all = "kebab-case")]
pub enum LayoutError {
    /// A setting of the layout is out of its range.
    #[error(transparent)]
    BadSetting(#[from] BadSetting<String>),
    /// A row of markers would reach or pass the point opposite the apex.
    #[error(
        "the markers would reach {reach_deg:.4} degrees from the apex; it must be less than 180",
        reach_deg = Number(*reach_deg)
    )]
    AroundTheSphere {
        /// Name of the setting that makes the row too long.
        setting: &'static str,
        /// Angle (degrees) at the sphere's centre between the apex and the farthest marker; the limit is 180.
        reach_deg: f64,
    },
    /// The layout places its markers by angles at the sensor's centre, but the skin is flat, so there is no centre.
    #[error(
        "needs a skin with a radius, because its markers are placed by angles; for a flat skin, use the layout \
         {{ kind = \"grid\", pitch = .., width = .., height = .. }}"
    )]
    NoAngles,
    /// The layout has more markers than allowed.
    #[error(
        "there would be {markers:.0} markers; at most {limit} are possible",
        markers = Number(*markers)
    )]
    TooManyMarkers {
        /// Number of markers that the layout would have.
        markers: f64,
        /// Largest allowed number of markers in a layout.
        limit: usize,
    },
    /// The markers are so far apart that no marker lies on the cap.
    #[error(
        "no marker lies within {cap_deg} degrees of the apex at a pitch of {pitch}",
        cap_deg = Number(*cap_deg), pitch = Number(*pitch)
    )]
    NoMarker {
        /// Distance between neighbouring markers (length).
        pitch: f64,
        /// Polar angle of the rim of the cap that contains the markers, degrees.
        cap_deg: f64,
    },
}

impl LayoutError {
    pub(crate) fn unless(
        holds: bool,
        setting: &'static str,
        value: f64,
        expected: &str,
    ) -> Result<f64, Self> {
        Ok(BadSetting::unless(holds, setting, value, expected)?)
    }

    /// Name of the wrong setting in the config, if a setting is the reason.
    pub const fn setting(&self) -> Option<&'static str> {
        match self {
            Self::BadSetting(BadSetting { setting, .. })
            | Self::AroundTheSphere { setting, .. } => Some(setting),
            Self::NoMarker { .. } => Some("pitch"),
            Self::TooManyMarkers { .. } | Self::NoAngles => None,
        }
    }
}

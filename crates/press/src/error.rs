//! Errors of impossible presses, and of readings that do not determine a curvature.

use palpate_statistics::{BadSetting, Number};
use strum::{IntoStaticStr, VariantNames};
use thiserror::Error;

/// Reasons why a press is impossible, or why its curvature cannot be estimated.
#[derive(Clone, Copy, Debug, Error, IntoStaticStr, PartialEq, VariantNames)]
#[strum(serialize_all = "kebab-case")]
pub enum PressError {
    /// A setting is out of its range.
    #[error(transparent)]
    BadSetting(#[from] BadSetting),
    /// A reading, or a value computed from it, is not a finite number.
    #[error("marker {marker} (counting from 0): a number is not finite, or beyond 1e50")]
    NotFinite {
        /// Number of the marker, counted from 0.
        marker: usize,
    },
    /// A marker lies beyond the pole of the skin opposite the apex.
    #[error(
        "marker {marker} (counting from 0) lies {distance} from the apex along the skin, whose other pole is at {limit}",
        distance = Number(*distance), limit = Number(*limit)
    )]
    OffSkin {
        /// Number of the marker, counted from 0.
        marker: usize,
        /// Distance from the apex, length.
        distance: f64,
        /// Half the sensor's circumference, length.
        limit: f64,
    },
    /// The bodies do not press into each other.
    #[error(
        "the indentation is {indentation}; a contact needs one > 0",
        indentation = Number(*indentation)
    )]
    NoIndentation {
        /// The approach of the bodies since first touch, length.
        indentation: f64,
    },
    /// The object is hollow with exactly the curvature of the sensor: the surfaces touch everywhere at once.
    #[error(
        "the bodies conform: the relative curvature is {relative_curvature}",
        relative_curvature = Number(*relative_curvature)
    )]
    Conforming {
        /// 1/R_s + 1/R_o, 1/length.
        relative_curvature: f64,
    },
    /// The object is hollow with more curvature than the sensor: the sensor touches its edge, not its bottom.
    #[error(
        "the relative curvature is {relative_curvature}, below 0: the contact is at the edge",
        relative_curvature = Number(*relative_curvature)
    )]
    EdgeContact {
        /// 1/R_s + 1/R_o, 1/length.
        relative_curvature: f64,
    },
    /// The indentation reaches beyond the elastic body.
    #[error(
        "the indentation is {indentation}; it must be less than {limit}, {what}",
        indentation = Number(*indentation), limit = Number(*limit)
    )]
    TooDeep {
        /// The indentation, length.
        indentation: f64,
        /// Limit that the indentation must stay below, length.
        limit: f64,
        /// Name of that limit, such as "the layer's thickness".
        what: &'static str,
    },
    /// The contact would be too wide for the sensor or for the convex object.
    #[error(
        "the contact would have a radius of {radius:.4}; it must stay below {limit:.4}, {what}",
        radius = Number(*radius), limit = Number(*limit)
    )]
    TooWide {
        /// Radius of the contact, length.
        radius: f64,
        /// Limit that the radius must stay below, length.
        limit: f64,
        /// Name of that limit, such as "the sensor's radius".
        what: &'static str,
    },
    /// The contact is so much wider than the layer is thick that the equations cannot be solved.
    #[error(
        "the contact is {} times as wide as the layer is thick; at most {limit} can be solved",
        Number::rounded(*ratio)
    )]
    LayerTooThin {
        /// Radius of the contact over the thickness.
        ratio: f64,
        /// The largest that can be solved.
        limit: f64,
    },
    /// Fewer readings than unknowns.
    #[error("{markers} marker(s) give {equations} equation(s); {needed} are needed")]
    TooFewMarkers {
        /// Number of markers.
        markers: usize,
        /// Number of equations: one for each marker, three if its tangential displacement is measured too.
        equations: usize,
        /// Number of equations needed.
        needed: usize,
    },
    /// All markers moved alike, or not beyond their noise. Without contact, fewer than 5 % of the presses are mistaken for a
    /// contact (`cargo xtask intervals press`).
    #[error(
        "no contact to be seen: the best fit explains the readings only {improvement:.1} better \
         than none does (chi-squared; {needed:.1} are needed)",
        improvement = Number(*improvement)
    )]
    NoContact {
        /// Chi-squared without a contact minus that with one.
        improvement: f64,
        /// Smallest improvement that counts as a contact.
        needed: f64,
    },
    /// The markers moved, but not as in a press of this body: a press explains them no better than no press, or a needle of any
    /// sharpness does.
    #[error(
        "the markers moved, but not as a press moves this body: residuals have a chi-squared of {chi_squared:.1}, where noise \
         alone leaves about {freedom}; the body, its thickness or the depth of the markers is another, or noise is larger \
         than stated",
        chi_squared = Number(*chi_squared)
    )]
    OtherBody {
        /// Chi-squared of the readings against a sensor at rest, or against the fit.
        chi_squared: f64,
        /// Degrees of freedom, about which chi-squared would be.
        freedom: usize,
    },
    /// The contact that explains the readings best is far from all markers.
    #[error(
        "the contact lies {distance} from the nearest marker, off the sensor's markers",
        distance = Number::rounded(*distance)
    )]
    OffMarkers {
        /// Distance along the skin, length.
        distance: f64,
    },
    /// A marker has a reading at rest, although it is hidden from the camera of the sensor that fits the other markers.
    #[error(
        "marker {marker} (counting from 0) was seen at rest, but no camera that the others allow sees it; the layout or the \
         camera is another"
    )]
    HiddenMarker {
        /// Number of the first such marker.
        marker: usize,
    },
    /// The readings do not determine the unknowns.
    #[error("the readings do not determine the press: {what}")]
    Undetermined {
        /// Description of what is missing.
        what: &'static str,
    },
    /// The numbers exceed the range of doubles.
    #[error("the numbers are too large or too small to be worked with")]
    OutOfRange,
}

impl PressError {
    /// [`PressError::BadSetting`] unless the setting is valid.
    pub(crate) fn unless_good(
        setting: &'static str,
        value: f64,
        is_good: bool,
        expected: &'static str,
    ) -> Result<f64, Self> {
        Ok(BadSetting::unless(is_good, setting, value, expected)?)
    }

    /// The stable name of this kind of error.
    pub fn name(&self) -> &'static str {
        self.into()
    }
}

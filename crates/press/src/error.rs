//! Errors of computations on presses, and of fits to their readings.

use palpate_statistics::{BadSetting, Number};
use strum::{IntoStaticStr, VariantNames};
use thiserror::Error;

/// Errors for presses that are impossible, and for readings that do not determine a curvature.
#[derive(Clone, Copy, Debug, Error, IntoStaticStr, PartialEq, VariantNames)]
#[strum(serialize_all = "kebab-case")]
pub enum PressError {
    /// A setting is out of its range.
    #[error(transparent)]
    BadSetting(#[from] BadSetting),
    /// A reading, or a value computed from it, is not a finite number.
    #[error("marker {marker} (counting from 0): a number is not finite, or beyond 1e50")]
    NotFinite {
        /// Number of the marker with a value that is not finite, counted from 0.
        marker: usize,
    },
    /// A marker is beyond the point of the skin opposite the apex.
    #[error(
        "marker {marker} (counting from 0) lies {distance} from the apex along the skin; the skin \
         ends at {limit}",
        distance = Number(*distance), limit = Number(*limit)
    )]
    OffSkin {
        /// Number of the marker, counted from 0.
        marker: usize,
        /// Distance (length) of the marker from the apex along the skin.
        distance: f64,
        /// Half the circumference of the sensor (a length). The distance of a marker from the apex must be smaller.
        limit: f64,
    },
    /// The stated or computed indentation is not positive, so sensor and object do not touch.
    #[error(
        "the indentation is {indentation}; it must be > 0 for a contact",
        indentation = Number(*indentation)
    )]
    NoIndentation {
        /// Distance (length) by which the bodies have approached each other since they first touched.
        indentation: f64,
    },
    /// The object is concave, and its curvature equals the sensor's curvature, so the surfaces touch everywhere at
    /// once.
    #[error(
        "the bodies conform: the relative curvature is {relative_curvature}",
        relative_curvature = Number(*relative_curvature)
    )]
    Conforming {
        /// Sum (1/length) of the sensor's and the object's curvatures.
        relative_curvature: f64,
    },
    /// The object is concave, and its curvature is larger than the sensor's. The sensor therefore touches the object's
    /// edge instead of its bottom.
    #[error(
        "the relative curvature is {relative_curvature}, below 0: the sensor touches the edge of \
         the object",
        relative_curvature = Number(*relative_curvature)
    )]
    EdgeContact {
        /// Sum (1/length) of the sensor's and the object's curvatures.
        relative_curvature: f64,
    },
    /// The indentation is too large: it reaches the layer's base or the sensor's centre.
    #[error(
        "the indentation is {indentation}; it must be less than {limit}, {what}",
        indentation = Number(*indentation), limit = Number(*limit)
    )]
    TooDeep {
        /// The impossible indentation (length).
        indentation: f64,
        /// Limit (length): the indentation must be less than this value.
        limit: f64,
        /// Name of the quantity whose value is `limit`, such as "the layer's thickness".
        what: &'static str,
    },
    /// The contact would be too wide for the sensor or for the convex object.
    #[error(
        "the contact radius would be {radius:.4}; it must be less than {limit:.4}, {what}",
        radius = Number(*radius), limit = Number(*limit)
    )]
    TooWide {
        /// Radius (length) that the contact would have.
        radius: f64,
        /// The contact radius must be less than this length.
        limit: f64,
        /// Name of the quantity whose value is `limit`, such as "the sensor's radius".
        what: &'static str,
    },
    /// The ratio of the contact's radius to the layer's thickness is too large for the equations to be solved.
    #[error(
        "the contact radius is {} times the layer's thickness; it must be at most {limit} times \
         the thickness",
        Number::rounded(*ratio)
    )]
    LayerTooThin {
        /// Ratio of the contact's radius to the layer's thickness.
        ratio: f64,
        /// Largest ratio of contact radius to thickness for which the equations can be solved.
        limit: f64,
    },
    /// There are fewer readings than fit parameters.
    #[error("{markers} marker(s) give {equations} equation(s); {needed} are needed")]
    TooFewMarkers {
        /// Number of markers in the readings.
        markers: usize,
        /// Number of equations of the fit: one per marker, or three per marker if tangential displacements are also
        /// measured.
        equations: usize,
        /// Number of equations that are necessary for the fit.
        needed: usize,
    },
    /// No contact was detected: all markers moved equally, or no marker moved more than the noise. For readings without
    /// a contact, the fit wrongly reports a contact in less than 5 % of cases (tested by `cargo xtask intervals
    /// press`).
    #[error(
        "no contact was found: the best fit of a press reduces chi-squared by {improvement:.1}; \
         at least {needed:.1} is needed",
        improvement = Number(*improvement)
    )]
    NoContact {
        /// Difference of chi-squared: the best fit without a contact minus the best fit with a contact.
        improvement: f64,
        /// Smallest decrease of chi-squared that counts as a contact.
        needed: f64,
    },
    /// The markers moved, but not as in a press on this body. Either no press fits the readings better than "no
    /// contact", or presses of blunt and of very sharp objects fit the readings equally well.
    #[error(
        "the markers moved, but not as in a press on this body: chi-squared of the residuals is {chi_squared:.1}, and noise \
         alone would give about {freedom}; the stated body, its thickness, the depth of the markers or the noise is wrong",
        chi_squared = Number(*chi_squared)
    )]
    OtherBody {
        /// Chi-squared of the readings, either with respect to unmoved markers or with respect to the best fit.
        chi_squared: f64,
        /// Number of degrees of freedom. Noise alone gives this value of chi-squared on average.
        freedom: usize,
    },
    /// The contact of the best fit is far from all markers.
    #[error(
        "the estimated contact is {distance} from the nearest marker, outside the area of the \
         markers",
        distance = Number::rounded(*distance)
    )]
    OffMarkers {
        /// Distance (length) between the contact and the nearest marker along the skin.
        distance: f64,
    },
    /// A marker was visible in the frame at rest, but according to the fitted sensor model, the camera cannot see it.
    #[error(
        "marker {marker} (counting from 0) was found at rest where no camera that fits the other \
         markers can see it; the layout or the camera is wrong"
    )]
    HiddenMarker {
        /// Number of the first marker that was found at rest but that the camera model cannot see, counted from 0.
        marker: usize,
    },
    /// The readings do not determine the fit parameters.
    #[error("the readings do not determine the press: {what}")]
    Undetermined {
        /// Text for the message: the quantity that the readings do not determine.
        what: &'static str,
    },
    /// A number in the input or in the computation is beyond the range of double-precision numbers.
    #[error("the numbers are too large or too small for double precision")]
    OutOfRange,
}

impl PressError {
    pub(crate) fn unless_good(
        setting: &'static str,
        value: f64,
        is_good: bool,
        expected: &'static str,
    ) -> Result<f64, Self> {
        Ok(BadSetting::unless(is_good, setting, value, expected)?)
    }
}

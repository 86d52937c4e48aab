//! The estimate from one press: values with standard errors and intervals, and the sign of the object's curvature.

use strum::IntoStaticStr;

use crate::regime::within_object;
use crate::{EllipticContact, GoodnessOfFit, PressError};

/// An estimated value with its standard error and interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimated {
    /// The estimate of the quantity.
    pub value: f64,
    /// Standard error of the estimate, correct to first order in the noise.
    pub std: f64,
    /// 95 % interval of the quantity.
    pub interval: Interval,
}

impl Estimated {
    /// A normally distributed estimate. `half_width` is half the width of its interval, divided by the standard error.
    pub(crate) fn normal(value: f64, std: f64, half_width: f64) -> Self {
        let interval = Interval {
            low: Some(value - half_width * std),
            high: Some(value + half_width * std),
        };
        Self {
            value,
            std,
            interval,
        }
    }

    /// Limits this estimate to a quantity that cannot be negative: negative ends of the interval become 0.
    pub(crate) fn positive(mut self) -> Self {
        self.interval.low = self.interval.low.map(|low| low.max(0.0));
        self
    }
}

/// The 95 % interval of an estimated quantity. An end is `None` if the readings do not bound the quantity on that side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end of the interval; `None` if there is no lower bound.
    pub low: Option<f64>,
    /// Upper end of the interval; `None` if there is no upper bound.
    pub high: Option<f64>,
}

impl Interval {
    pub(crate) const UNBOUNDED: Self = Self {
        low: None,
        high: None,
    };

    pub(crate) fn hull(&self, other: Self) -> Self {
        let both = |one: Option<f64>, other: Option<f64>, end: fn(f64, f64) -> f64| {
            one.zip(other).map(|(one, other)| end(one, other))
        };
        Self {
            low: both(self.low, other.low, f64::min),
            high: both(self.high, other.high, f64::max),
        }
    }

    /// Applies the function `end` to both ends of this interval. The function must be increasing.
    pub(crate) fn map(self, end: impl Fn(f64) -> f64) -> Self {
        Self {
            low: self.low.map(&end),
            high: self.high.map(end),
        }
    }

    /// Whether the interval contains a value.
    pub fn holds(&self, value: f64) -> bool {
        self.low.is_none_or(|low| low <= value) && self.high.is_none_or(|high| value <= high)
    }
}

/// Conclusion about the sign of the object's curvature.
#[derive(Clone, Copy, Debug, Eq, Hash, IntoStaticStr, PartialEq)]
#[strum(serialize_all = "kebab-case")]
pub enum Verdict {
    /// Convex: the interval of the object's curvature is above 0.
    Convex,
    /// Concave: the interval of the object's curvature is below 0.
    Concave,
    /// Flat within the noise: the interval of the object's curvature contains 0 and is narrower than the sensor's own
    /// curvature.
    FlatWithinNoise,
    /// Not resolved: the interval of the object's curvature contains 0 and is at least as wide as the sensor's own
    /// curvature.
    NotResolved,
}

impl Verdict {
    /// The verdict that follows from the interval of the relative curvature. `sensor` is the curvature of the sensor.
    pub(crate) fn of(interval: Interval, sensor: f64) -> Self {
        let Interval { low, high } = interval;
        match (low, high) {
            (Some(low), _) if low > sensor => Self::Convex,
            (_, Some(high)) if high < sensor => Self::Concave,
            (Some(low), Some(high)) if high - low < sensor => Self::FlatWithinNoise,
            _ => Self::NotResolved,
        }
    }
}

/// Principal curvatures of an object, estimated from one press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrincipalCurvatures {
    /// Principal curvatures (1/length) of the object, the larger one first.
    pub curvatures: [Estimated; 2],
    /// Angle between the direction of the smaller curvature (the axis of a cylinder) and the x axis at the contact,
    /// from −π/2 to π/2.
    pub axis: f64,
    /// Standard error (rad) of the angle `axis`. It is at most π/√12, the standard deviation of a completely unknown
    /// direction.
    pub axis_std: f64,
    /// The elliptic contact of the estimated press.
    pub contact: EllipticContact,
}

/// Estimate of an object's curvature from one press.
#[derive(Clone, Debug, PartialEq)]
pub struct PressEstimate {
    /// Curvature of the sensor, 1/length.
    pub sensor_curvature: f64,
    /// Relative curvature 1/R_s + 1/R_o (1/length), corrected for the bias of least squares. The interval is computed
    /// by profile likelihood. If a marker contradicts the other markers, but not enough to be rejected as an outlier,
    /// the interval also contains the interval of a fit without this marker.
    pub relative_curvature: Estimated,
    /// Relative curvature (1/length) of the best fit, without bias correction.
    pub most_likely_curvature: f64,
    /// The principal curvatures of the object; `None` unless an elliptic contact was fitted. With an elliptic contact,
    /// all other curvatures in this estimate are mean curvatures.
    pub principal: Option<PrincipalCurvatures>,
    /// Indentation: distance (length) by which the bodies have approached each other since they first touched.
    pub indentation: Estimated,
    /// Radius of the contact area (length).
    pub contact_radius: Estimated,
    /// Position of the contact on the skin (length), in the same coordinates as the positions of the markers.
    pub contact: [f64; 2],
    /// Standard errors (length) of the contact's position along the axes at the contact. If all markers are in a row,
    /// the fit assumes that the contact is on this row, and the standard error across the row is 0.
    pub contact_std: [f64; 2],
    /// Estimated offset (length) that is added to all normal displacements; `None` if it was not fitted.
    pub baseline: Option<Estimated>,
    /// Estimated factor by which all normal displacements are multiplied; `None` if it was not fitted.
    pub gain: Option<Estimated>,
    /// Numbers of the markers that were rejected as outliers, counted from 0.
    pub wrong_markers: Vec<usize>,
    /// Standard deviation (length) of the noise of normal displacements, stated or estimated.
    pub normal_std: f64,
    /// Standard deviation (length) of the noise of tangential displacements, stated or estimated; `None` if tangential
    /// displacements were not used.
    pub tangential_std: Option<f64>,
    /// Share of the normal displacements' variance that the fit explains.
    pub r_squared: f64,
    /// Chi-squared of the residuals divided by the degrees of freedom. It is about 1 if the stated noise is correct.
    pub reduced_chi_squared: f64,
    /// Goodness of fit. It is `None` if some noise was estimated from the residuals. In a fit of images, the likelihood
    /// is averaged over the unknown deviations of the sensor's parameters from their nominal values. Each deviation has
    /// a prior, so the deviations do not reduce the degrees of freedom.
    pub goodness: Option<GoodnessOfFit>,
    /// Whether the readings alone show a contact. If this is `false`, the estimate relies on a stated indentation. The
    /// interval of the curvature then contains the curvatures of all contacts in the area of the markers that are
    /// compatible with the readings. In most cases, the interval has no upper end, and the position of the contact is
    /// unknown.
    pub is_detected: bool,
    /// Number (from 0) of the marker, if only one marker moved significantly; otherwise `None`. Without this marker,
    /// the readings show no contact. Either the marker is an outlier, or the object presses at a place where no other
    /// marker moves.
    pub only_marker: Option<usize>,
    /// Conclusion about the sign of the object's curvature, from the 95 % interval of this curvature.
    pub verdict: Verdict,
}

impl PressEstimate {
    /// This estimate with `interval` as the interval of the relative curvature. The verdict follows from the new
    /// interval.
    pub(crate) fn holding(mut self, interval: Interval) -> Self {
        self.relative_curvature.interval = interval;
        self.verdict = Verdict::of(interval, self.sensor_curvature);
        self
    }

    /// Effective radius R = 1/C_r (length) of the best fit. Unlike the curvature, the radius has almost no bias.
    pub fn effective_radius(&self) -> Estimated {
        let curvature = self.relative_curvature;
        let most_likely = self.most_likely_curvature;
        let inverse = |end: Option<f64>| end.filter(|&end| end > 0.0).map(f64::recip);
        Estimated {
            value: most_likely.recip(),
            // The effective radius and its inverse, the relative curvature, have the same relative standard error.
            std: curvature.std / (curvature.value * most_likely),
            interval: Interval {
                low: Some(curvature.interval.high.map_or(0.0, f64::recip)),
                high: inverse(curvature.interval.low),
            },
        }
    }

    /// Checks that the contact is narrow enough for the object. The check passes if the contact is narrow enough for at
    /// least one curvature in the interval of the object's curvature.
    ///
    /// # Errors
    /// [`PressError::TooWide`] if the contact radius exceeds 0.9 times the object's radius for every curvature in the
    /// interval.
    pub fn within_object(&self) -> Result<(), PressError> {
        // The shorter semi-axis of the contact is in the direction of the larger curvature.
        let (curvature, radius) = match self.principal {
            Some(principal) => (principal.curvatures[0], principal.contact.semi_axes[1]),
            None => (self.object_curvature(), self.contact_radius.value),
        };
        within_object(curvature.interval.low.unwrap_or_default(), radius)
    }

    /// The object's curvature 1/R_o (1/length) in the best fit, where R_o is the object's radius.
    pub fn most_likely_object_curvature(&self) -> f64 {
        self.most_likely_curvature - self.sensor_curvature
    }

    /// The object's curvature 1/R_o (1/length), positive for a convex object. Like the value of the relative curvature,
    /// this value is corrected for bias.
    pub fn object_curvature(&self) -> Estimated {
        let shift = |end: f64| end - self.sensor_curvature;
        let relative = self.relative_curvature;
        Estimated {
            value: shift(relative.value),
            std: relative.std,
            interval: relative.interval.map(shift),
        }
    }
}

//! The estimate from one press: values, intervals and the verdict.

use strum::IntoStaticStr;

use crate::{EllipticContact, GoodnessOfFit, PressError, within_object};

/// A value with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimated {
    /// The estimate.
    pub value: f64,
    /// Its standard deviation, to first order.
    pub std: f64,
    /// The 95 % interval.
    pub interval: Interval,
}

impl Estimated {
    /// A normally distributed value; its interval has this half-width in standard deviations.
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

    /// The value of a length that cannot be negative.
    pub(crate) fn positive(mut self) -> Self {
        self.interval.low = self.interval.low.map(|low| low.max(0.0));
        self
    }
}

/// A 95 % interval. An end is `None` if the readings give no bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
}

impl Interval {
    /// All numbers.
    pub(crate) const UNBOUNDED: Self = Self {
        low: None,
        high: None,
    };

    /// The smallest interval that contains this one and another.
    pub(crate) fn hull(&self, other: Self) -> Self {
        let both = |one: Option<f64>, other: Option<f64>, end: fn(f64, f64) -> f64| {
            one.zip(other).map(|(one, other)| end(one, other))
        };
        Self {
            low: both(self.low, other.low, f64::min),
            high: both(self.high, other.high, f64::max),
        }
    }

    /// The interval with both ends mapped by an increasing function.
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

/// The sign of the object's curvature, if the readings determine it.
#[derive(Clone, Copy, Debug, Eq, Hash, IntoStaticStr, PartialEq)]
#[strum(serialize_all = "kebab-case")]
pub enum Verdict {
    /// The interval of the object's curvature lies above 0.
    Convex,
    /// The interval lies below 0.
    Concave,
    /// The interval contains 0 and is narrower than the sensor's own curvature.
    FlatWithinNoise,
    /// The interval contains 0 and is at least as wide as the sensor's own curvature.
    NotResolved,
}

impl Verdict {
    /// The verdict on the object from an interval of the relative curvature, for a sensor of this curvature.
    pub(crate) fn of(interval: Interval, sensor: f64) -> Self {
        let Interval { low, high } = interval;
        match (low, high) {
            (Some(low), _) if low > sensor => Self::Convex,
            (_, Some(high)) if high < sensor => Self::Concave,
            (Some(low), Some(high)) if high - low < sensor => Self::FlatWithinNoise,
            _ => Self::NotResolved,
        }
    }

    /// The stable name.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

/// Principal curvatures of an object from one press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrincipalCurvatures {
    /// Curvatures of the object, the larger first, 1/length.
    pub curvatures: [Estimated; 2],
    /// Angle of the direction of the smaller curvature (the axis of a cylinder) to the x axis at the contact, from −π/2 to π/2.
    pub axis: f64,
    /// Standard deviation of that angle, at most π/√12, which is that of an unknown axis.
    pub axis_std: f64,
    /// The contact.
    pub contact: EllipticContact,
}

/// An object's curvature from one press.
#[derive(Clone, Debug, PartialEq)]
pub struct PressEstimate {
    /// Curvature of the sensor, 1/length.
    pub sensor_curvature: f64,
    /// 1/R_s + 1/R_o, 1/length, without the bias of least squares; the interval is by profile likelihood. If one marker
    /// contradicts the others, but not enough for an outlier, the interval also contains the interval without this marker.
    pub relative_curvature: Estimated,
    /// The relative curvature of the best fit, without correction of its bias, 1/length.
    pub most_likely_curvature: f64,
    /// The principal curvatures, from a fit of an elliptic contact; the other curvatures are then their mean.
    pub principal: Option<PrincipalCurvatures>,
    /// The approach of the bodies, length.
    pub indentation: Estimated,
    /// Radius of the contact, length.
    pub contact_radius: Estimated,
    /// Chart coordinates of the contact on the skin, length.
    pub contact: [f64; 2],
    /// Standard deviations of the contact along the axes there, length. If the markers lie in a row, the contact is searched on
    /// this row, and the standard deviation across it is 0.
    pub contact_std: [f64; 2],
    /// Offset common to all normal displacements, length, if fitted.
    pub baseline: Option<Estimated>,
    /// The factor on all normal displacements, if fitted.
    pub gain: Option<Estimated>,
    /// Numbers of the markers that were rejected as outliers, counted from 0.
    pub wrong_markers: Vec<usize>,
    /// Standard deviation of the normal displacements, stated or estimated. Length.
    pub normal_std: f64,
    /// Standard deviation of the tangential displacements, stated or estimated. Length; `None` if they were not used.
    pub tangential_std: Option<f64>,
    /// The share of the normal displacements' variance that the fit explains.
    pub r_squared: f64,
    /// Chi-squared of the residuals per degree of freedom; about 1 if the noise is as stated.
    pub reduced_chi_squared: f64,
    /// Goodness of fit if the noise is stated; `None` if some noise was estimated from the residuals, and for a Gaussian. A fit
    /// of images marginalises the unknown departures of the sensor: each has a prior, so they do not count as unknowns.
    pub goodness: Option<GoodnessOfFit>,
    /// Whether the readings alone show a contact. If not, but an indentation is stated, the interval of the curvature contains
    /// all contacts on the markers that are compatible with the readings; it mostly has no upper end, and the place is unknown.
    pub is_detected: bool,
    /// Number of a marker, counted from 0, that moved significantly and without which the readings show no contact: it is an
    /// outlier, or the object presses where no other marker moves.
    pub only_marker: Option<usize>,
    /// Sign of the object's curvature.
    pub verdict: Verdict,
}

impl PressEstimate {
    /// The estimate with another interval of the relative curvature.
    pub(crate) fn holding(mut self, interval: Interval) -> Self {
        self.relative_curvature.interval = interval;
        self.verdict = Verdict::of(interval, self.sensor_curvature);
        self
    }

    /// R = 1/C_r of the best fit, length. Unlike the curvature, the radius has almost no bias.
    pub fn effective_radius(&self) -> Estimated {
        let Estimated {
            value,
            std,
            interval,
        } = self.relative_curvature;
        let most_likely = self.most_likely_curvature;
        let inverse = |end: Option<f64>| end.filter(|&end| end > 0.0).map(f64::recip);
        Estimated {
            value: most_likely.recip(),
            // Radius and curvature have the same relative standard deviation.
            std: std / (value * most_likely),
            interval: Interval {
                low: Some(interval.high.map_or(0.0, f64::recip)),
                high: inverse(interval.low),
            },
        }
    }

    /// Checks that the contact is narrow enough for at least one curvature in the object's interval.
    ///
    /// # Errors
    /// [`PressError::TooWide`] if the contact radius exceeds 0.9 of the object's radius for every curvature in the
    /// interval.
    pub fn within_object(&self) -> Result<(), PressError> {
        // The shorter semi-axis lies across the larger curvature.
        let (curvature, radius) = match self.principal {
            Some(principal) => (principal.curvatures[0], principal.contact.semi_axes[1]),
            None => (self.object_curvature(), self.contact_radius.value),
        };
        within_object(curvature.interval.low.unwrap_or_default(), radius)
    }

    /// 1/R_o of the best fit, 1/length; its inverse is the object's radius.
    pub fn most_likely_object_curvature(&self) -> f64 {
        self.most_likely_curvature - self.sensor_curvature
    }

    /// 1/R_o, positive for a convex object, 1/length; without bias, as the relative curvature.
    pub fn object_curvature(&self) -> Estimated {
        let shift = |end: f64| end - self.sensor_curvature;
        let Estimated {
            value,
            std,
            interval,
        } = self.relative_curvature;
        Estimated {
            value: shift(value),
            std,
            interval: interval.map(shift),
        }
    }
}

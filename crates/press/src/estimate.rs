//! The estimate from one press: its values, their intervals and the verdict.

use strum::IntoStaticStr;

use crate::skin::within_object;
use crate::{GoodnessOfFit, PressError};

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

/// A 95 % interval. An end is `None` where the readings set no bound.
///
/// ```
/// use palpate_press::Interval;
///
/// let bounded = Interval { low: Some(1.0), high: Some(2.0) };
/// let hull = bounded.hull(Interval { low: Some(1.5), high: None });
/// assert_eq!(hull, Interval { low: Some(1.0), high: None });
/// assert!(hull.holds(1e9) && !hull.holds(0.5));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
}

impl Interval {
    /// All numbers.
    pub const UNBOUNDED: Self = Self {
        low: None,
        high: None,
    };

    /// The smallest interval that holds this one and another.
    pub fn hull(&self, other: Self) -> Self {
        let both = |one: Option<f64>, other: Option<f64>, end: fn(f64, f64) -> f64| {
            one.zip(other).map(|(one, other)| end(one, other))
        };
        Self {
            low: both(self.low, other.low, f64::min),
            high: both(self.high, other.high, f64::max),
        }
    }

    /// Whether it holds a value.
    pub fn holds(&self, value: f64) -> bool {
        self.low.is_none_or(|low| low <= value) && self.high.is_none_or(|high| value <= high)
    }
}

/// The sign of the object's curvature, as far as the readings tell it.
#[derive(Clone, Copy, Debug, Eq, Hash, IntoStaticStr, PartialEq)]
#[strum(serialize_all = "kebab-case")]
pub enum Verdict {
    /// The interval of the object's curvature lies above 0.
    Convex,
    /// The interval lies below 0.
    Concave,
    /// The interval holds 0, and is narrower than the sensor's own curvature.
    FlatWithinNoise,
    /// The interval holds 0, and is at least as wide as the sensor's own curvature.
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

/// An object's curvature from one press.
#[derive(Clone, Debug, PartialEq)]
pub struct PressEstimate {
    /// Curvature of the sensor, 1/length.
    pub sensor_curvature: f64,
    /// 1/R_s + 1/R_o, 1/length: without the bias of least squares; the interval by profile likelihood. Where one marker's
    /// displacement contradicts the others by too little to be left out, it also holds what the others tell alone.
    pub relative_curvature: Estimated,
    /// The relative curvature that fits best, bias and all, 1/length.
    pub most_likely_curvature: f64,
    /// The approach of the bodies, length.
    pub indentation: Estimated,
    /// Radius of the contact, length.
    pub contact_radius: Estimated,
    /// Chart coordinates of the contact on the skin, length.
    pub contact: [f64; 2],
    /// Standard deviations of the contact along the axes there, length; 0 across a row of markers, on which the contact
    /// is then sought.
    pub contact_std: [f64; 2],
    /// Offset common to all normal displacements, length, if fitted.
    pub baseline: Option<Estimated>,
    /// The factor on all normal displacements, if fitted.
    pub gain: Option<Estimated>,
    /// Markers that were left out because they contradict the others, counted from 0.
    pub wrong_markers: Vec<usize>,
    /// Standard deviation of the normal displacements: as given, or as found. Length.
    pub normal_std: f64,
    /// Standard deviation of the tangential displacements: as given, or as found. Length; `None` if they were not used.
    pub tangential_std: Option<f64>,
    /// The share of the normal displacements' variance that the fit explains.
    pub r_squared: f64,
    /// Chi-squared of the residuals per degree of freedom; about 1 where the noise is as stated.
    pub reduced_chi_squared: f64,
    /// Goodness of fit of readings whose noise is stated; `None` where some noise is found from the residuals, and of a
    /// Gaussian. Of pictures what is common to all markers is taken out as far as it is not known: it has its own prior
    /// knowledge, and counts as no unknown.
    pub goodness: Option<GoodnessOfFit>,
    /// Whether the readings show a contact of themselves. Where they do not, but an indentation is given, the interval of the
    /// curvature is that of all contacts on the markers that the readings leave, mostly without an upper end, and the place
    /// is not known.
    pub is_seen: bool,
    /// Marker, counted from 0, without which the readings show no contact, though it moved beyond noise: it is wrong, or the
    /// object presses where no other feels it.
    pub only_marker: Option<usize>,
    /// Sign of the object's curvature, as far as the readings tell it.
    pub verdict: Verdict,
}

impl PressEstimate {
    /// Estimate with another interval of the relative curvature.
    pub(crate) fn holding(self, interval: Interval) -> Self {
        Self {
            relative_curvature: Estimated {
                interval,
                ..self.relative_curvature
            },
            verdict: Verdict::of(interval, self.sensor_curvature),
            ..self
        }
    }

    /// R = 1/C_r of the best fit, length: radii are nearly without bias as they are, unlike curvatures.
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
            // The relative standard deviation is the same.
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
    /// [`PressError::TooWide`] if the contact radius exceeds [`MAX_CONTACT`](crate::hertz::MAX_CONTACT) times the
    /// object's radius for every curvature in the interval.
    pub fn within_object(&self) -> Result<(), PressError> {
        let least = self.object_curvature().interval.low;
        within_object(least.unwrap_or_default(), self.contact_radius.value)
    }

    /// 1/R_o of the best fit, 1/length; its inverse is the object's radius.
    pub fn most_likely_object_curvature(&self) -> f64 {
        self.most_likely_curvature - self.sensor_curvature
    }

    /// 1/R_o, positive where the object is convex, 1/length; without bias, as the relative curvature.
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
            interval: Interval {
                low: interval.low.map(shift),
                high: interval.high.map(shift),
            },
        }
    }
}

//! Misfits: contradictions between readings and the model that was fitted to these readings.

use crate::chi_squared_tail;

/// A way in which readings contradict the fitted model. Its p-value is the probability of a contradiction at least as
/// large as the observed one if the model is correct.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Misfit {
    /// The residuals are larger than the noise can explain.
    PoorFit {
        /// P-value of the goodness of fit.
        p_value: f64,
    },
    /// One reading contradicts the other readings.
    Outlier {
        /// Index, counted from 0, of the roll, contact or marker whose reading contradicts the others.
        reading: usize,
        /// P-value of the largest contradiction among all readings.
        p_value: f64,
    },
    /// The stated value of a quantity contradicts the estimate of this quantity from the readings.
    Stated {
        /// The stated quantity.
        quantity: StatedQuantity,
        /// Stated value of the quantity.
        stated: f64,
        /// Estimate of the quantity from the readings, in the same unit as the stated value.
        estimated: f64,
        /// P-value of the difference between the stated value and the estimate.
        p_value: f64,
    },
    /// The displacements of a press do not vary with the distance from the contact as the fitted model predicts.
    OtherBody {
        /// P-value of the test whether the residuals of the displacements depend on the distance from the contact.
        p_value: f64,
    },
    /// The displacements of a press depend on the direction from the contact more than the fitted model predicts.
    NotRound {
        /// P-value of the test whether the residuals of the displacements depend on the direction from the contact.
        p_value: f64,
    },
}

/// A quantity that the user states and that can also be estimated from the readings.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum StatedQuantity {
    /// Standard deviation of the readings' noise.
    Noise,
    /// Indentation of a press.
    Indentation,
    /// Distance between neighbouring pads of the sensor.
    Pitch,
    /// A length of the sensor that the readings contain too: the distance between fingers or the tip radius.
    Scale,
}

impl StatedQuantity {
    /// Code of the warning that the stated value of this quantity contradicts its estimate from the readings.
    pub const fn code(self) -> &'static str {
        match self {
            Self::Noise => "stated-noise",
            Self::Indentation => "stated-indentation",
            Self::Pitch => "stated-pitch",
            Self::Scale => "stated-scale",
        }
    }
}

impl Misfit {
    /// Returns [`Misfit::PoorFit`] if the p-value of `goodness` is below the significance level `level`, otherwise
    /// `None`.
    pub fn poor_fit(goodness: GoodnessOfFit, level: f64) -> Option<Self> {
        let p_value = goodness.p_value;
        (p_value < level).then_some(Self::PoorFit { p_value })
    }

    /// Returns [`Misfit::Outlier`] for the reading with the smallest p-value, or `None` if this p-value is not
    /// significant. Because many readings are tested, the smallest p-value is first multiplied by the number of
    /// readings (Bonferroni). Each item of `p_values` is the index of a reading and its p-value.
    ///
    /// ```
    /// use palpate_statistics::Misfit;
    ///
    /// let p_values = [(3, 0.5), (7, 0.001)];
    /// let outlier = Misfit::Outlier { reading: 7, p_value: 0.002 };
    /// assert_eq!(Misfit::outlier(p_values), Some(outlier));
    /// assert_eq!(Misfit::outlier([(3, 0.5), (7, 0.01)]), None);
    /// ```
    pub fn outlier(p_values: impl IntoIterator<Item = (usize, f64)>) -> Option<Self> {
        let mut count = 0.0;
        let smallest = p_values
            .into_iter()
            .inspect(|_| count += 1.0)
            .min_by(|(_, one), (_, other)| one.total_cmp(other));
        let (reading, p_value) = smallest?;
        let p_value = count * p_value;
        (p_value < SIGNIFICANCE_LEVEL).then_some(Self::Outlier { reading, p_value })
    }

    /// Code of the warning about this misfit. It stays the same in all versions.
    pub const fn code(&self) -> &'static str {
        match self {
            Self::PoorFit { .. } => "poor-fit",
            Self::Outlier { .. } => "outlier",
            Self::Stated { quantity, .. } => quantity.code(),
            Self::OtherBody { .. } => "other-body",
            Self::NotRound { .. } => "not-round",
        }
    }

    /// The p-value of this misfit: the probability of a contradiction at least as large as this one, if the model is
    /// correct.
    pub const fn p_value(&self) -> f64 {
        match self {
            Self::PoorFit { p_value }
            | Self::Outlier { p_value, .. }
            | Self::Stated { p_value, .. }
            | Self::OtherBody { p_value }
            | Self::NotRound { p_value } => *p_value,
        }
    }
}

/// Significance level of each test for a contradiction between readings and model: the probability of a false alarm if
/// the model is correct.
pub const SIGNIFICANCE_LEVEL: f64 = 0.005;

/// Chi-squared of a fit, and the p-value for the hypothesis that the stated noise explains the residuals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GoodnessOfFit {
    /// Sum over all readings and priors of (residual / standard deviation)².
    pub chi_squared: f64,
    /// Degrees of freedom: the number of readings and priors that the fit uses, minus the number of fitted parameters.
    pub freedom: usize,
    /// Probability of a chi-squared at least as large as this one, if the model is correct and the noise is normal with
    /// the stated standard deviation. A small p-value means that the readings contradict the model or the stated noise.
    /// If the readings agree with both, the p-value is distributed uniformly from 0 to 1. Without degrees of freedom,
    /// the p-value is 1.
    pub p_value: f64,
}

impl GoodnessOfFit {
    /// Goodness of fit for a chi-squared with `freedom` degrees of freedom.
    pub fn new(chi_squared: f64, freedom: usize) -> Self {
        Self {
            chi_squared,
            freedom,
            p_value: chi_squared_tail(chi_squared, freedom),
        }
    }

    /// Whether the p-value is below [`SIGNIFICANCE_LEVEL`]. A poor fit may mean that the stated noise is too small.
    /// With too small a noise, every pattern in the residuals seems significant. Therefore, if the fit is poor, compare
    /// patterns with the scatter of the residuals instead of the stated noise.
    pub fn is_poor(&self) -> bool {
        self.p_value < SIGNIFICANCE_LEVEL
    }
}

//! Misfit: ways in which readings contradict the model that was fitted to them.

use crate::{GoodnessOfFit, SIGNIFICANCE_LEVEL};

/// A way in which readings contradict the fitted model, with the probability of a contradiction at least as large if the
/// model holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Misfit {
    /// The residuals are larger than the noise explains.
    PoorFit {
        /// Goodness-of-fit p-value.
        p_value: f64,
    },
    /// One reading contradicts the others.
    Outlier {
        /// Number of the roll, contact or marker, counted from 0.
        reading: usize,
        /// P-value for one of all readings.
        p_value: f64,
    },
    /// A stated quantity contradicts its estimate from the readings.
    Stated {
        /// The quantity.
        quantity: StatedQuantity,
        /// The stated value.
        stated: f64,
        /// The estimate from the readings, in the same unit.
        estimated: f64,
        /// P-value of the difference.
        p_value: f64,
    },
    /// The displacements of a press vary with the distance from the contact differently than the fitted model predicts.
    OtherBody {
        /// P-value of the dependence that the body does not explain.
        p_value: f64,
    },
    /// The displacements of a press depend on the direction from the contact.
    NotRound {
        /// P-value of the dependence on the direction.
        p_value: f64,
    },
}

/// A quantity that the user states and that the readings also determine.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum StatedQuantity {
    /// Standard deviation of the readings.
    Noise,
    /// Indentation of a press.
    Indentation,
    /// Distance between neighbouring pads.
    Pitch,
    /// A length that sets the scale of the readings, for example the distance between fingers.
    Scale,
}

impl StatedQuantity {
    /// Code of the warning about this quantity.
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
    /// Reports a poor fit at a significance level.
    pub fn poor_fit(goodness: GoodnessOfFit, level: f64) -> Option<Self> {
        let p_value = goodness.p_value;
        (p_value < level).then_some(Self::PoorFit { p_value })
    }

    /// Reports the reading with the smallest of these p-values, if it is significant among all of them (Bonferroni).
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

    /// Stable code of the warning about this misfit.
    pub const fn code(&self) -> &'static str {
        match self {
            Self::PoorFit { .. } => "poor-fit",
            Self::Outlier { .. } => "outlier",
            Self::Stated { quantity, .. } => quantity.code(),
            Self::OtherBody { .. } => "other-body",
            Self::NotRound { .. } => "not-round",
        }
    }

    /// Probability of a contradiction at least as large if the model holds.
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

//! Texts of warnings about contradictions between the readings and the model.

use palpate_statistics::{Misfit, Number, StatedQuantity};

use palpate_study::Warning;

/// Words with which the warnings name the readings of an estimate, such as shifts or displacements.
pub(super) struct ReadingWords<'w> {
    pub(super) reading: &'w dyn Fn(usize) -> String,
    /// Plural noun for the readings to which the stated noise refers, for example `shifts`.
    pub(super) noise_of: &'w str,
    /// Unit in which the warnings write the stated noise and the other stated quantities.
    pub(super) unit: &'w str,
}

impl ReadingWords<'_> {
    pub(super) fn warning(&self, misfit: &Misfit) -> Warning {
        let p_value = misfit.p_value();
        let shown = Number::rounded(p_value);
        let text = match misfit {
            Misfit::PoorFit { .. } => format!(
                "the residuals are larger than the noise explains (p-value {shown}): the stated noise is too small, or the model does not hold"
            ),
            Misfit::Outlier { reading, .. } => {
                let reading = (self.reading)(*reading);
                format!("{reading} contradicts the other readings (p-value {shown})")
            }
            Misfit::Stated {
                quantity,
                stated,
                estimated,
                ..
            } => {
                let (quantity, consequence) = match quantity {
                    StatedQuantity::Noise => (
                        &*format!("noise of {}", self.noise_of),
                        "; the intervals are not reliable: correct the stated noise, or do not state it",
                    ),
                    StatedQuantity::Indentation => {
                        ("indentation", "; the curvature is not reliable")
                    }
                    StatedQuantity::Pitch => ("pitch", ""),
                    StatedQuantity::Scale => ("scale", ""),
                };
                let [stated, estimated] = [*stated, *estimated].map(Number::rounded);
                let unit = self.unit;
                format!(
                    "the {quantity} is stated as {stated} {unit}, but the readings show {estimated} {unit}{consequence}"
                )
            }
            Misfit::OtherBody { .. } => format!(
                "the displacements depend on the distance from the contact in another way than in the fitted body (p-value {shown}): the kind of the body, its thickness, the depth of the markers or the scale of the displacements is wrong"
            ),
            Misfit::NotRound { .. } => format!(
                "the displacements depend on the direction from the contact (p-value {shown}): the object is not a ball, but an edge, a cylinder or a saddle"
            ),
        };
        let mut warning = Warning::new(misfit.code(), text, [("p_value", p_value)]);
        match *misfit {
            Misfit::Outlier { reading, .. } => {
                warning.numbers.insert("reading".into(), reading as f64);
            }
            Misfit::Stated {
                stated, estimated, ..
            } => warning
                .numbers
                .extend([("stated".into(), stated), ("estimated".into(), estimated)]),
            _ => {}
        }
        warning
    }
}

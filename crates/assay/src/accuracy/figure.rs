//! Figures of accuracy.

/// An error of palpate: relative, or in the unit that its name ends with.
pub struct Figure {
    /// Name of the estimate and of the scene.
    pub name: String,
    /// Finite and at least 0.
    pub error: f64,
}

impl Figure {
    pub(super) fn new(name: impl Into<String>, error: f64) -> Self {
        Self {
            name: name.into(),
            error,
        }
    }
}

/// Root of the mean square.
pub(crate) fn rms(errors: impl IntoIterator<Item = f64>) -> f64 {
    let square = |(sum, count): (f64, u32), error: f64| (sum + error * error, count + 1);
    let (sum, count) = errors.into_iter().fold((0.0, 0), square);
    (sum / f64::from(count)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn root_of_the_mean_square() {
        assert_eq!(rms([3.0, -4.0, 0.0, 0.0]), 2.5);
    }
}

//! Distributions of measurement errors, and Gaussian errors of single numbers.

use crate::Stream;
use palpate_statistics::BadSetting;

/// The distribution of a measurement error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distribution {
    /// Uniform distribution. The stated size is the bound of the absolute error.
    Uniform,
    /// Gaussian distribution. The stated size is the standard deviation.
    Gaussian,
}

impl Distribution {
    /// Draws a random error with this distribution. The bound (uniform) or the standard deviation (Gaussian) of the
    /// error is 1.
    #[inline(always)]
    pub fn draw(self, stream: &mut Stream) -> f64 {
        match self {
            Self::Uniform => stream.symmetric_uniform(),
            Self::Gaussian => stream.standard_normal(),
        }
    }

    pub(crate) fn std(self, size: f64) -> f64 {
        match self {
            Self::Uniform => size / 3.0_f64.sqrt(),
            Self::Gaussian => size,
        }
    }
}

/// A Gaussian error that is added to a measured number such as a displacement or a gain. The errors of different
/// readings are independent.
///
/// ```
/// use palpate_sensing::{Channel, GaussianError, Stream};
///
/// let error = GaussianError::new(0.3)?;
/// // The error of the mean of nine readings is a third of the error of one reading.
/// assert!((error.averaged(9).std() - 0.1).abs() < 1e-15);
/// let exact = GaussianError::new(0.0)?;
/// assert_eq!(exact.draw(&mut Stream::new(1, 0, Channel::Gain)), 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GaussianError {
    std: f64,
    bias: f64,
}

impl GaussianError {
    /// An error with the standard deviation `std`, in the unit of the measured number, and with mean 0.
    ///
    /// # Errors
    /// [`BadSetting`] unless the standard deviation is from 0 to 10¹⁵⁰.
    pub fn new(std: f64) -> Result<Self, BadSetting<String>> {
        let holds = (0.0..=1e150).contains(&std);
        BadSetting::unless(holds, "std", std, "from 0 to 1e150")?;
        Ok(Self { std, bias: 0.0 })
    }

    /// The same error, but with the mean `bias` instead of 0.
    ///
    /// # Errors
    /// [`BadSetting`] unless the bias is from −10¹⁵⁰ to 10¹⁵⁰.
    pub fn with_bias(self, bias: f64) -> Result<Self, BadSetting<String>> {
        let holds = bias.abs() <= 1e150;
        BadSetting::unless(holds, "bias", bias, "from -1e150 to 1e150")?;
        Ok(Self { bias, ..self })
    }

    /// Mean of the error (bias).
    pub const fn bias(&self) -> f64 {
        self.bias
    }

    /// Standard deviation of the error.
    pub const fn std(&self) -> f64 {
        self.std
    }

    /// The error of the mean of `readings` readings. The number 0 counts as 1.
    #[must_use]
    pub fn averaged(&self, readings: u32) -> Self {
        Self {
            std: self.std / f64::from(readings.max(1)).sqrt(),
            ..*self
        }
    }

    /// Whether the error is random. If the standard deviation is 0, no random numbers are drawn, and the error of every
    /// reading is the bias.
    pub fn is_random(&self) -> bool {
        self.std > 0.0
    }

    /// Draws the error of one reading. The function draws one random number, or none if the standard deviation is 0.
    #[inline]
    pub fn draw(&self, stream: &mut Stream) -> f64 {
        if !self.is_random() {
            return self.bias;
        }
        self.bias + self.std * stream.standard_normal()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Channel;
    use approx::assert_relative_eq;

    #[test]
    fn errors_have_the_stated_size_and_means_a_smaller_one() {
        let single = GaussianError::new(0.3).unwrap();
        for (error, std) in [
            (single, 0.3),
            (single.averaged(4), 0.15),
            (single.averaged(0), 0.3),
        ] {
            assert_relative_eq!(error.std(), std, max_relative = 1e-15);
            let mut stream = Stream::new(5, 0, Channel::NormalDisplacement);
            let count = 100_000;
            let errors: Vec<f64> = (0..count).map(|_| error.draw(&mut stream)).collect();
            let mean = errors.iter().sum::<f64>() / f64::from(count);
            let square = errors.iter().map(|error| error * error).sum::<f64>() / f64::from(count);
            assert!(mean.abs() < 0.02 * std, "{mean}");
            assert_relative_eq!(square.sqrt(), std, max_relative = 0.01);
        }
    }

    #[test]
    fn a_bias_is_added_to_each_draw_and_stays_in_the_mean() {
        let error = GaussianError::new(0.3).unwrap();
        let biased = error.with_bias(-2.0).unwrap();
        let draw = |error: GaussianError| error.draw(&mut Stream::new(5, 0, Channel::Gain));
        assert_eq!(draw(biased.averaged(9)), draw(error.averaged(9)) - 2.0);
        let exact = GaussianError::new(0.0).unwrap().with_bias(0.5).unwrap();
        assert!(!exact.is_random() && draw(exact) == 0.5);
        assert_eq!(error.with_bias(f64::NAN).unwrap_err().setting, "bias");
    }

    #[test]
    fn without_an_error_nothing_is_drawn() {
        let exact = GaussianError::new(0.0).unwrap();
        assert!(!exact.is_random());
        let mut stream = Stream::new(5, 0, Channel::Gain);
        assert_eq!(exact.draw(&mut stream), 0.0);
        let untouched = Stream::new(5, 0, Channel::Gain).symmetric_uniform();
        assert_eq!(stream.symmetric_uniform(), untouched);
    }
}

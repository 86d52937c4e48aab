//! Chi-squared in which wrong markers count less.

/// Product of so much is turned into its logarithm.
const MUCH: f64 = 1e100;

/// Chi-squared that is summed marker by marker. Of a marker's sum of squares s counts c² ln(1 + s/c²) after Cauchy,
/// which is about s within the tolerance c.
pub(super) struct Misfit {
    /// c², in variances.
    limit: f64,
    sum: f64,
    /// Product of 1 + s/c², the logarithm of which is still to be taken: one for many markers.
    product: f64,
}

impl Misfit {
    /// The sum over no markers, for a tolerance in standard deviations; all residuals count alike if it is infinite.
    pub(super) const fn new(tolerance: f64) -> Self {
        Self {
            limit: tolerance * tolerance,
            sum: 0.0,
            product: 1.0,
        }
    }

    /// Adds a marker with these residuals, in standard deviations; the weight of its slopes.
    pub(super) fn add(&mut self, residuals: [f64; 3]) -> f64 {
        let squared: f64 = residuals.iter().map(|residual| residual * residual).sum();
        if self.limit == f64::INFINITY {
            self.sum += squared;
            return 1.0;
        }
        let rise = 1.0 + squared / self.limit;
        let product = self.product * rise;
        if product < MUCH {
            self.product = product;
        } else {
            self.sum += self.limit * (libm::log(self.product) + libm::log(rise));
            self.product = 1.0;
        }
        rise.recip()
    }

    /// The sum.
    pub(super) fn total(&self) -> f64 {
        if self.product == 1.0 {
            self.sum
        } else {
            self.sum + self.limit * libm::log(self.product)
        }
    }
}

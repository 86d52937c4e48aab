//! Sums over trials, by which intervals are judged.

use palpate_statistics::HALF_WIDTHS;

/// Intervals of 95 % that hold less often than this do not hold in a scene.
pub(super) const HOLDS: f64 = 0.85;

/// Sums over the places and trials of one scene.
#[derive(Clone, Debug, Default)]
pub(super) struct Sums {
    /// Number of curvatures that were asked for.
    pub(super) asked: f64,
    /// Number of those that have a standard deviation.
    pub(super) stated: f64,
    pub(super) within: [f64; 3],
    pub(super) error: f64,
    pub(super) square_error: f64,
    pub(super) square_std: f64,
    pub(super) std: f64,
}

/// Whether intervals of 50, 80 and 95 % about an estimate with this error and standard deviation hold the truth.
pub(super) fn within(error: f64, std: f64) -> [bool; 3] {
    within_widths(error, std, HALF_WIDTHS)
}

/// Whether intervals of these half-widths, in standard deviations, hold the truth.
pub(super) fn within_widths(error: f64, std: f64, half_widths: [f64; 3]) -> [bool; 3] {
    half_widths.map(|width| error.abs() <= width * std)
}

impl Sums {
    pub(super) fn add(&mut self, error: f64, std: f64, holds: [bool; 3]) {
        self.stated += 1.0;
        for (within, holds) in self.within.iter_mut().zip(holds) {
            *within += f64::from(u8::from(holds));
        }
        self.error += error;
        self.square_error += error * error;
        self.square_std += std * std;
        self.std += std;
    }

    pub(super) fn coverage(&self, width: usize) -> f64 {
        self.within[width] / self.asked
    }

    pub(super) fn std_per_rms(&self) -> f64 {
        (self.square_std / self.square_error).sqrt()
    }

    /// Root mean square of the errors.
    pub(super) fn rms(&self) -> f64 {
        (self.square_error / self.stated).sqrt()
    }

    /// Mean error over the errors' standard deviation.
    pub(super) fn mean_per_scatter(&self) -> f64 {
        let mean = self.error / self.stated;
        let variance = (self.square_error - self.stated * mean * mean) / (self.stated - 1.0);
        mean / variance.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_error_counts_in_the_scatter() {
        let mut sums = Sums::default();
        for error in [1.0, 2.0, 3.0] {
            sums.add(error, 1.0, within(error, 1.0));
        }
        // Their standard deviation is 1.
        assert!((sums.mean_per_scatter() - 2.0).abs() < 1e-12);
        assert!((sums.rms() - (14.0_f64 / 3.0).sqrt()).abs() < 1e-12);
    }
}

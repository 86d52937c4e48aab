//! A straight line through readings.

use super::bound::near;

/// Place along x: the mean of the readings there, and their standard deviation.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reading {
    pub(super) x: f64,
    pub(super) mean: f64,
    pub(super) std: f64,
}

/// A line by least squares.
#[derive(Debug, Clone, Copy)]
pub(super) struct StraightLine {
    pub(super) slope: f64,
    /// Share of the variance of single readings that the line explains; 0 where there is none to explain.
    pub(super) r_squared: f64,
}

impl StraightLine {
    /// The line through `readings`, places weighted alike; none if they stand at fewer than three places, through which
    /// any line would be good.
    pub(super) fn through(readings: &[Reading]) -> Option<Self> {
        let mut places: Vec<f64> = readings.iter().map(|reading| reading.x).collect();
        places.sort_by(f64::total_cmp);
        places.dedup_by(|a, b| near(*a, *b));
        if places.len() < 3 {
            return None;
        }
        let count = readings.len() as f64;
        let mean = |of: &dyn Fn(&Reading) -> f64| readings.iter().map(of).sum::<f64>() / count;
        let (x, y) = (mean(&|r| r.x), mean(&|r| r.mean));
        let slope = mean(&|r| (r.x - x) * (r.mean - y)) / mean(&|r| (r.x - x).powi(2));
        let scatter = mean(&|r| r.std * r.std);
        let left = mean(&|r| (r.mean - y - slope * (r.x - x)).powi(2)) + scatter;
        let all = mean(&|r| (r.mean - y).powi(2)) + scatter;
        let r_squared = if all > 0.0 { 1.0 - left / all } else { 0.0 };
        (slope.is_finite() && r_squared.is_finite()).then_some(Self { slope, r_squared })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn readings(values: &[(f64, f64)], std: f64) -> Vec<Reading> {
        let reading = |(x, mean): &(f64, f64)| Reading {
            x: *x,
            mean: *mean,
            std,
        };
        values.iter().map(reading).collect()
    }

    #[test]
    fn a_known_line() {
        // About the means 1 and 5/3: Sxy = 2, Sxx = 2; residuals 1/3, −2/3, 1/3 leave 6/9 of Syy = 24/9.
        let bent = [(0.0, 1.0), (1.0, 1.0), (2.0, 3.0)];
        let line = StraightLine::through(&readings(&bent, 0.0)).unwrap();
        assert!((line.slope - 1.0).abs() < 1e-15);
        assert!((line.r_squared - 0.75).abs() < 1e-15);
        // Scatter of variance 8/9 adds 24/9 to both sums: 1 − 30/48.
        let line = StraightLine::through(&readings(&bent, (8.0_f64 / 9.0).sqrt())).unwrap();
        assert!((line.r_squared - 0.375).abs() < 1e-15);
    }

    #[test]
    fn what_has_no_slope_explains_nothing_and_two_places_make_no_line() {
        let flat = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)];
        let line = StraightLine::through(&readings(&flat, 0.0)).unwrap();
        assert_eq!((line.slope, line.r_squared), (0.0, 0.0));
        let two = [(0.0, 1.0), (1.0, 2.0), (1.0, 2.5)];
        assert!(StraightLine::through(&readings(&two, 0.0)).is_none());
        let huge = [(0.0, 0.0), (1e200, 1e200), (2e200, 2e200)];
        assert!(StraightLine::through(&readings(&huge, 0.0)).is_none());
    }
}

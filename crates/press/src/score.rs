//! Score tests of a press's model (Rao): the decrease of chi-squared, to first order, by one more unknown in the model.
//!
//! The test projects the residuals on the pattern of that unknown, after removing the part that the fitted unknowns explain.

use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

use nalgebra::{DMatrix, DVector, SMatrix, SVector, Vector2, Vector3};
use palpate_statistics::{Explained, LEFT, doubted};

use crate::markers::Sight;
use crate::{Contact, Doubt, GoodnessOfFit, Measured};

/// Number of patterns. In this order: five by the distance; two by the direction; the mean over all directions of a row of
/// contacts; one by the indentation.
pub(crate) const PATTERNS: usize = 9;
const BY_DISTANCE: std::ops::Range<usize> = 0..5;
const BY_DIRECTION: std::ops::Range<usize> = 5..7;
const WIDER: usize = 7;
/// Pattern of an indentation that is stated as exact.
pub(crate) const BY_INDENTATION: usize = 8;

/// Number of directions over half a turn in which the test looks for a row of contacts.
const ROWS: usize = 60;

/// A pattern is tested only if the fitted unknowns leave at least this share of it. A smaller rest is mostly an effect of the
/// curved model with uncertain unknowns.
const MIN_REMAINING_SHARE: f64 = 0.1;

/// Approximate number of standard deviations beyond which a marker is rejected as an outlier.
const OUTLIER: f64 = 5.0;

/// Whether an error of a marker that is too small for rejection can change the curvature by a standard deviation. `moves` is
/// the variance of the curvature due to the noise of this marker. Other markers cannot spoil the interval.
pub(crate) fn matters(moves: f64, variance: f64) -> bool {
    OUTLIER * OUTLIER * moves >= variance
}

pub(crate) type Patterns = SVector<f64, PATTERNS>;

/// Directions at 0, 45, 90 and 135 degrees from the bearing's first axis.
const AXES: [[f64; 2]; 4] = [
    [1.0, 0.0],
    [FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [0.0, 1.0],
    [-FRAC_1_SQRT_2, FRAC_1_SQRT_2],
];

/// Patterns of a marker's displacement by a contact, of any scale: inward, and along the axes at the marker.
pub(crate) fn patterns(contact: &Contact<'_>, sight: &Sight) -> [Patterns; 3] {
    let field = contact.field(sight.distance);
    let mut normal = Patterns::zeros();
    normal[0] = field.normal;
    normal[1] = sight.distance * field.normal_per_r;
    normal[2] = contact.radius * contact.radius;
    let mut radial = Patterns::zeros();
    radial[3] = field.radial;
    radial[4] = sight.distance * field.radial_per_r;
    let mut all = [normal, radial * sight.outward.x, radial * sight.outward.y];
    let here = at_shifted(contact, sight, Vector2::zeros());
    let rows = AXES.map(|axis| {
        let side = Vector2::from(axis) * contact.radius;
        at_shifted(contact, sight, side) + at_shifted(contact, sight, -side) - 2.0 * here
    });
    for (component, all) in all.iter_mut().enumerate() {
        let [along, oblique, across, other] = rows.map(|row| row[component]);
        all[BY_DIRECTION.start] = along - across;
        all[BY_DIRECTION.start + 1] = oblique - other;
        all[WIDER] = 0.5 * (along + oblique + across + other);
    }
    all
}

/// Displacement, inward and along the axes at the marker, by the contact shifted by a vector.
fn at_shifted(contact: &Contact<'_>, sight: &Sight, by: Vector2<f64>) -> Vector3<f64> {
    let from = sight.bearing * sight.distance - by;
    let distance = from.norm();
    let moved = contact.displacement(distance);
    if distance == 0.0 {
        return Vector3::new(moved.normal, 0.0, 0.0);
    }
    // The axes at the marker are rotated against the bearing by the same angle as the outward direction.
    let along = [from.dot(&sight.bearing), sight.bearing.perp(&from)];
    let [cosine, sine] = along.map(|one| one / distance);
    let [x, y] = [sight.outward.x, sight.outward.y];
    let along = Vector2::new(cosine * x - sine * y, sine * x + cosine * y) * moved.radial;
    Vector3::new(moved.normal, along.x, along.y)
}

/// Pattern of a row of contacts along a direction at this angle: to second order in their distance, the sum of a part common to
/// all directions and a second harmonic.
fn row_at(angle: f64) -> Patterns {
    let (sine, cosine) = libm::sincos(2.0 * angle);
    let mut weights = Patterns::zeros();
    weights[BY_DIRECTION.start] = cosine;
    weights[BY_DIRECTION.start + 1] = sine;
    weights[WIDER] = 1.0;
    weights
}

/// Noise to which residuals are compared.
#[derive(Clone, Copy)]
pub(crate) enum Noise {
    /// Noise whose size is stated.
    Stated,
    /// Noise estimated from the residuals, with their chi-squared and degrees of freedom.
    Found { chi_squared: f64, freedom: usize },
}

impl Noise {
    /// The stated noise, or the noise of the residuals if they are significantly larger: with too small a stated noise every
    /// pattern would be significant.
    pub(crate) fn stated_or_found(goodness: GoodnessOfFit) -> Self {
        match goodness.is_doubted() {
            true => Self::Found {
                chi_squared: goodness.chi_squared,
                freedom: goodness.freedom,
            },
            false => Self::Stated,
        }
    }

    /// P-value of the decrease of chi-squared that patterns explain.
    pub(crate) fn chance(&self, explained: Explained) -> f64 {
        match *self {
            Self::Stated => explained.p_value(),
            Self::Found {
                chi_squared,
                freedom,
            } => explained.p_value_beside(chi_squared, freedom),
        }
    }

    /// P-value of the difference between the stated indentation and the fitted one, whose variance is `variance`; `None` if
    /// no indentation is stated or it was not fitted.
    pub(crate) fn indentation(
        &self,
        stated: Option<Measured>,
        is_fitted: bool,
        fitted: f64,
        variance: f64,
    ) -> Option<f64> {
        let stated = stated.filter(|_| is_fitted)?;
        let (off, prior) = (fitted - stated.value, stated.std * stated.std);
        // The fit moves only this share of the way from the stated indentation to that of the displacements alone.
        let share = 1.0 - variance / prior;
        Some(match share > LEFT {
            true => self.chance(Explained {
                fall: off * off / (share * prior),
                freedom: 1,
            }),
            false => 1.0,
        })
    }
}

/// Weighted sums over readings of the products of their residuals, their slopes by the unknowns, and the patterns.
pub(crate) struct Products<const UNKNOWNS: usize> {
    pub(crate) by_slopes: SMatrix<f64, UNKNOWNS, PATTERNS>,
    pub(crate) by_patterns: SMatrix<f64, PATTERNS, PATTERNS>,
    pub(crate) by_residuals: Patterns,
}

/// Projection of the residuals of a fit on the patterns.
pub(crate) struct Score {
    found: Patterns,
    /// Products of the patterns, and of their parts that the unknowns do not explain.
    all: SMatrix<f64, PATTERNS, PATTERNS>,
    left: SMatrix<f64, PATTERNS, PATTERNS>,
    pub(crate) noise: Noise,
}

impl Score {
    /// The score of a fit with this covariance of the unknowns and this gradient of half of chi-squared. The gradient is 0
    /// unless the best fit is at a limit of an unknown; its part of the residuals is removed (Neyman's C(α)).
    pub(crate) fn new<const UNKNOWNS: usize>(
        products: &Products<UNKNOWNS>,
        covariance: &SMatrix<f64, UNKNOWNS, UNKNOWNS>,
        gradient: &SVector<f64, UNKNOWNS>,
        noise: Noise,
    ) -> Self {
        let Products {
            by_slopes,
            by_patterns,
            by_residuals,
        } = products;
        let taken = by_slopes.transpose() * covariance;
        Self {
            found: by_residuals + taken * gradient,
            all: *by_patterns,
            left: by_patterns - taken * by_slopes,
            noise,
        }
    }

    /// P-value of the projection on these patterns.
    pub(crate) fn pattern(&self, range: std::ops::Range<usize>) -> f64 {
        let squares: Vec<f64> = range.clone().map(|one| self.all[(one, one)]).collect();
        let left = DMatrix::from_fn(range.len(), range.len(), |row, column| {
            self.left[(range.start + row, range.start + column)]
        });
        let found = DVector::from_fn(range.len(), |row, _| self.found[range.start + row]);
        let explained = Explained::by(&squares, &left, &found, MIN_REMAINING_SHARE);
        self.noise.chance(explained)
    }

    /// P-value of a row of contacts in the direction with the largest projection: an upper bound by the tube around the curve of
    /// the patterns of all directions (Hotelling; Naiman for estimated noise). `None` if the unknowns explain too much of the
    /// difference between a row and a round contact.
    fn rows(&self) -> Option<f64> {
        let rows: [Patterns; ROWS] =
            std::array::from_fn(|one| row_at(PI * one as f64 / ROWS as f64));
        let is_left =
            |row: &Patterns| self.left_of(row) > MIN_REMAINING_SHARE * row.dot(&(self.all * row));
        let wider = rows.iter().sum::<Patterns>();
        if !is_left(&wider) || !rows.iter().all(is_left) {
            return None;
        }
        let rows = rows.map(|row| row / self.left_of(&row).sqrt());
        let (mut most, mut length) = (0.0_f64, 0.0);
        for (row, last) in rows.iter().zip(rows.iter().cycle().skip(ROWS - 1)) {
            most = most.max(row.dot(&self.found));
            length += libm::acos(row.dot(&(self.left * last)).clamp(-1.0, 1.0));
        }
        // If no point of the closed curve leaves the tube, its mean is in the tube too.
        let mean = rows.iter().sum::<Patterns>() / ROWS as f64;
        let chance = |fall, freedom| self.noise.chance(Explained { fall, freedom });
        let squared = most * most;
        let beside = 0.5 * chance(squared / self.left_of(&mean), 1);
        Some((length / TAU * chance(squared, 2) + beside).min(1.0))
    }

    /// Square of the part of a sum of patterns that the unknowns do not explain.
    fn left_of(&self, weights: &Patterns) -> f64 {
        weights.dot(&(self.left * weights))
    }

    /// Doubts about the fit. `indentation` is the p-value of a stated indentation that was fitted, `slipped` that of this marker
    /// as an outlier, and `large` that of the residuals.
    pub(crate) fn doubts(
        &self,
        indentation: Option<f64>,
        (marker, slipped): (usize, f64),
        large: f64,
    ) -> Vec<Doubt> {
        let of_pattern = || self.pattern(BY_INDENTATION..BY_INDENTATION + 1);
        let (of_direction, of_rows) = (self.pattern(BY_DIRECTION), self.rows());
        let of_body = self.pattern(BY_DISTANCE);
        // Another body also makes the contact wider or narrower, but round.
        let of_rows = of_rows.filter(|_| of_body >= Doubt::LEVEL);
        let doubts = [
            Doubt::OtherIndentation {
                p_value: indentation.unwrap_or_else(of_pattern),
            },
            Doubt::OtherBody { p_value: of_body },
            Doubt::NotRound {
                p_value: of_rows.map_or(of_direction, |of_rows| {
                    (2.0 * of_rows.min(of_direction)).min(1.0)
                }),
            },
            Doubt::SlippedMarker {
                marker,
                p_value: slipped,
            },
            Doubt::LargeResiduals { p_value: large },
        ];
        let by_all = self.pattern(0..PATTERNS);
        let by_all = of_rows.map_or(by_all, |of_rows| of_rows.min(by_all));
        doubted(&doubts, Doubt::p_value, 3, by_all)
    }
}

#[cfg(test)]
mod tests {
    use palpate_sensing::{Channel, Stream};

    use super::*;

    /// Irregular numbers of both signs.
    fn scattered(number: usize) -> f64 {
        libm::sin(1.7 * (number * number) as f64 + 0.3)
    }

    #[test]
    fn what_lies_beyond_a_limit_of_the_unknowns_is_no_pattern() {
        const READINGS: usize = 20;
        let slopes =
            SMatrix::<f64, READINGS, 2>::from_fn(|row, column| scattered(2 * row + column));
        let patterns = SMatrix::<f64, READINGS, PATTERNS>::from_fn(|row, column| {
            scattered(90 + 9 * row + column)
        });
        // At a limit the residuals have a part that the unknowns would explain.
        let residuals = slopes * SVector::from([40.0, -70.0]);
        let products = Products {
            by_slopes: slopes.tr_mul(&patterns),
            by_patterns: patterns.tr_mul(&patterns),
            by_residuals: patterns.tr_mul(&residuals),
        };
        let covariance = slopes.tr_mul(&slopes).try_inverse().unwrap();
        let gradient = -slopes.tr_mul(&residuals);
        let score = Score::new(&products, &covariance, &gradient, Noise::Stated);
        assert!(score.pattern(0..PATTERNS) > 0.999_999);
        let unheld = Score::new(&products, &covariance, &SVector::zeros(), Noise::Stated);
        assert!(unheld.pattern(0..PATTERNS) < 1e-6);
    }

    /// Score of residuals that have as much of each pattern; the unknowns take of patterns by direction a share.
    fn found(found: Patterns, taken: f64) -> Score {
        let all = SMatrix::identity();
        let mut left = all;
        for one in BY_DIRECTION.start..=WIDER {
            left[(one, one)] -= taken;
        }
        let noise = Noise::Stated;
        Score {
            found,
            all,
            left,
            noise,
        }
    }

    #[test]
    fn a_marker_matters_whose_slip_may_spoil_the_curvature() {
        // A share of 0.1 of the variance is large enough, one of 0.01 is not.
        assert!(matters(0.1 * 0.3, 0.3) && !matters(0.01 * 0.3, 0.3));
    }

    #[test]
    fn rows_are_found_by_chance_as_often_as_said() {
        const TRIALS: u64 = 20_000;
        let mut told = 0.0;
        for trial in 0..TRIALS {
            let mut stream = Stream::new(2020, trial, Channel::Normal);
            let noise = Patterns::from_fn(|_, _| 0.5_f64.sqrt() * stream.standard_normal());
            let p_value = found(noise, 0.5).rows().unwrap();
            told += f64::from(p_value < Doubt::LEVEL_OF_ALL) / TRIALS as f64;
        }
        // Four standard deviations of this count of trials.
        assert!((told - Doubt::LEVEL_OF_ALL).abs() < 0.004, "{told}");
    }

    #[test]
    fn a_row_tells_more_by_its_width_too() {
        let row = row_at(1.1) * 2.4;
        let along = found(row, 0.0);
        assert!(along.rows().unwrap() < 0.3 * along.pattern(BY_DIRECTION));
        let narrow = Patterns::from_fn(|one, _| if one == WIDER { -row[one] } else { row[one] });
        assert!(found(narrow, 0.0).rows().unwrap() > along.pattern(BY_DIRECTION));
        assert_eq!(found(row, 0.95).rows(), None);
    }
}

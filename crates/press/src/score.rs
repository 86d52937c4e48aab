//! Score tests of a press's model (Rao): how much chi-squared would fall, to first order, if the model had one more unknown.
//!
//! The answer is what the residuals have of a pattern, after the unknowns that were fitted have taken of it what they can.

use std::f64::consts::FRAC_1_SQRT_2;

use nalgebra::{DMatrix, DVector, SMatrix, SVector, Vector2};
use palpate_chance::{Explained, LEFT, doubted};

use crate::markers::Sight;
use crate::{Contact, Doubt, GoodnessOfFit, MarkerDisplacement};

/// Patterns, in this order: what depends on the distance alone, on the direction, and on the indentation.
pub(crate) const PATTERNS: usize = 8;
const BY_DISTANCE: std::ops::Range<usize> = 0..5;
const BY_DIRECTION: std::ops::Range<usize> = 5..7;
/// Pattern of an indentation that is taken for exact.
pub(crate) const BY_INDENTATION: usize = 7;

pub(crate) type Patterns = SVector<f64, PATTERNS>;

/// Directions along and across which contacts are longer, as angles from the bearing's first axis.
const AXES: [[[f64; 2]; 2]; 2] = [
    [[1.0, 0.0], [0.0, 1.0]],
    [
        [FRAC_1_SQRT_2, FRAC_1_SQRT_2],
        [-FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    ],
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
    for (pattern, axes) in BY_DIRECTION.zip(AXES) {
        let longer = elongation(contact, sight, axes);
        let [x, y] = longer.tangential;
        for (all, longer) in all.iter_mut().zip([longer.normal, x, y]) {
            all[pattern] = longer;
        }
    }
    all
}

/// Displacements by a contact that is longer along one axis than along the other, less those of a round one: by contacts one
/// radius to either side along one, less those along the other.
fn elongation(contact: &Contact<'_>, sight: &Sight, axes: [[f64; 2]; 2]) -> MarkerDisplacement {
    let mut sum = MarkerDisplacement::default();
    for (axis, sign) in axes.into_iter().zip([1.0, -1.0]) {
        for side in [contact.radius, -contact.radius] {
            let from = sight.bearing * sight.distance - Vector2::from(axis) * side;
            let distance = from.norm();
            let moved = contact.displacement(distance);
            sum.normal += sign * moved.normal;
            if distance > 0.0 {
                // The marker's own axes are turned against the bearing's by as much as its outward direction is.
                let along = [from.dot(&sight.bearing), sight.bearing.perp(&from)];
                let [cosine, sine] = along.map(|one| one / distance);
                let [x, y] = [sight.outward.x, sight.outward.y];
                sum.tangential[0] += sign * moved.radial * (cosine * x - sine * y);
                sum.tangential[1] += sign * moved.radial * (sine * x + cosine * y);
            }
        }
    }
    sum
}

/// Noise that residuals are judged by.
pub(crate) enum Noise {
    /// Its size is stated.
    Stated,
    /// It is found from the residuals, whose sum of squares is this with so many degrees of freedom.
    Found { chi_squared: f64, freedom: usize },
}

impl Noise {
    /// The stated noise, or the noise that the residuals show where they are larger than the stated one makes them: noise
    /// that is stated too small finds every pattern.
    pub(crate) fn stated_or_found(goodness: GoodnessOfFit) -> Self {
        match goodness.is_doubted() {
            true => Self::Found {
                chi_squared: goodness.chi_squared,
                freedom: goodness.freedom,
            },
            false => Self::Stated,
        }
    }

    /// Probability by chance of as much that patterns explain.
    pub(crate) fn chance(&self, explained: Explained) -> f64 {
        match *self {
            Self::Stated => explained.p_value(),
            Self::Found {
                chi_squared,
                freedom,
            } => explained.p_value_beside(chi_squared, freedom),
        }
    }

    /// Probability by chance of a given indentation as far as `off` from the fitted one: its variance is `prior`, that of
    /// the fit `variance`.
    pub(crate) fn of_indentation(&self, off: f64, prior: f64, variance: f64) -> f64 {
        // The fit moved a share of the way from what is told to what the displacements alone tell.
        let share = 1.0 - variance / prior;
        match share > LEFT {
            true => self.chance(Explained {
                fall: off * off / (share * prior),
                freedom: 1,
            }),
            false => 1.0,
        }
    }
}

/// Sums over readings, by their weights, of products of their residuals, their slopes by the unknowns, and patterns.
pub(crate) struct Products<const UNKNOWNS: usize> {
    pub(crate) by_slopes: SMatrix<f64, UNKNOWNS, PATTERNS>,
    pub(crate) by_patterns: SMatrix<f64, PATTERNS, PATTERNS>,
    pub(crate) by_residuals: Patterns,
}

/// Share that residuals of a fit have of patterns.
pub(crate) struct Score {
    found: Patterns,
    /// Squares of the patterns, and products of what the unknowns leave of them.
    squares: Patterns,
    left: SMatrix<f64, PATTERNS, PATTERNS>,
    pub(crate) noise: Noise,
}

impl Score {
    /// The score of a fit whose unknowns have this covariance.
    pub(crate) fn new<const UNKNOWNS: usize>(
        products: &Products<UNKNOWNS>,
        covariance: &SMatrix<f64, UNKNOWNS, UNKNOWNS>,
        noise: Noise,
    ) -> Self {
        let Products {
            by_slopes,
            by_patterns,
            by_residuals,
        } = products;
        Self {
            found: *by_residuals,
            squares: by_patterns.diagonal(),
            left: by_patterns - by_slopes.transpose() * covariance * by_slopes,
            noise,
        }
    }

    /// Probability by chance of as much of these patterns as the residuals have.
    pub(crate) fn pattern(&self, range: std::ops::Range<usize>) -> f64 {
        let squares: Vec<f64> = range.clone().map(|one| self.squares[one]).collect();
        let left = DMatrix::from_fn(range.len(), range.len(), |row, column| {
            self.left[(range.start + row, range.start + column)]
        });
        let found = DVector::from_fn(range.len(), |row, _| self.found[range.start + row]);
        let explained = Explained::by(&squares, &left, &found, LEFT);
        self.noise.chance(explained)
    }

    /// Doubts about the fit. `indentation` is the probability by chance of one that was fitted about the given one, `slipped`
    /// that of a marker that contradicts the others as much as this one, and `large` that of the residuals.
    pub(crate) fn doubts(
        &self,
        indentation: Option<f64>,
        (marker, slipped): (usize, f64),
        large: f64,
    ) -> Vec<Doubt> {
        let of_pattern = || self.pattern(BY_INDENTATION..BY_INDENTATION + 1);
        let doubts = [
            Doubt::OtherIndentation {
                p_value: indentation.unwrap_or_else(of_pattern),
            },
            Doubt::OtherBody {
                p_value: self.pattern(BY_DISTANCE),
            },
            Doubt::NotRound {
                p_value: self.pattern(BY_DIRECTION),
            },
            Doubt::SlippedMarker {
                marker,
                p_value: slipped,
            },
            Doubt::LargeResiduals { p_value: large },
        ];
        let by_all = self.pattern(0..PATTERNS);
        doubted(&doubts, Doubt::p_value, 3, by_all)
    }
}

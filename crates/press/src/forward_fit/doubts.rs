//! Tests of a fit against readings that contradict it.
//!
//! Each asks how much chi-squared would fall, to first order, if the model had one more unknown (Rao's score test): what the
//! residuals have of a pattern, after the unknowns that were fitted have taken of it what they can.

use nalgebra::{DMatrix, DVector, SMatrix, SVector};
use palpate_chance::{Explained, LEFT};

use super::problem::{INDENTATION, Problem, Square, State, UNKNOWNS, Unknowns};
use super::reading::Reading;
use super::search::SINGULAR;
use super::settings::ForwardFit;
use crate::definite::inverse;
use crate::{Doubt, PressError, PressEstimate};

/// Patterns, in this order: what depends on the distance alone, on the direction, and on the indentation.
const PATTERNS: usize = 8;
const BY_DISTANCE: std::ops::Range<usize> = 0..5;
const BY_DIRECTION: std::ops::Range<usize> = 5..7;
const BY_INDENTATION: std::ops::Range<usize> = 7..8;
/// Noise that is found, as a share of the largest displacement, below which it may be rounding.
const ROUNDING: f64 = 1e-3;
/// Least number of equations beyond the unknowns by which noise that is found can be told from patterns.
const FEW: usize = 8;

type Patterns = SVector<f64, PATTERNS>;

/// Sums over readings of products of their residuals, slopes and patterns.
struct Products {
    by_slopes: SMatrix<f64, UNKNOWNS, PATTERNS>,
    by_patterns: SMatrix<f64, PATTERNS, PATTERNS>,
    by_residuals: Patterns,
}

impl ForwardFit {
    /// Ways in which readings contradict the model, of an estimate that this fit made of them; none for a Gaussian, which
    /// is no body, and where there are hardly more equations than unknowns.
    ///
    /// # Errors
    /// Those of [`ForwardFit::estimate`].
    pub fn doubts(
        &self,
        reading: &Reading<'_>,
        estimate: &PressEstimate,
    ) -> Result<Vec<Doubt>, PressError> {
        self.validate(reading)?;
        if self.body.is_approximate() {
            return Ok(Vec::new());
        }
        let mut problem = Problem::new(self, reading);
        let skin = reading.markers.skin();
        let place = problem.place_at(skin.place(estimate.contact).direction.as_ref());
        let state = State {
            log_curvature: libm::log(estimate.most_likely_curvature),
            place,
            indentation: estimate.indentation.value,
            baseline: estimate.baseline.map_or(0.0, |baseline| baseline.value),
            gain: estimate.gain.map_or(1.0, |gain| gain.value),
        };
        problem.keep_window(&state);
        for &marker in &estimate.wrong_markers {
            if let Some(kept) = problem.kept.get_mut(marker) {
                *kept = false;
            }
        }
        problem.normal_std = estimate.normal_std;
        problem.tangential_std = estimate.tangential_std.unwrap_or(problem.tangential_std);
        let doubts = Test::new(&problem, &state)?.map(|test| test.doubts(estimate));
        Ok(doubts.transpose()?.unwrap_or_default())
    }
}

/// A fit with all that its tests ask for.
struct Test<'p, 'a> {
    problem: &'p Problem<'a>,
    state: &'p State,
    covariance: Square,
    chi_squared: f64,
    freedom: usize,
}

impl<'p, 'a> Test<'p, 'a> {
    /// The tests of a fit; `None` where there is nothing to be tested.
    fn new(problem: &'p Problem<'a>, state: &'p State) -> Result<Option<Self>, PressError> {
        let freedom = problem.equations().saturating_sub(problem.unknowns());
        let largest = problem.reading.normal.iter();
        let largest = largest.fold(0.0, |most: f64, one| most.max(one.abs()));
        let is_rounding = !problem.knows_noise() && problem.normal_std <= ROUNDING * largest;
        if freedom < FEW || is_rounding {
            return Ok(None);
        }
        let sums = problem.sums(state)?;
        Ok(inverse(&sums.hessian, SINGULAR).map(|covariance| Self {
            problem,
            state,
            covariance,
            chi_squared: sums.chi_squared,
            freedom,
        }))
    }

    fn doubts(self, estimate: &PressEstimate) -> Result<Vec<Doubt>, PressError> {
        let large = Doubt::LargeResiduals {
            p_value: estimate.goodness.map_or(1.0, |goodness| goodness.p_value),
        };
        if !estimate.is_seen {
            // Patterns are sought about the best of all fits, which this is not.
            let is_large = large.p_value() < Doubt::LEVEL;
            return Ok(is_large.then_some(large).into_iter().collect());
        }
        let products = self.products()?;
        let pattern = |range: std::ops::Range<usize>| self.pattern(&products, range);
        let (marker, slipped) = self.slipped()?;
        let doubts = [
            Doubt::OtherIndentation {
                p_value: self
                    .indentation()
                    .unwrap_or_else(|| pattern(BY_INDENTATION)),
            },
            Doubt::OtherBody {
                p_value: pattern(BY_DISTANCE),
            },
            Doubt::NotRound {
                p_value: pattern(BY_DIRECTION),
            },
            Doubt::SlippedMarker {
                marker,
                p_value: slipped,
            },
            large,
        ];
        let least = doubts[..3]
            .iter()
            .map(|doubt| doubt.p_value())
            .fold(1.0, f64::min);
        // What no pattern alone tells, all may tell together.
        let is_told_by_all = pattern(0..PATTERNS) < Doubt::LEVEL_OF_ALL;
        let is_doubted = |doubt: &Doubt| {
            let p_value = doubt.p_value();
            p_value < Doubt::LEVEL || is_told_by_all && p_value == least
        };
        Ok(doubts.into_iter().filter(is_doubted).collect())
    }

    fn products(&self) -> Result<Products, PressError> {
        let (problem, state) = (self.problem, self.state);
        let contact = problem.contact(state)?;
        let is_given = problem.reading.indentation.is_some() && !problem.sought[INDENTATION];
        let mut products = Products {
            by_slopes: SMatrix::zeros(),
            by_patterns: SMatrix::zeros(),
            by_residuals: Patterns::zeros(),
        };
        let slopes = problem.slopes(state)?;
        for (marker, slopes) in problem.counting().zip(slopes) {
            let sight = problem.sight(state, marker);
            let field = contact.field(sight.distance);
            let stretch = sight.distance * field.normal_per_r;
            let (cosine, sine) = (sight.bearing.x, sight.bearing.y);
            let [along, across] = [cosine * cosine - sine * sine, 2.0 * cosine * sine];
            let mut normal = Patterns::zeros();
            normal[0] = field.normal;
            normal[1] = stretch;
            normal[2] = contact.radius * contact.radius;
            normal[5] = along * stretch;
            normal[6] = across * stretch;
            let mut patterns = [
                normal / problem.normal_std,
                Patterns::zeros(),
                Patterns::zeros(),
            ];
            if problem.uses_tangential() {
                for axis in 0..2 {
                    let outward = [sight.outward.x, sight.outward.y][axis];
                    let stretch = sight.distance * field.radial_per_r;
                    let mut tangential = Patterns::zeros();
                    tangential[3] = field.radial;
                    tangential[4] = stretch;
                    tangential[5] = along * stretch;
                    tangential[6] = across * stretch;
                    patterns[1 + axis] = tangential * (outward / problem.tangential_std);
                }
            }
            let residuals = problem.residuals_at(&contact, state, marker);
            for ((patterns, slopes), residual) in patterns.iter_mut().zip(&slopes).zip(residuals) {
                if is_given {
                    patterns[BY_INDENTATION.start] = slopes[INDENTATION];
                }
                products.by_slopes += self.sought(slopes) * patterns.transpose();
                products.by_patterns += *patterns * patterns.transpose();
                products.by_residuals += *patterns * residual;
            }
        }
        Ok(products)
    }

    /// Slopes by the unknowns that were fitted.
    fn sought(&self, slopes: &Unknowns) -> Unknowns {
        Unknowns::from_fn(|unknown, _| match self.problem.sought[unknown] {
            true => slopes[unknown],
            false => 0.0,
        })
    }

    /// Probability by chance of as much of these patterns as the residuals have.
    fn pattern(&self, products: &Products, range: std::ops::Range<usize>) -> f64 {
        let Products {
            by_slopes,
            by_patterns,
            by_residuals,
        } = products;
        let left = by_patterns - by_slopes.transpose() * self.covariance * by_slopes;
        let squares: Vec<f64> = range.clone().map(|one| by_patterns[(one, one)]).collect();
        let left = DMatrix::from_fn(range.len(), range.len(), |row, column| {
            left[(range.start + row, range.start + column)]
        });
        let found = DVector::from_fn(range.len(), |row, _| by_residuals[range.start + row]);
        self.chance(Explained::by(&squares, &left, &found, LEFT))
    }

    /// Probability by chance of as much that patterns explain.
    fn chance(&self, explained: Explained) -> f64 {
        if self.problem.knows_noise() {
            return explained.p_value();
        }
        explained.p_value_beside(self.chi_squared, self.freedom)
    }

    /// Probability by chance of a given indentation as far from the one that the displacements tell, where it was fitted
    /// too; `None` where it was not.
    fn indentation(&self) -> Option<f64> {
        let told = self.problem.reading.indentation?;
        if !self.problem.sought[INDENTATION] {
            return None;
        }
        let variance = self.covariance[(INDENTATION, INDENTATION)];
        let prior = told.std * told.std;
        // The fit moved a share of the way from what is told to what the displacements alone tell.
        let share = 1.0 - variance / prior;
        let off = self.state.indentation - told.value;
        let of_off = share * prior;
        Some(match share > LEFT {
            true => self.chance(Explained {
                fall: off * off / of_off,
                freedom: 1,
            }),
            false => 1.0,
        })
    }

    /// The marker that contradicts the others most, and the probability that chance makes one do as much.
    fn slipped(&self) -> Result<(usize, f64), PressError> {
        let (problem, state) = (self.problem, self.state);
        let contact = problem.contact(state)?;
        let components = if problem.uses_tangential() { 3 } else { 1 };
        let (mut most, mut least) = (0, 1.0);
        for (marker, slopes) in problem.counting().zip(problem.slopes(state)?) {
            let residuals = problem.residuals_at(&contact, state, marker);
            let mut square = 0.0;
            for (residual, slopes) in residuals.iter().zip(&slopes) {
                let slopes = self.sought(slopes);
                let leverage = slopes.dot(&(self.covariance * slopes));
                square += residual * residual / (1.0 - leverage).max(LEFT);
            }
            let chance = self.chance(Explained {
                fall: square,
                freedom: components,
            });
            if chance < least {
                (most, least) = (marker, chance);
            }
        }
        Ok((most, (least * problem.counting().count() as f64).min(1.0)))
    }
}

//! Least-squares search for the sensor parameters that fit the image of the markers at rest best.

use nalgebra::DVector;

use super::image_search::WRONG;
use super::rest::{Pictures, Rest, Resting, State};
use super::view::NUMBERS;
use crate::{GoodnessOfFit, PressError};

const MAX_STEPS: usize = 200;
/// Levenberg–Marquardt damping of the first step, relative to the information in the priors.
const DAMPING: f64 = 1.0;
/// A search ends if its Levenberg–Marquardt damping exceeds this value.
const MAX_DAMPING: f64 = 1e9;
/// Convergence limit for searches with the stated variances of the readings: a search ends after a step that decreases
/// chi-squared by less than this value.
const ENOUGH: f64 = 1e-6;
/// Convergence limit for searches with increased variances of the readings, which need not be exact: a search ends
/// after a step that decreases chi-squared by less than this value.
const ROUGHLY: f64 = 1.0;
/// Largest factor by which the variances of the readings are multiplied.
const MAX_VARIANCE: f64 = 1e12;
const FALL: f64 = 10.0;
/// Exponents e of the first factor v^e on the variances of the readings, in the order in which they are tried. Here v
/// is the variance of the residuals before the first search, in units of the stated variances. For each exponent, one
/// sequence of searches starts with this factor.
const ROOTS: [f64; 4] = [1.0, 0.5, 0.25, 0.0];
/// Smallest accepted p-value of chi-squared. If the p-value is smaller, a further sequence of searches follows. With a
/// correct sensor model, the probability of a further sequence equals this constant.
const PLAUSIBLE: f64 = 1e-3;

struct Minimum {
    state: State,
    pictures: Pictures,
    cost: Cost,
}

/// Misfit between sensor parameters and the frame at rest. Misfits are compared by the number of hidden markers, which
/// have a reading but are not visible in the model. If these numbers are equal, they are compared by the sum of squared
/// residuals of the other markers.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
struct Cost {
    hidden: usize,
    squares: f64,
}

impl Cost {
    fn less(self, other: Self) -> f64 {
        match self.hidden == other.hidden {
            true => self.squares - other.squares,
            false => f64::INFINITY,
        }
    }
}

impl Resting<'_> {
    pub(super) fn rest(&self) -> Result<Rest, PressError> {
        let start = State {
            common: DVector::zeros(self.free.len()),
            misalignments: vec![[0.0; 2]; self.markers()],
        };
        let variance = self.variance_at(&start).ok_or(PressError::OutOfRange)?;
        let mut least: Option<(Minimum, f64)> = None;
        // A sequence of searches multiplies the variances of the readings by a factor that decreases to 1. Sequences
        // with different first factors may end in different minima, so try several and use the best minimum.
        for root in ROOTS {
            let Ok(minimum) = self.cooled(start.clone(), libm::pow(variance, root)) else {
                continue;
            };
            let square = self.robust(&minimum);
            if least.as_ref().is_none_or(|(_, least)| square < *least) {
                least = Some((minimum, square));
            }
            let goodness = GoodnessOfFit::new(square, self.freedom());
            if goodness.p_value >= PLAUSIBLE || variance <= 1.0 {
                break;
            }
        }
        let (minimum, _) = least.ok_or(PressError::OutOfRange)?;
        let (state, squares) = (minimum.state, minimum.cost.squares);
        let mut readings = self.frame.weights.iter().zip(&minimum.pictures);
        let is_hidden =
            |(weight, picture): (&Option<_>, &Option<_>)| weight.is_some() && picture.is_none();
        if let Some(marker) = readings.position(is_hidden) {
            return Err(PressError::HiddenMarker { marker });
        }
        let slopes = self.slopes(&state).ok_or(PressError::OutOfRange)?;
        let equations = self.equations(&state, &slopes, 0.0);
        let equations = equations.filter(|_| squares.is_finite());
        let equations = equations.ok_or(PressError::OutOfRange)?;
        Ok(self.result(state, equations, slopes, squares))
    }

    /// Finds the minimum by a sequence of searches. Each search multiplies the variances of the readings by a factor,
    /// which decreases to 1 from search to search. Far from its global minimum, chi-squared has local minima and narrow
    /// valleys. They disappear if the variances are as large as the squared residuals before the first search. While
    /// the factor decreases, the searches stay near the global minimum.
    fn cooled(&self, mut state: State, mut variance: f64) -> Result<Minimum, PressError> {
        while variance > 1.0 {
            let noisier = self.noisier(variance);
            state = noisier.minimised(state, ROUGHLY)?.state;
            variance /= FALL;
        }
        self.minimised(state, ENOUGH)
    }

    fn cost(&self, state: &State, pictures: &Pictures) -> Cost {
        let own = self.own_costs(state, pictures).into_iter().flatten();
        let (seen, hidden): (Vec<f64>, Vec<f64>) = own.partition(|square| square.is_finite());
        Cost {
            hidden: hidden.len(),
            squares: state.common.norm_squared() + seen.into_iter().sum::<f64>(),
        }
    }

    /// For each marker, the sum of the squared residuals of its reading and its misalignment. The sum is infinite if
    /// the marker has a reading but is not visible in the model, and `None` if the marker has no reading.
    fn own_costs(&self, state: &State, pictures: &Pictures) -> Vec<Option<f64>> {
        let own = |marker: usize| {
            let weight = self.frame.weights[marker].as_ref()?;
            let residual = self.frame.residual(marker, pictures);
            let square =
                residual.map_or(f64::INFINITY, |residual| residual.dot(&(weight * residual)));
            let [x, y] = state.misalignments[marker];
            let known = match self.fit.misalignment_std {
                0.0 => 0.0,
                std => (x * x + y * y) / (std * std),
            };
            Some(square + known)
        };
        (0..self.markers()).map(own).collect()
    }

    fn robust(&self, minimum: &Minimum) -> f64 {
        let own = self.own_costs(&minimum.state, &minimum.pictures);
        let own = own.into_iter().flatten().map(|square| square.min(WRONG));
        minimum.state.common.norm_squared() + own.sum::<f64>()
    }

    /// Noise variance of the residuals, relative to the stated variances. It is the median over the markers of the mean
    /// squared residual, so up to half of the markers may be outliers. `None` if the sensor parameters `state` are
    /// impossible.
    fn variance_at(&self, state: &State) -> Option<f64> {
        let pictures = self.pictures(state)?;
        let costs = self.own_costs(state, &pictures);
        let mut squares: Vec<f64> = costs.into_iter().flatten().collect();
        squares.sort_by(f64::total_cmp);
        let middle = squares.get(squares.len() / 2)?;
        Some((middle / NUMBERS as f64).min(MAX_VARIANCE))
    }

    fn noisier(&self, variance: f64) -> Self {
        let mut frame = (*self.frame).clone();
        for weight in frame.weights.iter_mut().flatten() {
            *weight /= variance;
        }
        Self {
            frame: frame.into(),
            free: self.free.clone(),
            known: self.known.clone(),
            fit: self.fit,
        }
    }

    /// The minimum of chi-squared near the sensor parameters `state`, and the sensor parameters at this minimum. The
    /// search ends after a step that decreases chi-squared by less than `enough`.
    fn minimised(&self, mut state: State, enough: f64) -> Result<Minimum, PressError> {
        let impossible = PressError::OutOfRange;
        let mut pictures = self.pictures(&state).ok_or(impossible)?;
        let mut slopes = self.slopes(&state).ok_or(impossible)?;
        let mut cost = self.cost(&state, &pictures);
        let mut damping = DAMPING;
        for _ in 0..MAX_STEPS {
            let equations = self.equations(&state, &slopes, damping).ok_or(impossible)?;
            let tried = self.stepped(&state, &equations);
            let better = tried.and_then(|tried| {
                let pictures = self.pictures(&tried)?;
                let less = self.cost(&tried, &pictures);
                (less <= cost).then_some((tried, pictures, less))
            });
            match better {
                Some((tried, seen, less)) => {
                    let gain = cost.less(less);
                    (state, pictures, cost) = (tried, seen, less);
                    // A small decrease of the cost means convergence only if the damping is weak. With strong damping,
                    // every step is small.
                    if gain <= enough && damping <= DAMPING {
                        break;
                    }
                    damping *= 0.1;
                    slopes = self.slopes(&state).ok_or(impossible)?;
                }
                None => {
                    damping *= 10.0;
                    if damping > MAX_DAMPING {
                        break;
                    }
                }
            }
        }
        Ok(Minimum {
            state,
            pictures,
            cost,
        })
    }
}

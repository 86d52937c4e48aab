//! Way down to the sensor that frames show: the least sum of squares.

use nalgebra::DVector;

use super::frame::KnownFrame;
use super::outcome::WRONG;
use super::rest::{Pictures, Rest, Resting, State};
use super::view::{NUMBERS, View};
use crate::{GoodnessOfFit, PressError};

const MOST_STEPS: usize = 200;
/// Damping of a first step: as much information as there is beforehand.
const DAMPING: f64 = 1.0;
const MOST_DAMPING: f64 = 1e9;
/// Decreases of chi-squared below which nothing is left to find: at last, and on the way there.
const ENOUGH: f64 = 1e-6;
const ROUGHLY: f64 = 1.0;
/// Most by which variances are multiplied on the way, and how fast they fall.
const MOST_VARIANCE: f64 = 1e12;
const FALL: f64 = 10.0;
/// Powers of that multiple from which further paths start where the sum of squares stays large.
const ROOTS: [f64; 4] = [1.0, 0.5, 0.25, 0.0];
/// P-value of a sum of squares that is not large: one sensor in a thousand is sought along further paths in vain.
const PLAUSIBLE: f64 = 1e-3;

/// The least sum of squares that was found.
struct Minimum {
    state: State,
    pictures: Pictures,
    cost: Cost,
}

/// Cost of a state, the least of which is sought: first the markers that were seen and should be out of sight, then the sum of
/// the squares of all others.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
struct Cost {
    hidden: usize,
    squares: f64,
}

impl Cost {
    /// Amount by which another is less.
    fn less(self, other: Self) -> f64 {
        match self.hidden == other.hidden {
            true => self.squares - other.squares,
            false => f64::INFINITY,
        }
    }

    /// Sum of all squares: infinite where a marker that was seen should be out of sight.
    fn sum(self) -> f64 {
        match self.hidden {
            0 => self.squares,
            _ => f64::INFINITY,
        }
    }
}

impl<V: View> Resting<'_, V> {
    /// The sensor that is likeliest.
    pub(super) fn rest(&self) -> Result<Rest, PressError> {
        let start = State {
            common: DVector::zeros(self.free.len()),
            misalignments: vec![[0.0; 2]; self.markers()],
        };
        let variance = self.variance_at(&start).ok_or(PressError::OutOfRange)?;
        let mut least: Option<(Minimum, f64)> = None;
        // Of paths that part where another minimum lies, some end in each.
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
        let Minimum { state, cost, .. } = minimum;
        let slopes = self.slopes(&state).ok_or(PressError::OutOfRange)?;
        let equations = self.equations(&state, &slopes, 0.0);
        let rest = self.told(
            state,
            equations.ok_or(PressError::OutOfRange)?,
            slopes,
            cost.sum(),
        );
        rest.ok_or(PressError::OutOfRange)
    }

    /// The least sum of squares by a path from variances so many times as large as those that are stated. Far from it are
    /// others that only look least, and narrow valleys: noise as large as what the start leaves has neither, and as it falls
    /// the state stays near the least.
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

    /// Sum of the squares of each marker, infinite where it should be out of sight; `None` of those that were not seen.
    fn own_costs(&self, state: &State, pictures: &Pictures) -> Vec<Option<f64>> {
        let square = |marker: usize, frame: &KnownFrame, pictures: &[Option<[f64; NUMBERS]>]| {
            let weight = frame.weights[marker].as_ref()?;
            let residual = frame.residual(marker, pictures);
            // A marker that was seen cannot be out of sight.
            Some(residual.map_or(f64::INFINITY, |residual| residual.dot(&(weight * residual))))
        };
        let own = |marker: usize| {
            let frames = self.frames.iter().zip(pictures);
            let squares = frames.filter_map(|(frame, pictures)| square(marker, frame, pictures));
            let squares = squares.reduce(|sum, square| sum + square)?;
            let [x, y] = state.misalignments[marker];
            let known = match self.fit.misalignment_std {
                0.0 => 0.0,
                std => (x * x + y * y) / (std * std),
            };
            Some(squares + known)
        };
        (0..self.markers()).map(own).collect()
    }

    /// Sum of the squares where no marker counts more than a wrong one.
    fn robust(&self, minimum: &Minimum) -> f64 {
        let most = WRONG * self.frames.len() as f64;
        let own = self.own_costs(&minimum.state, &minimum.pictures);
        let own = own.into_iter().flatten().map(|square| square.min(most));
        minimum.state.common.norm_squared() + own.sum::<f64>()
    }

    /// Median over the markers of their mean square residual, in stated variances; half of them may be wrong.
    fn variance_at(&self, state: &State) -> Option<f64> {
        let pictures = self.pictures(state)?;
        let costs = self.own_costs(state, &pictures);
        let mut squares: Vec<f64> = costs.into_iter().flatten().collect();
        squares.sort_by(f64::total_cmp);
        let numbers = NUMBERS * self.frames.len();
        let middle = squares.get(squares.len() / 2)?;
        Some((middle / numbers as f64).min(MOST_VARIANCE))
    }

    /// The fit where all readings have so many times their variance.
    fn noisier(&self, variance: f64) -> Self {
        let mut frames = self.frames.to_vec();
        let weights = frames.iter_mut().flat_map(|frame| &mut frame.weights);
        for weight in weights.flatten() {
            *weight /= variance;
        }
        Self {
            frames: frames.into(),
            free: self.free.clone(),
            known: self.known.clone(),
            fit: self.fit,
        }
    }

    /// The least sum of squares near a state, to about so much.
    fn minimised(&self, mut state: State, enough: f64) -> Result<Minimum, PressError> {
        let impossible = PressError::OutOfRange;
        let mut pictures = self.pictures(&state).ok_or(impossible)?;
        let mut slopes = self.slopes(&state).ok_or(impossible)?;
        let mut cost = self.cost(&state, &pictures);
        let mut damping = DAMPING;
        for _ in 0..MOST_STEPS {
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
                    // Small steps gain little anywhere.
                    if gain <= enough && damping <= DAMPING {
                        break;
                    }
                    damping *= 0.1;
                    slopes = self.slopes(&state).ok_or(impossible)?;
                }
                None => {
                    damping *= 10.0;
                    if damping > MOST_DAMPING {
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

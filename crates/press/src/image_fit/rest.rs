//! Departures of the sensor that the markers at rest tell.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector, Dyn, Matrix2, OMatrix, U2, Vector4};

use super::frame::KnownFrame;
use super::settings::ImageFit;
use super::told::Known;
use super::view::{MOST_MISALIGNED, NUMBERS, Seen, Sensor, SensorState, View, difference};
use crate::{GoodnessOfFit, MarkerDisplacement, PressError};

/// Steps by which slopes are found, as shares of the standard deviation.
const SHARE: f64 = 1e-2;
/// Step of a misalignment, rad.
pub(super) const MISALIGNED: f64 = 1e-6;

/// The sensor as its markers at rest show it: misalignments, and what is common to all of them.
#[derive(Clone, Debug)]
pub struct Rest {
    /// Departures common to all markers from what calibration knows, the likeliest.
    pub common: Vec<f64>,
    /// Misalignment of each marker's discs, rad at the sensor's centre, the likeliest.
    pub misalignments: Vec<[f64; 2]>,
    /// Whether each marker was seen, and contradicts nothing.
    pub seen: Vec<bool>,
    /// Sum of the squares that are left, priors included: about `freedom` where all is as it should be.
    pub chi_squared: f64,
    /// Degrees of freedom of that sum.
    pub freedom: usize,
    /// Information on the common departures that are free, after the frame at rest.
    pub(super) information: DMatrix<f64>,
    /// How each marker's misalignment follows the free common departures, and its covariance beyond that.
    pub(super) local: Vec<Option<Local>>,
    /// The frames that tell it.
    frames: Arc<[KnownFrame]>,
}

impl Rest {
    /// The sensor that is likeliest.
    pub(super) fn sensor(&self) -> Sensor {
        Sensor {
            common: self.common.clone(),
            misalignments: self.misalignments.clone(),
        }
    }

    /// How well the sensor fits the frames that tell it: a small p-value where they contradict each other or what is known of
    /// the sensor.
    pub fn goodness(&self) -> GoodnessOfFit {
        GoodnessOfFit::new(self.chi_squared, self.freedom)
    }

    /// Covariance of the common departures that are not exact, in their standard deviations; `None` where it cannot be
    /// computed.
    pub fn covariance(&self) -> Option<DMatrix<f64>> {
        let factor = self.information.clone().cholesky()?;
        Some(factor.inverse())
    }
}

/// Misalignment of a marker, as far as it is left unknown.
#[derive(Clone, Debug)]
pub(super) struct Local {
    pub(super) follows: OMatrix<f64, U2, Dyn>,
    pub(super) spread: Matrix2<f64>,
}

/// Slopes of the pictures at a state of the sensor.
pub(super) struct Slopes {
    /// By the free common departures, in their standard deviations: per marker 4 rows.
    pub(super) common: Vec<Option<OMatrix<f64, nalgebra::U4, Dyn>>>,
    /// By the misalignment, per rad.
    pub(super) local: Vec<Option<nalgebra::Matrix4x2<f64>>>,
}

impl<V: View> ImageFit<V> {
    /// The sensor as its markers at rest show it: one reading per marker, `None` for those that are not seen.
    ///
    /// # Errors
    /// [`PressError::BadSetting`], [`PressError::NotFinite`] for what is given; [`PressError::TooFewMarkers`] without
    /// a marker; [`PressError::OutOfRange`] where there is no such sensor.
    pub fn at_rest(&self, seen: &[Option<Seen>]) -> Result<Rest, PressError> {
        self.calibrated(seen, &[])
    }

    /// The sensor as frames tell it together.
    pub(super) fn told_by(&self, frames: Vec<KnownFrame>) -> Result<Rest, PressError> {
        Resting {
            fit: self,
            free: self.free(),
            known: self.known()?.map(Arc::new),
            frames: frames.into(),
        }
        .rest()
    }

    /// Knowledge of the sensor from the frame at rest, taken to first order about a sensor; `None` where there is no such sensor.
    pub(super) fn rest_about(&self, rest: &Rest, sensor: &Sensor) -> Option<Rest> {
        let resting = Resting {
            fit: self,
            free: self.free(),
            known: self.known().ok()?.map(Arc::new),
            frames: Arc::clone(&rest.frames),
        };
        let free = resting.free.iter();
        let common = free.map(|&number| sensor.common[number] / self.common_stds[number]);
        let state = State {
            common: DVector::from_iterator(resting.free.len(), common),
            misalignments: sensor.misalignments.clone(),
        };
        let pictures = resting.pictures(&state)?;
        let slopes = resting.slopes(&state, &pictures)?;
        let equations = resting.equations(&state, &pictures, &slopes, 0.0)?;
        let likeliest = resting.stepped(&state, &equations)?;
        Some(resting.told(likeliest, equations, rest.chi_squared))
    }

    /// Slopes of pictures by what is not known of the sensor; the markers move by `moved`, and where the discs of one
    /// colour lie deeper by what `deeper` tells per length.
    pub(super) fn slopes(
        &self,
        common: &[f64],
        misalignments: &[[f64; 2]],
        moved: &[[MarkerDisplacement; 2]],
        per_depth: Option<&[[MarkerDisplacement; 2]]>,
        at: &[Option<[f64; NUMBERS]>],
    ) -> Option<Slopes> {
        let markers = moved.len();
        let free = self.free();
        let mut of_common: Vec<_> = at
            .iter()
            .map(|at| at.map(|_| OMatrix::<f64, nalgebra::U4, Dyn>::zeros(free.len())))
            .collect();
        for (column, &number) in free.iter().enumerate() {
            let step = SHARE * self.common_stds[number];
            let mut common = common.to_vec();
            common[number] += step;
            let state = SensorState {
                common: &common,
                misalignments,
            };
            let pictures = match per_depth.filter(|_| number < 2) {
                Some(per_depth) => {
                    let shifted: Vec<_> = moved
                        .iter()
                        .zip(per_depth)
                        .map(|(moved, per_depth)| {
                            let mut moved = *moved;
                            let (disc, slope) = (&mut moved[number], &per_depth[number]);
                            disc.normal += step * slope.normal;
                            for axis in 0..2 {
                                disc.tangential[axis] += step * slope.tangential[axis];
                            }
                            moved
                        })
                        .collect();
                    self.view.pictures(&state, &shifted)?
                }
                None => self.view.pictures(&state, moved)?,
            };
            for marker in 0..markers {
                let slopes = of_common[marker].as_mut();
                if let (Some(slopes), Some(at), Some(there)) =
                    (slopes, &at[marker], &pictures[marker])
                {
                    // Per standard deviation.
                    slopes.set_column(column, &(Vector4::from(difference(there, at)) / SHARE));
                }
            }
        }
        let mut of_local: Vec<_> = at
            .iter()
            .map(|at| at.map(|_| nalgebra::Matrix4x2::zeros()))
            .collect();
        if self.misalignment_std > 0.0 {
            for axis in 0..2 {
                let mut beside = misalignments.to_vec();
                for misalignment in &mut beside {
                    misalignment[axis] += MISALIGNED;
                }
                let state = SensorState {
                    common,
                    misalignments: &beside,
                };
                let pictures = self.view.pictures(&state, moved)?;
                for marker in 0..markers {
                    let slopes: Option<&mut nalgebra::Matrix4x2<f64>> = of_local[marker].as_mut();
                    if let (Some(slopes), Some(at), Some(there)) =
                        (slopes, &at[marker], &pictures[marker])
                    {
                        slopes
                            .set_column(axis, &(Vector4::from(difference(there, at)) / MISALIGNED));
                    }
                }
            }
        }
        Some(Slopes {
            common: of_common,
            local: of_local,
        })
    }
}

/// The fit of frames that show the sensor: at rest, and in presses that are known.
pub(super) struct Resting<'a, V> {
    pub(super) fit: &'a ImageFit<V>,
    pub(super) free: Vec<usize>,
    /// Departures that something else tells.
    pub(super) known: Option<Arc<Known>>,
    /// The first is that at rest.
    pub(super) frames: Arc<[KnownFrame]>,
}

/// Unknowns of the fit: free common departures in standard deviations, and misalignments, rad.
#[derive(Clone)]
pub(super) struct State {
    pub(super) common: DVector<f64>,
    pub(super) misalignments: Vec<[f64; 2]>,
}

/// Pictures of the markers in each frame.
pub(super) type Pictures = Vec<Vec<Option<[f64; NUMBERS]>>>;

/// Equations of one step with the misalignments taken out.
pub(super) struct Equations {
    information: DMatrix<f64>,
    right: DVector<f64>,
    local: Vec<Option<Own>>,
}

/// The part of the equations that is a marker's own.
struct Own {
    inverse: Matrix2<f64>,
    across: OMatrix<f64, U2, Dyn>,
    right: nalgebra::Vector2<f64>,
}

impl<V: View> Resting<'_, V> {
    /// Knowledge of the sensor from equations whose solution is `state`.
    pub(super) fn told(&self, state: State, equations: Equations, chi_squared: f64) -> Rest {
        let Equations {
            information, local, ..
        } = equations;
        Rest {
            common: self.common(&state),
            misalignments: state.misalignments,
            seen: self.frames[0].weights.iter().map(Option::is_some).collect(),
            chi_squared,
            freedom: self.freedom(),
            information,
            local: local
                .into_iter()
                .map(|own| {
                    own.map(|own| Local {
                        follows: -own.inverse * own.across,
                        spread: own.inverse,
                    })
                })
                .collect(),
            frames: Arc::clone(&self.frames),
        }
    }

    /// Degrees of freedom: as many numbers are known beforehand as there are unknowns.
    pub(super) fn freedom(&self) -> usize {
        NUMBERS * self.frames.iter().map(KnownFrame::markers).sum::<usize>()
    }

    fn common(&self, state: &State) -> Vec<f64> {
        let mut common = vec![0.0; self.fit.common_stds.len()];
        for (&number, departure) in self.free.iter().zip(state.common.iter()) {
            common[number] = departure * self.fit.common_stds[number];
        }
        common
    }

    pub(super) fn markers(&self) -> usize {
        self.fit.markers.places().len()
    }

    pub(super) fn pictures(&self, state: &State) -> Option<Pictures> {
        let common = self.common(state);
        let sensor = SensorState {
            common: &common,
            misalignments: &state.misalignments,
        };
        let frames = self.frames.iter();
        frames
            .map(|frame| self.fit.view.pictures(&sensor, &frame.moved_at(&common)))
            .collect()
    }

    pub(super) fn cost(&self, state: &State, pictures: &Pictures) -> f64 {
        let own = self.own_costs(state, pictures).into_iter().flatten();
        state.common.norm_squared() + own.sum::<f64>()
    }

    /// Sum of the squares of each marker; `None` of those that were not seen.
    pub(super) fn own_costs(&self, state: &State, pictures: &Pictures) -> Vec<Option<f64>> {
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

    pub(super) fn slopes(&self, state: &State, pictures: &Pictures) -> Option<Vec<Slopes>> {
        let common = self.common(state);
        let of_frame = |(frame, pictures): (&KnownFrame, &Vec<_>)| {
            let moved = frame.moved_at(&common);
            let per_depth = frame.per_depth.as_deref();
            self.fit
                .slopes(&common, &state.misalignments, &moved, per_depth, pictures)
        };
        self.frames.iter().zip(pictures).map(of_frame).collect()
    }

    /// The equations of a step from a state, damped by so many times the information that there is beforehand.
    pub(super) fn equations(
        &self,
        state: &State,
        pictures: &Pictures,
        slopes: &[Slopes],
        damping: f64,
    ) -> Option<Equations> {
        let count = self.free.len();
        let mut information = DMatrix::<f64>::identity(count, count) * (1.0 + damping);
        let mut right = -state.common.clone();
        let mut reduced = Vec::new();
        let mut local = Vec::new();
        for marker in 0..self.markers() {
            let mut is_seen = false;
            let mut own = Matrix2::zeros();
            let mut across = OMatrix::<f64, U2, Dyn>::zeros(count);
            let mut own_right = nalgebra::Vector2::zeros();
            for ((frame, pictures), slopes) in self.frames.iter().zip(pictures).zip(slopes) {
                let parts = (
                    &frame.weights[marker],
                    frame.residual(marker, pictures),
                    &slopes.common[marker],
                    &slopes.local[marker],
                );
                let (Some(weight), Some(residual), Some(by_common), Some(by_local)) = parts else {
                    continue;
                };
                is_seen = true;
                let weighted = weight * by_common;
                information += by_common.transpose() * &weighted;
                right += weighted.transpose() * residual;
                own += by_local.transpose() * weight * by_local;
                own_right += by_local.transpose() * (weight * residual);
                across += by_local.transpose() * &weighted;
            }
            if !is_seen {
                local.push(None);
                continue;
            }
            if self.fit.misalignment_std == 0.0 {
                local.push(Some(Own {
                    inverse: Matrix2::zeros(),
                    across: OMatrix::<f64, U2, Dyn>::zeros(count),
                    right: nalgebra::Vector2::zeros(),
                }));
                continue;
            }
            let per_square = self.fit.misalignment_std.powi(-2);
            own_right -= nalgebra::Vector2::from(state.misalignments[marker]) * per_square;
            for axis in 0..2 {
                own[(axis, axis)] += (1.0 + damping) * per_square;
            }
            let inverse = own.try_inverse()?;
            reduced.push((
                across.transpose() * inverse * &across,
                across.transpose() * (inverse * own_right),
            ));
            local.push(Some(Own {
                inverse,
                across,
                right: own_right,
            }));
        }
        for (square, vector) in reduced {
            information -= square;
            right -= vector;
        }
        if let Some(known) = &self.known {
            known.cut(&state.common, &mut information, &mut right)?;
        }
        Some(Equations {
            information,
            right,
            local,
        })
    }

    pub(super) fn stepped(&self, state: &State, equations: &Equations) -> Option<State> {
        let step = equations
            .information
            .clone()
            .cholesky()?
            .solve(&equations.right);
        let mut tried = state.clone();
        tried.common += &step;
        for (misalignment, own) in tried.misalignments.iter_mut().zip(&equations.local) {
            if let Some(own) = own {
                let moved = own.inverse * (own.right - &own.across * &step);
                for axis in 0..2 {
                    misalignment[axis] =
                        (misalignment[axis] + moved[axis]).clamp(-MOST_MISALIGNED, MOST_MISALIGNED);
                }
            }
        }
        Some(tried)
    }
}

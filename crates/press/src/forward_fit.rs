//! Nonlinear least-squares fit of a press model to the displacements of markers.

mod bias;
mod contact_detection;
mod displacement_check;
mod outlier_test;
mod problem;
mod search;
mod start;
mod undetected_contacts;

use nalgebra::{DMatrix, DVector};
use palpate_statistics::{GoodnessOfFit, NORMAL_95, student_half_width};

use crate::least_squares::LeastSquares;
use crate::outcome::Stds;
use crate::unknowns::State;
use crate::{Body, Contact, Estimated, Interval, Markers, PressError, PressEstimate, Verdict};
use problem::Problem;
pub(crate) use search::MIN_READINGS_PER_PARAMETER;
use search::Search;

/// The readings of one press: displacements of the markers.
#[derive(Clone, Copy, Debug)]
pub struct Reading<'a> {
    /// The markers, that is, their places on the skin.
    pub markers: &'a Markers,
    /// Inward displacement (length) of each marker.
    pub normal: &'a [f64],
    /// Displacement (length) of each marker along the skin. The components are along the axes at the marker. `None` if
    /// the sensor does not measure this displacement.
    pub tangential: Option<&'a [[f64; 2]]>,
    /// The indentation, if it was measured separately (for example from a robot's pose); otherwise `None`.
    pub indentation: Option<Measured>,
}

/// A measured value with its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The measured or stated value.
    pub value: f64,
    /// Standard deviation of the value; 0 for an exact value.
    pub std: f64,
}

impl Measured {
    pub(crate) fn check(self) -> Result<(), PressError> {
        let Self { value, std } = self;
        let good = (0.0..=1e100).contains(&std);
        PressError::unless_good("indentation_std", std, good, "at least 0 and at most 1e100")?;
        if !value.is_finite() {
            return Err(PressError::OutOfRange);
        }
        match value > 0.0 {
            true => Ok(()),
            false => Err(PressError::NoIndentation { indentation: value }),
        }
    }
}

/// Prior of the baseline or of the gain. These parameters describe errors that are common to all normal displacements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Prior {
    /// The parameter is not fitted. It has the value of an ideal sensor: 0 for a baseline, 1 for a gain.
    Exact,
    /// The parameter is fitted. Its prior is normal around the ideal value, with this standard deviation (> 0, in the
    /// unit of the parameter).
    Within(f64),
    /// The parameter is fitted without a prior.
    Free,
}

/// Prior around the ideal value, with this standard deviation. If it is 0, the parameter is not fitted.
impl From<f64> for Prior {
    fn from(std: f64) -> Self {
        match std > 0.0 {
            true => Self::Within(std),
            false => Self::Exact,
        }
    }
}

/// Largest residual of an almost flat object, relative to the median residual. A larger residual is one of an outlier.
const MAX_RESIDUALS: f64 = 8.0;
/// Largest curvature of an almost flat object, in standard errors. For larger curvatures, an elastic contact is fitted.
const MAX_SIGNIFICANCE: f64 = 6.0;

/// Cramér–Rao bounds, which are the smallest possible standard errors of unbiased estimates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest possible standard error (1/length) of the relative curvature, and also of the object's curvature.
    pub relative_curvature: f64,
    /// Smallest possible standard error (length) of the indentation.
    pub indentation: f64,
    /// Smallest possible standard error (length) of the contact's radius.
    pub contact_radius: f64,
    /// Smallest possible standard errors of the larger principal curvature (1/length), the smaller principal curvature
    /// (1/length) and the direction of the axis (rad). The value is `None` if only one curvature is fitted, or if both
    /// principal curvatures are equal.
    pub principal: Option<[f64; 3]>,
}

/// A least-squares fit of one press. The fitted parameters are the relative curvature, the place of the contact, the
/// indentation and, unless their priors are [`Prior::Exact`], the baseline and the gain.
///
/// ```
/// use palpate_press::{Body, ForwardFit, Markers, Reading, Skin};
///
/// // 81 markers, 2 apart and 2 under a skin of radius 20, that an object of radius 80 moves.
/// let positions: Vec<[f64; 2]> =
///     (0..81).map(|i| [2.0 * f64::from(i % 9 - 4), 2.0 * f64::from(i / 9 - 4)]).collect();
/// let (skin, body) = (Skin::new(20.0)?, Body::half_space(0.5, 2.0)?);
/// let markers = Markers::new(skin, &positions)?;
/// let moved = markers.displacements(&skin.contact(&body, 1.0 / 80.0, 1.0)?, [0.0; 2]);
/// let normal: Vec<f64> = moved.iter().map(|moved| moved.normal).collect();
/// let reading = Reading { markers: &markers, normal: &normal, tangential: None, indentation: None };
/// let estimate = ForwardFit::new(body).estimate(&reading)?;
/// assert!((estimate.most_likely_object_curvature() - 1.0 / 80.0).abs() < 1e-7);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ForwardFit {
    /// Model of the soft body that the fit uses.
    pub body: Body,
    /// Prior of the baseline, an offset (length) that is added to all normal displacements. Its ideal value is 0.
    pub baseline: Prior,
    /// Prior of the gain, a factor on all normal displacements. Its ideal value is 1.
    pub gain: Prior,
    /// Standard deviation (length) of the noise of normal displacements. If the value is `None` or 0, the noise is
    /// estimated from the residuals. The estimate is at least 1e-10 of the largest normal displacement. If there are
    /// fewer than three markers per fitted parameter, normal and tangential noise are assumed equal for this estimate.
    pub normal_std: Option<f64>,
    /// Standard deviation (length) of the noise of each tangential displacement component. If the value is `None` or 0,
    /// the noise is estimated from the residuals. The estimate is at least 1e-10 of the largest normal displacement.
    pub tangential_std: Option<f64>,
    /// Radius (length) of the fit's window: the fit uses only the markers within this distance from the contact; `None`
    /// for all markers.
    pub window: Option<f64>,
    /// Whether both principal curvatures are fitted. This requires a half-space as the body, and [`Prior::Exact`] for
    /// the baseline and the gain. The fit then uses all markers.
    pub is_elliptic: bool,
}

impl ForwardFit {
    /// A fit with the model `body`. Its baseline and gain are not fitted, and the noise is estimated from the
    /// residuals.
    pub const fn new(body: Body) -> Self {
        Self {
            body,
            baseline: Prior::Exact,
            gain: Prior::Exact,
            normal_std: None,
            tangential_std: None,
            window: None,
            is_elliptic: false,
        }
    }

    /// Estimates the press from a reading. If the readings have no noise and determine the curvature, the relative
    /// error of the most likely curvature is below 1e-9.
    ///
    /// # Errors
    /// [`PressError::BadSetting`], [`PressError::NotFinite`], [`PressError::TooFewMarkers`] for invalid settings and
    /// readings; [`PressError::NoContact`] if no marker moved more than its noise, or all markers moved equally;
    /// [`PressError::OtherBody`] if the markers did not move as in a press on this body; [`PressError::OffMarkers`],
    /// [`PressError::Undetermined`] and errors of [`Body::press`] if no press fits the readings.
    pub fn estimate(&self, reading: &Reading<'_>) -> Result<PressEstimate, PressError> {
        self.validate(reading)?;
        match self.is_elliptic {
            true => self.elliptic_estimate(reading),
            false => match self.flat_object(reading) {
                Some(estimate) => Ok(estimate),
                None => Search::new(self, reading)?.run(),
            },
        }
    }

    /// Estimates a press of a flat pad on an object that may be flat, if all markers lie within the contact area.
    /// `None` for other presses. At the edge of the contact area, the displacement is at most half of the largest
    /// displacement, so markers with larger displacements lie inside. There the skin has the shape of the object, so a
    /// paraboloid is fitted to the displacements.
    fn flat_object(&self, reading: &Reading<'_>) -> Option<PressEstimate> {
        let (markers, normal) = (reading.markers, DVector::from_column_slice(reading.normal));
        let (skin, most) = (markers.skin(), normal.max());
        let is_ideal = self.baseline == Prior::Exact && self.gain == Prior::Exact;
        let freedom = normal.len().checked_sub(4).filter(|&freedom| freedom > 0)?;
        if skin.curvature() > 0.0
            || self.body.c().is_some()
            || !is_ideal
            || normal.min() <= 0.5 * most
        {
            return None;
        }
        let places = markers.places().iter();
        let places: Vec<_> = places
            .map(|one| skin.chart(one.direction.as_ref()))
            .collect();
        let extent = (markers.distances([0.0; 2]).into_iter()).fold(0.0, f64::max);
        let paraboloid = DMatrix::from_fn(places.len(), 4, |row, term| {
            let [x, y] = places[row].map(|along| along / extent);
            [1.0, x, y, -0.5 * (x * x + y * y)][term]
        });
        let inverse = paraboloid.tr_mul(&paraboloid).cholesky()?.inverse();
        let solved = &inverse * paraboloid.tr_mul(&normal);
        let residuals = &normal - &paraboloid * &solved;
        let mut sizes: Vec<f64> = residuals.iter().map(|one| one.abs()).collect();
        sizes.sort_unstable_by(f64::total_cmp);
        let squares = residuals.norm_squared();
        let stated = self.normal_std.filter(|&std| std > 0.0);
        let found = (squares / freedom as f64).sqrt().max(1e-10 * most);
        let std = stated.unwrap_or(found);
        let half_width = stated.map_or_else(|| student_half_width(0.95, freedom), |_| NORMAL_95);
        let of = |term: usize, scale: f64| {
            let std = std * inverse[(term, term)].sqrt();
            Estimated::normal(solved[term] / scale, std / scale, half_width)
        };
        let goodness = stated.map(|std| GoodnessOfFit::new(squares / (std * std), freedom));
        let relative_curvature = of(3, extent * extent);
        let unbounded = f64::INFINITY;
        let estimate = PressEstimate {
            sensor_curvature: 0.0,
            relative_curvature,
            most_likely_curvature: relative_curvature.value,
            principal: None,
            indentation: reading.indentation.map_or(of(0, 1.0), |stated| {
                Estimated::normal(stated.value, stated.std, NORMAL_95)
            }),
            contact_radius: Estimated {
                value: extent,
                std: unbounded,
                interval: Interval {
                    low: Some(extent),
                    high: None,
                },
            },
            contact: [0.0; 2],
            contact_std: [unbounded; 2],
            baseline: None,
            gain: None,
            wrong_markers: Vec::new(),
            normal_std: std,
            tangential_std: None,
            r_squared: 1.0 - squares / normal.norm_squared(),
            reduced_chi_squared: squares / (std * std * freedom as f64),
            goodness,
            is_detected: true,
            only_marker: None,
            verdict: match relative_curvature.interval.holds(0.0) {
                true => Verdict::FlatWithinNoise,
                false => Verdict::of(relative_curvature.interval, 0.0),
            },
        };
        let significance = relative_curvature.value / relative_curvature.std;
        let has_outliers = sizes[sizes.len() - 1] > MAX_RESIDUALS * sizes[sizes.len() / 2];
        (significance.abs() < MAX_SIGNIFICANCE && !has_outliers).then_some(estimate)
    }

    /// The smallest possible standard errors of an unbiased estimate (Cramér–Rao bounds). The true contact is at the
    /// skin coordinates `at`. `tangential` states whether the sensor measures tangential displacements.
    /// `indentation_std` is the standard deviation (length) of a measured indentation.
    ///
    /// The result is `None` if the noise is not stated, or if the readings do not determine the press.
    pub fn bounds(
        &self,
        markers: &Markers,
        contact: &Contact<'_>,
        at: [f64; 2],
        tangential: bool,
        indentation_std: Option<f64>,
    ) -> Option<Bounds> {
        let stated = |std: Option<f64>| std.filter(|&std| std > 0.0);
        let moved = markers.displacements(contact, at);
        let normal: Vec<f64> = moved.iter().map(|moved| moved.normal).collect();
        let along: Vec<[f64; 2]> = moved.iter().map(|moved| moved.tangential).collect();
        let value = contact.indentation;
        let reading = Reading {
            markers,
            normal: &normal,
            tangential: tangential.then_some(along.as_slice()),
            indentation: indentation_std.map(|std| Measured { value, std }),
        };
        let mut problem = Problem::new(self, &reading);
        problem.normal_std = stated(self.normal_std)?;
        if problem.uses_tangential() {
            problem.tangential_std = stated(self.tangential_std)?;
        }
        let place = problem.place_at(markers.skin().place(at).direction.as_ref());
        let state = State::new(
            contact.relative_curvature,
            place,
            contact.indentation,
            [0.0, 1.0],
        );
        problem.keep_window(&state);
        let covariance = problem.covariance(&problem.sums(&state).ok()?).ok()?;
        let stds = Stds::new(&problem, &state, &covariance).ok()?;
        Some(Bounds {
            relative_curvature: contact.relative_curvature * stds.log_curvature,
            indentation: stds.indentation,
            contact_radius: stds.contact_radius,
            principal: None,
        })
    }

    pub(super) fn validate(&self, reading: &Reading<'_>) -> Result<(), PressError> {
        let at_least_0 = |setting, value: f64| {
            let good = (0.0..=1e100).contains(&value);
            PressError::unless_good(setting, value, good, "at least 0 and at most 1e100")
                .map(|_| ())
        };
        for (setting, std) in [
            ("normal_std", self.normal_std),
            ("tangential_std", self.tangential_std),
        ] {
            std.map_or(Ok(()), |std| at_least_0(setting, std))?;
        }
        for (setting, prior) in [("baseline_std", self.baseline), ("gain_std", self.gain)] {
            if let Prior::Within(std) = prior {
                let good = std > 0.0 && std <= 1e100;
                PressError::unless_good(setting, std, good, "> 0 and at most 1e100")?;
            }
        }
        if let Some(window) = self.window {
            let good = window > 0.0;
            PressError::unless_good("window", window, good, "> 0")?;
        }
        reading.indentation.map_or(Ok(()), Measured::check)?;
        let markers = reading.markers.places().len();
        let lengths = [
            Some(reading.normal.len()),
            reading.tangential.map(<[_]>::len),
        ];
        for given in lengths.into_iter().flatten() {
            let good = given == markers;
            PressError::unless_good("readings", given as f64, good, "one for each marker")?;
        }
        let sound = |value: f64| value.abs() <= 1e50;
        let is_bad = |marker: &usize| {
            let tangential = reading.tangential.map_or([0.0; 2], |given| given[*marker]);
            !(sound(reading.normal[*marker]) && tangential.into_iter().all(sound))
        };
        let bad = (0..markers).find(is_bad);
        bad.map_or(Ok(()), |marker| Err(PressError::NotFinite { marker }))
    }
}

/// The constant c of the Gaussian approximation R = c σ²/δ, with the effective radius R, the width σ of the Gaussian
/// and the indentation δ. The calibration uses a press of a plane against the apex with the indentation `indentation`.
/// The constant is chosen such that the estimated radius of this press is the sensor's own radius.
///
/// # Errors
/// [`PressError`] if the press or the fit of the Gaussian fails. [`PressError::Undetermined`] if the plane would touch
/// all markers, as on a flat pad, because no marker then determines the width of the Gaussian.
pub fn calibrated_c(
    markers: &Markers,
    body: &Body,
    indentation: f64,
    window: Option<f64>,
) -> Result<f64, PressError> {
    let skin = markers.skin();
    let undetermined = PressError::Undetermined {
        what: "the Gaussian's constant `c` is calibrated by a press of a plane, which would touch all markers of this flat or nearly flat sensor; state `c`, or use another method",
    };
    if skin.curvature() == 0.0 {
        return Err(undetermined);
    }
    let plane = skin.contact(body, 0.0, indentation)?;
    let distances = markers.distances([0.0; 2]);
    if distances.iter().all(|distance| *distance <= plane.radius) {
        return Err(undetermined);
    }
    let moved = markers.displacements(&plane, [0.0; 2]);
    let normal: Vec<f64> = moved.iter().map(|moved| moved.normal).collect();
    let fit = ForwardFit {
        gain: Prior::Free,
        window,
        ..ForwardFit::new(Body::gaussian(1.0)?)
    };
    let found = fit.estimate(&Reading {
        markers,
        normal: &normal,
        tangential: None,
        indentation: Some(Measured {
            value: indentation,
            std: 0.0,
        }),
    })?;
    Ok(skin.radius() * found.most_likely_curvature)
}

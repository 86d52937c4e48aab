//! The method of Charlebois, Gupta and Payandeh (1996): a smoothing spline is fitted to the contacts, and a second
//! spline is fitted to points of the first spline and of its tangents.

use palpate_statistics::BadSetting;

use crate::error::LARGEST;
use crate::knots::MAX_DEGREE;
use crate::smoothing::{Smoothed, SmoothingSpline, WeightedPoint};
use crate::spline::TensorSpline;
use crate::{Ep2Error, Fit, Method, MisfitTest, Patch, Penalised, Sample, Status};

/// The normals from which the tangents of the second pass are computed. A tangent is perpendicular to its normal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TangentNormals {
    /// The normals of the contacts; if there are none, the normals of the first spline.
    #[default]
    Measured,
    /// The normals of the first of the two fitted splines.
    FirstFit,
}

/// Number of splines that the method `two-pass` fits one after the other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Passes {
    /// One spline, fitted to the contacts.
    One,
    /// Two splines: the first is fitted to the contacts, the second to points of the first spline and of its tangents.
    #[default]
    Two,
}

/// The two-pass method of Charlebois, Gupta and Payandeh (1996).
///
/// First, a smoothing spline is fitted to the contacts. Then a second spline is fitted to three points per contact. One
/// of them is the point of the first spline at the contact. The other two are on a tangent through this point, one step
/// to each side of it. The tangent is perpendicular to the fingers' travel (u in the patch's frame).
///
/// The settings use a unit of length, which by default is the distance between fingers. Residuals and the tangent step
/// are in this unit. The sum of `weight`² · `residual`² is compared with the required sums `smoothing` and
/// `second_smoothing`. A contact's own weight is an inverse variance, so its `weight` is multiplied by the square root
/// of it.
///
/// For example, with 30 contacts and a weight of 100, a required sum of 1000 corresponds to a root-mean-square residual
/// of 0.058 units. If the required sum is too small for the allowed number of knots, the last fit is returned. Its
/// curvature is useless, and [`Fit::status`] reports this.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoPass {
    /// Degree of the first spline along u and along v, 1 to 5.
    pub first_degree: usize,
    /// Degree of the second spline along u and along v, 1 to 5.
    pub second_degree: usize,
    /// Weight that multiplies the residuals: an inverse standard deviation, per unit of length (see `unit_length`).
    pub weight: f64,
    /// Required sum of squared weighted residuals of the first spline.
    pub smoothing: f64,
    /// Required sum of squared weighted residuals of the second spline.
    pub second_smoothing: f64,
    /// Length of the step along the tangent, in the unit of the settings (see `unit_length`).
    pub tangent_step: f64,
    /// Normals from which the tangents are computed.
    pub normals: TangentNormals,
    /// Unit of length of the settings, in the unit of the contacts. With `None`, it is the mean distance between
    /// neighbouring fingers.
    pub unit_length: Option<f64>,
    /// Number of splines that are fitted one after the other.
    pub passes: Passes,
    /// Largest number of interior knots of a spline in each direction.
    pub most_knots: usize,
}

impl Default for TwoPass {
    /// The settings of Charlebois, Gupta and Payandeh (1996), except that the second spline is bicubic.
    fn default() -> Self {
        Self {
            first_degree: 2,
            second_degree: 3,
            weight: 100.0,
            smoothing: 1000.0,
            second_smoothing: 1000.0,
            tangent_step: 0.05,
            normals: TangentNormals::default(),
            unit_length: None,
            passes: Passes::default(),
            most_knots: 16,
        }
    }
}

impl Method for TwoPass {
    fn fit(&self, patch: &Patch) -> Result<Fit, Ep2Error> {
        self.check(patch)?;
        let unit = self.unit(patch)?;
        let points: Vec<WeightedPoint> = patch
            .samples
            .iter()
            .map(|sample| self.point(sample, unit, [sample.u, sample.v, sample.w]))
            .collect();
        let first = self
            .spline(self.first_degree, self.smoothing)
            .fit(&points)?;
        if self.passes == Passes::One {
            determined(&first, patch)?;
            return Ok(fit(patch, first, None));
        }
        let points = self.second_points(patch, unit, &first)?;
        let second = self.spline(self.second_degree, self.second_smoothing);
        let second = second.fit(&points)?;
        determined(&second, patch)?;
        Ok(fit(patch, second, Some(first.status)))
    }

    /// The misfit test of [`Penalised`] with estimated noise. The result of this test is also valid for `TwoPass`,
    /// because the test compares each contact with the other contacts and not with a spline of `TwoPass`. The result is
    /// empty if the contacts do not determine a penalised spline.
    fn misfit(&self, patch: &Patch, _fit: Option<&Fit>) -> Result<MisfitTest, Ep2Error> {
        let found = Penalised::default().misfit(patch, None);
        Ok(found.unwrap_or_default())
    }
}

impl TwoPass {
    fn spline(&self, degree: usize, smoothing: f64) -> SmoothingSpline {
        SmoothingSpline {
            most_knots: [self.most_knots; 2],
            ..SmoothingSpline::new(degree, smoothing)
        }
    }

    /// The unit of length of the settings, in the patch's unit.
    ///
    /// Points are not converted to the unit of the settings. Instead, the weight and the tangent step are converted to
    /// the patch's unit, which gives the same result.
    fn unit(&self, patch: &Patch) -> Result<f64, Ep2Error> {
        let set = self.unit_length.map(|length| length / patch.frame.scale());
        let unit = set.or(patch.finger_distance).ok_or(BadSetting {
            setting: "unit_length",
            value: 0.0,
            expected: "given, as one finger has no distance to another",
        })?;
        if (1.0 / LARGEST..=LARGEST).contains(&unit) && self.weight / unit <= LARGEST {
            Ok(unit)
        } else {
            Err(Ep2Error::OutOfRange)
        }
    }

    fn point(&self, sample: &Sample, unit: f64, [u, v, w]: [f64; 3]) -> WeightedPoint {
        let weight = self.weight / unit * sample.weight.sqrt();
        WeightedPoint { u, v, w, weight }
    }

    /// Three points per contact: a point of the first spline, and two points on its tangent, one step to each side.
    fn second_points(
        &self,
        patch: &Patch,
        unit: f64,
        first: &Smoothed,
    ) -> Result<Vec<WeightedPoint>, Ep2Error> {
        let is_measured = self.normals == TangentNormals::Measured && patch.has_normals();
        if !is_measured {
            determined(first, patch)?;
        }
        let mut points = Vec::with_capacity(3 * patch.samples.len());
        for sample in &patch.samples {
            let (height, slope) = match sample.slopes {
                Some([_, slope]) if is_measured => (first.spline.value(sample.u, sample.v), slope),
                _ => height_and_slope(&first.spline, sample),
            };
            let across = self.tangent_step * unit / libm::hypot(slope, 1.0);
            for step in [0.0, across, -across] {
                let place = [sample.u, sample.v + step, height + step * slope];
                if !place.iter().all(|number| number.abs() <= LARGEST) {
                    return Err(Ep2Error::OutOfRange);
                }
                points.push(self.point(sample, unit, place));
            }
        }
        Ok(points)
    }

    fn check(&self, patch: &Patch) -> Result<(), Ep2Error> {
        // A surface of degree 1 has no curvature. Therefore the spline that is fitted last needs at least degree 2.
        let (first_is_last, bent) = (self.passes == Passes::One, 2..=MAX_DEGREE);
        let first_degrees = if first_is_last {
            bent.clone()
        } else {
            1..=MAX_DEGREE
        };
        let degree = |setting, degree: usize, range: std::ops::RangeInclusive<usize>| {
            let expected = if *range.start() == 1 {
                "between 1 and 5"
            } else {
                "between 2 and 5, to have a curvature"
            };
            Ep2Error::unless_good(setting, degree as f64, range.contains(&degree), expected)
        };
        degree("first_degree", self.first_degree, first_degrees)?;
        degree("second_degree", self.second_degree, bent)?;
        let positive = |setting, value: f64| {
            let is_good = value > 0.0 && value <= LARGEST;
            Ep2Error::unless_good(setting, value, is_good, "> 0 and at most 1e150")
        };
        positive("weight", self.weight)?;
        positive("tangent_step", self.tangent_step)?;
        positive("unit_length", self.unit_length.unwrap_or(1.0))?;
        for (setting, value) in [
            ("smoothing", self.smoothing),
            ("second_smoothing", self.second_smoothing),
        ] {
            Ep2Error::unless_good(setting, value, value >= 0.0, ">= 0")?;
        }
        let coefficients = |degree: usize| (degree + 1) * (degree + 1);
        let of_second = coefficients(self.second_degree).div_ceil(3);
        let of_second = if first_is_last { 0 } else { of_second };
        let needed = coefficients(self.first_degree).max(of_second);
        let contacts = patch.samples.len();
        if contacts < needed {
            return Err(Ep2Error::TooFewContacts {
                contacts,
                equations: contacts,
                needed,
            });
        }
        Ok(())
    }
}

/// Checks that the points determine a spline without interior knots. Interior knots need no check, because they are
/// added only where the data require them.
fn determined(smoothed: &Smoothed, patch: &Patch) -> Result<(), Ep2Error> {
    let spline = &smoothed.spline;
    let is_polynomial = spline.u.interior().is_empty() && spline.v.interior().is_empty();
    let (rank, unknowns) = (smoothed.rank, spline.coefficients.len());
    if is_polynomial && rank < unknowns {
        return Err(Ep2Error::Undetermined {
            contacts: patch.samples.len(),
            rank,
            unknowns,
        });
    }
    Ok(())
}

fn height_and_slope(spline: &TensorSpline, sample: &Sample) -> (f64, f64) {
    let jet = spline.jet(sample.u, sample.v);
    (jet.w, jet.v)
}

fn fit(patch: &Patch, smoothed: Smoothed, before: Option<Status>) -> Fit {
    let unmet = before.filter(|status| !status.is_met());
    Fit {
        frame: patch.frame,
        domain: patch.domain,
        spline: smoothed.spline,
        mean: None,
        posterior: None,
        basis: None,
        noise: None,
        effective_unknowns: smoothed.effective_unknowns,
        status: unmet.or(Some(smoothed.status)),
    }
}

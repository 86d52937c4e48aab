//! Estimates curvature from glides.

use std::borrow::Cow;
use std::sync::{Arc, OnceLock};

use numpy::{PyArray1, PyArrayMethods};
use palpate::config::{GlideEstimatorConfig, setting};
use palpate::recorded::{
    self, Curvature, GlideFitResult, GlideMap, GlideOptions, GlideRecording, RecordedError,
    ShapeClass,
};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict, PyString};

use super::batch::{batch, in_set};
use super::settings::{given, length_unit, like};
use crate::arrays::{Numbers, array, whole};
use crate::error;
use crate::json::to_python;
use crate::record::{Made, Record, record};
use crate::study::Study;

record!(
    GlideEstimate,
    "Curvature of a patch, from contacts of gliding fingers.\n\nFields: those that `palpate estimate glide` prints, for the middle of the patch: `gaussian_curvature`, `mean_curvature`,\n`k_min`, `k_max` (each with `value`, `std` or None, and `unit`), `position`, `normal`, `direction_of_min`,\n`direction_of_max` (arrays of 3), `shape_index`, `class_`, `class_probabilities`,\n`thresholds`, `noise`, `regions`, `p_value`, `effective_contacts`, `left_out` (rows from 1, with a reason) and `warnings`\n(each with `code`, `text` and `numbers`); for methods plane, sphere, cylinder and shape also `shape`, `radius` and\n`rms_misfit`; for one stroke `stroke`, and None as curvatures; `covariance`, (2, 2), of Gaussian and mean curvature, NaN where\nthe method states no uncertainty; and `map`: arrays (grid, grid), along the fingers' travel first, or (n,) at the\ncontacts that are not left out: `position`, `normal`, `direction_of_min`, `direction_of_max` with 3 numbers each, `gaussian_curvature`,\n`gaussian_curvature_std`, `mean_curvature`, `mean_curvature_std`, `k_min`, `k_max`, `shape_index`, `class_index` of\n`palpate.SHAPE_CLASSES`, `region` (-1: none) and `class_probabilities` with 8 numbers each."
);

/// Estimate of a patch. The fitted surface and its curvatures are computed first; all other results are computed only
/// when Python reads them.
struct Patch {
    fitted: GlideFitResult<'static>,
    curvatures: Vec<Curvature>,
    report: OnceLock<(recorded::GlideEstimate, GlideMap)>,
    /// Shape of an array with one number per point of the map: two axes for a grid, one axis for a map at the contacts.
    shape: Vec<usize>,
}

/// The map of a patch: a result whose fields are arrays with one entry per point.
struct Map(Arc<Patch>);

impl Made for Arc<Patch> {
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.report(py)?.0)
    }

    fn others(&self) -> &'static [&'static str] {
        &["covariance", "map", "map_csv"]
    }

    fn other<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        match name {
            "covariance" => {
                let covariance = self.report(py)?.0.covariance.unwrap_or([[f64::NAN; 2]; 2]);
                array(py, covariance.as_flattened().to_vec(), &[2, 2])
            }
            "map" => Ok(Bound::new(py, Record::new(Map(Arc::clone(self))))?.into_any()),
            _ => Ok(self.report(py)?.1.to_csv().into_pyobject(py)?.into_any()),
        }
    }
}

impl Patch {
    fn new(readings: GlideRecording, options: &GlideOptions) -> Result<Self, RecordedError> {
        let fitted = GlideFitResult::new(Cow::Owned(readings), options)?;
        let curvatures = fitted.curvatures()?;
        let shape = match options.map_at_contacts {
            true => vec![curvatures.len()],
            false => vec![options.grid; 2],
        };
        Ok(Self {
            fitted,
            curvatures,
            report: OnceLock::new(),
            shape,
        })
    }

    fn complete(&self) -> Result<&(recorded::GlideEstimate, GlideMap), RecordedError> {
        if let Some(report) = self.report.get() {
            return Ok(report);
        }
        let report = self.fitted.estimate()?;
        Ok(self.report.get_or_init(|| report))
    }

    fn report(&self, py: Python<'_>) -> PyResult<&(recorded::GlideEstimate, GlideMap)> {
        py.detach(|| self.complete()).map_err(error::recorded)
    }
}

impl Made for Map {
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(PyDict::new(py).into_any())
    }

    fn others(&self) -> &'static [&'static str] {
        &[
            "position",
            "normal",
            "gaussian_curvature",
            "gaussian_curvature_std",
            "mean_curvature",
            "mean_curvature_std",
            "k_min",
            "k_max",
            "direction_of_min",
            "direction_of_max",
            "shape_index",
            "class_index",
            "region",
            "class_probabilities",
        ]
    }

    fn other<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let Self(patch) = self;
        let limits = &patch.fitted.thresholds;
        let curvatures = || patch.curvatures.iter();
        let stds = || {
            curvatures().map(|one| match &one.uncertainty {
                Some(stds) => [stds.gaussian_std, stds.mean_std],
                None => [f64::NAN; 2],
            })
        };
        match name {
            "gaussian_curvature" => {
                return self.stacked(py, curvatures().map(|one| [one.gaussian]));
            }
            "gaussian_curvature_std" => {
                return self.stacked(py, stds().map(|[gaussian, _]| [gaussian]));
            }
            "mean_curvature" => return self.stacked(py, curvatures().map(|one| [one.mean])),
            "mean_curvature_std" => return self.stacked(py, stds().map(|[_, mean]| [mean])),
            "class_probabilities" => {
                let of_point = |one: &Curvature| one.class_probabilities(limits);
                let none = [f64::NAN; ShapeClass::ALL.len()];
                return self.stacked(py, curvatures().map(|one| of_point(one).unwrap_or(none)));
            }
            "class_index" => {
                let class = |one: &Curvature| {
                    ShapeClass::ALL
                        .iter()
                        .position(|class| *class == limits.classify(one.gaussian, one.mean))
                };
                let index = curvatures().map(|one| class(one).map_or(-1, |place| place as i64));
                return self.whole(py, index.collect());
            }
            _ => {}
        }
        let (_, map) = patch.report(py)?;
        let points = map.points.iter();
        match name {
            "position" => self.stacked::<3>(py, points.map(|one| one.position.coords.into())),
            "normal" => self.stacked::<3>(py, points.map(|one| one.normal.into())),
            "k_min" => self.stacked(py, points.map(|one| [one.k_min])),
            "k_max" => self.stacked(py, points.map(|one| [one.k_max])),
            "direction_of_min" => {
                self.stacked::<3>(py, points.map(|one| one.direction_of_min.into()))
            }
            "direction_of_max" => {
                self.stacked::<3>(py, points.map(|one| one.direction_of_max.into()))
            }
            "shape_index" => {
                self.stacked(py, points.map(|one| [one.shape_index.unwrap_or(f64::NAN)]))
            }
            _ => {
                let none = || vec![-1; patch.curvatures.len()];
                let regions = map.regions.as_ref();
                let regions = regions.map(|all| all.iter().map(|region| *region as i64).collect());
                self.whole(py, regions.unwrap_or_else(none))
            }
        }
    }
}

impl Map {
    fn stacked<'py, const D: usize>(
        &self,
        py: Python<'py>,
        numbers: impl Iterator<Item = [f64; D]>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut shape = self.0.shape.clone();
        shape.extend((D > 1).then_some(D));
        array(py, numbers.collect::<Vec<_>>().into_flattened(), &shape)
    }

    fn whole<'py>(&self, py: Python<'py>, numbers: Vec<i64>) -> PyResult<Bound<'py, PyAny>> {
        let flat = PyArray1::from_vec(py, numbers);
        Ok(flat.reshape(self.0.shape.as_slice())?.into_any())
    }
}

#[doc = include_str!("glide_signature.txt")]
/// Curvature of a patch, with a map of it, from contacts of fingers that glide over the object.
///
/// Parameters
/// ----------
/// points : array, (n, 3)
///     Positions of the contacts, in `length_unit`. The contacts of a finger are in the order of its path.
/// normals : array, (n, 3), optional
///     Measured normals, which point out of the object. They need not be unit vectors.
/// fingers : array, (n,), optional
///     Number (from 0) or name of the finger of each contact; by default all contacts belong to one finger.
/// grid : int, optional
///     Number of points along each side of the map, from 1 to 1000; 30 by default.
/// at_contacts : bool
///     Whether the map has one point per contact, in the order of the contacts, instead of a grid.
/// tip_radius : float, optional
///     Radius of round fingertips, in `length_unit`. Needed if `points` are points of the fingertips instead of
///     contacts.
/// reports : str, optional
///     The point of each fingertip that `points` contains: "lowest-point", the default, or "centre". The lowest point
///     is the point of the tip that is farthest in the direction opposite to `outward`. Only with `tip_radius`.
/// outward : array, (3,), optional
///     Direction out of the object; +z by default. It is used for contacts without normals and for lowest points.
/// gaussian_threshold, mean_threshold : float, optional
///     Magnitudes below which the Gaussian and the mean curvature count as zero, 1/length² and 1/length. By default,
///     they are chosen from the size of the patch.
/// inter_finger_distance : float, optional
///     Distance between neighbouring fingers, in `length_unit`; by default their mean distance in `points`. The method
///     "two-pass" uses it as the unit of length of its settings.
/// length_unit : str, optional
///     Unit of all lengths: "m", "cm", "mm", "um" or "unit", which is the default.
/// like : Study, optional
///     Study of kind glide. It supplies the estimator, the inter-finger distance and the thresholds, unless an argument
///     states them.
/// cell : int
///     Number of the study's cell, from 0.
/// threads : int, optional
///     Number of threads that compute a batch; by default one per processor.
#[doc = include_str!("glide_settings.txt")]
///
/// Returns
/// -------
/// GlideEstimate
///     For points and normals of shape (m, n, 3), the result is a Batch of m estimates. All m sets share the fingers,
///     which have the shape (n,).
///
/// Raises
/// ------
/// ArgumentError
///     If a shape is wrong, a number is not finite, or a setting is out of its range or has no effect on the method.
/// ReadingsError
///     If the contacts do not determine the patch: they are too few, they are on one line, or their surface has
///     several heights above a point of its mean plane.
///
/// Source
/// ------
/// M. Charlebois, K. Gupta and S. Payandeh, Curvature Based Shape Estimation Using Tactile Sensing, ICRA 1996;
/// P. Dierckx, Curve and Surface Fitting with Splines, 1993 (two-pass); S. Wood, Generalized Additive Models, 2017.
#[pyfunction]
#[pyo3(signature = (points, normals=None, fingers=None, *, at_contacts=false, length_unit=None, like=None, cell=0,
    threads=None, **settings),
    text_signature = None)]
#[allow(clippy::too_many_arguments)]
pub(crate) fn estimate_glide<'py>(
    py: Python<'py>,
    points: &Bound<'py, PyAny>,
    normals: Option<Bound<'py, PyAny>>,
    fingers: Option<Bound<'py, PyAny>>,
    at_contacts: bool,
    length_unit: Option<&str>,
    like: Option<Bound<'py, Study>>,
    cell: usize,
    threads: Option<usize>,
    settings: Option<Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    let unit = self::length_unit(length_unit)?;
    let given = given(
        settings.as_ref(),
        [setting::<GlideOptions>, setting::<GlideEstimatorConfig>],
    )?;
    let base = self::like(like.as_ref(), cell, unit, GlideOptions::from_study)?;
    let options = GlideOptions::with_settings(base, &given, unit, normals.is_some());
    let options = GlideOptions {
        map_at_contacts: at_contacts,
        ..options.map_err(error::setting)?
    };
    let points = Numbers::of("points", points)?;
    let (sets, _) = points.sets(&[3], "(n, 3) or (m, n, 3)")?;
    let normals = normals.map(|normals| Numbers::of("normals", &normals));
    let normals = normals.transpose()?;
    if let Some(normals) = normals.as_ref().filter(|one| one.shape() != points.shape()) {
        let wanted = format!("{:?}, like points,", points.shape());
        let wanted = wanted.replace('[', "(").replace(']', ")");
        return Err(error::shape("normals", &wanted, normals.shape()));
    }
    let fingers = fingers.map(|fingers| numbered(&fingers)).transpose()?;
    let readings = |set: usize| {
        let normals = normals.as_ref().map(|normals| normals.set::<3>(set));
        GlideRecording::new(points.set(set), normals, fingers.as_deref(), unit)
    };
    let Some(sets) = sets else {
        let readings = readings(0).map_err(error::recorded)?;
        let patch = py.detach(|| Patch::new(readings, &options));
        let patch = Arc::new(patch.map_err(error::recorded)?);
        return GlideEstimate::of(py, Record::new(patch));
    };
    let in_set = |set, error| in_set(set, &["points", "normals"], error);
    let all = (0..sets).map(|set| readings(set).map_err(|error| in_set(set, error)));
    let all: Vec<GlideRecording> = all.collect::<Result<_, _>>().map_err(error::recorded)?;
    let estimate = move |readings| {
        let patch = Patch::new(readings, &options)?;
        patch.complete()?;
        Ok(Arc::new(patch))
    };
    batch(py, all, threads, estimate, GlideEstimate::of)
}

/// Converts the argument `fingers` to numbers. If fingers have names, each name gets a number.
fn numbered(fingers: &Bound<'_, PyAny>) -> PyResult<Vec<u64>> {
    let numpy = fingers.py().import("numpy")?;
    let names = numpy.call_method1("asarray", (fingers,));
    let is_text = |names: &Bound<'_, PyAny>| {
        let first = names.getattr("flat").and_then(|all| all.get_item(0));
        first.is_ok_and(|name| name.is_instance_of::<PyString>())
    };
    let fingers = match names {
        Ok(names) if is_text(&names) => {
            let inverse = [("return_inverse", true)].into_py_dict(fingers.py())?;
            let unique = numpy.call_method("unique", (names,), Some(&inverse))?;
            Numbers::of("fingers", &unique.get_item(1)?)?
        }
        _ => Numbers::of("fingers", fingers)?,
    };
    match fingers.shape() {
        [_] => whole(&fingers),
        found => Err(error::shape("fingers", "(n,)", found)),
    }
}

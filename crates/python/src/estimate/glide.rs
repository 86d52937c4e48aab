//! Estimates from glides.

use std::borrow::Cow;
use std::sync::{Arc, OnceLock};

use numpy::{PyArray1, PyArrayMethods};
use palpate::config::{GlideEstimatorConfig, setting};
use palpate::recorded::{
    self, Curvature, GlideFitResult, GlideMap, GlideOptions, GlideRecording, MapPoint,
    RecordedError, ShapeClass,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::Value as Json;

use super::batch::{batch, in_set};
use super::like::like;
use super::settings::{given, length_unit};
use crate::arrays::{Numbers, array, whole};
use crate::error;
use crate::json::to_python;
use crate::record::{Made, Record, record};
use crate::study::Study;

record!(
    GlideEstimate,
    "Curvature of a patch, from contacts of gliding fingers.\n\nFields: what `palpate estimate glide` prints, of the patch's middle: `gaussian_curvature`, `mean_curvature`,\n`k_min`, `k_max` (each with `value`, `std` or None, and `unit`), `position`, `normal`, `direction_of_min`,\n`direction_of_max` (arrays of 3), `shape_index`, `class_`, `class_probabilities`,\n`thresholds`, `noise`, `regions`, `p_value` and `warnings`\n(each with `code`, `text` and `numbers`); `covariance`, (2, 2), of Gaussian and mean curvature, NaN where\nthe method states no uncertainty; and `map`: arrays (grid, grid), along the fingers' travel first, or (n,) at the\ncontacts: `position`, `normal`, `direction_of_min`, `direction_of_max` with 3 numbers each, `gaussian_curvature`,\n`gaussian_curvature_std`, `mean_curvature`, `mean_curvature_std`, `k_min`, `k_max`, `shape_index`, `class_index` of\n`palpate.SHAPE_CLASSES`, `region` (-1: none) and `class_probabilities` with 8 numbers each."
);

/// Source that an estimate of a patch is made from: the surface and its curvatures, and, once asked for, all else.
struct Patch {
    fitted: GlideFitResult<'static>,
    curvatures: Vec<Curvature>,
    told: OnceLock<(recorded::GlideEstimate, GlideMap)>,
    /// Shape of an array with a number per place of the map.
    shape: Vec<usize>,
}

/// Source that a map of a patch is made from.
struct Map(Arc<Patch>);

impl Made for Arc<Patch> {
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.told(py)?.0)
    }

    fn others(&self) -> &'static [&'static str] {
        &["covariance", "map", "map_csv"]
    }

    fn other<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        match name {
            "covariance" => {
                let covariance = self.told(py)?.0.covariance().unwrap_or([[f64::NAN; 2]; 2]);
                array(py, covariance.as_flattened().to_vec(), &[2, 2])
            }
            "map" => Ok(Bound::new(py, Record::new(Map(Arc::clone(self))))?.into_any()),
            _ => Ok(self.told(py)?.1.to_csv().into_pyobject(py)?.into_any()),
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
            told: OnceLock::new(),
            shape,
        })
    }

    fn known(&self) -> Result<&(recorded::GlideEstimate, GlideMap), RecordedError> {
        if let Some(told) = self.told.get() {
            return Ok(told);
        }
        let told = self.fitted.estimate()?;
        Ok(self.told.get_or_init(|| told))
    }

    fn told(&self, py: Python<'_>) -> PyResult<&(recorded::GlideEstimate, GlideMap)> {
        py.detach(|| self.known()).map_err(error::recorded)
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
        let limits = self.0.fitted.thresholds();
        let stds = |one: &Curvature| match one.uncertainty {
            Some(stds) => [stds.gaussian_std, stds.mean_std],
            None => [f64::NAN; 2],
        };
        match name {
            "gaussian_curvature" => self.curvature(py, |one| [one.gaussian]),
            "gaussian_curvature_std" => self.curvature(py, |one| [stds(one)[0]]),
            "mean_curvature" => self.curvature(py, |one| [one.mean]),
            "mean_curvature_std" => self.curvature(py, |one| [stds(one)[1]]),
            "class_probabilities" => {
                let unknown = [f64::NAN; ShapeClass::ALL.len()];
                self.curvature(py, |one| one.class_probabilities(limits).unwrap_or(unknown))
            }
            "class_index" => {
                let place = |one: &Curvature| {
                    let class = one.class(limits);
                    let place = ShapeClass::ALL.iter().position(|one| *one == class);
                    place.map_or(-1, |place| place as i64)
                };
                self.whole(py, self.0.curvatures.iter().map(place).collect())
            }
            "position" => self.point(py, |one| one.position.coords.into()),
            "normal" => self.point::<3>(py, |one| one.normal.into()),
            "k_min" => self.point(py, |one| [one.k_min]),
            "k_max" => self.point(py, |one| [one.k_max]),
            "direction_of_min" => self.point::<3>(py, |one| one.direction_of_min.into()),
            "direction_of_max" => self.point::<3>(py, |one| one.direction_of_max.into()),
            "shape_index" => self.point(py, |one| [one.shape_index.unwrap_or(f64::NAN)]),
            _ => self.whole(
                py,
                match self.0.told(py)?.1.regions() {
                    Some(regions) => regions.iter().map(|region| *region as i64).collect(),
                    None => vec![-1; self.0.curvatures.len()],
                },
            ),
        }
    }
}

impl Map {
    /// Array of `D` numbers of the curvature at each place.
    fn curvature<'py, const D: usize>(
        &self,
        py: Python<'py>,
        of: impl Fn(&Curvature) -> [f64; D],
    ) -> PyResult<Bound<'py, PyAny>> {
        self.stacked(py, self.0.curvatures.iter().map(of).collect())
    }

    /// Array of `D` numbers of each place.
    fn point<'py, const D: usize>(
        &self,
        py: Python<'py>,
        of: impl Fn(&MapPoint) -> [f64; D],
    ) -> PyResult<Bound<'py, PyAny>> {
        let points = self.0.told(py)?.1.points();
        self.stacked(py, points.iter().map(of).collect())
    }

    fn stacked<'py, const D: usize>(
        &self,
        py: Python<'py>,
        numbers: Vec<[f64; D]>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut shape = self.0.shape.clone();
        shape.extend((D > 1).then_some(D));
        array(py, numbers.into_flattened(), &shape)
    }

    fn whole<'py>(&self, py: Python<'py>, numbers: Vec<i64>) -> PyResult<Bound<'py, PyAny>> {
        let flat = PyArray1::from_vec(py, numbers);
        Ok(flat.reshape(self.0.shape.as_slice())?.into_any())
    }
}

#[doc = include_str!("glide_signature.txt")]
/// Curvature of a patch all over it, from contacts of fingers that glide over the object.
///
/// Parameters
/// ----------
/// points : array, (n, 3)
///     Places of the contacts, length; those of a finger in the order in which it made them.
/// normals : array, (n, 3), optional
///     CameraReading normals out of the object, of any length.
/// fingers : array, (n,), optional
///     Number of the finger of each contact, from 0; without, all are of one finger.
/// grid : int, optional
///     Places along each side of the map, from 1 to 1000; 30 by default.
/// at_contacts : bool
///     Whether the map has a place per contact, in their order, instead of a grid.
/// tip_radius : float, optional
///     Radius of round fingertips of which `points` are not the contacts but what `reports` names, length.
/// reports : str, optional
///     That point of the tips: "lowest-point" (the default), the farthest against `outward`, or "centre".
/// outward : array, (3,), optional
///     Direction out of the object, for contacts without normals and for lowest points; +z by default.
/// gaussian_threshold, mean_threshold : float, optional
///     Magnitudes below which a curvature counts as zero, 1/length² and 1/length; by default from the patch's size.
/// inter_finger_distance : float, optional
///     Length in which the settings of two-pass count; by default the mean distance between neighbouring fingers.
/// length_unit : str, optional
///     Unit of all lengths: "m", "cm", "mm", "um" or "unit", which is the default.
/// like : Study, optional
///     Study of kind glide whose estimator, finger distance and thresholds stand for what is not given.
/// cell : int
///     Number of the study's cell, from 0.
/// threads : int, optional
///     Threads that a batch is worked on by; by default one per processor.
#[doc = include_str!("glide_settings.txt")]
///
/// Returns
/// -------
/// GlideEstimate
///     Of a batch, points (m, n, 3) with normals (m, n, 3), a Batch of them; fingers (n,) count for all m sets.
///
/// Raises
/// ------
/// ArgumentError
///     For a shape, a number that is not finite, or a setting out of its range or of no use to the method.
/// ReadingsError
///     Where the contacts do not tell the patch: too few, on one line, of a surface that is no graph.
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
    let base = self::like(like.as_ref(), cell, unit, palpate::study_options::glide)?;
    let options = GlideOptions::with_settings(base, &given, unit, normals.is_some());
    let options = GlideOptions {
        map_at_contacts: at_contacts,
        ..options.map_err(error::setting)?
    };
    let points = Numbers::of("points", points)?;
    let axes = points.shape().len().clamp(2, 3);
    points.columns(axes, &[3], "(n, 3) or (m, n, 3)")?;
    let normals = normals
        .map(|normals| Numbers::of("normals", &normals))
        .transpose()?;
    if let Some(normals) = normals.as_ref().filter(|one| one.shape() != points.shape()) {
        let wanted = format!("{:?}, as points have it,", points.shape());
        let wanted = wanted.replace('[', "(").replace(']', ")");
        return Err(error::shape("normals", &wanted, normals.shape()));
    }
    let contacts = points.shape()[axes - 2];
    let fingers = fingers
        .map(|fingers| {
            let fingers = Numbers::of("fingers", &fingers)?;
            match fingers.shape() {
                [_] => whole(&fingers),
                found => Err(error::shape("fingers", "(n,)", found)),
            }
        })
        .transpose()?;
    let readings = |points: &[[f64; 3]], normals: Option<&[[f64; 3]]>| {
        GlideRecording::new(points, normals, fingers.as_deref(), unit)
    };
    let (rows, normals) = (points.rows::<3>(), normals.as_ref().map(Numbers::rows::<3>));
    if axes == 2 {
        let readings = readings(rows, normals).map_err(error::recorded)?;
        let patch = py.detach(|| Patch::new(readings, &options));
        return GlideEstimate::of(py, Arc::new(patch.map_err(error::recorded)?));
    }
    let sets = (0..points.shape()[0]).map(|set| {
        let of_set = |rows: &[[f64; 3]]| rows[set * contacts..][..contacts].to_vec();
        let readings = readings(&of_set(rows), normals.map(of_set).as_deref());
        readings.map_err(|error| in_set(set, error))
    });
    let sets: Vec<GlideRecording> = sets.collect::<Result<_, _>>().map_err(error::recorded)?;
    let estimate = |readings: &GlideRecording| {
        let patch = Patch::new(readings.clone(), &options)?;
        let fields = serde_json::to_value(&patch.known()?.0).unwrap_or(Json::Null);
        Ok((patch, fields))
    };
    let shown = |patch| GlideEstimate::of(py, Arc::new(patch));
    batch(py, &sets, threads, estimate, shown)
}

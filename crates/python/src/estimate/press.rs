//! Estimates from presses.

use palpate::config::LengthUnit;
use palpate::recorded::{self, PressGiven, PressOptions, PressReadings, Wording};
use pyo3::conversion::FromPyObjectOwned;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::Value as Json;

use super::batch::{batch, in_set};
use super::like::like;
use super::settings::{given, length_unit, number};
use crate::arrays::Numbers;
use crate::error;
use crate::json::to_python;
use crate::record::{Made, record};
use crate::study::Study;

record!(
    PressEstimate,
    "Curvature of an object, from one press of a soft sphere with markers.\n\nFields: what `palpate estimate press` prints: `relative_curvature`, `effective_radius`, `object_curvature`,\n`indentation`, `contact_radius` (each with `value`, `std`, `unit` and `interval95`; an end without a bound is NaN),\n`object_radius` (`value` None for a flat object, `convex95`, `concave95`), `verdict`, `regime`, `contact`,\n`contact_std`, `force`, `peak_pressure`, `baseline`, `gain`, `wrong_markers`, `noise`, `r_squared`, `contact_seen` (False if\nonly the stated indentation indicates a contact), and `warnings` (each with `code`, `text` and `numbers`)."
);

impl Made for recorded::PressedObject {
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, self)
    }
}

/// Value of a keyword argument, if it is there and not None.
fn taken<'py, T: FromPyObjectOwned<'py>>(
    settings: &Bound<'py, PyDict>,
    name: &str,
) -> PyResult<Option<T>> {
    match settings.get_item(name)?.filter(|value| !value.is_none()) {
        Some(value) => value.extract().map(Some).map_err(Into::into),
        None => Ok(None),
    }
}

/// Declares the settings of a press that a call gives, with their reading from keyword arguments.
macro_rules! arguments {
    ($($name:ident: $kind:ty),* $(,)?) => {
        /// Settings of a press that a call gives.
        #[derive(Default)]
        pub(crate) struct PressArguments {
            $($name: Option<$kind>,)*
        }

        impl PressArguments {
            /// Settings among the keyword arguments of a call.
            pub(crate) fn of(settings: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
                let Some(settings) = settings else {
                    return Ok(Self::default());
                };
                let known = [$(stringify!($name)),*];
                for name in settings.keys() {
                    let name: String = name.extract()?;
                    if !known.contains(&name.as_str()) {
                        let message = format!("got an unexpected keyword argument {name:?}");
                        return Err(PyTypeError::new_err(message));
                    }
                }
                Ok(Self {
                    $($name: taken(settings, stringify!($name))?,)*
                })
            }
        }
    };
}

arguments! {
    sensor_radius: f64,
    depth: f64,
    method: String,
    indentation: f64,
    indentation_std: f64,
    normal_std: f64,
    tangential_std: f64,
    young: f64,
    poisson: f64,
    thickness: f64,
    c: f64,
    window: f64,
    baseline: String,
    gain_std: f64,
    shift_std: f64,
    noise: String,
}

impl PressArguments {
    pub(crate) fn given(&self, unit: Option<LengthUnit>) -> PyResult<PressGiven> {
        let word = |word: &Option<String>| word.clone().map(Json::String);
        Ok(PressGiven {
            sensor_radius: self.sensor_radius,
            depth: self.depth,
            estimator: given([
                ("kind", word(&self.method)),
                (
                    "indentation_std",
                    number("indentation_std", self.indentation_std)?,
                ),
                ("poisson", number("poisson", self.poisson)?),
                ("thickness", number("thickness", self.thickness)?),
                ("c", number("c", self.c)?),
                ("window", number("window", self.window)?),
                ("baseline", word(&self.baseline)),
                ("gain_std", number("gain_std", self.gain_std)?),
                ("shift_std", number("shift_std", self.shift_std)?),
                ("noise", word(&self.noise)),
            ]),
            indentation: self.indentation,
            normal_std: self.normal_std,
            tangential_std: self.tangential_std,
            young: self.young,
            length_unit: unit,
            ..PressGiven::default()
        })
    }
}

/// Curvature of an object, from the displacements of the markers of a soft sphere that is pressed onto it.
///
/// Parameters
/// ----------
/// positions : array, (n, 2) or (n,)
///     Places of the markers on the skin at rest: (x, y) lies sqrt(x² + y²) along the skin from the apex, in the
///     direction (x, y); of a row of markers through the apex their signed places along it. Length.
/// displacements : array, (n,) or (n, 3)
///     Displacement of each marker inward, length; with two more columns those along the skin, along the axes of the
///     apex carried along the meridian.
/// sensor_radius : float
///     Radius of the skin, length; needed unless `like` tells it.
/// depth : float, optional
///     Depth of the markers under the skin, length; 0 by default.
/// method : str, optional
///     "half-space" (the default), "bonded-layer" or "gaussian", the 2020 paper's.
/// indentation : float, optional
///     Indentation, where it is known from elsewhere, length; else it is fitted.
/// indentation_std : float, optional
///     Its standard deviation, length; 2 % of it by default.
/// normal_std, tangential_std : float, optional
///     Standard deviations of the displacements inward and along the skin, length; else found from the residuals.
/// radial_scale : float, optional
///     Factor on the positions; 1 by default.
/// young : float, optional
///     Young's modulus of the soft body, force per length²: gives `force` and `peak_pressure`.
/// poisson : float, optional
///     Of half-space: Poisson's ratio, from 0 to 0.5, which is the default.
/// thickness : float, optional
///     Of bonded-layer: thickness of the layer, length.
/// c, window : float, optional
///     Of gaussian: its c, by default calibrated at the indentation; and the distance from the contact, length, within
///     which markers count.
/// baseline : str, optional
///     "known" (the default), or "fitted" where all normal displacements may have an offset.
/// gain_std : float, optional
///     Standard deviation of a factor on all normal displacements; 0 by default.
/// shift_std : float, optional
///     Of image, which `track` knows: standard deviation of a sideways move of the object, along either axis, length.
/// noise : str, optional
///     "stated" (the default), or "found" from the residuals although `like` states it.
/// length_unit : str, optional
///     Unit of all lengths: "m", "cm", "mm", "um" or "unit", which is the default.
/// like : Study, optional
///     Study of kind press whose sensor, noise and estimator stand for what is not given.
/// cell : int
///     Number of the study's cell, from 0.
/// threads : int, optional
///     Threads that a batch is worked on by; by default one per processor.
///
/// Returns
/// -------
/// PressEstimate
///     Of a batch, displacements (m, n) or (m, n, 3) of markers at positions (n, 2) or (n,), a Batch of them.
///
/// Raises
/// ------
/// ArgumentError
///     For a shape, a number that is not finite, or a setting out of its range or of no use to the method.
/// ReadingsError
///     Where the displacements tell no press.
///
/// Source
/// ------
/// X. Lin, L. Willemet, A. Bailleul and M. Wiertlewski, Curvature sensing with a spherical tactile sensor using the
/// color-interference of a marker array, ICRA 2020; K. Johnson, Contact Mechanics, 1985, chapters 3 and 4.
#[pyfunction]
#[pyo3(signature = (positions, displacements, *, sensor_radius=None, depth=None, method=None, indentation=None,
    indentation_std=None, normal_std=None, tangential_std=None, radial_scale=None, young=None, poisson=None,
    thickness=None, c=None, window=None, baseline=None, gain_std=None, shift_std=None, noise=None, length_unit=None,
    like=None, cell=0, threads=None))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn estimate_press<'py>(
    py: Python<'py>,
    positions: &Bound<'py, PyAny>,
    displacements: &Bound<'py, PyAny>,
    sensor_radius: Option<f64>,
    depth: Option<f64>,
    method: Option<String>,
    indentation: Option<f64>,
    indentation_std: Option<f64>,
    normal_std: Option<f64>,
    tangential_std: Option<f64>,
    radial_scale: Option<f64>,
    young: Option<f64>,
    poisson: Option<f64>,
    thickness: Option<f64>,
    c: Option<f64>,
    window: Option<f64>,
    baseline: Option<String>,
    gain_std: Option<f64>,
    shift_std: Option<f64>,
    noise: Option<String>,
    length_unit: Option<&str>,
    like: Option<Bound<'py, Study>>,
    cell: usize,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyAny>> {
    let unit = self::length_unit(length_unit)?;
    let arguments = PressArguments {
        sensor_radius,
        depth,
        method,
        indentation,
        indentation_std,
        normal_std,
        tangential_std,
        young,
        poisson,
        thickness,
        c,
        window,
        baseline,
        gain_std,
        shift_std,
        noise,
    };
    let given = PressGiven {
        radial_scale,
        ..arguments.given(unit)?
    };
    let base = self::like(like.as_ref(), cell, unit, palpate::study_options::press)?;
    let options = PressOptions::given(&given, base, Wording::Arguments).map_err(error::given)?;
    let positions = Numbers::of("positions", positions)?;
    let places: Vec<[f64; 2]> = match positions.shape() {
        [_] => positions.flat().iter().map(|place| [*place, 0.0]).collect(),
        [_, 2] => positions.rows::<2>().to_vec(),
        found => return Err(error::shape("positions", "(n, 2) or (n,)", found)),
    };
    let displacements = Numbers::of("displacements", displacements)?;
    let markers = places.len();
    let (sets, with_tangential) = match *displacements.shape() {
        [_] => (None, false),
        [_, 3] if markers != 3 => (None, true),
        [first, second] if first == markers && second == 3 => (None, true),
        [sets, of_set] if of_set == markers => (Some(sets), false),
        [sets, of_set, 3] if of_set == markers => (Some(sets), true),
        _ => {
            let wanted =
                format!("({markers},), ({markers}, 3), (m, {markers}) or (m, {markers}, 3)");
            return Err(error::shape(
                "displacements",
                &wanted,
                displacements.shape(),
            ));
        }
    };
    let readings = |set: usize| {
        let flat = displacements.flat();
        let of_set = match sets {
            None => flat,
            Some(sets) => &flat[set * (flat.len() / sets)..][..flat.len() / sets],
        };
        if !with_tangential {
            return PressReadings::new(&places, of_set, None, unit);
        }
        let (rows, _) = of_set.as_chunks::<3>();
        let normal: Vec<f64> = rows.iter().map(|[normal, _, _]| *normal).collect();
        let along: Vec<[f64; 2]> = rows.iter().map(|[_, x, y]| [*x, *y]).collect();
        PressReadings::new(&places, &normal, Some(&along), unit)
    };
    let Some(sets) = sets else {
        let readings = readings(0).map_err(error::recorded)?;
        given
            .fits(&readings, Wording::Arguments)
            .map_err(error::given)?;
        let object = py.detach(|| recorded::estimate_press(&readings, &options));
        return PressEstimate::of(py, object.map_err(error::recorded)?);
    };
    let all = (0..sets).map(|set| readings(set).map_err(|error| in_set(set, error)));
    let all: Vec<PressReadings> = all.collect::<Result<_, _>>().map_err(error::recorded)?;
    if let Some(first) = all.first() {
        given
            .fits(first, Wording::Arguments)
            .map_err(error::given)?;
    }
    let estimate = |readings: &PressReadings| {
        let object = recorded::estimate_press(readings, &options)?;
        let fields = serde_json::to_value(&object).unwrap_or(Json::Null);
        Ok((object, fields))
    };
    let shown = |object| PressEstimate::of(py, object);
    batch(py, &all, threads, estimate, shown)
}

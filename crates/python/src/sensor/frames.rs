//! Tracks markers in frames of a camera sensor.

use image::RgbImage;
use numpy::{PyArray1, PyArray3, PyArrayMethods, PyUntypedArrayMethods, get_array_module};
use palpate::config::{PressEstimatorConfig, setting};
use palpate::recorded::{
    Frame, PressOptions, TrackedPress, difference_image, overlay, track_frames,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::json;

use super::reader::reader;
use crate::error;
use crate::estimate::{PressEstimate, given};
use crate::json::to_python;
use crate::record::{Made, Record, record};
use crate::study::Study;
use crate::table::table_of;

impl Made for TrackedPress {
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, self)
    }
}

record!(
    Tracked,
    "Markers of two frames of a camera sensor, and with a calibration the estimate from them.\n\nFields: `fates`, the number of markers with each status (`at_rest`, `tracked`, `lost`, `merged`, `split`, `new`,\n`cut_at_rest`); `warnings` about the frames, each with `code`, `text` and `numbers` (`estimate` has them too);\n`markers`, a Table of one row per marker: position and hue at rest, their changes, and its status; `overlay`, the pressed\nframe with the status of each marker, and `difference`, the signed difference of the frames (magenta if green light was\nlost, green if gained), (h, w, 3) of uint8. With a calibration or `method=\"image\"` also `readings`, a Table of the\ndisplacements of the tracked markers, `field`, a Table of displacements on a grid between the markers, and `estimate`,\nthe PressEstimate from them; None otherwise."
);

/// Finds the markers of a frame at rest in a pressed frame. With a calibration, or with `method="image"`, also
/// estimates the curvature of the pressed object.
///
/// Parameters
/// ----------
/// rest, pressed : array of uint8, (h, w, 3)
///     Frames of the same size, with the colours red, green and blue. The camera is in the sensor's centre and looks at
///     the apex. Its fisheye lens maps an angle to the image radius r = f · angle. The column number of a pixel
///     increases along x, the row number along −y.
/// calibration : Calibration or CameraCalibration, optional
///     A Calibration converts the frames to displacements, and also needs `sensor_radius` and `depth`, or `like`. A
///     CameraCalibration is for `method="image"`: its camera and covariance replace those of the study. All lengths are
///     in the unit of the calibration.
/// px_per_rad : float, optional
///     Focal length f of the fisheye lens, px per rad. By default, it is the calibration's scale (px per length),
///     multiplied by the distance of the markers from the centre.
/// grid : int
///     Number of points along each side of the grid of the displacement field, from 1 to 1000.
/// filter : float
///     Standard deviation of the Gaussian that smooths the displacement field, a length along the skin.
/// srgb : bool
///     Whether the pixels are encoded by sRGB, as in images of most cameras. If false, pixel values are proportional to
///     the light.
/// like, cell
///     The same arguments as in `estimate_press`.
/// **settings
///     All other arguments of `estimate_press` except `radial_scale`, `length_unit` and `threads`. `method="image"`
///     fits the press to the centroid, hue and size of each marker in the frames. `method="image"` needs the argument
///     `like`: a study that states the layout, discs, soft body, camera and noise.
///
/// Returns
/// -------
/// Tracked
///
/// Raises
/// ------
/// ArgumentError
///     If a frame does not have the shape (h, w, 3), or a setting is invalid.
/// ReadingsError
///     If the frames have different sizes, show no markers or are of different sensors, or if the displacements show no
///     press. With `method="image"`, also if a frame contradicts the stated layout, camera or colours, or is saturated or
///     under-exposed.
///
/// Source
/// ------
/// X. Lin et al., ICRA 2020.
#[pyfunction]
#[pyo3(signature = (rest, pressed, *, calibration=None, px_per_rad=None, grid=30, filter=0.0, srgb=false, like=None,
    cell=0, **settings))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn track<'py>(
    py: Python<'py>,
    rest: &Bound<'py, PyAny>,
    pressed: &Bound<'_, PyAny>,
    calibration: Option<Bound<'_, PyAny>>,
    px_per_rad: Option<f64>,
    grid: usize,
    filter: f64,
    srgb: bool,
    like: Option<Bound<'_, Study>>,
    cell: usize,
    settings: Option<Bound<'_, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    let frames = [frame("rest", rest, srgb)?, frame("pressed", pressed, srgb)?];
    let given = given(
        settings.as_ref(),
        [setting::<PressOptions>, setting::<PressEstimatorConfig>],
    )?;
    if given.contains_key("radial_scale") {
        let message = "radial_scale has an effect only in estimate_press";
        return Err(error::argument("radial_scale", &[], None, message));
    }
    if !(1..=1000).contains(&grid) {
        let message = format!("grid is {grid}; it must be a whole number from 1 to 1000");
        return Err(error::argument("grid", &[], Some(grid as f64), message));
    }
    let reader = reader(
        calibration.as_ref(),
        px_per_rad,
        (like.as_ref(), cell),
        &given,
    )?;
    if reader.is_none()
        && let Some(name) = settings.iter().flat_map(|all| all.keys()).next()
    {
        let message = format!("{name} has an effect only with calibration");
        return Err(error::argument(&name.to_string(), &[], None, message));
    }
    let [rest, pressed] = &frames;
    let found = py.detach(|| {
        let tracked = track_frames(rest, pressed)?;
        tracked.of_one_sensor()?;
        let pictures = [
            overlay(&pressed.image, &tracked),
            difference_image(rest, pressed)?,
        ];
        let estimated = match reader {
            Some(reader) => {
                let read = reader.read([rest, pressed], &tracked, (grid, filter), None)?;
                Some((read.estimate?, read.readings, read.field, read.unit))
            }
            None => None,
        };
        Ok((tracked, pictures, estimated))
    });
    let (tracked, [drawn, difference], estimated) = found.map_err(error::recorded)?;
    let fields = json!({ "fates": tracked.counts(), "warnings": tracked.warnings() });
    let arrays = PyDict::new(py);
    arrays.set_item(
        "markers",
        table_of(py, &tracked.table(), Default::default())?,
    )?;
    arrays.set_item("overlay", pixels(py, drawn)?)?;
    arrays.set_item("difference", pixels(py, difference)?)?;
    for name in ["readings", "field", "estimate"] {
        arrays.set_item(name, py.None())?;
    }
    if let Some((estimate, readings, field, unit)) = estimated {
        arrays.set_item("readings", table_of(py, &readings, unit)?)?;
        arrays.set_item("field", table_of(py, &field, unit)?)?;
        arrays.set_item("estimate", PressEstimate::of(py, Record::new(estimate))?)?;
    }
    let fields = to_python(py, &fields)?.cast_into()?;
    Tracked::of(py, Record::restored(fields, Some(arrays)))
}

/// Converts an array argument to a camera frame. `srgb` states whether the pixels are encoded by sRGB.
pub(crate) fn frame(name: &str, value: &Bound<'_, PyAny>, srgb: bool) -> PyResult<Frame> {
    let numpy = get_array_module(value.py())?;
    let array = numpy.call_method1("ascontiguousarray", (value,))?;
    let array = array.cast_into::<PyArray3<u8>>().map_err(|error| {
        let array = error.into_inner();
        let text = |name: &str| array.getattr(name).map(|one| one.to_string());
        let [shape, kind] = ["shape", "dtype"].map(|one| text(one).unwrap_or_default());
        let message = format!("{name}: must be uint8 of shape (h, w, 3), is {kind} of {shape}");
        error::argument(name, &[], None, message)
    })?;
    let sides = match *array.shape() {
        [height, width, 3] => [width, height].map(u32::try_from),
        _ => return Err(error::shape(name, "(h, w, 3)", array.shape())),
    };
    let bytes = array.readonly().as_slice()?.to_vec();
    let frame = match sides {
        [Ok(width), Ok(height)] => palpate::frame(name, width, height, bytes),
        _ => None,
    };
    let linear = frame.map(|frame| if srgb { frame.linearised() } else { frame });
    linear.ok_or_else(|| error::shape(name, "(h, w, 3)", array.shape()))
}

pub(crate) fn pixels(py: Python<'_>, picture: RgbImage) -> PyResult<Bound<'_, PyAny>> {
    let (width, height) = picture.dimensions();
    let bytes = PyArray1::from_vec(py, picture.into_raw());
    let shaped = bytes.reshape([height as usize, width as usize, 3])?;
    Ok(shaped.into_any())
}

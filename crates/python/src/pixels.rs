//! Converts images to arrays of pixels, and back.

use image::RgbImage;
use numpy::{PyArray1, PyArray3, PyArrayMethods, PyUntypedArrayMethods, get_array_module};
use palpate::recorded::Frame;
use pyo3::prelude::*;

use crate::error;

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

//! Pictures as arrays of pixels.

use image::RgbImage;
use numpy::{PyArray1, PyArray3, PyArrayMethods, PyUntypedArrayMethods, get_array_module};
use palpate::recorded::Frame;
use pyo3::prelude::*;

use crate::error;

/// Frame of an argument.
pub(crate) fn frame(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Frame> {
    let array = match value.cast::<PyArray3<u8>>() {
        Ok(array) => array.clone(),
        Err(_) => {
            let array = get_array_module(value.py())?.call_method1("asarray", (value,))?;
            array.cast_into::<PyArray3<u8>>().map_err(|error| {
                let array = error.into_inner();
                let told = |name: &str| array.getattr(name).map(|one| one.to_string());
                let [shape, kind] = ["shape", "dtype"].map(|one| told(one).unwrap_or_default());
                let wanted = "must be uint8 of shape (h, w, 3)";
                let message = format!("{name}: {wanted}, is {kind} of {shape}");
                error::argument(name, &[], None, message)
            })?
        }
    };
    let [height, width, colours] = *array.shape() else {
        return Err(error::shape(name, "(h, w, 3)", array.shape()));
    };
    if colours != 3 {
        return Err(error::shape(name, "(h, w, 3)", array.shape()));
    }
    let read = array.readonly();
    let bytes = match read.as_slice() {
        Ok(bytes) if read.is_c_contiguous() => bytes.to_vec(),
        _ => read.as_array().iter().copied().collect(),
    };
    let sides = [width, height].map(u32::try_from);
    let frame = match sides {
        [Ok(width), Ok(height)] => palpate::frame(name, width, height, bytes),
        _ => None,
    };
    frame.ok_or_else(|| error::shape(name, "(h, w, 3)", array.shape()))
}

/// Pixels as an array (h, w, 3) of uint8.
pub(crate) fn pixels(py: Python<'_>, picture: RgbImage) -> PyResult<Py<PyAny>> {
    let (width, height) = picture.dimensions();
    let bytes = PyArray1::from_vec(py, picture.into_raw());
    let shaped = bytes.reshape([height as usize, width as usize, 3])?;
    Ok(shaped.into_any().unbind())
}

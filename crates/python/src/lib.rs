//! The native module of the Python package palpate: arrays and arguments in, the library's answers out.

mod answers;
mod arrays;
mod error;
mod estimate;
mod figure;
mod json;
mod pixels;
mod record;
mod sensor;
mod study;
mod table;
mod watch;

use palpate::recorded::ShapeClass;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

/// JSON Schema of a study's config, as a dictionary: every key with its meaning, its unit and its default.
#[pyfunction]
fn schema(py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
    json::of_json(py, &palpate::config::schema())
}

/// Native part of palpate; its names are those of the package.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    let classes = ShapeClass::ALL.map(ShapeClass::name);
    module.add("SHAPE_CLASSES", PyTuple::new(module.py(), classes)?)?;
    error::register(module)?;
    module.add_class::<record::Record>()?;
    module.add_class::<figure::Figure>()?;
    module.add_class::<estimate::Batch>()?;
    module.add_class::<estimate::RollEstimate>()?;
    module.add_class::<estimate::RollBatch>()?;
    module.add_class::<estimate::GlideEstimate>()?;
    module.add_class::<estimate::PressEstimate>()?;
    module.add_class::<sensor::Calibration>()?;
    module.add_class::<sensor::CameraCalibration>()?;
    module.add_class::<sensor::Tracked>()?;
    module.add_class::<sensor::Layout>()?;
    module.add_class::<sensor::Pattern>()?;
    module.add_class::<study::Study>()?;
    module.add_class::<study::Results>()?;
    module.add_class::<study::Trace>()?;
    module.add_class::<answers::design::DesignAnswer>()?;
    module.add_class::<answers::report::Report>()?;
    module.add_class::<answers::distinguish::ToldApart>()?;
    module.add_function(wrap_pyfunction!(schema, module)?)?;
    module.add_function(wrap_pyfunction!(estimate::estimate_roll, module)?)?;
    module.add_function(wrap_pyfunction!(estimate::estimate_glide, module)?)?;
    module.add_function(wrap_pyfunction!(estimate::estimate_press, module)?)?;
    module.add_function(wrap_pyfunction!(sensor::calibrate, module)?)?;
    module.add_function(wrap_pyfunction!(sensor::calibrate_frames, module)?)?;
    module.add_function(wrap_pyfunction!(sensor::calibrate_camera, module)?)?;
    module.add_function(wrap_pyfunction!(sensor::track, module)?)?;
    module.add_function(wrap_pyfunction!(sensor::pattern, module)?)?;
    module.add_function(wrap_pyfunction!(answers::design::design, module)?)?;
    module.add_function(wrap_pyfunction!(answers::distinguish::distinguish, module)?)?;
    module.add_function(wrap_pyfunction!(answers::report::report, module)?)?;
    module.add_function(wrap_pyfunction!(answers::words::explain, module)?)?;
    Ok(())
}

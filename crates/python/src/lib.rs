//! The native module of the Python package palpate: converts arrays and arguments, calls the library, and converts its
//! results.

mod answers;
mod arrays;
mod error;
mod estimate;
mod figure;
mod json;
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
    json::to_python(py, &palpate::config::schema())
}

/// Native part of the package palpate. The package exports the same names.
#[pymodule]
mod _native {
    use super::*;

    #[pymodule_export]
    use super::answers::design::{DesignAnswer, design};
    #[pymodule_export]
    use super::answers::distinguish::{Distinction, distinguish};
    #[pymodule_export]
    use super::answers::explain;
    #[pymodule_export]
    use super::answers::report::{Report, report};
    #[pymodule_export]
    use super::answers::sensitivity::{Sensitivity, sensitivity};
    #[pymodule_export]
    use super::estimate::{Batch, GlideEstimate, PressEstimate, RollEstimate};
    #[pymodule_export]
    use super::estimate::{estimate_glide, estimate_press, estimate_roll};
    #[pymodule_export]
    use super::sensor::{Calibration, CameraCalibration, Layout, Pattern, Tracked};
    #[pymodule_export]
    use super::sensor::{calibrate, calibrate_camera, calibrate_frames, pattern, track};
    #[pymodule_export]
    use super::study::{Results, Study, Trace};
    #[pymodule_export]
    use super::{figure::Figure, record::Record, schema};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))?;
        let classes = ShapeClass::ALL.map(ShapeClass::name);
        module.add("SHAPE_CLASSES", PyTuple::new(module.py(), classes)?)?;
        error::register(module)
    }
}

//! Defines the class of figures that functions of the package return.

use pyo3::prelude::*;

/// Figure in SVG format. A notebook displays it.
#[pyclass(frozen, module = "palpate")]
pub(crate) struct Figure {
    /// Name of the figure's files, without the extension.
    #[pyo3(get)]
    name: String,
    /// Title of the figure, which is also drawn in the picture.
    #[pyo3(get)]
    title: String,
    /// The picture as SVG text.
    #[pyo3(get)]
    svg: String,
}

impl From<palpate::Figure> for Figure {
    fn from(figure: palpate::Figure) -> Self {
        Self {
            name: figure.name,
            title: figure.title,
            svg: figure.svg,
        }
    }
}

#[pymethods]
impl Figure {
    #[new]
    fn new(name: String, title: String, svg: String) -> Self {
        Self { name, title, svg }
    }

    fn _repr_svg_(&self) -> &str {
        &self.svg
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> (Bound<'py, PyAny>, (String, String, String)) {
        let own = slf.get();
        let state = (own.name.clone(), own.title.clone(), own.svg.clone());
        (slf.get_type().into_any(), state)
    }

    fn __repr__(&self) -> String {
        format!("<Figure {:?}: {}>", self.name, self.title)
    }
}

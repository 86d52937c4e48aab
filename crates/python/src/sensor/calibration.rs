//! Calibrates a camera sensor.

use palpate::config::LengthUnit;
use palpate::recorded::{
    self, CalibrateOptions, CalibrationPoints, CalibrationReport, KnownDisplacements, NormalFrom,
    RecordedFile, calibration_toml, frame_calibration_points, parse_calibration,
};
use palpate::{Column, Table as Rows};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::Numbers;
use crate::error;
use crate::estimate::length_unit;
use crate::json::to_python;
use crate::record::records;
use crate::sensor::frame;

/// Calibration of a sensor: how the hue, size and centroid of a marker in the frames depend on its displacement.
///
/// `Calibration(toml)` reads the text that `palpate sensor calibrate` writes. `summary` is a list of lines of text.
#[pyclass(frozen, module = "palpate")]
pub(crate) struct Calibration {
    pub(super) calibration: recorded::Calibration,
    pub(super) unit: LengthUnit,
    /// Lines of text that describe the calibration: slopes, standard errors, R² and residuals.
    #[pyo3(get)]
    summary: Vec<String>,
    /// Warnings, each with `code`, `text` and `numbers`.
    #[pyo3(get)]
    warnings: Py<PyAny>,
}

impl Calibration {
    fn of(py: Python<'_>, report: CalibrationReport) -> PyResult<Self> {
        Ok(Self {
            summary: report.summary(),
            warnings: records(py, &report.warnings())?,
            unit: report.length_unit,
            calibration: report.calibration,
        })
    }
}

#[pymethods]
impl Calibration {
    #[new]
    #[pyo3(signature = (toml, summary=None, warnings=None))]
    fn new(
        py: Python<'_>,
        toml: String,
        summary: Option<Vec<String>>,
        warnings: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let file = RecordedFile::new("calibration", toml.into_bytes());
        let (calibration, unit) = parse_calibration(&file).map_err(error::recorded)?;
        Ok(Self {
            calibration,
            unit,
            summary: summary.unwrap_or_default(),
            warnings: warnings.map_or_else(|| records(py, &[]), Ok)?,
        })
    }

    /// Unit of all lengths in the calibration.
    #[getter]
    fn length_unit(&self) -> &'static str {
        self.unit.as_str()
    }

    /// The calibration as TOML text. `palpate sensor track --calibration` reads this text from a file.
    fn to_toml(&self) -> String {
        calibration_toml(&self.calibration, self.unit)
    }

    /// The fields as a dictionary.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let parsed: toml::Value = toml::from_str(&self.to_toml()).map_err(error::run)?;
        to_python(py, &parsed)
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.to_toml() == other.to_toml()
    }

    #[allow(clippy::type_complexity)]
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> (Bound<'py, PyAny>, (String, Vec<String>, Py<PyAny>)) {
        let own = slf.get();
        let warnings = own.warnings.clone_ref(slf.py());
        let state = (own.to_toml(), own.summary.clone(), warnings);
        (slf.get_type().into_any(), state)
    }

    fn __repr__(&self) -> String {
        match self.summary.is_empty() {
            true => format!("<Calibration in {}>", self.unit.as_str()),
            false => self.summary.join("\n"),
        }
    }
}

fn source(name: &str) -> PyResult<NormalFrom> {
    let mut all = NormalFrom::ALL.into_iter();
    all.find(|from| name == <&str>::from(from)).ok_or_else(|| {
        let message = format!("source: must be hue, size or both, is {name:?}");
        error::argument("source", &[], None, message)
    })
}

/// Calibrates hue, size and centroid of markers against measured displacements, from tables.
///
/// Parameters
/// ----------
/// *tables : mapping of str to array, (n,)
///     Each table has columns for displacements inward, for displacements along the skin, or for both. Inward:
///     `normal_displacement` (in `length_unit`), with `hue_turns` or `growth` (change of the logarithm of the marker's
///     diameter) or both. Along the skin: `tangential_displacement` (in `length_unit`), with `centroid_shift_px`. The
///     optional columns `series` and `marker` contain the number of the series and of the marker. Other columns are
///     ignored. A table may be a data frame.
/// source : str
///     Property of a marker from which its normal displacement is computed: "hue", "size" or "both".
/// per_marker : bool
///     Whether to fit a separate slope for each marker that was measured at 3 or more displacements.
/// length_unit : str, optional
///     Unit of all lengths: "m", "cm", "mm", "um" or "unit", which is the default.
///
/// Returns
/// -------
/// Calibration
///
/// Raises
/// ------
/// ArgumentError, ReadingsError
///     If columns are missing, have different lengths or contain numbers that are not finite; if the points do not
///     determine a slope.
///
/// Source
/// ------
/// X. Lin et al., ICRA 2020, section IV.
#[pyfunction]
#[pyo3(signature = (*tables, source="hue", per_marker=false, length_unit=None))]
pub(crate) fn calibrate(
    py: Python<'_>,
    tables: Vec<Bound<'_, PyAny>>,
    source: &str,
    per_marker: bool,
    length_unit: Option<&str>,
) -> PyResult<Calibration> {
    let options = CalibrateOptions {
        from: self::source(source)?,
        per_marker,
        markers: None,
        length_unit: self::length_unit(length_unit)?,
    };
    let points = tables.iter().enumerate().map(|(place, table)| {
        let file = RecordedFile::new(format!("tables[{place}]"), csv(place, table)?);
        CalibrationPoints::try_from(&file).map_err(error::recorded)
    });
    let points: Vec<_> = points.collect::<PyResult<_>>()?;
    let report = recorded::calibrate(&points, &options).map_err(error::recorded)?;
    Calibration::of(py, report)
}

/// Converts a table, given as a mapping of columns, to CSV. The numbers keep every digit.
fn csv(place: usize, table: &Bound<'_, PyAny>) -> PyResult<Vec<u8>> {
    let py = table.py();
    let columns = py
        .get_type::<PyDict>()
        .call1((table,))?
        .cast_into::<PyDict>()?;
    let mut names: Vec<Column> = Vec::new();
    let mut texts: Vec<Column> = Vec::new();
    let mut all: Vec<Vec<f64>> = Vec::new();
    for (name, column) in columns.iter() {
        let name: String = name.extract()?;
        let Ok(numbers) = Numbers::of("tables", &column) else {
            // Not all values of this column are numbers. Treat it as a column of text, and leave all its fields empty.
            texts.push(Column::text(&name));
            continue;
        };
        let column = numbers.flat().to_vec();
        let at = |message: String, index: &[usize], value| {
            let message = format!("tables[{place}][{name:?}]{message}");
            error::argument("tables", index, value, message)
        };
        let rows = all.first().map_or(column.len(), Vec::len);
        if numbers.shape().len() != 1 || column.len() != rows {
            let message = format!(": must have shape ({rows},), has {:?}", numbers.shape());
            return Err(at(message, &[place], None));
        }
        if let Some(row) = column.iter().position(|number| !number.is_finite()) {
            let message = format!("[{row}]: must be finite, is {}", column[row]);
            return Err(at(message, &[place, row], Some(column[row])));
        }
        names.push(Column::number(&name, "1"));
        all.push(column);
    }
    let mut rows = Rows::new(names.into_iter().chain(texts.clone()));
    for row in 0..all.first().map_or(0, Vec::len) {
        let empty = texts.iter().map(|_| f64::NAN);
        rows.push_numbers(all.iter().map(|column| column[row]).chain(empty));
    }
    Ok(rows.to_csv().into_bytes())
}

/// Calibrates hue, size and centroid of markers against measured displacements, from frames of a camera.
///
/// Parameters
/// ----------
/// rest : array of uint8, (h, w, 3)
///     Frame at rest, with the colours red, green and blue.
/// pressed : sequence of such arrays
///     Pressed frames. In each frame, the marker that changes most must be the marker under the contact.
/// normal, tangential : array, (k,), optional
///     Displacements of this marker in the k pressed frames, in `length_unit`: `normal` inward, `tangential` along the
///     skin.
/// px_per_rad : float, optional
///     Focal length of the fisheye lens, px per rad; by default, the scale in the middle of each frame applies to the
///     whole frame.
/// source, per_marker, length_unit
///     The same arguments as in `calibrate`.
/// srgb : bool
///     Whether the pixels are encoded by sRGB, as in images of most cameras. If false, pixel values are proportional to
///     the light.
///
/// Returns
/// -------
/// Calibration
///
/// Raises
/// ------
/// ArgumentError, ReadingsError
///     If the frames have different sizes, show no markers or are of different sensors; if the points do not determine
///     a slope.
#[pyfunction]
#[pyo3(signature = (rest, pressed, *, normal=None, tangential=None, px_per_rad=None, source="hue", per_marker=false,
    length_unit=None, srgb=false))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn calibrate_frames(
    py: Python<'_>,
    rest: &Bound<'_, PyAny>,
    pressed: Vec<Bound<'_, PyAny>>,
    normal: Option<Bound<'_, PyAny>>,
    tangential: Option<Bound<'_, PyAny>>,
    px_per_rad: Option<f64>,
    source: &str,
    per_marker: bool,
    length_unit: Option<&str>,
    srgb: bool,
) -> PyResult<Calibration> {
    let known = |name: &'static str, numbers: Option<Bound<'_, PyAny>>| {
        let of_frames = |numbers: Bound<'_, PyAny>| {
            let numbers = Numbers::of(name, &numbers)?;
            if numbers.shape() != [pressed.len()] {
                let wanted = format!("({},), one per pressed frame,", pressed.len());
                return Err(error::shape(name, &wanted, numbers.shape()));
            }
            Ok(numbers.flat().to_vec())
        };
        numbers.map(of_frames).transpose()
    };
    let from = self::source(source)?;
    let known = KnownDisplacements {
        normal: known("normal", normal)?,
        tangential: known("tangential", tangential)?,
        from,
        px_per_rad,
    };
    if known.normal.is_none() && known.tangential.is_none() {
        let message = "frames need normal or tangential: a displacement of the marker under the contact for each";
        return Err(error::argument("normal", &[], None, message));
    }
    let rest = frame("rest", rest, srgb)?;
    let frames = pressed.iter().enumerate();
    let frames = frames.map(|(place, one)| frame(&format!("pressed[{place}]"), one, srgb));
    let frames: Vec<recorded::Frame> = frames.collect::<PyResult<_>>()?;
    let unit = self::length_unit(length_unit)?;
    let report = py.detach(|| {
        let (points, markers) = frame_calibration_points(&rest, &frames, &known)?;
        let options = CalibrateOptions {
            from,
            per_marker,
            markers: Some(markers),
            length_unit: unit,
        };
        recorded::calibrate(&[points], &options)
    });
    Calibration::of(py, report.map_err(error::recorded)?)
}

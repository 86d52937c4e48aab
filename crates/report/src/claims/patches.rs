//! Estimates of patches in a table: what was touched, how noisily, and by which method it was fitted.

use super::evidence::{near, percent, short};
use crate::group::distinct;
use crate::{Study, study};

const OBJECT: &str = "scene.object";
const ESTIMATOR: &str = "scene.estimator";
const NOISE: &str = "scene.noise.position.fraction_of_ifd";

/// Name of the Gaussian curvature in the table.
pub(super) const GAUSSIAN: &str = "gaussian_curvature";
/// Name of the mean curvature in the table.
pub(super) const MEAN: &str = "mean_curvature";
/// Name of the share classified correctly in the table.
const CLASS: &str = "class";

/// The paper's method, both fits.
pub(super) const TWO_PASS: &str = "two-pass";
/// Its first fit alone; a label may go on after these words.
pub(super) const FIRST_PASS: &str = "first pass";

/// The rows of a table by object, method and noise, each as labelled there but for [`FIRST_PASS`].
pub(super) struct Patches<'a> {
    study: &'a Study,
    rows: Vec<Row<'a>>,
}

struct Row<'a> {
    row: usize,
    object: &'a str,
    method: &'a str,
    /// Position noise in inter-finger distances.
    noise: f64,
}

impl<'a> Patches<'a> {
    /// Reads every row of the table; an error says what the table lacks.
    pub(super) fn of(study: &'a Study) -> Result<Self, String> {
        let named = |row: usize, path: &str| {
            let kind = || study.setting(path)?.as_table()?.get("kind")?.as_str();
            let label = study.text(row, path).or_else(kind);
            label.ok_or_else(|| format!("no {path} in the table or the config"))
        };
        let place = |row: usize| {
            Ok(Row {
                row,
                object: named(row, OBJECT)?,
                method: match named(row, ESTIMATOR)? {
                    label if label.starts_with(FIRST_PASS) => FIRST_PASS,
                    label => label,
                },
                noise: study
                    .number(row, NOISE)
                    .ok_or_else(|| format!("no number for {NOISE} in the table or the config"))?,
            })
        };
        let rows = (0..study.cells().rows()).map(place);
        Ok(Self {
            study,
            rows: rows.collect::<Result<_, String>>()?,
        })
    }

    /// The objects that `method` was used on, in the order of the table.
    pub(super) fn objects(&self, method: &str) -> Vec<&'a str> {
        distinct(
            self.rows
                .iter()
                .filter(|row| row.method == method)
                .map(|row| row.object),
        )
    }

    /// The methods other than the paper's and its first fit, in the order of the table.
    pub(super) fn other_methods(&self) -> Vec<&'a str> {
        let all = self.rows.iter().map(|row| row.method);
        distinct(all.filter(|method| ![TWO_PASS, FIRST_PASS].contains(method)))
    }

    /// The levels of noise for which `keep` holds, rising.
    pub(super) fn noises(&self, keep: impl Fn(f64) -> bool) -> Vec<f64> {
        let mut all: Vec<f64> = self
            .rows
            .iter()
            .map(|row| row.noise)
            .filter(|noise| keep(*noise))
            .collect();
        all.sort_by(f64::total_cmp);
        all.dedup_by(|a, b| near(*a, *b));
        all
    }

    /// The rms error of `quantity` over the patch and all trials.
    pub(super) fn rms(
        &self,
        quantity: &str,
        object: &str,
        method: &str,
        noise: f64,
    ) -> Result<f64, String> {
        let row = self.row(quantity, object, method, noise)?;
        self.study
            .cells()
            .statistic(row, "rms_error")
            .filter(|error| *error > 0.0)
            .ok_or_else(|| {
                format!(
                    "no rms error of {quantity} above 0 for {}",
                    told(object, method, noise)
                )
            })
    }

    /// The share of the patch that is classified correctly, over all trials; a failed trial classifies nothing.
    pub(super) fn share(&self, object: &str, method: &str, noise: f64) -> Result<f64, String> {
        let row = self.row(CLASS, object, method, noise)?;
        let statistic = |name: &str| self.study.cells().statistic(row, name);
        let (Some(trials), Some(failures)) = (statistic("trials"), statistic("failures")) else {
            return Err(format!(
                "no number of trials for {}",
                told(object, method, noise)
            ));
        };
        if trials > 0.0 && failures >= trials {
            return Ok(0.0);
        }
        let share = statistic("mean").filter(|_| trials > 0.0);
        share
            .map(|share| share * (1.0 - failures / trials))
            .ok_or_else(|| format!("no share of classes for {}", told(object, method, noise)))
    }

    /// The largest principal curvature of an object: from its true curvatures where the table has one value for all
    /// of the patch, else from its shape: 1/radius, or for a saddle z = a (x² − y²) that at its middle, 2a.
    pub(super) fn largest_curvature(&self, object: &str) -> Result<f64, String> {
        let table = self.study.cells();
        let truth = |quantity: &str| {
            let mut rows = self
                .rows
                .iter()
                .filter(|row| row.object == object && table.quantity(row.row) == quantity);
            rows.find_map(|row| table.statistic(row.row, "truth"))
        };
        let from_truth = || {
            let (gaussian, mean) = (truth(GAUSSIAN)?, truth(MEAN)?);
            Some(mean.abs() + (mean * mean - gaussian).max(0.0).sqrt())
        };
        let from_config = || {
            let shape = self.shape(object)?;
            let number = |key: &str| study::number(shape.get(key)?);
            match shape.get("kind")?.as_str()? {
                "saddle" => Some(2.0 * number("a")?.abs()),
                "sphere" | "dish" | "cylinder" => Some(1.0 / number("radius")?),
                _ => None,
            }
        };
        from_truth()
            .or_else(from_config)
            .filter(|curvature| *curvature > 0.0 && curvature.is_finite())
            .ok_or_else(|| format!("neither table nor config tell how curved the {object} is"))
    }

    /// The config of an object: where the sweep gives it this label, else the scene's own.
    pub(super) fn shape(&self, object: &str) -> Option<&'a toml::Table> {
        let sweeps = self
            .study
            .config()
            .get("sweep")
            .and_then(toml::Value::as_array);
        let labelled = sweeps
            .into_iter()
            .flatten()
            .filter(|sweep| sweep.get("path").and_then(toml::Value::as_str) == Some(OBJECT))
            .filter_map(|sweep| sweep.get("values")?.as_array())
            .flatten()
            .filter_map(toml::Value::as_table)
            .find(|shape| shape.get("label").and_then(toml::Value::as_str) == Some(object));
        labelled.or_else(|| self.study.setting(OBJECT)?.as_table())
    }

    /// The one row of a quantity, object, method and noise.
    fn row(&self, quantity: &str, object: &str, method: &str, noise: f64) -> Result<usize, String> {
        let mut rows = self.rows.iter().filter(|row| {
            row.object == object
                && row.method == method
                && near(row.noise, noise)
                && self.study.cells().quantity(row.row) == quantity
        });
        match (rows.next(), rows.next()) {
            (Some(row), None) => Ok(row.row),
            (None, _) => Err(format!(
                "the table has no {quantity} for {}",
                told(object, method, noise)
            )),
            (Some(_), Some(_)) => Err(format!(
                "the table has several rows of {quantity} for {}",
                told(object, method, noise)
            )),
        }
    }
}

fn told(object: &str, method: &str, noise: f64) -> String {
    format!("{object}, {method}, {} noise", percent(noise))
}

/// A ratio in three digits: `2.5 ×`.
pub(super) fn times(ratio: f64) -> String {
    format!("{} ×", short(ratio))
}

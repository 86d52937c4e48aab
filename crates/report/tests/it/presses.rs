//! Small studies of presses: tables of fabricated estimates, profiles of a given shape.

use crate::fixture::{self, NO_FAILURES, STATISTICS};
use palpate_report::Study;

/// Objects by label, config and effective radius on a sensor of 20 mm.
pub(crate) const OBJECTS: [(&str, &str, f64); 3] = [
    (
        "dish of 80 mm",
        "kind = \"dish\", radius = 80.0",
        80.0 / 3.0,
    ),
    ("plane", "kind = \"plane\"", 20.0),
    ("ball of 80 mm", "kind = \"sphere\", radius = 80.0", 16.0),
];

/// Config of presses in mm that sweeps objects and estimators. The config also contains `rest`.
pub(crate) fn config(claims: &str, rest: &str) -> String {
    let objects = OBJECTS.map(|(label, shape, _)| format!("{{ label = \"{label}\", {shape} }}"));
    format!(
        "name = \"study\"\ntitle = \"A question?\"\nlength_unit = \"mm\"\nclaims = {claims}\n\
         [scene]\nkind = \"press\"\nprobe = {{ kind = \"marker-sphere\", radius = 20.0 }}\n\
         object = {{ kind = \"plane\" }}\nmotion = {{ indentation = 1.0 }}\n\
         model = {{ kind = \"half-space\" }}\nestimator = {{ kind = \"half-space\" }}\n\
         [[sweep]]\npath = \"scene.object\"\nvalues = [{}]\n\
         [[sweep]]\npaths = [\"scene.estimator\"]\nvalues = [[{{ label = \"half-space\", kind = \"half-space\" }}], \
         [{{ label = \"gaussian\", kind = \"gaussian\", c = 1.0 }}], \
         [{{ label = \"calibrated gaussian\", kind = \"gaussian\" }}]]\n{rest}",
        objects.join(", ")
    )
}

/// Numbers of a row, without its swept values.
#[derive(Clone, Copy, Default)]
pub(crate) struct Numbers {
    pub(crate) truth: Option<f64>,
    pub(crate) trials: u64,
    pub(crate) failures: u64,
    pub(crate) mean: Option<f64>,
    pub(crate) std: Option<f64>,
    /// The 5, 50 and 95 % quantiles.
    pub(crate) quantiles: Option<[f64; 3]>,
    pub(crate) coverage: Option<f64>,
    pub(crate) bound: Option<f64>,
}

/// Builder of a table with a column for the Cramér–Rao bound.
pub(crate) struct Cells {
    text: String,
    failures: String,
    rows: usize,
}

impl Cells {
    pub(crate) fn new(axes: &str) -> Self {
        Self {
            text: format!("cell,{axes},quantity,unit,{STATISTICS},std_bound\n"),
            failures: NO_FAILURES.to_owned(),
            rows: 0,
        }
    }

    /// A cell of one quantity; its failures are of this kind.
    pub(crate) fn push(&mut self, place: &str, quantity: &str, numbers: Numbers, failure: &str) {
        let Numbers {
            trials, failures, ..
        } = numbers;
        let text = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
        let quantiles = match numbers.quantiles {
            None => ",,".to_owned(),
            Some([low, median, high]) => format!("{low},{median},{high}"),
        };
        let cell = self.rows;
        self.rows += 1;
        self.text += &format!(
            "{cell},{place},{quantity},1/mm,{},{trials},{failures},{},{},,,,,,,{quantiles},,,,{},{}\n",
            text(numbers.truth),
            text(numbers.mean),
            text(numbers.std),
            text(numbers.coverage),
            text(numbers.bound),
        );
        if failures > 0 {
            self.failures += &format!("{cell},{failure},{failures},0\n");
        }
    }

    pub(crate) fn study(&self, config: &str, map: Option<&str>) -> Study {
        let map: Vec<(&str, &str)> = map.map(|text| ("map.csv", text)).into_iter().collect();
        fixture::study(config, &self.text, &self.failures, &map)
    }
}

//! The plot that is drawn for a study without a `[[plot]]` table.

use crate::table::Axis;
use crate::{ReportError, Study, Table};
use palpate_study::config::{self, PlotConfig, Scale};
use palpate_study::{Quantity, QuantityKind, Statistic};
use std::collections::{BTreeMap, BTreeSet};

/// The default plot shows the first of these quantities that the study has.
const PREFERRED: [Quantity; 2] = [Quantity::OBJECT_CURVATURE, Quantity::MEAN_CURVATURE];
/// An axis is logarithmic if the ratio of its largest to its smallest value exceeds this number.
const MIN_LOG_RATIO: f64 = 8.0;

/// The default plot. It shows the relative rms error of the object's curvature over the first swept field. It has one
/// line per value of the second swept field, and one panel per value of the third. For every further field, only the
/// first value is plotted. A field is ignored if the values of the earlier fields determine its value. The result is
/// `None` if no field is swept, or if no statistic has a value.
///
/// If the study does not estimate the object's curvature, the plot shows the mean curvature, or else the first
/// quantity. If the true value is 0 or varies, the plot shows the rms error. If the quantity is not an estimate, or if
/// the table contains no errors of it, the plot shows the mean.
pub(crate) fn plot(study: &Study) -> Result<Option<PlotConfig>, ReportError> {
    let table = study.cells();
    let is_first = |first: &&Quantity| table.quantities().values().contains(&first.name.to_owned());
    let first = PREFERRED.iter().find(is_first);
    let quantity = first.map_or(table.quantity(0), |first| first.name);
    let of = |row: &usize| table.quantity(*row) == quantity;
    let mut rows: Vec<usize> = (0..table.rows()).filter(of).collect();
    let mut axes: Vec<&Axis> = Vec::new();
    let mut fixed: Vec<(&Axis, String)> = Vec::new();
    for axis in table.axes().iter().chain([table.trials()]) {
        if !adds_variation(axis, &axes, &rows) {
            continue;
        }
        if axes.len() < 3 {
            axes.push(axis);
            continue;
        }
        let first = axis.among(&rows)[0].to_owned();
        rows.retain(|row| axis.text(*row) == first);
        fixed.push((axis, first));
    }
    let (Some(x), Some(y)) = (axes.first(), statistic(table, quantity, &rows)) else {
        return Ok(None);
    };
    let is_far = |numbers: &mut dyn Iterator<Item = Option<f64>>| {
        let numbers: Option<Vec<f64>> = numbers.collect();
        numbers.is_some_and(|numbers| {
            let least = numbers.iter().copied().fold(f64::INFINITY, f64::min);
            let most = numbers.iter().copied().fold(0.0, f64::max);
            least > 0.0 && most > MIN_LOG_RATIO * least
        })
    };
    let known = rows.iter().filter_map(|row| table.statistic(*row, y));
    let scale = match (
        is_far(&mut rows.iter().map(|row| x.number(*row))),
        is_far(&mut known.map(Some)),
    ) {
        (true, true) => Scale::LogLog,
        (true, false) => Scale::LogX,
        (false, true) => Scale::LogY,
        (false, false) => Scale::Linear,
    };
    let header = |place: usize| axes.get(place).map(|axis| axis.header.clone());
    let values = fixed.into_iter();
    let values = values.map(|(axis, value)| (axis.header.clone(), toml::Value::String(value)));
    // Parse a plot that has only the required keys. This sets all other keys to their default values.
    let file = study.run_toml().display().to_string();
    let mut plots = config::plots(&file, "[[plot]]\nx = \"\"\ny = \"mean\"\n")?;
    Ok(plots.pop().map(|empty| PlotConfig {
        x: header(0),
        y: Some(y.to_owned()),
        quantity: Some(quantity.to_owned()),
        series: header(1),
        panels: header(2),
        where_: values.collect::<BTreeMap<_, _>>(),
        scale,
        ..empty
    }))
}

/// Whether `axis` varies independently of the axes `others`: two of the `rows` have equal values on all axes `others`,
/// but different values on `axis`.
fn adds_variation(axis: &Axis, others: &[&Axis], rows: &[usize]) -> bool {
    let mut known: BTreeMap<Vec<&str>, BTreeSet<&str>> = BTreeMap::new();
    for &row in rows {
        let key = others.iter().map(|other| other.text(row)).collect();
        known.entry(key).or_default().insert(axis.text(row));
    }
    known.values().any(|values| values.len() > 1)
}

/// The statistic that the default plot shows. It is the first statistic, in the order of preference, that has a value
/// in one of `rows`; `None` if no statistic has a value.
fn statistic(table: &Table, quantity: &str, rows: &[usize]) -> Option<&'static str> {
    let is_estimated =
        Quantity::named(quantity).is_none_or(|known| known.kind == QuantityKind::Estimated);
    let errors = [Statistic::RelativeRmsError, Statistic::RmsError];
    let all = errors.into_iter().filter(|_| is_estimated);
    let mut all = all.chain([Statistic::Mean]).map(Statistic::name);
    all.find(|name| rows.iter().any(|row| table.statistic(*row, name).is_some()))
}

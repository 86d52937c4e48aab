//! Summary of an estimate in at most six lines, for a person at a terminal.

use palpate_statistics::Number;
use serde_json::Value;

/// Keys of the quantities that a summary may show, most important first.
const QUANTITIES: [&str; 12] = [
    "radius",
    "object_curvature",
    "mean_curvature",
    "gaussian_curvature",
    "k_min",
    "k_max",
    "normal_curvature_u",
    "normal_curvature_v",
    "effective_radius",
    "indentation",
    "contact_radius",
    "rms_misfit",
];
/// Largest number of quantities in a summary.
const MAX_SHOWN: usize = 5;
/// Largest number of rejected rows that a summary lists by number.
const LISTED_ROWS: usize = 8;

/// Lines of text about an estimate: the first quantity and the shape of the object in one line, then the other
/// quantities, then the number of readings.
pub(super) fn summary(estimate: &Value) -> String {
    let along = quantity(
        "curvature along the stroke",
        &estimate["stroke"]["curvature_along"],
    );
    let quantities = QUANTITIES
        .iter()
        .filter_map(|key| quantity(key, &estimate[*key]));
    let path = &estimate["single_direction"]["curvature_along"];
    let along = along.or_else(|| quantity("curvature along the rolls", path));
    let quantities = along.into_iter().chain(quantities);
    let mut lines: Vec<String> = quantities.take(MAX_SHOWN).collect();
    if let (Some(first), Some(verdict)) = (lines.first_mut(), verdict(estimate)) {
        *first = format!("{first}, {verdict}");
    }
    lines.extend(readings(estimate));
    lines.join("\n")
}

/// Text of a quantity with its 95 % interval; `None` if `value` has no interval.
fn quantity(key: &str, value: &Value) -> Option<String> {
    value.get("interval95")?;
    let unit = value.get("unit")?.as_str()?;
    let unit = if unit.is_empty() {
        String::new()
    } else {
        format!(" {unit}")
    };
    let number = |value: &Value| {
        value
            .as_f64()
            .map(|number| Number::rounded(number).to_string())
    };
    let name = key.replace('_', " ");
    let [low, high] = [0, 1].map(|end| number(&value["interval95"][end]));
    let estimate = number(&value["value"]);
    let interval = match (&low, &high) {
        (Some(low), Some(high)) => format!(" (95 %: {low} to {high})"),
        (Some(low), None) if estimate.is_some() => format!(" (95 %: at least {low})"),
        (None, Some(high)) if estimate.is_some() => format!(" (95 %: at most {high})"),
        _ => String::new(),
    };
    Some(match (estimate, low) {
        (Some(estimate), _) => format!("{name} {estimate}{unit}{interval}"),
        (None, Some(low)) => format!("{name} not resolved, at least {low}{unit} (95 %)"),
        (None, None) => format!("{name} not resolved"),
    })
}

/// Text with the shape or the shape class of the object, and the probability of this shape or class. The text is "not
/// resolved across" if all rolls or strokes have the same direction, because they do not determine the curvature across
/// this direction.
fn verdict(estimate: &Value) -> Option<String> {
    if !(estimate["stroke"].is_null() && estimate["single_direction"].is_null()) {
        return Some("not resolved across".to_owned());
    }
    let of_shape = (&estimate["shape"], &estimate["shape_probabilities"]);
    let of_class = (&estimate["class"], &estimate["class_probabilities"]);
    let alone = (&estimate["verdict"], &Value::Null);
    let mut all = [of_shape, of_class, alone].into_iter();
    let (name, probabilities) = all.find(|(name, _)| name.is_string())?;
    let name = name.as_str()?;
    let share = probabilities[name].as_f64();
    let percent = share.map_or(String::new(), |share| format!(" {:.0} %", 100.0 * share));
    Some(format!(
        "{}{percent}",
        if name == "none" {
            "no simple shape"
        } else {
            name
        }
    ))
}

/// Text with the number of readings, and with the rows that were left out or rejected.
fn readings(estimate: &Value) -> Option<String> {
    let mut counts = ["contacts", "markers", "probes"].into_iter();
    let (what, count) = counts.find_map(|what| Some((what, estimate[what].as_u64()?)))?;
    let left = ["left_out", "wrong_markers"].map(|key| estimate[key].as_array());
    let left: Vec<&Value> = left.into_iter().flatten().flatten().collect();
    let warnings = estimate["warnings"].as_array().into_iter().flatten();
    let lost = warnings.filter_map(|one| one["numbers"]["without_numbers"].as_f64());
    let lost: f64 = lost.sum();
    let (first, separator) = match left.len() {
        0 => (format!("{count} {what}"), ", "),
        all => (left_out(all, &left, &format!("of {count} {what}")), "; "),
    };
    let independent = estimate["effective_contacts"].as_f64().map(Number::rounded);
    let without = match lost > 0.0 {
        true => Some(format!("{lost} without numbers left out")),
        false => left.is_empty().then(|| "none left out".to_owned()),
    };
    let independent = independent.map(|all| format!("{all} independent"));
    let all = [Some(first), independent, without].into_iter().flatten();
    Some(all.collect::<Vec<_>>().join(separator))
}

/// Text that states how many readings are left out, and lists the rows or probes of the first [`LISTED_ROWS`] of them.
/// `left` contains these readings.
fn left_out(count: usize, left: &[&Value], total: &str) -> String {
    let rows = left.iter().take(LISTED_ROWS);
    let rows = rows.map(|one| one.get("row").unwrap_or(&one["probe"]).to_string());
    let rows = rows.collect::<Vec<_>>().join(", ");
    let more = if count > LISTED_ROWS { ", …" } else { "" };
    let has_rows = left.iter().all(|one| one.get("row").is_some());
    let word = if has_rows { "row" } else { "probe" };
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {total} left out: {word}{plural} {rows}{more}")
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn an_estimate_is_a_verdict_and_few_lines() {
        let radius = json!({ "value": 39.62, "interval95": [38.7, 40.54], "unit": "mm" });
        let open = json!({ "value": null, "interval95": [null, null], "unit": "1/mm" });
        let rows = json!([{ "row": 5 }, { "row": 14 }]);
        let estimate = json!({
            "radius": radius, "mean_curvature": open, "shape": "cylinder", "contacts": 36,
            "shape_probabilities": { "cylinder": 0.97 }, "left_out": rows, "effective_contacts": 34.0,
        });
        let lines = "radius 39.6 mm (95 %: 38.7 to 40.5), cylinder 97 %\nmean curvature not resolved\n2 of 36 contacts left out: rows 5, 14; 34 independent";
        assert_eq!(summary(&estimate), lines);
    }
}

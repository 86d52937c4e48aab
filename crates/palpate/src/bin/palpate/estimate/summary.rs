//! Summary of an estimate in at most six lines, for a person at a terminal.

use palpate_statistics::Number;
use serde_json::Value;

/// Names of the quantities that a summary may show, and where the estimate has them, most important first.
const QUANTITIES: [(&str, &str); 17] = [
    ("curvature along the stroke", "/stroke/curvature_along"),
    ("curvature along the rolls", ALONG_ROLLS),
    ("radius", "/radius"),
    (OBJECT_RADIUS, "/object_radius"),
    (MEAN_RADIUS, "/radius"),
    ("object curvature", "/object_curvature"),
    ("mean curvature", "/mean_curvature"),
    ("gaussian curvature", "/gaussian_curvature"),
    ("k_min", "/k_min"),
    ("k_max", "/k_max"),
    ("k_min", "/principal_curvature_min"),
    ("k_max", "/principal_curvature_max"),
    ("k_min", "/principal/curvature_min"),
    ("k_max", "/principal/curvature_max"),
    ("indentation", "/indentation"),
    ("contact radius", "/contact_radius"),
    ("rms misfit", "/rms_misfit"),
];
const ALONG_ROLLS: &str = "/single_direction/curvature_along";
const OBJECT_RADIUS: &str = "object radius";
/// The inverse of the mean curvature. It is shown only for an object that is curved in all directions.
const MEAN_RADIUS: &str = "mean radius";
/// Largest number of quantities in a summary.
const MAX_SHOWN: usize = 5;
const MAX_DECIMALS: f64 = 6.0;
/// Largest number of rejected rows that a summary lists by number.
const LISTED_ROWS: usize = 8;

/// Lines of text about an estimate: the first quantity and the shape of the object in one line, then the other
/// quantities, then the number of readings.
pub(super) fn summary(estimate: &Value) -> String {
    let is_round = match estimate["class"].as_str() {
        Some(class) => ["peak", "pit"].contains(&class),
        None => estimate["principal"].is_null(),
    };
    let shown = QUANTITIES
        .iter()
        .filter(|(name, _)| is_round || ![OBJECT_RADIUS, MEAN_RADIUS].contains(name));
    let quantities = shown.filter_map(|(name, place)| quantity(name, estimate.pointer(place)?));
    let mut lines: Vec<String> = quantities.take(MAX_SHOWN).collect();
    if let Some(first) = lines.first_mut() {
        let axis = estimate["principal"]["axis_deg"].as_f64();
        let axis = axis.map(|deg| format!("axis at {} deg", Number::rounded(deg)));
        let curvatures = ["mean_curvature", "object_curvature"].into_iter();
        let mut highest = curvatures.filter_map(|name| estimate[name]["interval95"][1].as_f64());
        let is_concave = is_round && highest.any(|highest| highest < 0.0);
        let concave = is_concave.then(|| "concave".to_owned());
        for text in verdict(estimate).into_iter().chain(concave).chain(axis) {
            *first = format!("{first}, {text}");
        }
    }
    lines.extend(readings(estimate));
    lines.join("\n")
}

/// Text of a quantity with its 95 % interval; `None` if `value` has no interval, or if the model has set the value to 0.
/// A radius has an interval if the object is surely convex, or surely concave.
fn quantity(name: &str, value: &Value) -> Option<String> {
    let ends = match (name, [&value["convex95"], &value["concave95"]]) {
        (OBJECT_RADIUS | MEAN_RADIUS, [ends @ Value::Array(_), Value::Null]) => ends,
        (OBJECT_RADIUS | MEAN_RADIUS, [Value::Null, ends @ Value::Array(_)]) => ends,
        (OBJECT_RADIUS | MEAN_RADIUS, _) => return None,
        _ => value.get("interval95")?,
    };
    let unit = match value.get("unit")?.as_str()? {
        "" => String::new(),
        unit => format!(" {unit}"),
    };
    let [low, high] = [0, 1].map(|end| ends[end].as_f64());
    if low == Some(0.0) && high == low {
        return None;
    }
    // The width of the interval has two significant digits.
    let decimals = low
        .zip(high)
        .map_or(f64::NAN, |(low, high)| 1.0 - (high - low).log10().floor());
    let number = |number: f64| match (0.0..=MAX_DECIMALS).contains(&decimals) {
        true => match format!("{number:.*}", decimals as usize) {
            zero if zero.parse() == Ok(0.0) => "0".to_owned(),
            text => text,
        },
        false => Number::rounded(number).to_string(),
    };
    // The radius of a concave object is negative, but its interval has the two magnitudes.
    let is_radius = [OBJECT_RADIUS, MEAN_RADIUS].contains(&name);
    let estimate = value["value"].as_f64();
    let estimate = estimate.map(|value| number(if is_radius { value.abs() } else { value }));
    let [low, high] = [low, high].map(|end| end.map(number));
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
    let nearest = match (estimate["axis"].is_null(), estimate["radius"].is_null()) {
        (false, _) => "cylinder",
        (true, false) => "sphere",
        (true, true) => "plane",
    };
    Some(match name {
        "none" => format!("no simple shape{percent}, the nearest is a {nearest}"),
        _ => format!("{name}{percent}"),
    })
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
        let of_dish =
            json!({ "value": -39.62, "convex95": null, "concave95": [38.7, 40.54], "unit": "mm" });
        let dish = json!({ "object_radius": of_dish, "object_curvature": { "interval95": [-0.026, -0.025] } });
        let line = "object radius 39.6 mm (95 %: 38.7 to 40.5), concave";
        assert_eq!(summary(&dish), line);
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

//! Statistics and quantities of `cells.csv` in words.

use super::{Meaning, unit};

/// The meaning of a statistic of a quantity whose unit in the table is `quantity_unit`.
pub(crate) fn statistic(name: &str, quantity: &str, quantity_unit: &str) -> Meaning {
    statistic_of(name, &[quantity], quantity_unit)
}

/// The meaning of a statistic of several quantities at once, which are all like the first and in its unit.
pub(crate) fn statistic_of(name: &str, quantities: &[&str], quantity_unit: &str) -> Meaning {
    let first = quantities.first().copied().unwrap_or_default();
    let (share, measured, strain) = (
        first == "class",
        is_measured(first),
        first.ends_with("_strain"),
    );
    let quantity = in_common(quantities);
    let (words, percent, pure) = match name {
        "mean" if share => (quantity, true, true),
        "mean" if measured => (quantity, false, false),
        "truth" => (format!("true {quantity}"), false, false),
        "trials" => ("trials".to_owned(), false, true),
        "failures" => ("failed trials".to_owned(), false, true),
        "mean" => (format!("mean estimate of {quantity}"), false, false),
        "std" => (format!("standard deviation of {quantity}"), false, false),
        "bias" => (format!("bias of {quantity}"), false, false),
        "rms_error" => (format!("rms error of {quantity}"), false, false),
        "mean_abs_error" => (format!("mean |error| of {quantity}"), false, false),
        "relative_rms_error" => (format!("rms relative error of {quantity}"), true, true),
        "relative_mean_abs_error" => (format!("mean |relative error| of {quantity}"), true, true),
        "mean_reported_std" => (format!("mean reported std of {quantity}"), false, false),
        "std_bound" => (
            format!("Cramér–Rao bound on the std of {quantity}"),
            false,
            false,
        ),
        "q50" => (format!("median estimate of {quantity}"), false, false),
        "coverage95" => (
            format!("share of 95 % intervals that hold the true {quantity}"),
            true,
            true,
        ),
        _ => match name.strip_prefix('q').and_then(|p| p.parse::<u8>().ok()) {
            Some(percent) => (
                format!("{percent} % quantile of the estimates of {quantity}"),
                false,
                false,
            ),
            None => (
                format!("{} of {quantity}", name.replace('_', " ")),
                false,
                false,
            ),
        },
    };
    match (percent, pure) {
        (true, _) => in_percent(words),
        (false, true) => Meaning {
            words,
            unit: String::new(),
            factor: 1.0,
        },
        (false, false) if strain => in_percent(words),
        (false, false) => Meaning {
            words,
            unit: unit(quantity_unit),
            factor: 1.0,
        },
    }
}

fn in_percent(words: String) -> Meaning {
    Meaning {
        words,
        unit: "%".to_owned(),
        factor: 100.0,
    }
}

/// The words in which the names of some quantities end: `strain of folding` of the greatest and the rms one.
fn in_common(quantities: &[&str]) -> String {
    let words: Vec<String> = quantities.iter().map(|name| quantity(name)).collect();
    let Some((first, others)) = words.split_first() else {
        return String::new();
    };
    let mut shared = first.as_str();
    while !shared.is_empty() {
        let end = |other: &String| other == shared || other.ends_with(&format!(" {shared}"));
        if others.iter().all(end) {
            return shared.to_owned();
        }
        shared = shared.split_once(' ').map_or("", |(_, rest)| rest);
    }
    "each quantity".to_owned()
}

/// Whether a quantity is found by looking, not by estimating: the mean of its values is not a mean estimate.
fn is_measured(quantity: &str) -> bool {
    matches!(
        quantity,
        "hue_change"
            | "centroid_shift"
            | "marker_area"
            | "greatest_fold_strain"
            | "rms_fold_strain"
            | "markers_tracked"
            | "wrong_matches"
            | "pixels"
    )
}

/// The short name of a statistic, for a legend that already says of what.
pub(crate) fn short_statistic(name: &str) -> String {
    match name {
        "rms_error" => "rms error".to_owned(),
        "mean_abs_error" => "mean |error|".to_owned(),
        "relative_rms_error" => "rms relative error".to_owned(),
        "relative_mean_abs_error" => "mean |relative error|".to_owned(),
        "mean_reported_std" => "mean reported std".to_owned(),
        "truth" => "true value".to_owned(),
        "mean" => "mean estimate".to_owned(),
        "coverage95" => "coverage of 95 % intervals".to_owned(),
        "std" => "standard deviation".to_owned(),
        "q50" => "median estimate".to_owned(),
        "std_bound" => "Cramér–Rao bound".to_owned(),
        other => other.replace('_', " "),
    }
}

/// The words of a quantity.
pub(crate) fn quantity(name: &str) -> String {
    match name {
        "normal_curvature_u" => "normal curvature along u".to_owned(),
        "normal_curvature_v" => "normal curvature along v".to_owned(),
        "gaussian_curvature" => "Gaussian curvature".to_owned(),
        "class" => "share classified correctly".to_owned(),
        "r_squared" => "R² of the fit".to_owned(),
        "marker_area" => "image area of a marker".to_owned(),
        "greatest_fold_strain" => "greatest strain of folding".to_owned(),
        "rms_fold_strain" => "rms strain of folding".to_owned(),
        "pixels" => "pixels evaluated per press".to_owned(),
        other => other.replace('_', " "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_are_words_with_units() {
        assert_eq!(
            statistic("rms_error", "gaussian_curvature", "per_cm2").label(),
            "rms error of Gaussian curvature (1/cm²)"
        );
        assert_eq!(
            statistic("relative_mean_abs_error", "normal_curvature_u", "1/cm").label(),
            "mean |relative error| of normal curvature along u (%)"
        );
        assert_eq!(
            statistic("mean", "class", "").label(),
            "share classified correctly (%)"
        );
        assert_eq!(
            statistic("std_bound", "relative_curvature", "1/mm").label(),
            "Cramér–Rao bound on the std of relative curvature (1/mm)"
        );
        assert_eq!(
            statistic("mean", "r_squared", "1").label(),
            "mean estimate of R² of the fit"
        );
        for (quantity, unit, label) in [
            ("hue_change", "turn", "hue change (turns)"),
            ("centroid_shift", "px", "centroid shift (px)"),
            ("marker_area", "px^2", "image area of a marker (px²)"),
            (
                "greatest_fold_strain",
                "1",
                "greatest strain of folding (%)",
            ),
            ("rms_fold_strain", "1", "rms strain of folding (%)"),
            ("markers_tracked", "1", "markers tracked"),
            ("wrong_matches", "1", "wrong matches"),
            ("pixels", "1", "pixels evaluated per press"),
        ] {
            assert_eq!(statistic("mean", quantity, unit).label(), label);
        }
        for component in ["normal", "tangential"] {
            assert_eq!(
                statistic("rms_error", &format!("{component}_displacement"), "mm").label(),
                format!("rms error of {component} displacement (mm)")
            );
        }
        assert_eq!(
            statistic("mean", "rms_fold_strain", "1").value("0.47"),
            "47 %"
        );
        for (quantities, label) in [
            (
                ["greatest_fold_strain", "rms_fold_strain"],
                "strain of folding (%)",
            ),
            (["hue_change", "marker_area"], "each quantity (%)"),
        ] {
            let unit = if label.starts_with('s') { "1" } else { "%" };
            assert_eq!(statistic_of("mean", &quantities, unit).label(), label);
        }
    }
}

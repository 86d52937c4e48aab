//! Labels of swept fields (words and units), computed from the headers of their columns.

use super::schema::{SCHEMA, fields_at, variants};
use super::{LengthUnit, schema};
use crate::label::{Label, split_unit, spoken_unit};

impl Label {
    /// Label of a swept field, from the header of its column.
    pub fn of_field(header: &str) -> Self {
        let (stem, tail) = field(header);
        let spaced = stem.replace('_', " ");
        let segments: Vec<&str> = spaced
            .strip_prefix("scene.")
            .unwrap_or(&spaced)
            .split('.')
            .collect();
        let leaf = segments.last().copied().unwrap_or_default();
        let gain = "gain error the estimator allows for, std";
        match segments.as_slice() {
            ["noise", channel, "fraction of ifd"] => {
                Self::in_percent(format!("{channel} noise"), "% of the IFD")
            }
            ["noise", "gain", "std"] => Self::in_percent("gain error of a press, std", "%"),
            ["noise", "size", "std"] => Self::in_percent("marker size noise, std", "%"),
            ["noise", "pixel", "std"] => Self::in_unit("pixel noise, std", "levels of 255"),
            ["noise", "hue", "std"] => Self::in_unit("hue noise, std", "turns"),
            ["noise", "centroid", "std"] => Self::in_unit("centroid noise, std", "px"),
            ["estimator", "gain std"] => Self::in_percent(gain, "%"),
            ["estimator", "position fraction of ifd"] => {
                Self::in_percent("position noise that the estimator assumes", "% of the IFD")
            }
            ["sensor", "light at rim"] => Self::in_percent("light at the rim", "% of the middle's"),
            ["sensor", term @ ("k3" | "k5")] => {
                Self::in_unit(format!("odd term {term} of the lens"), "")
            }
            ["motion", "contact deg", "0"] => Self::in_unit("polar angle of the contact", "°"),
            ["motion", "contact deg", _] => Self::in_unit("azimuth of the contact", "°"),
            all if leaf.starts_with("fraction") => Self::in_percent(plain(all), "%"),
            all => Self::in_unit(plain(all), &spoken_unit(tail)),
        }
    }
}

fn plain(segments: &[&str]) -> String {
    match segments {
        ["noise", "wrong markers", "count"] => "wrong markers".to_owned(),
        ["noise", "wrong markers", "std"] => "wrong_markers error, std".to_owned(),
        ["noise", "lost markers", "count"] => "lost markers".to_owned(),
        ["noise", channel, "std"] => format!("{channel} noise, std"),
        ["noise", channel, "fraction" | "bound"] => format!("{channel} noise"),
        ["noise", channel, leaf] if leaf.starts_with("fraction") => {
            format!("{channel} noise, {leaf}")
        }
        ["noise", rest @ ..] => format!("{} noise", rest.join(" ")),
        ["motion", "rate"] => "rolling rate".to_owned(),
        ["motion", "angle"] => "roll angle".to_owned(),
        ["motion", "shift"] => "shift along the skin".to_owned(),
        ["motion", rest @ ..] if !rest.is_empty() => rest.join(" "),
        ["probe", "layout"] => "marker layout".to_owned(),
        ["probe", "layout", leaf @ ("markers" | "gores")] => (*leaf).to_owned(),
        ["probe", "layout", rest @ ..] => format!("marker {}", rest.join(" ")),
        ["probe", "marker depth"] => "marker depth".to_owned(),
        [
            "probe",
            "discs",
            leaf @ ("separation" | "misalignment" | "strain"),
        ] => {
            format!("{leaf} of the two discs")
        }
        ["probe", "discs", "inner"] => "inner discs".to_owned(),
        ["probe", "discs", "yellow strain"] => "strain of the yellow discs".to_owned(),
        ["probe", "discs", leaf] => match leaf.strip_suffix(" diameter") {
            Some(colour) => format!("diameter of the {colour} discs"),
            None => format!("{leaf} of the discs"),
        },
        ["model", "thickness"] => "layer thickness".to_owned(),
        ["model", "poisson"] => "Poisson's ratio".to_owned(),
        ["estimator", "thickness"] => "layer thickness that the estimator assumes".to_owned(),
        ["estimator", "poisson"] => "Poisson's ratio that the estimator assumes".to_owned(),
        ["sensor", "kind"] => "sensor".to_owned(),
        ["sensor", "size"] => "image size".to_owned(),
        ["sensor", "field"] => "half-angle of the field of view".to_owned(),
        ["sensor", "tangential"] => "tangential readings".to_owned(),
        ["sensor", "normal from"] => "normal displacement from".to_owned(),
        ["sensor", "frames"] => "frames averaged".to_owned(),
        ["sensor", leaf @ ("lens" | "blur" | "seam width")] => (*leaf).to_owned(),
        ["sensor", "calibration", leaf] => format!("calibration {leaf}"),
        ["view", "polar"] => "polar angle of the marker".to_owned(),
        [group, "parameters", name] => format!("{group} {name}"),
        all => all.join(" "),
    }
}

/// Splits the header of a swept field's column into the field's name and its unit. The schema of configs states which
/// ending of a header is a unit. If the schema has no field for a header, the ending is compared with a list of units
/// ([`split_unit`]).
///
/// ```
/// use palpate_study::config::field;
///
/// assert_eq!(field("scene.object.c_per_cm"), ("scene.object.c", "per_cm"));
/// assert_eq!(field("scene.motion.rate_rad_per_s"), ("scene.motion.rate", "rad_per_s"));
/// assert_eq!(field("scene.object.parameters.half_s"), ("scene.object.parameters.half_s", ""));
/// assert_eq!(field("weather_cm"), ("weather", "cm"));
/// ```
pub fn field(header: &str) -> (&str, &str) {
    in_schema(header).unwrap_or_else(|| split_unit(header))
}

fn in_schema(header: &str) -> Option<(&str, &str)> {
    let is_column = |stem: &str| {
        LengthUnit::ALL
            .iter()
            .any(|unit| schema::column(&SCHEMA, stem, *unit) == header)
    };
    let keys: Vec<&str> = header.split('.').collect();
    let known = known(&keys);
    let in_key = |unit: &&str| header.ends_with(&format!("_{unit}"));
    let end = match known {
        // The whole header is not a key of a config. It may be a key, followed by a unit of length.
        None => {
            let mut ends = header.match_indices('_').map(|(at, _)| at);
            ends.find(|at| is_column(&header[..*at]))?
        }
        Some(true) => {
            let unit = IN_KEYS.into_iter().find(in_key);
            unit.map_or(header.len(), |unit| header.len() - unit.len() - 1)
        }
        Some(false) => header.len(),
    };
    Some((&header[..end], header.get(end + 1..).unwrap_or_default()))
}

/// Units that may be at the end of a config's key.
const IN_KEYS: [&str; 7] = ["rad_per_s", "deg_per_s", "rad", "deg", "s", "hz", "px"];

/// Whether the schema of configs defines the name of the field with these `keys`. `Some(false)` if the author of the
/// config chose the name, as for a parameter of a formula. `None` if a config cannot have such a field.
fn known(keys: &[&str]) -> Option<bool> {
    if !fields_at(&SCHEMA, keys).is_empty() {
        return Some(true);
    }
    let tables = fields_at(&SCHEMA, &keys[..keys.len() - 1]).into_iter();
    let mut kinds = tables.flat_map(variants);
    let is_free = kinds.any(|kind| kind["additionalProperties"].is_object());
    is_free.then_some(false)
}

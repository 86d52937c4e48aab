//! Columns in the words of a reader: swept fields of a config by their paths, and units.

use crate::config;
use crate::number;

/// Words of a column, its unit as a reader writes it, and the factor from the numbers in the table to those shown (shares
/// are shown in percent).
///
/// ```
/// use palpate_study::Label;
///
/// let noise = Label::of_field("scene.noise.angular_velocity.fraction");
/// assert_eq!(noise.text(), "angular velocity noise (%)");
/// assert_eq!(noise.value("0.05"), "5 %");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// Words without the unit.
    pub words: String,
    /// Unit as a reader writes it; empty for a pure number.
    pub unit: String,
    /// Factor from the numbers in the table to those shown.
    pub factor: f64,
}

impl Label {
    /// Label of numbers that are shown as they are; `unit` as a reader writes it.
    pub fn in_unit(words: impl Into<String>, unit: &str) -> Self {
        Self {
            words: words.into(),
            unit: unit.to_owned(),
            factor: 1.0,
        }
    }

    /// Label of shares; `unit` holds a percent sign and may say of what.
    pub fn in_percent(words: impl Into<String>, unit: &str) -> Self {
        Self {
            words: words.into(),
            unit: unit.to_owned(),
            factor: 100.0,
        }
    }

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
            ["sensor", "light at rim"] => Self::in_percent("light at the rim", "% of the middle's"),
            ["motion", "contact deg", "0"] => Self::in_unit("polar angle of the contact", "°"),
            ["motion", "contact deg", _] => Self::in_unit("azimuth of the contact", "°"),
            all if leaf.starts_with("fraction") => Self::in_percent(plain(all), "%"),
            all => Self::in_unit(plain(all), &spoken_unit(tail)),
        }
    }

    /// Words and unit, as on an axis.
    pub fn text(&self) -> String {
        with_unit(&self.words, &self.unit)
    }

    /// Value of the table as shown, with its unit: `0.05` of a share is `5 %`; text stays as it is.
    pub fn value(&self, text: &str) -> String {
        let bare = self.bare_value(text);
        match self.unit.as_str() {
            _ if number::finite(text).is_none() => bare,
            "" => bare,
            "°" => format!("{bare}°"),
            unit => format!("{bare} {unit}"),
        }
    }

    /// Value of the table as shown, without its unit.
    pub fn bare_value(&self, text: &str) -> String {
        number::finite(text).map_or_else(
            || text.to_owned(),
            |value| number::rounded(value * self.factor),
        )
    }
}

/// Name of a swept field without its unit, and the unit, from the header of its column: as the schema of configs has it,
/// else as the header looks ([`split_unit`]).
pub fn field(header: &str) -> (&str, &str) {
    config::field(header).unwrap_or_else(|| split_unit(header))
}

/// The words of a path that is shown in the unit of its header.
fn plain(segments: &[&str]) -> String {
    match segments {
        ["noise", "wrong markers", "count"] => "wrong markers".to_owned(),
        ["noise", "wrong markers", "std"] => "error of wrong markers, std".to_owned(),
        ["noise", "lost markers", "count"] => "lost markers".to_owned(),
        ["noise", channel, "std"] => format!("{channel} noise, std"),
        ["noise", channel, "fraction" | "bound"] => format!("{channel} noise"),
        ["noise", channel, leaf] if leaf.starts_with("fraction") => {
            format!("{channel} noise, {leaf}")
        }
        ["noise", rest @ ..] => format!("{} noise", rest.join(" ")),
        ["motion", "rate"] => "rolling rate".to_owned(),
        ["motion", "shift"] => "shift along the skin".to_owned(),
        ["motion", rest @ ..] if !rest.is_empty() => rest.join(" "),
        ["probe", "layout"] => "marker layout".to_owned(),
        ["probe", "layout", leaf @ ("markers" | "gores")] => (*leaf).to_owned(),
        ["probe", "layout", rest @ ..] => format!("marker {}", rest.join(" ")),
        ["probe", "marker depth"] => "marker depth".to_owned(),
        ["probe", "discs", leaf @ ("separation" | "misalignment")] => {
            format!("{leaf} of the two discs")
        }
        ["probe", "discs", leaf] => match leaf.strip_suffix(" diameter") {
            Some(colour) => format!("diameter of the {colour} discs"),
            None => format!("{leaf} of the discs"),
        },
        ["model", "thickness"] => "layer thickness".to_owned(),
        ["model", "poisson"] => "Poisson's ratio".to_owned(),
        ["estimator", "thickness"] => "layer thickness of the estimator".to_owned(),
        ["estimator", "poisson"] => "Poisson's ratio of the estimator".to_owned(),
        ["sensor", "kind"] => "sensor".to_owned(),
        ["sensor", "size"] => "image size".to_owned(),
        ["sensor", "field"] => "field of view, from its middle".to_owned(),
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

/// Units a header may end in, alone (`_cm`), squared (`_cm2`), inverse (`_per_cm`) or in a ratio (`_rad_per_s`).
const UNITS: [&str; 9] = ["m", "cm", "mm", "um", "unit", "rad", "deg", "s", "px"];

/// Name and unit of a column, split at the end of its header: `scene.object.radius_cm` is `scene.object.radius` in `cm`,
/// `scene.motion.rate_rad_per_s` is `scene.motion.rate` in `rad_per_s`. A header without a unit keeps its whole name.
pub fn split_unit(header: &str) -> (&str, &str) {
    let leaf = header.rfind('.').map_or(0, |dot| dot + 1);
    let tokens: Vec<&str> = header[leaf..].split('_').collect();
    let is_unit = |token: &str| UNITS.contains(&token.strip_suffix(['2', '3']).unwrap_or(token));
    // The longest unit wins, and a name must be left.
    for length in (1..=3.min(tokens.len() - 1)).rev() {
        let found = match tokens[tokens.len() - length..] {
            [a, "per", b] => is_unit(a) && is_unit(b),
            ["per", b] | [b] => is_unit(b),
            _ => false,
        };
        if found {
            let unit: usize = tokens[tokens.len() - length..]
                .iter()
                .map(|token| token.len() + 1)
                .sum();
            let cut = header.len() - unit;
            return (&header[..cut], &header[cut + 1..]);
        }
    }
    (header, "")
}

/// Text of a unit as a reader writes it: `per_cm2` is `1/cm²`, `rad_per_s` is `rad/s`, `turn` is `turns`. Nothing for a pure
/// number.
pub fn spoken_unit(text: &str) -> String {
    let text = text.trim();
    if text.is_empty() || text == "1" || text == "-" {
        return String::new();
    }
    let text = match text.strip_prefix("per_") {
        Some(rest) => format!("1/{rest}"),
        None => text.replace("_per_", "/"),
    };
    let plural = |part: &str| if part == "turn" { "turns" } else { part }.to_owned();
    let text = text.split('/').map(plural).collect::<Vec<_>>().join("/");
    text.replace("um", "µm")
        .replace("deg", "°")
        .replace("^2", "²")
        .replace('2', "²")
        .replace('3', "³")
}

/// Text of a label with its unit in brackets, if it has one.
pub fn with_unit(label: &str, unit: &str) -> String {
    if unit.is_empty() {
        label.to_owned()
    } else {
        format!("{label} ({unit})")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_come_off_headers() {
        for (stem, unit) in [
            ("scene.object.radius", "cm"),
            ("scene.motion.rate", "rad_per_s"),
            ("scene.motion.duration", "s"),
            ("scene.object.c", "per_cm"),
            ("gaussian_curvature", "per_cm2"),
            ("scene.object.m", "per_cm"),
        ] {
            let header = format!("{stem}_{unit}");
            assert_eq!(split_unit(&header), (stem, unit), "{header}");
        }
        for bare in [
            "scene.noise.angular_velocity.fraction",
            "scene.object.s",
            "a.A",
            "",
        ] {
            assert_eq!(split_unit(bare), (bare, ""));
        }
    }

    #[test]
    fn units_are_as_a_reader_writes_them() {
        for (written, shown) in [
            ("per_cm2", "1/cm²"),
            ("rad_per_s", "rad/s"),
            ("1/mm^2", "1/mm²"),
            ("um", "µm"),
            ("deg", "°"),
            ("turn", "turns"),
            ("turn_per_mm", "turns/mm"),
            ("px^2", "px²"),
            ("1", ""),
        ] {
            assert_eq!(spoken_unit(written), shown);
        }
    }

    #[test]
    fn labels_are_words_with_units() {
        let table = "\
            scene.object.radius_cm: object radius (cm)
            scene.motion.rate_rad_per_s: rolling rate (rad/s)
            scene.motion.arc_length_cm: arc length (cm)
            scene.object.c_per_cm: object c (1/cm)
            scene.noise.angular_velocity.fraction: angular velocity noise (%)
            scene.sensor: sensor
            scene.noise.position.fraction_of_ifd: position noise (% of the IFD)
            scene.noise.normal.std_deg: normal noise, std (°)
            scene.motion.indentation_mm: indentation (mm)
            scene.motion.contact_deg.0: polar angle of the contact (°)
            scene.noise.normal_displacement.std_mm: normal displacement noise, std (mm)
            scene.noise.indentation.std_mm: indentation noise, std (mm)
            scene.noise.gain.std: gain error of a press, std (%)
            scene.noise.wrong_markers.count: wrong markers
            scene.probe.layout: marker layout
            scene.probe.layout.pitch_mm: marker pitch (mm)
            scene.probe.marker_depth_mm: marker depth (mm)
            scene.probe.radius_mm: probe radius (mm)
            scene.model: model
            scene.model.thickness_mm: layer thickness (mm)
            scene.estimator: estimator
            scene.estimator.indentation: estimator indentation
            scene.sensor.frames: frames averaged
            scene.sensor.kind: sensor
            scene.sensor.size_px: image size (px)
            scene.sensor.field_deg: field of view, from its middle (°)
            scene.sensor.lens: lens
            scene.sensor.light_at_rim: light at the rim (% of the middle's)
            scene.sensor.blur_px: blur (px)
            scene.sensor.tangential: tangential readings
            scene.sensor.normal_from: normal displacement from
            scene.probe.discs.magenta_diameter_mm: diameter of the magenta discs (mm)
            scene.probe.discs.yellow_diameter_mm: diameter of the yellow discs (mm)
            scene.probe.discs.separation_mm: separation of the two discs (mm)
            scene.probe.discs.misalignment_mm: misalignment of the two discs (mm)
            scene.probe.layout.gores: gores
            scene.noise.pixel.std: pixel noise, std (levels of 255)
            scene.noise.hue.std: hue noise, std (turns)
            scene.noise.centroid.std: centroid noise, std (px)
            scene.noise.size.std: marker size noise, std (%)
            scene.noise.lost_markers.count: lost markers
            scene.motion.shift_mm: shift along the skin (mm)
            scene.view.polar_deg: polar angle of the marker (°)";
        for row in table.lines() {
            let (header, label) = row.trim().split_once(": ").unwrap();
            assert_eq!(Label::of_field(header).text(), label);
        }
        assert_eq!(
            Label::of_field("scene.noise.angular_velocity.fraction").value("0.07"),
            "7 %"
        );
        assert_eq!(
            Label::of_field("scene.noise.normal.std_deg").value("2.50"),
            "2.5°"
        );
    }
}

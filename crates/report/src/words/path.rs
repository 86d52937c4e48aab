//! The paths of a config's fields in words.

use super::{Meaning, split_unit, unit};

/// The meaning of a swept path from its header.
pub(crate) fn path(header: &str) -> Meaning {
    let (stem, tail) = split_unit(header);
    let spaced = stem.replace('_', " ");
    let segments: Vec<&str> = spaced
        .strip_prefix("scene.")
        .unwrap_or(&spaced)
        .split('.')
        .collect();
    let percent = |words: &str, unit: &str| Meaning {
        words: words.to_owned(),
        unit: unit.to_owned(),
        factor: 100.0,
    };
    let in_unit = |words: &str, unit: &str| Meaning {
        words: words.to_owned(),
        unit: unit.to_owned(),
        factor: 1.0,
    };
    let leaf = segments.last().copied().unwrap_or_default();
    match segments.as_slice() {
        ["noise", channel, "fraction of ifd"] => {
            percent(&format!("{channel} noise"), "% of the IFD")
        }
        ["noise", "gain", "std"] => percent("gain error of a press, std", "%"),
        ["noise", "size", "std"] => percent("marker size noise, std", "%"),
        ["noise", "pixel", "std"] => in_unit("pixel noise, std", "levels of 255"),
        ["noise", "hue", "std"] => in_unit("hue noise, std", "turns"),
        ["noise", "centroid", "std"] => in_unit("centroid noise, std", "px"),
        ["estimator", "gain std"] => percent("gain error the estimator allows for, std", "%"),
        ["sensor", "light at rim"] => percent("light at the rim", "% of the middle's"),
        ["motion", "contact deg", "0"] => in_unit("polar angle of the contact", "°"),
        ["motion", "contact deg", _] => in_unit("azimuth of the contact", "°"),
        all if leaf.starts_with("fraction") => percent(&plain(all), "%"),
        all => in_unit(&plain(all), &unit(tail)),
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_words_with_units() {
        for (header, label) in [
            ("scene.object.radius_cm", "object radius (cm)"),
            ("scene.motion.rate_rad_per_s", "rolling rate (rad/s)"),
            ("scene.motion.arc_length_cm", "arc length (cm)"),
            ("scene.object.c_per_cm", "object c (1/cm)"),
            (
                "scene.noise.angular_velocity.fraction",
                "angular velocity noise (%)",
            ),
            ("scene.sensor", "sensor"),
            (
                "scene.noise.position.fraction_of_ifd",
                "position noise (% of the IFD)",
            ),
            ("scene.noise.normal.std_deg", "normal noise, std (°)"),
            ("scene.motion.indentation_mm", "indentation (mm)"),
            (
                "scene.motion.contact_deg.0",
                "polar angle of the contact (°)",
            ),
            (
                "scene.noise.normal_displacement.std_mm",
                "normal displacement noise, std (mm)",
            ),
            (
                "scene.noise.indentation.std_mm",
                "indentation noise, std (mm)",
            ),
            ("scene.noise.gain.std", "gain error of a press, std (%)"),
            ("scene.noise.wrong_markers.count", "wrong markers"),
            ("scene.probe.layout", "marker layout"),
            ("scene.probe.layout.pitch_mm", "marker pitch (mm)"),
            ("scene.probe.marker_depth_mm", "marker depth (mm)"),
            ("scene.probe.radius_mm", "probe radius (mm)"),
            ("scene.model", "model"),
            ("scene.model.thickness_mm", "layer thickness (mm)"),
            ("scene.estimator", "estimator"),
            ("scene.estimator.indentation", "estimator indentation"),
            ("scene.sensor.frames", "frames averaged"),
            ("scene.sensor.kind", "sensor"),
            ("scene.sensor.size_px", "image size (px)"),
            (
                "scene.sensor.field_deg",
                "field of view, from its middle (°)",
            ),
            ("scene.sensor.lens", "lens"),
            (
                "scene.sensor.light_at_rim",
                "light at the rim (% of the middle's)",
            ),
            ("scene.sensor.blur_px", "blur (px)"),
            ("scene.sensor.tangential", "tangential readings"),
            ("scene.sensor.normal_from", "normal displacement from"),
            (
                "scene.probe.discs.magenta_diameter_mm",
                "diameter of the magenta discs (mm)",
            ),
            (
                "scene.probe.discs.yellow_diameter_mm",
                "diameter of the yellow discs (mm)",
            ),
            (
                "scene.probe.discs.separation_mm",
                "separation of the two discs (mm)",
            ),
            (
                "scene.probe.discs.misalignment_mm",
                "misalignment of the two discs (mm)",
            ),
            ("scene.probe.layout.gores", "gores"),
            ("scene.noise.pixel.std", "pixel noise, std (levels of 255)"),
            ("scene.noise.hue.std", "hue noise, std (turns)"),
            ("scene.noise.centroid.std", "centroid noise, std (px)"),
            ("scene.noise.size.std", "marker size noise, std (%)"),
            ("scene.noise.lost_markers.count", "lost markers"),
            ("scene.motion.shift_mm", "shift along the skin (mm)"),
            ("scene.view.polar_deg", "polar angle of the marker (°)"),
        ] {
            assert_eq!(path(header).label(), label);
        }
        assert_eq!(
            path("scene.noise.angular_velocity.fraction").value("0.07"),
            "7 %"
        );
        assert_eq!(path("scene.noise.normal.std_deg").value("2.50"), "2.5°");
    }
}

//! Fingertips by themselves: strains of folding and areas of markers, in closed form.

use palpate_scene::Scenes;
use std::f64::consts::PI;

use palpate_study::config::parse;

use super::Refused;
use crate::extremes::Precise;
use crate::extremes::{Answer, Case};

const ENTRY: &str = "scene::FingertipScene::trial";

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for gores in [3, 4, 12, 360, 1000] {
        cases.push(Case::value(
            ENTRY,
            format!("{gores} gores: the greatest strain"),
            move || greatest_strain(gores),
        ));
    }
    for unit in [1e-9, 1e-3, 1.0, 1e3, 1e9] {
        cases.push(Case::value(
            ENTRY,
            format!("lengths of {unit:e}: area of a marker on the axis"),
            move || area(unit, "0.1", "0.0"),
        ));
    }
    for diameter in ["1e-6", "0.01", "0.5"] {
        cases.push(Case::value(
            ENTRY,
            format!("discs of {diameter} radii: area of a marker on the axis"),
            move || area(1.0, diameter, "0.0"),
        ));
    }
    for (setting, numbers) in [
        (
            "diameter",
            &[
                "nan", "inf", "0.0", "-0.0", "-1.0", "5e-324", "1e-12", "3.0",
            ][..],
        ),
        ("polar", &["nan", "inf", "-1.0", "89.0", "180.1", "1e308"]),
    ] {
        for number in numbers {
            cases.push(Case::refusal(
                ENTRY,
                format!("{setting} {number}"),
                move || match setting {
                    "diameter" => area(1.0, number, "0.0"),
                    _ => area(1.0, "0.1", number),
                },
            ));
        }
    }
    for radius in ["nan", "inf", "0.0", "-0.0", "-1.0", "1e308"] {
        cases.push(Case::refusal(
            ENTRY,
            format!("a sensor of radius {radius}"),
            move || told(&text(radius, "0.1", GORES, "")),
        ));
    }
    for gores in ["0", "-1", "2", "nan", "4.5", "1e9"] {
        let layout =
            format!("{{ kind = \"gores\", gores = {gores}, rows = [1], row_spacing_deg = 11.9 }}");
        cases.push(Case::refusal(ENTRY, format!("{gores} gores"), move || {
            told(&text("1.0", "0.1", &layout, ""))
        }));
    }
    cases
}

const GORES: &str = "{ kind = \"gores\", gores = 4, rows = [1, 3], row_spacing_deg = 11.9 }";

/// A sensor whose markers lie at a tenth of its radius.
fn text(radius: &str, depth: &str, layout: &str, lines: &str) -> String {
    format!(
        "name = \"a\"\n[scene]\nkind = \"fingertip\"\nprobe = {{ kind = \"marker-sphere\", radius = {radius}, \
         marker_depth = {depth}, layout = {layout}{lines} }}\n"
    )
}

fn told(text: &str) -> Result<Vec<f64>, Refused> {
    let study = parse("study.toml", text);
    let scene = study.and_then(|study| study.estimable_scene(0));
    let scene = scene.map_err(|error| Refused::of(&error))?;
    let mut told = Vec::new();
    let trial = scene.trial(0, |_, outcome| told.push(outcome.estimate));
    trial.map_err(|name| Refused(name.to_owned()))?;
    Ok(told)
}

/// σ − 1 of the shear s = π/n, where σ = s/2 + √(1 + s²/4).
fn greatest_strain(gores: u32) -> Result<Answer, Refused> {
    let layout =
        format!("{{ kind = \"gores\", gores = {gores}, rows = [1], row_spacing_deg = 11.9 }}");
    let told = told(&text("20.0", "2.0", &layout, ""))?;
    let half = Precise::pi() / f64::from(gores) * 0.5;
    let truth = (half.squared() + 1.0).sqrt() + &half - 1.0;
    Ok(Answer::near(told[0], truth.to_f64())
        .within(1e-12)
        .also(told))
}

/// A disc of half-width w at the distance d fills the solid angle `2π (1 − cos atan(w/d))`, which a fisheye enlarges by
/// a sixth of its half-angle squared at most.
fn area(unit: f64, diameter: &str, polar_deg: &str) -> Result<Answer, Refused> {
    let scaled = |number: &str| {
        let parsed = number
            .parse::<f64>()
            .map(|number| format!("{:e}", number * unit));
        parsed.unwrap_or_else(|_| number.to_owned()).to_lowercase()
    };
    let layout = format!("{{ kind = \"lattice\", pitch = {unit:e}, cap_deg = 60.0 }}");
    let wide = scaled(diameter);
    let lines = format!(
        ", discs = {{ magenta_diameter = {wide}, yellow_diameter = {wide}, separation = {:e} }}",
        0.01 * unit
    );
    let [radius, depth] = [unit, 0.1 * unit].map(|length| format!("{length:e}"));
    let probe = text(&radius, &depth, &layout, &lines);
    let camera = "sensor = { lens = \"fisheye\", size_px = 640, field_deg = 65.0 }";
    let told = told(&format!(
        "{probe}{camera}\nview = {{ polar_deg = {polar_deg} }}\n"
    ))?;
    let width = 0.5 * diameter.parse::<f64>().unwrap_or(f64::NAN);
    let px_per_rad = 320.0 / 65f64.to_radians();
    // The magenta disc is half the separation nearer to the camera than the marker.
    let half = (Precise::new(width / 0.895)).atan() * 0.5;
    let truth = (half.sin().squared() * 4.0 * PI).to_f64() * px_per_rad * px_per_rad;
    Ok(Answer::near(told[0], truth)
        .within(1e-9 + width * width / 4.0)
        .also(told))
}

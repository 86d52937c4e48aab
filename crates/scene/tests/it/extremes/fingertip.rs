//! Fingertips by themselves: strains of folding and areas of markers, in closed form.

use std::f64::consts::PI;

use palpate_scene::Scenes;
use palpate_study::config::parse;
use palpate_verdict::{Answer, Precise, rows};

use super::refused::invalid;

const TRIAL: &str = "scene::FingertipScene::trial";
const GORES: &str = "invalid-scene-probe-layout-gores";
const DIAMETER: &str = "invalid-scene-probe-discs-magenta-diameter";
const POLAR: &str = "invalid-scene-view-polar-deg";
const NO_DIAMETERS: [&str; 8] = [
    "nan", "inf", "0.0", "-0.0", "-1.0", "5e-324", "1e-12", "3.0",
];

rows! {
    TRIAL, "{gores} gores: the greatest strain" => greatest_strain(gores), for gores in [3, 4, 12, 360, 1000];
    TRIAL, "lengths of {unit:e}: area of a marker on the axis" => area(unit, "0.1", "0.0"),
        for unit in [1e-9, 1e-3, 1.0, 1e3, 1e9];
    TRIAL, "discs of {diameter} radii: area of a marker on the axis" => area(1.0, diameter, "0.0"),
        for diameter in ["1e-6", "0.01", "0.5"];
    TRIAL, "diameter {number}", DIAMETER => area(1.0, number, "0.0"), for number in NO_DIAMETERS;
    TRIAL, "polar {number}", POLAR => area(1.0, "0.1", number), for number in ["nan", "inf", "-1.0", "180.1", "1e308"];
    TRIAL, "polar 89.0", "out-of-field" => area(1.0, "0.1", "89.0");
    TRIAL, "a sensor of radius {radius}", "invalid-scene-probe-radius" => told(&text(radius, "0.1", &gored("4"), "")),
        for radius in ["nan", "inf", "0.0", "-0.0", "-1.0"];
    TRIAL, "a sensor of radius 1e308", "invalid-scene-probe-layout-radius" =>
        told(&text("1e308", "0.1", &gored("4"), ""));
    TRIAL, "{gores} gores", GORES => told(&text("1.0", "0.1", &gored(gores), "")),
        for gores in ["0", "-1", "2", "nan", "4.5", "1e9"];
}

fn gored(gores: &str) -> String {
    format!("{{ kind = \"gores\", gores = {gores}, rows = [1], row_spacing_deg = 11.9 }}")
}

/// A sensor whose markers lie at a tenth of its radius.
fn text(radius: &str, depth: &str, layout: &str, lines: &str) -> String {
    format!(
        "name = \"a\"\n[scene]\nkind = \"fingertip\"\nprobe = {{ kind = \"marker-sphere\", radius = {radius}, \
         marker_depth = {depth}, layout = {layout}{lines} }}\n"
    )
}

fn told(text: &str) -> Result<Vec<f64>, String> {
    let study = parse("study.toml", text);
    let scene = study.and_then(|study| study.estimable_scene(0));
    let scene = scene.map_err(|error| invalid(&error))?;
    let mut told = Vec::new();
    scene.trial(0, |_, outcome| told.push(outcome.estimate))?;
    Ok(told)
}

/// σ − 1 of the shear s = π/n, where σ = s/2 + √(1 + s²/4).
fn greatest_strain(gores: u32) -> Result<Answer, String> {
    let told = told(&text("20.0", "2.0", &gored(&gores.to_string()), ""))?;
    let half = Precise::pi() / f64::from(gores) * 0.5;
    let truth = (half.squared() + 1.0).sqrt() + &half - 1.0;
    let answer = Answer::near(told[0], truth.to_f64()).within(1e-12);
    Ok(answer.also(told))
}

/// A disc of half-width w at the distance d fills the solid angle `2π (1 − cos atan(w/d))`, which a fisheye enlarges by
/// a sixth of its half-angle squared at most.
fn area(unit: f64, diameter: &str, polar_deg: &str) -> Result<Answer, String> {
    let diameter: f64 = diameter.parse().unwrap();
    let wide = format!("{:e}", diameter * unit).to_lowercase();
    let layout = format!("{{ kind = \"lattice\", pitch = {unit:e}, cap_deg = 60.0 }}");
    let separation = 0.01 * unit;
    let lines = format!(
        ", discs = {{ magenta_diameter = {wide}, yellow_diameter = {wide}, separation = {separation:e} }}"
    );
    let [radius, depth] = [unit, 0.1 * unit].map(|length| format!("{length:e}"));
    let probe = text(&radius, &depth, &layout, &lines);
    let camera = "sensor = { lens = \"fisheye\", size_px = 640, field_deg = 65.0 }";
    let told = told(&format!(
        "{probe}{camera}\nview = {{ polar_deg = {polar_deg} }}\n"
    ))?;
    let width = 0.5 * diameter;
    let px_per_rad = 320.0 / 65f64.to_radians();
    // The magenta disc is half the separation nearer to the camera than the marker.
    let half = Precise::new(width / 0.895).atan() * 0.5;
    let truth = (half.sin().squared() * 4.0 * PI).to_f64() * px_per_rad * px_per_rad;
    let answer = Answer::near(told[0], truth).within(1e-9 + width * width / 4.0);
    Ok(answer.also(told))
}

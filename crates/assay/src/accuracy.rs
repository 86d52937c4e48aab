//! Errors of palpate on fixed scenes with fixed seeds. The references of models are closed-form solutions; the
//! references of estimators are the true values of the scenes. The marker tracker is compared with the true positions
//! of the discs in its frames.
//!
//! `cargo xtask bench-check` compares these errors with `baseline/accuracy.csv`, to detect changes of the code that
//! make results less accurate. If the name of an error ends with a unit, the error has this unit. All other errors are
//! relative.

use anyhow::{Context, Result, ensure};
use palpate_ep2::{Curvature, Method, Penalised, Quadric, TwoPass};
use palpate_press::Body;
use palpate_rolling::HeldAxis;
use palpate_tracking::Finder;

use crate::paraboloid_reference::{self, ParaboloidPress, largest_error};
use crate::workloads::camera_frames::{self, Disc};
use crate::workloads::ep2_contacts;
use crate::workloads::marker_presses::{
    AT, INDENTATION, MarkerReadings, OBJECT, SKIN, fit, markers,
};
use crate::workloads::unit_rolls::{self, Chart, Ep1, Model, paraboloid, roller, sphere};

type Figures = Vec<(String, f64)>;

/// Name and value of every error: of rolls, of estimates from rolls (EP1), of fits to contacts (EP2), of presses, and
/// of markers in frames.
///
/// # Errors
/// An error if a scene cannot be run, or an error is not finite.
pub fn figures() -> Result<Vec<(String, f64)>> {
    let figures = [
        roll_errors()?,
        trial_errors()?,
        ep2_errors()?,
        press_errors()?,
        frame_errors()?,
    ]
    .concat();
    for (name, error) in &figures {
        ensure!(error.is_finite() && *error >= 0.0, "{name}: error {error}");
    }
    Ok(figures)
}

pub(crate) fn rms(errors: impl IntoIterator<Item = f64>) -> f64 {
    let square = |(sum, count): (f64, u32), error: f64| (sum + error * error, count + 1);
    let (sum, count) = errors.into_iter().fold((0.0, 0), square);
    (sum / f64::from(count)).sqrt()
}

/// Errors of simulated rolls relative to closed-form solutions, for each roll model.
fn roll_errors() -> Result<Figures> {
    let charts = Chart::Montana(HeldAxis::Transported);
    let rk4 = |chart| Model::Rk4 { steps: 64, chart };
    let dop853 = |tolerance, chart| Model::Dop853 { tolerance, chart };
    let mut figures = Vec::new();
    for (object, shape, exact, model) in [
        ("sphere", sphere()?, "closed form", Model::ClosedForm),
        ("paraboloid", paraboloid()?, "meridian", Model::Meridian),
    ] {
        for angle_rad in [0.1, 6.0] {
            for (rung, model) in [
                (exact, model),
                ("RK4, 64 steps, chart-free", rk4(Chart::Free)),
                ("RK4, 64 steps, in charts", rk4(charts)),
                ("DOP853, 1e-6, chart-free", dop853(1e-6, Chart::Free)),
                ("DOP853, 1e-6, in charts", dop853(1e-6, charts)),
                ("DOP853, 1e-10, chart-free", dop853(1e-10, Chart::Free)),
                ("DOP853, 1e-10, in charts", dop853(1e-10, charts)),
            ] {
                let error =
                    unit_rolls::error(&roller(shape.clone(), model, angle_rad)?, angle_rad)?;
                let name = format!("roll {angle_rad} rad over a {object}, {rung}");
                figures.push((name, error));
            }
        }
    }
    Ok(figures)
}

/// Errors of the curvatures that are estimated from rolls (EP1), over repeated trials.
fn trial_errors() -> Result<Figures> {
    let mut figures = Vec::new();
    for (sensor, setting) in [("uniform errors", Ep1::UNIFORM), ("pads", Ep1::PADS)] {
        let statistics = Ep1::new(setting)?.statistics(1 << 14)?;
        for (quantity, curvature) in [(0, "normal"), (2, "gaussian")] {
            let summary = statistics.quantities.get(quantity);
            let summary = summary.context("no quantity")?;
            let error = summary.relative_rms_error.context("no error")?;
            figures.push((format!("EP1, {sensor}, {curvature} curvature"), error));
        }
    }
    Ok(figures)
}

/// Errors of the curvatures that are estimated from contact points (EP2).
fn ep2_errors() -> Result<Figures> {
    const MANY: usize = 10_000;
    let methods: [(&str, &dyn Method); 3] = [
        ("quadric", &Quadric::default()),
        ("penalised", &Penalised::default()),
        ("two-pass", &TwoPass::default()),
    ];
    let mut figures = Vec::new();
    for (name, method) in methods {
        let mut found = Vec::new();
        for patch in 0..50 {
            let patch = ep2_contacts::patch(&ep2_contacts::few(patch))?;
            found.extend(method.fit(&patch)?.curvatures(20)?);
        }
        let radius = ep2_contacts::RADIUS;
        let mean = |one: &Curvature| one.mean * radius - 1.0;
        let gaussian = |one: &Curvature| one.gaussian * radius * radius - 1.0;
        let name = |of: &str| format!("EP2, 30 contacts, {name}, {of} curvature");
        figures.push((name("mean"), rms(found.iter().map(mean))));
        figures.push((name("gaussian"), rms(found.iter().map(gaussian))));
    }
    let method = Penalised {
        intervals: Some(6),
        ..Penalised::default()
    };
    let fit = method.fit(&ep2_contacts::patch(&ep2_contacts::many(MANY))?)?;
    let name = format!("EP2, {MANY} contacts, penalised, mean curvature, 1/length");
    figures.push((name, ep2_contacts::error_on_waves(&fit)?));
    Ok(figures)
}

/// Errors of the markers that the tracker finds in two frames. One frame is drawn with discs on a dark background. The
/// other is rendered as the sensor's camera would record it.
fn frame_errors() -> Result<Figures> {
    let (frame, discs) = camera_frames::frame(640);
    let dark = camera_frames::errors(&camera_frames::finder(640).find(&frame)?.markers, &discs);
    let (optics, motions) = (camera_frames::optics(640)?, camera_frames::motions());
    let frame = optics.render(&motions, None)?;
    let discs = optics.project(&motions)?.into_iter().flatten();
    let discs = discs.map(|disc| Disc {
        centroid_px: disc.centroid_px,
        hue_turns: disc.hue_turns,
    });
    let mut finder = Finder::default();
    let rendered = camera_frames::errors(&finder.find(&frame)?.markers, &discs.collect::<Vec<_>>());
    let named = |frame, [px, turns]: [f64; 2]| {
        [
            (format!("find, {frame}, centroid, px"), px),
            (format!("find, {frame}, hue, turns"), turns),
        ]
    };
    Ok([named("dark", dark), named("rendered", rendered)].concat())
}

/// Thickness of the pressed layer, mm.
const THICKNESS: f64 = 5.0;
/// Depth of the markers, mm.
const DEPTH: f64 = 2.0;

/// Errors of a press: errors of the displacements that each contact model computes, and the error of the object's
/// curvature that is fitted to displacements.
fn press_errors() -> Result<Figures> {
    let half_space = Body::half_space(0.5, DEPTH)?;
    let table = Body::bonded_layer(THICKNESS, DEPTH)?;
    let solved = Body::solved_layer(THICKNESS, DEPTH)?;
    let solid = paraboloid_reference::Body::HalfSpace { poisson: 0.5 };
    let layer = paraboloid_reference::Body::Layer {
        thickness: THICKNESS,
    };
    let figures = [
        ("half-space", displacement_error(&half_space, solid)?),
        ("layer from its table", displacement_error(&table, layer)?),
        ("layer, solved", displacement_error(&solved, layer)?),
        (
            "half-space fit, object curvature",
            press_fit_error(half_space)?,
        ),
        ("layer fit, object curvature", press_fit_error(table)?),
    ];
    let name = |(name, error)| (format!("press, {name}"), error);
    Ok(figures.map(name).to_vec())
}

/// Largest error of the displacements that are computed with the soft body `body`, divided by the largest displacement.
/// The reference is a quadrature over wavenumbers.
fn displacement_error(body: &Body, reference: paraboloid_reference::Body) -> Result<f64> {
    let distances: Vec<f64> = (0..77).map(|marker| 0.25 * f64::from(marker)).collect();
    let truth = ParaboloidPress::new(reference, 1.0 / SKIN, INDENTATION)?;
    let truth = truth.displacements(DEPTH, &distances)?;
    let contact = body.press(1.0 / SKIN, INDENTATION)?;
    let found = distances.iter().map(|r| contact.displacement(*r));
    let found: Vec<[f64; 2]> = found.map(|one| [one.normal, one.radial]).collect();
    Ok(largest_error(&found, &truth))
}

/// Rms error of the object's curvature that is fitted to noisy readings. It is divided by the sum of the curvatures of
/// the skin and the object.
fn press_fit_error(body: Body) -> Result<f64> {
    let markers = markers()?;
    let contact = markers.skin().contact(&body, OBJECT, INDENTATION)?;
    let moved = markers.displacements(&contact, AT);
    let fit = fit(body.clone());
    let mut errors = Vec::new();
    for press in 0..20 {
        let readings = MarkerReadings::new(&moved, press);
        let estimate = fit.estimate(&readings.reading(&markers))?;
        errors.push((estimate.object_curvature().value - OBJECT) / (OBJECT + 1.0 / SKIN));
    }
    Ok(rms(errors))
}

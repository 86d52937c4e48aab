//! Tests the claims about presses. The tables are invented: some agree with a claim, and others contradict it.

use crate::fixture::{Cells, Numbers, differs, holds, untestable};
use crate::presses::{OBJECTS, config};
use palpate_report::{Study, score};

// ---- Claim 15: R² of the Gaussian

/// Table with one R² for each layout of the markers. All rows have the number of trials `trials` and the estimator
/// `estimator`.
fn profiles(by_layout: &[(&str, f64)], trials: u64, estimator: &str) -> Cells {
    let mut cells = Cells::new("scene.probe.layout,scene.estimator");
    for (layout, found) in by_layout {
        let numbers = Numbers {
            truth: Some(1.0),
            trials,
            mean: Some(*found),
            ..Numbers::default()
        };
        cells.push_of(
            &format!("{layout},{estimator}"),
            "r_squared,1/mm",
            numbers,
            "",
        );
    }
    cells
}

#[test]
fn claim_15_holds_if_some_weighting_gives_the_published_value() {
    let study = |found: &[(&str, f64)]| {
        profiles(found, 1, "calibrated gaussian").study(&config("[15]", ""))
    };
    holds(
        &study(&[("equal steps", 0.977), ("even over the area", 0.961)]),
        &[
            "0.977 (equal steps, calibrated gaussian), 0.961 (even over the area, calibrated gaussian)",
        ],
    );
    differs(
        &study(&[("equal steps", 0.977), ("even over the area", 0.9717)]),
        &["0.977 (equal steps, calibrated gaussian), 0.972"],
    );
    // If one of two rows with the same layout of markers contradicts the published R², the claim fails.
    differs(
        &study(&[("equal steps", 0.961), ("equal steps", 0.98)]),
        &["0.961 to 0.98 (equal steps, calibrated gaussian)"],
    );
}

#[test]
fn claim_15_needs_a_noiseless_gaussian_on_the_half_space() {
    let found = [("equal steps", 0.96)];
    let missing = |cells: Cells, config: String| {
        untestable(&cells.study(&config), &["r_squared"]);
    };
    missing(profiles(&found, 1, "half-space"), config("[15]", ""));
    missing(profiles(&found, 100, "gaussian"), config("[15]", ""));
    let hertz = config("[15]", "").replace(
        "model = { kind = \"half-space\"",
        "model = { kind = \"hertz\"",
    );
    missing(profiles(&found, 1, "gaussian"), hertz);
}

// ---- Claim 16: convergence of the effective radius

/// A study with all objects, estimators and indentations. `made` returns the median and the scatter of the estimates of
/// the paper's method at an indentation, both relative to the true value; `None` if there are no estimates.
fn radii(made: impl Fn(f64) -> Option<[f64; 2]>) -> Study {
    let mut cells = Cells::new("scene.object,scene.motion.indentation_mm,scene.estimator");
    for (object, _, radius) in OBJECTS {
        for depth in [0.5, 0.75, 1.0, 1.4] {
            for estimator in ["half-space", "gaussian", "calibrated gaussian"] {
                let found = match estimator {
                    "gaussian" => made(depth),
                    _ => Some([1.0, 0.01]),
                };
                let numbers = Numbers {
                    truth: Some(radius),
                    trials: 100,
                    quantiles: found.map(|[median, scatter]| {
                        [median - scatter, median, median + scatter].map(|share| share * radius)
                    }),
                    ..Numbers::default()
                };
                let place = format!("{object},{depth},{estimator}");
                cells.push_of(&place, "effective_radius,1/mm", numbers, "");
            }
        }
    }
    cells.study(&config("[16]", ""))
}

#[test]
fn claim_16_wants_an_end_near_the_truth_and_a_noisy_start() {
    let course = |end: f64, start: [f64; 2], scatter: f64| {
        radii(move |depth| match depth {
            1.4 => Some([end, scatter]),
            1.0 => Some([2.0, 0.0]),
            _ => Some(start),
        })
    };
    holds(
        &course(1.15, [1.2, 0.3], 0.1),
        &["30.7 (for 26.7), 23 (for 20)"],
    );
    differs(&course(1.25, [1.2, 0.3], 0.1), &["off by 25 %"]);
    differs(&course(0.75, [1.2, 0.3], 0.1), &["off by 25 %"]);
    differs(&course(1.15, [1.4, 0.3], 0.1), &["in 0 of 6 cells"]);
    differs(&course(1.15, [1.2, 0.3], 0.25), &["at 1.4 mm it is 25 %"]);
    let study = course(1.15, [1.2, 0.3], 0.1);
    let score = score(&[study]).remove(0);
    assert!(!score.measured.contains("fail"), "{score:?}");
    // Cells (grid points) without an estimate are left out of the claim.
    holds(
        &radii(|depth| (depth > 0.6).then_some(if depth < 1.0 { [1.0, 0.3] } else { [1.0, 0.1] })),
        &["in 3 of 3 cells"],
    );
    untestable(
        &radii(|depth| (depth < 1.4).then_some([1.0, 0.3])),
        &["no median of 26.7 mm at 1.4 mm"],
    );
}

#[test]
fn claim_16_needs_the_papers_objects_estimator_and_unit() {
    let numbers = Numbers {
        truth: Some(20.0),
        trials: 100,
        quantiles: Some([19.0, 20.0, 21.0]),
        ..Numbers::default()
    };
    let mut cells = Cells::new("scene.estimator");
    cells.push_of("gaussian", "effective_radius,1/mm", numbers, "");
    untestable(&cells.study(&config("[16]", "")), &["gaussian with c = 1"]);
    let unnamed = config("[16]", "").replace("length_unit = \"mm\"\n", "");
    untestable(&cells.study(&unnamed), &["must state its `length_unit`"]);
}

// ---- Claim 17: regimes

/// Table of sensors with radii of 5, 10 and 20 mm on a ball, a plane, and dishes with radii of 20 and 10 mm. If the
/// relative curvature is positive, the object touches at a point, and `coverage` computes the coverage of the intervals
/// from this curvature. Otherwise all trials fail, and `failure` returns the kind of failure.
fn regimes(coverage: impl Fn(f64) -> f64, failure: impl Fn(f64) -> &'static str) -> Cells {
    let mut cells = Cells::new("scene.probe.radius_mm,scene.object");
    for radius in [20.0, 10.0, 5.0] {
        for (object, curvature) in [
            ("ball", 0.1),
            ("plane", 0.0),
            ("dish of 20 mm", -0.05),
            ("dish of 10 mm", -0.1),
        ] {
            let relative = 1.0 / radius + curvature;
            let touches = relative > 1e-12;
            let numbers = Numbers {
                // If all trials fail, the table contains no true value. The claim then computes the true value from the
                // config.
                truth: touches.then_some(relative),
                trials: 1000,
                failures: if touches { 0 } else { 1000 },
                coverage: touches.then(|| coverage(relative)),
                ..Numbers::default()
            };
            cells.push_of(
                &format!("{radius},{object}"),
                "relative_curvature,1/mm",
                numbers,
                failure(relative),
            );
        }
    }
    cells
}

fn by_sign(relative: f64) -> &'static str {
    if relative.abs() < 1e-12 {
        "conforming"
    } else {
        "edge-contact"
    }
}

fn of_regimes(cells: &Cells) -> Study {
    let objects = "[{ label = \"ball\", kind = \"sphere\", radius = 10 }, { label = \"plane\", kind = \"plane\" }, \
        { label = \"dish of 20 mm\", kind = \"dish\", radius = 20 }, { label = \"dish of 10 mm\", kind = \"dish\", radius = 10 }]";
    let sweep = format!("[[sweep]]\npath = \"scene.object\"\nvalues = {objects}\n");
    let config = format!(
        "name = \"study\"\nlength_unit = \"mm\"\nclaims = [17]\n[scene]\nkind = \"press\"\n\
         probe = {{ kind = \"marker-sphere\", radius = 20.0 }}\nobject = {{ kind = \"plane\" }}\n{sweep}"
    );
    cells.study(&config)
}

#[test]
fn claim_17_differs_if_a_regime_or_the_trend_is_another() {
    // At the smallest positive relative curvature, the trials succeed, but only half of the intervals contain the true
    // value.
    differs(
        &of_regimes(&regimes(|c| if c < 0.051 { 0.5 } else { 0.94 }, by_sign)),
        &["7 of 9 cells of positive relative curvature are sensed"],
    );
    differs(
        &of_regimes(&regimes(|_| 0.94, |_| "conforming")),
        &["0 of 1 cells of negative relative curvature fail as edge-contact"],
    );
    differs(
        &of_regimes(&regimes(|_| 0.94, |_| "undetermined")),
        &["0 of 2 cells of zero relative curvature fail as conforming"],
    );
}

#[test]
fn claim_17_needs_all_three_signs_and_two_sensors() {
    let of = |places: &[(&str, f64)]| {
        let mut cells = Cells::new("scene.probe.radius_mm,scene.object");
        for (object, truth) in places {
            let numbers = Numbers {
                truth: Some(*truth),
                trials: 10,
                coverage: Some(0.95),
                ..Numbers::default()
            };
            let place = format!("20,{object}");
            cells.push_of(&place, "relative_curvature,1/mm", numbers, "");
        }
        of_regimes(&cells)
    };
    let (ball, wide) = (("ball", 0.15), ("dish of 20 mm", 0.0));
    untestable(&of(&[ball]), &["zero relative curvature"]);
    untestable(&of(&[("plane", 0.0)]), &["positive relative curvature"]);
    let all = of(&[ball, wide, ("dish of 10 mm", -0.05)]);
    untestable(&all, &["steps to a larger sensor"]);
}

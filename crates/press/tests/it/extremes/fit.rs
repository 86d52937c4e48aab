//! From displacements back to the curvature, of readings without error, with much of it, and of few markers.

use palpate_press::{
    Body, ForwardFit, Markers, Measured, PressError, PressEstimate, Prior, Reading, Skin,
    calibrated_c,
};
use palpate_verdict::{Answer, rows};

const ESTIMATE: &str = "press::ForwardFit::estimate";
const CALIBRATED: &str = "press::calibrated_c";
const BOUNDS: &str = "press::ForwardFit::bounds";
/// Relative error that the documentation of `ForwardFit::estimate` allows for readings without noise.
const EXACT: f64 = 1e-9;
/// Makes a body for a sensor of a radius.
type OfRadius = fn(f64) -> Body;
pub(super) const BODIES: [(&str, OfRadius); 3] = [
    ("half-space", half_space),
    ("layer", |radius| {
        Body::bonded_layer(0.3 * radius, 0.1 * radius).unwrap()
    }),
    ("gaussian", |_| Body::gaussian(1.0).unwrap()),
];
/// Units of length: a power of two changes no digit.
const UNITS: [f64; 2] = [1.0, (1 << 20) as f64];
const BAD: [f64; 3] = [f64::NAN, f64::INFINITY, 1e200];
const FLAT: [f64; 6] = [0.0, -0.0, f64::from_bits(1), 1e-300, 1e50, -1e50];

rows! {
    ESTIMATE, "{name}, sensor of radius {radius:e}, readings without error" => exact(body, radius, 0.0, 0.05),
        for radius in [1e-30, 1e-9, 1e-3, 20.0, 1e9, 1e30], for (name, body) in BODIES;
    ESTIMATE, "half-space, object of {object} times the sensor's curvature, no error" =>
        exact(half_space, 20.0, object, 0.01), for object in [-0.5, -0.9, -0.99, 1.0, 5.0, 20.0];
    ESTIMATE, "half-space, indentation {depth:e} of the sensor's radius, no error" =>
        exact(half_space, 20.0, 0.0, depth), for depth in [1e-9, 1e-6, 1e-3, 0.05, 0.3];
    ESTIMATE, "half-space, errors of {noise:e} of the indentation, stated: {stated}: as of one 2^20 times as large" =>
        noisy(noise, stated), for noise in [1e-15, 1e-6, 0.01, 0.1], for stated in [false, true];
    ESTIMATE, "half-space, errors of {noise:e} of the indentation, stated: {stated}, unit {unit}", "no-contact" =>
        noisy_press(noise, stated, unit), for noise in [1.0, 10.0], for stated in [false, true], for unit in UNITS;
    ESTIMATE, "{count} markers in one place", "too-few-markers" => together(count), for count in 0..3;
    ESTIMATE, "{count} markers in one place", "no-contact" => together(count), for count in [3, 4, 1000];
    ESTIMATE, "a reading that is {bad:e}", "not-finite" => read(|index| if index == 3 { bad } else { 0.1 }, None),
        for bad in BAD;
    ESTIMATE, "an indentation whose standard deviation is {bad:e}", "bad-setting" => read(|_| 0.1, known(1.0, bad)),
        for bad in BAD;
    ESTIMATE, "an indentation that is {bad:e}", "out-of-range" => read(|_| 0.1, known(bad, 0.0)),
        for bad in [f64::NAN, f64::INFINITY];
    ESTIMATE, "all readings {value:e}", "no-contact" => read(|_| value, None), for value in FLAT;
    ESTIMATE, "readings {value:e} and their opposites in turn", "no-contact" =>
        read(|index| [value, -value][index % 2], known(1.0, 0.0)), for value in FLAT;
    CALIBRATED, "an indentation that is NaN", "out-of-range" => calibrated(f64::NAN);
    CALIBRATED, "an indentation that is infinite", "too-deep" => calibrated(f64::INFINITY);
    BOUNDS, "noise of {std:e}: in proportion to it" => bounds(std), for std in [1e-9, 1e9, 1e100];
    BOUNDS, "noise of {std:e}: none, as they leave the doubles", "none" => bounds(std),
        for std in [f64::from_bits(1), 1e-300];
}

fn half_space(radius: f64) -> Body {
    Body::half_space(0.5, 0.1 * radius).unwrap()
}

/// A grid of 7 × 7 markers over half the skin's radius.
fn grid(radius: f64) -> Markers {
    let at = |index: usize| 0.5 * radius * (index as f64 - 3.0) / 3.0;
    let places: Vec<_> = (0..49)
        .map(|index| [at(index % 7), at(index / 7)])
        .collect();
    Markers::new(Skin::new(radius).unwrap(), &places).unwrap()
}

const fn known(value: f64, std: f64) -> Option<Measured> {
    Some(Measured { value, std })
}

fn estimate(
    fit: &ForwardFit,
    markers: &Markers,
    normal: &[f64],
    indentation: Option<Measured>,
) -> Result<PressEstimate, PressError> {
    fit.estimate(&Reading {
        markers,
        normal,
        tangential: None,
        indentation,
    })
}

/// Relative curvature and contact of a press whose readings have no error, object and indentation in the sensor's
/// units.
fn exact(body: OfRadius, radius: f64, object: f64, depth: f64) -> Result<Answer, PressError> {
    let (markers, body) = (grid(radius), body(radius));
    let skin = markers.skin();
    let contact = skin.contact(&body, object / radius, depth * radius)?;
    let moved = markers.displacements(&contact, [0.02 * radius, -0.03 * radius]);
    let normal: Vec<f64> = moved.iter().map(|moved| moved.normal).collect();
    let fit = ForwardFit::new(body.clone());
    let found = estimate(&fit, &markers, &normal, known(contact.indentation, 0.0))?;
    let relative = contact.relative_curvature;
    Ok(Answer::near(found.most_likely_curvature, relative)
        .within(EXACT)
        .conditioned(found.relative_curvature.std / relative / f64::EPSILON)
        .also(numbers(&found)))
}

/// What the search for the place ends at may differ by its tolerance.
fn noisy(noise: f64, stated: bool) -> Result<Answer, PressError> {
    let [here, there] = UNITS.map(|unit| noisy_press(noise, stated, unit));
    let (here, there, unit) = (here?, there?, UNITS[1]);
    let pairs = [
        (
            there.most_likely_curvature * unit,
            here.most_likely_curvature,
        ),
        (there.indentation.value / unit, here.indentation.value),
        (there.r_squared, here.r_squared),
    ];
    let answer = Answer::all_near(pairs).within(EXACT);
    Ok(answer.also(numbers(&here)).also(numbers(&there)))
}

/// A sensor whose radius is 20 units, pressed by one. The errors are the same each time.
fn noisy_press(noise: f64, stated: bool, unit: f64) -> Result<PressEstimate, PressError> {
    let (markers, body) = (grid(20.0 * unit), half_space(20.0 * unit));
    let contact = markers.skin().contact(&body, 0.0, unit)?;
    let moved = markers.displacements(&contact, [0.5 * unit, 0.0]);
    let error = |index: usize| noise * unit * libm::sin(12.9898 * (index as f64 + 1.0));
    let errors = (0..49).map(error);
    let normal: Vec<f64> = (moved.iter().zip(errors))
        .map(|(moved, error)| moved.normal + error)
        .collect();
    let fit = ForwardFit {
        normal_std: stated.then_some(noise * unit),
        baseline: Prior::Free,
        ..ForwardFit::new(body.clone())
    };
    estimate(&fit, &markers, &normal, None)
}

fn together(count: usize) -> Result<PressEstimate, PressError> {
    let places = vec![[1.0, 2.0]; count];
    let markers = Markers::new(Skin::new(20.0).unwrap(), &places).unwrap();
    let fit = ForwardFit::new(half_space(20.0));
    estimate(&fit, &markers, &vec![0.4; count], known(1.0, 0.0))
}

fn read(
    normal: impl Fn(usize) -> f64,
    indentation: Option<Measured>,
) -> Result<PressEstimate, PressError> {
    let normal: Vec<f64> = (0..49).map(normal).collect();
    let fit = ForwardFit::new(half_space(20.0));
    estimate(&fit, &grid(20.0), &normal, indentation)
}

fn calibrated(indentation: f64) -> Result<f64, PressError> {
    calibrated_c(&grid(20.0), &Body::hertz(0.5).unwrap(), indentation, None)
}

/// Bounds grow with the noise.
fn bounds(std: f64) -> Option<Answer> {
    let (markers, body) = (grid(20.0), half_space(20.0));
    let contact = markers.skin().contact(&body, 0.0, 1.0).unwrap();
    let bounds_of = |std| {
        let fit = ForwardFit {
            normal_std: Some(std),
            ..ForwardFit::new(body.clone())
        };
        let found = fit.bounds(&markers, &contact, [0.0; 2], false, None)?;
        Some([
            found.relative_curvature,
            found.indentation,
            found.contact_radius,
        ])
    };
    let found = bounds_of(std)?.map(|bound| bound / std);
    Some(Answer::all_near(found.into_iter().zip(bounds_of(1.0).unwrap())).within(EXACT))
}

pub(super) fn numbers(found: &PressEstimate) -> Vec<f64> {
    let estimates = [
        found.relative_curvature,
        found.object_curvature(),
        found.effective_radius(),
        found.indentation,
        found.contact_radius,
    ];
    let spans = estimates.iter().flat_map(|found| {
        let ends = [found.interval.low, found.interval.high];
        [found.value, found.std]
            .into_iter()
            .chain(ends.into_iter().flatten())
    });
    [
        found.most_likely_curvature,
        found.most_likely_object_curvature(),
        found.r_squared,
        found.reduced_chi_squared,
        found.normal_std,
    ]
    .into_iter()
    .chain(spans)
    .chain(found.contact)
    .chain(found.contact_std)
    .collect()
}

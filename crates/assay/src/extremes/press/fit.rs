//! From displacements back to the curvature, of readings without error, with much of it, and of few markers.

use palpate_press::{
    Body, ForwardFit, MarkerDisplacement, Markers, Measured, PressError, PressEstimate, Prior,
    Reading, Skin, calibrated_c,
};

use crate::extremes::{Answer, Case};

/// Relative error that the documentation of `ForwardFit::estimate` allows for readings without noise.
const EXACT: f64 = 1e-9;

/// A grid of 7 × 7 markers over a share of the skin, in radii.
fn grid(radius: f64, share: f64) -> Result<Markers, PressError> {
    let at = |index: usize| share * radius * (index as f64 - 3.0) / 3.0;
    let places: Vec<[f64; 2]> = (0..49)
        .map(|index| [at(index % 7), at(index / 7)])
        .collect();
    Markers::new(Skin::new(radius)?, &places)
}

/// Numbers in [-1, 1], the same each time.
fn shaken(index: usize) -> f64 {
    libm::sin(12.9898 * (index as f64 + 1.0))
}

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for radius in [1e-30, 1e-9, 1e-3, 20.0, 1e9, 1e30] {
        for body in ["half-space", "layer", "gaussian"] {
            cases.push(Case::value(
                "press::ForwardFit::estimate",
                format!("{body}, sensor of radius {radius:e}, readings without error"),
                move || exact(body, radius, 0.0, 0.05),
            ));
        }
    }
    for object in [-0.5, -0.9, -0.99, 1.0, 5.0, 20.0] {
        cases.push(Case::new(
            "press::ForwardFit::estimate",
            format!("half-space, object of {object} times the sensor's curvature, no error"),
            move || exact("half-space", 20.0, object, 0.01).into(),
        ));
    }
    for indentation in [1e-9, 1e-6, 1e-3, 0.05, 0.3] {
        cases.push(Case::new(
            "press::ForwardFit::estimate",
            format!("half-space, indentation {indentation:e} of the sensor's radius, no error"),
            move || exact("half-space", 20.0, 0.0, indentation).into(),
        ));
    }
    for noise in [1e-15, 1e-6, 0.01, 0.1, 1.0, 10.0] {
        for stated in [false, true] {
            cases.push(Case::new(
                "press::ForwardFit::estimate",
                format!(
                    "half-space, errors of {noise:e} of the indentation, stated: {stated}: as of one 2^20 times as large"
                ),
                move || noisy(noise, stated).into(),
            ));
        }
    }
    for count in [0, 1, 2, 3, 4, 1000] {
        cases.push(Case::new(
            "press::ForwardFit::estimate",
            format!("{count} markers in one place; finite"),
            move || together(count).into(),
        ));
    }
    for (name, value) in [
        ("NaN", f64::NAN),
        ("infinite", f64::INFINITY),
        ("1e200", 1e200),
    ] {
        cases.push(Case::refusal(
            "press::ForwardFit::estimate",
            format!("a reading that is {name}"),
            move || read(|index| if index == 3 { value } else { 0.1 }, None),
        ));
        cases.push(Case::refusal(
            "press::ForwardFit::estimate",
            format!("an indentation whose standard deviation is {name}"),
            move || {
                read(
                    |_| 0.1,
                    Some(Measured {
                        value: 1.0,
                        std: value,
                    }),
                )
            },
        ));
        if value.is_nan() || value.is_infinite() {
            cases.push(Case::refusal(
                "press::ForwardFit::estimate",
                format!("an indentation that is {name}"),
                move || read(|_| 0.1, Some(Measured { value, std: 0.0 })),
            ));
            cases.push(Case::refusal(
                "press::calibrated_c",
                format!("an indentation that is {name}"),
                move || calibrated_c(&grid(20.0, 0.5)?, &Body::hertz(0.5)?, value, None),
            ));
        }
    }
    for value in [0.0, -0.0, f64::from_bits(1), 1e-300, 1e50, -1e50] {
        cases.push(Case::new(
            "press::ForwardFit::estimate",
            format!("all readings {value:e}; finite"),
            move || {
                let found = read(|_| value, None);
                found.map(|found| Answer::finite(numbers(&found))).into()
            },
        ));
        cases.push(Case::new(
            "press::ForwardFit::estimate",
            format!("readings {value:e} and their opposites in turn; finite"),
            move || {
                let sign = |index: usize| {
                    if index.is_multiple_of(2) {
                        value
                    } else {
                        -value
                    }
                };
                let found = read(
                    sign,
                    Some(Measured {
                        value: 1.0,
                        std: 0.0,
                    }),
                );
                found.map(|found| Answer::finite(numbers(&found))).into()
            },
        ));
    }
    for std in [f64::from_bits(1), 1e-300, 1e-9, 1e9, 1e100] {
        cases.push(Case::new(
            "press::ForwardFit::bounds",
            format!("noise of {std:e}; finite"),
            move || bounds(std).into(),
        ));
    }
    cases
}

fn body(name: &str, radius: f64) -> Result<Body, PressError> {
    match name {
        "half-space" => Body::half_space(0.5, 0.1 * radius),
        "layer" => Body::bonded_layer(0.3 * radius, 0.1 * radius),
        _ => Body::gaussian(1.0),
    }
}

/// Relative curvature and contact of a press whose readings have no error, object and indentation in the sensor's
/// units.
fn exact(name: &str, radius: f64, object: f64, indentation: f64) -> Result<Answer, PressError> {
    let markers = grid(radius, 0.5)?;
    let body = body(name, radius)?;
    let contact = markers
        .skin()
        .contact(&body, object / radius, indentation * radius)?;
    let at = [0.02 * radius, -0.03 * radius];
    let moved = markers.displacements(&contact, at);
    let found = ForwardFit::new(body.clone()).estimate(&Reading {
        markers: &markers,
        normal: &normal(&moved),
        tangential: None,
        indentation: Some(Measured {
            value: contact.indentation,
            std: 0.0,
        }),
    })?;
    let relative = contact.relative_curvature;
    Ok(Answer::near(found.most_likely_curvature, relative)
        .within(EXACT)
        .conditioned(found.relative_curvature.std / relative / f64::EPSILON)
        .also(numbers(&found)))
}

fn normal(moved: &[MarkerDisplacement]) -> Vec<f64> {
    moved.iter().map(|moved| moved.normal).collect()
}

/// A power of two as a unit of length changes no digit; what the search for the place ends at may differ by its
/// tolerance.
fn noisy(noise: f64, stated: bool) -> Result<Answer, PressError> {
    let unit = 2f64.powi(20);
    let [here, there] = [1.0, unit].map(|unit| noisy_press(noise, stated, unit));
    let (here, there) = (here?, there?);
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

/// A sensor whose radius is 20 units, pressed by one.
fn noisy_press(noise: f64, stated: bool, unit: f64) -> Result<PressEstimate, PressError> {
    let (radius, noise) = (20.0 * unit, noise * unit);
    let markers = grid(radius, 0.5)?;
    let body = body("half-space", radius)?;
    let contact = markers.skin().contact(&body, 0.0, unit)?;
    let moved = markers.displacements(&contact, [0.5 * unit, 0.0]);
    let read = |(index, moved): (usize, &MarkerDisplacement)| moved.normal + noise * shaken(index);
    let normal: Vec<f64> = moved.iter().enumerate().map(read).collect();
    let fit = ForwardFit {
        normal_std: stated.then_some(noise),
        baseline: Prior::Free,
        ..ForwardFit::new(body)
    };
    fit.estimate(&Reading {
        markers: &markers,
        normal: &normal,
        tangential: None,
        indentation: None,
    })
}

fn together(count: usize) -> Result<Answer, PressError> {
    let markers = Markers::new(Skin::new(20.0)?, &vec![[1.0, 2.0]; count])?;
    let found = ForwardFit::new(body("half-space", 20.0)?).estimate(&Reading {
        markers: &markers,
        normal: &vec![0.4; count],
        tangential: None,
        indentation: Some(Measured {
            value: 1.0,
            std: 0.0,
        }),
    })?;
    Ok(Answer::finite(numbers(&found)))
}

fn read(
    normal: impl Fn(usize) -> f64,
    indentation: Option<Measured>,
) -> Result<PressEstimate, PressError> {
    let markers = grid(20.0, 0.5)?;
    let normal: Vec<f64> = (0..49).map(normal).collect();
    ForwardFit::new(body("half-space", 20.0)?).estimate(&Reading {
        markers: &markers,
        normal: &normal,
        tangential: None,
        indentation,
    })
}

/// Bounds grow with the noise; where they leave the doubles there are none.
fn bounds(std: f64) -> Result<Answer, PressError> {
    let markers = grid(20.0, 0.5)?;
    let body = body("half-space", 20.0)?;
    let contact = markers.skin().contact(&body, 0.0, 1.0)?;
    let bounds_of = |std| {
        let fit = ForwardFit {
            normal_std: Some(std),
            ..ForwardFit::new(body.clone())
        };
        fit.bounds(&markers, &contact, [0.0; 2], false, None)
    };
    let (Some(found), Some(of_one)) = (bounds_of(std), bounds_of(1.0)) else {
        return Err(PressError::OutOfRange);
    };
    Ok(Answer::all_near([
        (found.relative_curvature / std, of_one.relative_curvature),
        (found.indentation / std, of_one.indentation),
        (found.contact_radius / std, of_one.contact_radius),
    ])
    .within(1e-9))
}

fn numbers(found: &PressEstimate) -> Vec<f64> {
    let mut numbers = vec![
        found.most_likely_curvature,
        found.most_likely_object_curvature(),
        found.r_squared,
        found.reduced_chi_squared,
        found.normal_std,
    ];
    for estimated in [
        found.relative_curvature,
        found.object_curvature(),
        found.effective_radius(),
        found.indentation,
        found.contact_radius,
    ] {
        numbers.extend([estimated.value, estimated.std]);
        numbers.extend(
            [estimated.interval.low, estimated.interval.high]
                .into_iter()
                .flatten(),
        );
    }
    numbers.extend(found.contact);
    numbers.extend(found.contact_std);
    numbers
}

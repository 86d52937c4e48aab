//! Sensors that cannot be.

use std::f64::consts::FRAC_PI_2;

use palpate_sensing::{
    AngularVelocityError, Distribution, Encoder, GaussianError, InvalidSensor, NormalError,
    PadLayout, PadOffset, Pads, PositionAxes, PositionError, UniformLattice, Wrist,
};

use super::super::Case;

type Maker = fn(f64) -> Result<(), InvalidSensor>;

/// No sizes of errors.
const NO_SIZES: [f64; 5] = [f64::NAN, f64::INFINITY, -1.0, f64::NEG_INFINITY, f64::MAX];
/// No lengths and angles of which something else is a part.
const NO_PARTS: [f64; 5] = [f64::NAN, f64::INFINITY, -1.0, 0.0, -0.0];

const SIZES: [(&str, Maker); 5] = [
    ("sensing::AngularVelocityError::new", |bad| {
        AngularVelocityError::new(Distribution::Gaussian, bad).map(|_| ())
    }),
    ("sensing::GaussianError::new", |bad| {
        GaussianError::new(bad).map(|_| ())
    }),
    ("sensing::PositionError::new", |bad| {
        PositionError::new(Distribution::Uniform, bad, PositionAxes::Xyz).map(|_| ())
    }),
    ("sensing::NormalError::new", |bad| {
        NormalError::new(bad).map(|_| ())
    }),
    ("sensing::Wrist::new, std", |bad| {
        Wrist::new(bad, 1.0).map(|_| ())
    }),
];

const PARTS: [(&str, Maker); 6] = [
    ("sensing::Encoder::new", |bad| Encoder::new(bad).map(|_| ())),
    ("sensing::Wrist::new, radius", |bad| {
        Wrist::new(1.0, bad).map(|_| ())
    }),
    ("sensing::UniformLattice::with_pitch", |bad| {
        UniformLattice::with_pitch(bad).map(|_| ())
    }),
    ("sensing::Pads::new, radius", |bad| {
        pads(bad, 0.1, FRAC_PI_2)
    }),
    ("sensing::Pads::new, pitch", |bad| pads(1.0, bad, FRAC_PI_2)),
    ("sensing::Pads::new, cap", |bad| pads(1.0, 0.1, bad)),
];

pub(super) fn cases() -> Vec<Case> {
    let sizes = SIZES
        .into_iter()
        .map(|(entry, make)| (entry, make, NO_SIZES));
    let parts = PARTS
        .into_iter()
        .map(|(entry, make)| (entry, make, NO_PARTS));
    let mut cases: Vec<Case> = sizes
        .chain(parts)
        .flat_map(|(entry, make, numbers)| numbers.map(|bad| (entry, make, bad)))
        .map(|(entry, make, bad)| Case::refusal(entry, format!("{bad:e}"), move || make(bad)))
        .collect();
    for (input, make) in [
        ("pitch 1e-16 of the radius", pads(1.0, 1e-16, 1.0)),
        ("pitch above the radius", pads(1.0, 1.0f64.next_up(), 1.0)),
        ("a subnormal pitch", pads(1.0, f64::from_bits(1), 1.0)),
        ("a cap beyond a half turn", pads(1.0, 0.1, 3.15)),
    ] {
        cases.push(Case::refusal("sensing::Pads::new", input, move || make));
    }
    for pitch in [1e-8, 3.0, 1e300, f64::from_bits(1)] {
        cases.push(Case::refusal(
            "sensing::UniformLattice::with_pitch",
            format!("{pitch:e}"),
            move || UniformLattice::with_pitch(pitch),
        ));
    }
    cases
}

/// Construction of pads in either layout; fails only where both layouts refuse.
fn pads(radius: f64, pitch: f64, cap_rad: f64) -> Result<(), InvalidSensor> {
    let made = |layout| Pads::new(radius, pitch, layout, PadOffset::Random, cap_rad).map(|_| ());
    made(PadLayout::Square).or(made(PadLayout::Uniform))
}

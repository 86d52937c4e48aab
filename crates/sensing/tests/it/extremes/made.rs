//! Sensors that cannot be.

use std::f64::consts::FRAC_PI_2;

use palpate_sensing::{
    AngularVelocityError, Distribution, Encoder, GaussianError, InvalidSensor, NormalError,
    PadLayout, PadOffset, Pads, PositionAxes, PositionError, UniformLattice, Wrist,
};
use palpate_verdict::rows;

const REFUSED: &str = "invalid-sensor";
const LAYOUTS: [PadLayout; 2] = [PadLayout::Square, PadLayout::Uniform];
/// No sizes of errors.
const NO_SIZES: [f64; 5] = [f64::NAN, f64::INFINITY, -1.0, f64::NEG_INFINITY, f64::MAX];
/// No lengths and angles of which something else is a part.
const NO_PARTS: [f64; 5] = [f64::NAN, f64::INFINITY, -1.0, 0.0, -0.0];
/// Pitches and caps, in radii and rad, that make no pads on a sphere of radius 1.
const NO_PADS: [(&str, f64, f64); 5] = [
    ("pitch 1e-16 of the radius", 1e-16, 1.0),
    ("pitch above the radius", 1.0 + f64::EPSILON, 1.0),
    ("pitch 11 times the radius", 11.0, 1.0),
    ("a subnormal pitch", f64::from_bits(1), 1.0),
    ("a cap beyond a half turn", 0.1, 3.15),
];

rows! {
    "sensing::AngularVelocityError::new", "{bad:e}", REFUSED => AngularVelocityError::new(Distribution::Gaussian, bad),
        for bad in NO_SIZES;
    "sensing::GaussianError::new", "{bad:e}", REFUSED => GaussianError::new(bad), for bad in NO_SIZES;
    "sensing::PositionError::new", "{bad:e}", REFUSED =>
        PositionError::new(Distribution::Uniform, bad, PositionAxes::Xyz), for bad in NO_SIZES;
    "sensing::NormalError::new", "{bad:e}", REFUSED => NormalError::new(bad), for bad in NO_SIZES;
    "sensing::Wrist::new, std", "{bad:e}", REFUSED => Wrist::new(bad, 1.0), for bad in NO_SIZES;
    "sensing::Wrist::new, radius", "{bad:e}", REFUSED => Wrist::new(1.0, bad), for bad in NO_PARTS;
    "sensing::Encoder::new", "{bad:e}", REFUSED => Encoder::new(bad), for bad in NO_PARTS;
    "sensing::UniformLattice::with_pitch", "{bad:e}", REFUSED => UniformLattice::with_pitch(bad), for bad in NO_PARTS;
    "sensing::UniformLattice::with_pitch", "{pitch:e}", REFUSED => UniformLattice::with_pitch(pitch),
        for pitch in [1e-9, 1e-8, 3.0, 10.0, 1e300, f64::from_bits(1)];
    "sensing::Pads::new, radius", "{bad:e}, {layout:?}", REFUSED => pads(layout, bad, 0.1, FRAC_PI_2),
        for bad in NO_PARTS, for layout in LAYOUTS;
    "sensing::Pads::new, pitch", "{bad:e}, {layout:?}", REFUSED => pads(layout, 1.0, bad, FRAC_PI_2),
        for bad in NO_PARTS, for layout in LAYOUTS;
    "sensing::Pads::new, cap", "{bad:e}, {layout:?}", REFUSED => pads(layout, 1.0, 0.1, bad),
        for bad in NO_PARTS, for layout in LAYOUTS;
    "sensing::Pads::new", "{input}, {layout:?}", REFUSED => pads(layout, 1.0, pitch, cap),
        for (input, pitch, cap) in NO_PADS, for layout in LAYOUTS;
}

fn pads(layout: PadLayout, radius: f64, pitch: f64, cap_rad: f64) -> Result<Pads, InvalidSensor> {
    Pads::new(radius, pitch, layout, PadOffset::Random, cap_rad)
}

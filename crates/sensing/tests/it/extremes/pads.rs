//! Pads from a millionth of the probe to the whole probe, and the maps of the sphere.

use std::f64::consts::PI;

use nalgebra::{Vector2, Vector3};
use palpate_sensing::{
    BeyondPads, Channel, PadLayout, PadOffset, PadPlacement, Pads, Stream, UniformLattice,
    direction_at, displacement_between,
};
use palpate_verdict::{Answer, NOT_FINITE, Precise, decades, extreme_pairs, rows};

const READ: &str = "sensing::Pads::read";
/// Least error of a reading between the centres of pads, in pitches; a smaller one could not be chance.
const LEAST_OFF: f64 = 1e-3;
const LAYOUTS: [PadLayout; 2] = [PadLayout::Square, PadLayout::Uniform];
/// Pads on a sphere of radius 1, each with the largest error of a reading, in pitches.
const OFF: [(PadLayout, PadOffset, f64); 3] = [
    (PadLayout::Square, PadOffset::Random, 1.0),
    (PadLayout::Uniform, PadOffset::Centred, 1.05),
    (PadLayout::Uniform, PadOffset::Random, 2.1),
];

rows! {
    READ, "square, centred, radius {radius:e}, pitch {pitch:e} of it: in pitches" =>
        read(radius, pitch, PadLayout::Square, PadOffset::Centred, 0.5),
        for pitch in decades(-6, 0, 1), for radius in [1e-9, 1.0, 1e9];
    READ, "{layout:?}, {offset:?}, pitch {pitch:e} of the radius: in pitches" =>
        read(1.0, pitch, layout, offset, bound), for pitch in decades(-6, 0, 1), for (layout, offset, bound) in OFF;
    READ, "{layout:?}, displacement {bad:e}", "beyond-pads" => at(layout, bad, 0.1),
        for layout in LAYOUTS, for bad in NOT_FINITE;
    READ, "{layout:?}, 1e-15 beyond a cap of 1 rad", "beyond-pads" => at(layout, 1.0 + 1e-15, 0.0),
        for layout in LAYOUTS;
    READ, "{layout:?}, 256 extreme displacements: finite" => extremely_far(layout), for layout in LAYOUTS;
    "sensing::UniformLattice::nearest", "pitch {pitch:e}: every pad is nearest to itself" => nearest(pitch),
        for pitch in decades(-6, 0, 1);
    "sensing::direction_at", "{angle:e} rad" => direction(angle),
        for angle in [1e-300, 1e-150, 1e-12, 1e-6, 0.1, 3.0, PI - 1e-6, PI, 1e6, 1e150];
    "sensing::displacement_between", "{angle:e} rad" => displacement(angle),
        for angle in [1e-300, 1e-150, 1e-12, 1e-6, 0.1, 3.0, PI - 1e-6];
}

/// Pads of that pitch around the middle of a sphere, and where they lie in some trial.
fn placed(radius: f64, pitch: f64, layout: PadLayout, offset: PadOffset) -> (Pads, PadPlacement) {
    let pads = Pads::new(radius, pitch * radius, layout, offset, 1.0).unwrap();
    let placement = pads.place(&mut Stream::new(3, 5, Channel::PadOffset));
    (pads, placement)
}

fn at(layout: PadLayout, x: f64, y: f64) -> Result<Vector2<f64>, BeyondPads> {
    let (pads, placement) = placed(1.0, 0.01, layout, PadOffset::Random);
    pads.read(&placement, &Vector2::new(x, y))
}

fn extremely_far(layout: PadLayout) -> Result<Answer, String> {
    let reads = extreme_pairs().map(|(x, y)| at(layout, x, y).map(|read| [read.x, read.y]));
    Answer::counted(reads, 61, &["beyond-pads"])
}

/// Error of a reading in pitches, which must be at most `bound` and not 0. The contact is half a radian away, along
/// neither axis, and no whole number of pitches away.
fn read(
    radius: f64,
    pitch: f64,
    layout: PadLayout,
    offset: PadOffset,
    bound: f64,
) -> Result<Answer, BeyondPads> {
    let (pads, placement) = placed(radius, pitch, layout, offset);
    let displacement = Vector2::new(0.1 * PI, -0.1 * 17f64.sqrt()) * radius;
    let read = pads.read(&placement, &displacement)?;
    let errors = match layout {
        PadLayout::Square => (read - displacement).amax(),
        PadLayout::Uniform => {
            let angle = displacement.norm() / radius;
            (read - displacement).norm() * libm::sin(angle) / angle
        }
    };
    let answer = Answer::at_scale(errors, 0.0, pitch * radius).within(bound);
    Ok(answer.at_least(LEAST_OFF).also([read.x, read.y]))
}

fn nearest(pitch: f64) -> Answer {
    let lattice = UniformLattice::with_pitch(pitch).unwrap();
    let last = lattice.pads() - 1;
    let asked = [0.0, 0.1, 0.25, 0.5, 0.7, 1.0].map(|share| (share * last as f64) as u64);
    let found = asked.map(|pad| lattice.nearest(&lattice.direction(pad.min(last))));
    let pairs = found.into_iter().zip(asked);
    Answer::all_at_scale(pairs.map(|(found, pad)| (found as f64, pad as f64)), 1.0)
}

/// Direction after a turn by `angle` along d, which is `(sin a · d, cos a)`. Where the angle is so large that its
/// double leaves no digit of the turn, only the ratio of x to y and the length of 1 are judged.
fn direction(angle: f64) -> Answer {
    let (x, y) = (0.6 * angle, 0.8 * angle);
    if angle * f64::EPSILON > 1.0 {
        let found = direction_at(&Vector2::new(x, y));
        let pairs = [(found.norm(), 1.0), (found.x / found.y, x / y)];
        return Answer::all_near(pairs).within(1e-15);
    }
    let length = (Precise::new(x).squared() + Precise::new(y).squared()).sqrt();
    let sine = length.sin();
    let found = direction_at(&Vector2::new(x, y));
    let pairs = [
        (found.x, (&sine * x / &length).to_f64()),
        (found.y, (&sine * y / &length).to_f64()),
        (found.z, length.cos().to_f64()),
    ];
    let answer = Answer::all_at_scale(pairs, 1.0).within(1e-15);
    answer.conditioned(angle.max(1.0))
}

fn displacement(angle: f64) -> Answer {
    let sine = (Precise::new(angle)).sin().to_f64();
    let to = Vector3::new(0.6 * sine, 0.8 * sine, libm::cos(angle));
    let found = displacement_between(&Vector3::z(), &to);
    let pairs = [(found.x, 0.6 * angle), (found.y, 0.8 * angle)];
    // The nearer to the opposite side, the less a direction tells the azimuth.
    let answer = Answer::all_at_scale(pairs, angle.max(1e-150)).within(1e-15);
    answer.conditioned((angle / sine).max(1.0))
}

//! Pads from a millionth of the probe to the whole probe, and the maps of the sphere.

use std::f64::consts::PI;

use nalgebra::{Vector2, Vector3};
use palpate_sensing::{
    BeyondPads, Channel, PadLayout, PadOffset, Pads, Stream, UniformLattice, direction_at,
    displacement_between,
};

use super::super::Precise;
use super::super::hostile::{EXTREME, NOT_FINITE};
use super::super::{Answer, Case, Outcome};

/// Least error of a reading between the centres of pads, in pitches; a smaller one could not be chance.
const LEAST_OFF: f64 = 1e-3;
const MADE: &str = "a pitch between 1e-6 and 1 of the radius";

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for exponent in [-6, -5, -4, -3, -2, -1, 0] {
        let pitch = 10f64.powi(exponent);
        for radius in [1e-9, 1.0, 1e9] {
            let input =
                format!("square, centred, radius {radius:e}, pitch {pitch:e} of it: in pitches");
            cases.push(Case::value("sensing::Pads::read", input, move || {
                read(radius, pitch, PadLayout::Square, PadOffset::Centred, 0.5)
            }));
        }
        for (layout, offset, bound) in [
            (PadLayout::Square, PadOffset::Random, 1.0),
            (PadLayout::Uniform, PadOffset::Centred, 1.05),
            (PadLayout::Uniform, PadOffset::Random, 2.1),
        ] {
            let input =
                format!("{layout:?}, {offset:?}, pitch {pitch:e} of the radius: in pitches");
            cases.push(Case::value("sensing::Pads::read", input, move || {
                read(1.0, pitch, layout, offset, bound)
            }));
        }
        let input = format!("pitch {pitch:e}: every pad is nearest to itself");
        cases.push(Case::new(
            "sensing::UniformLattice::nearest",
            input,
            move || nearest(pitch),
        ));
    }
    for (layout, bad) in [PadLayout::Square, PadLayout::Uniform]
        .into_iter()
        .flat_map(|layout| NOT_FINITE.map(|bad| (layout, bad)))
    {
        let input = format!("{layout:?}, displacement {bad:e}");
        cases.push(Case::refusal("sensing::Pads::read", input, move || {
            at(layout, Vector2::new(bad, 0.1)).or(sensed(layout, bad))
        }));
    }
    for layout in [PadLayout::Square, PadLayout::Uniform] {
        let input = format!("{layout:?}, 1e-15 beyond a cap of 1 rad");
        cases.push(Case::refusal("sensing::Pads::read", input, move || {
            at(layout, Vector2::new(1.0 + 1e-15, 0.0))
        }));
        let input = format!("{layout:?}, 256 extreme displacements: finite");
        cases.push(Case::new("sensing::Pads::read", input, move || {
            let pairs = EXTREME.into_iter().flat_map(|x| EXTREME.map(|y| (x, y)));
            let read = pairs.map(|(x, y)| {
                let shift = at(layout, Vector2::new(x, y))?;
                Ok::<_, BeyondPads>([shift.x, shift.y])
            });
            Outcome::of_all(read)
        }));
    }
    for angle in [
        1e-300,
        1e-150,
        1e-12,
        1e-6,
        0.1,
        3.0,
        PI - 1e-6,
        PI,
        1e6,
        1e150,
    ] {
        let input = format!("{angle:e} rad");
        cases.push(Case::new(
            "sensing::direction_at",
            input.clone(),
            move || direction(angle),
        ));
        if angle < PI {
            cases.push(Case::new(
                "sensing::displacement_between",
                input,
                move || displacement(angle),
            ));
        }
    }
    cases
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
    let pads = Pads::new(radius, pitch * radius, layout, offset, 1.0).expect(MADE);
    let placement = pads.place(|| Stream::new(3, 5, Channel::PadOffset));
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

fn nearest(pitch: f64) -> Outcome {
    let lattice = UniformLattice::with_pitch(pitch).expect(MADE);
    let last = lattice.pads() - 1;
    let asked = [0.0, 0.1, 0.25, 0.5, 0.7, 1.0].map(|share| (share * last as f64) as u64);
    let found = asked.map(|pad| lattice.nearest(&lattice.direction(pad.min(last))));
    let pairs = found.into_iter().zip(asked);
    Answer::all_at_scale(pairs.map(|(found, pad)| (found as f64, pad as f64)), 1.0).into()
}

fn at(layout: PadLayout, displacement: Vector2<f64>) -> Result<Vector2<f64>, BeyondPads> {
    let pads = Pads::new(1.0, 0.01, layout, PadOffset::Random, 1.0).expect(MADE);
    let placement = pads.place(|| Stream::new(3, 5, Channel::PadOffset));
    pads.read(&placement, &displacement)
}

/// Readings of pads of a direction with a bad coordinate.
fn sensed(layout: PadLayout, bad: f64) -> Result<Vector2<f64>, BeyondPads> {
    let pads = Pads::new(1.0, 0.01, layout, PadOffset::Random, 1.0).expect(MADE);
    let placement = pads.place(|| Stream::new(3, 5, Channel::PadOffset));
    let direction = Vector3::new(bad, 0.0, 1.0);
    let pad = pads.sensed_direction(&placement, &Vector3::z(), &direction)?;
    Ok(pad.xy())
}

/// Direction after a turn by `angle` along d, which is `(sin a · d, cos a)`. Where the angle is so large that its
/// double leaves no digit of the turn, only the ratio of x to y and the length of 1 are judged.
fn direction(angle: f64) -> Outcome {
    let (x, y) = (0.6 * angle, 0.8 * angle);
    if angle * f64::EPSILON > 1.0 {
        let found = direction_at(&Vector2::new(x, y));
        let pairs = [(found.norm(), 1.0), (found.x / found.y, x / y)];
        return Answer::all_near(pairs).within(1e-15).into();
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
    answer.conditioned(angle.max(1.0)).into()
}

fn displacement(angle: f64) -> Outcome {
    let sine = (Precise::new(angle)).sin().to_f64();
    let to = Vector3::new(0.6 * sine, 0.8 * sine, libm::cos(angle));
    let found = displacement_between(&Vector3::z(), &to);
    let pairs = [(found.x, 0.6 * angle), (found.y, 0.8 * angle)];
    // The nearer to the opposite side, the less a direction tells the azimuth.
    let answer = Answer::all_at_scale(pairs, angle.max(1e-150)).within(1e-15);
    answer.conditioned((angle / sine).max(1.0)).into()
}

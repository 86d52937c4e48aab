//! Noise from none to a thousand per cent and beyond, and encoders of any step.

use std::f64::consts::{FRAC_1_PI, PI};

use nalgebra::{Point3, Vector2, Vector3};
use palpate_sensing::{
    AngularVelocityError, Channel, Distribution, Encoder, GaussianError, NormalError, PositionAxes,
    PositionError, Stream, Wrist,
};
use palpate_verdict::{Answer, EXTREME, rows};

const READ: &str = "sensing::Encoder::read";
const DRAWS: u64 = 2000;
const LEVELS: [f64; 8] = [0.0, 1e-300, 1e-9, 0.01, 1.0, 10.0, 1e9, 1e150];
const SEEDS: [(u64, u64); 4] = [(0, 0), (u64::MAX, 0), (0, u64::MAX), (u64::MAX, u64::MAX)];

rows! {
    "sensing::AngularVelocityError::draw, Gaussian", "size {level:e}: root mean square of {DRAWS} draws" =>
        turned(Distribution::Gaussian, level, 1.0), for level in LEVELS;
    "sensing::AngularVelocityError::draw, uniform", "size {level:e}: root mean square of {DRAWS} draws" =>
        turned(Distribution::Uniform, level, 3f64.sqrt()), for level in LEVELS;
    "sensing::GaussianError::draw", "size {level:e}: root mean square of {DRAWS} draws" => drawn(level),
        for level in LEVELS;
    "sensing::PositionError::read", "size {level:e}: root mean square of {DRAWS} draws" => placed(level),
        for level in LEVELS;
    "sensing::NormalError::read", "{std_rad:e} rad: unit vectors all the same" => unit_normals(std_rad),
        for std_rad in [0.0, 1e-300, 1e-9, 0.1, PI];
    "sensing::Wrist::read", "std of {level:e} radii: at most half a turn away" => wrist(level),
        for level in [0.0, 1e-12, 0.01, 1.0, 10.0, 1e9, 1e150];
    READ, "step {step:e}, 1/π rad: the nearest whole number of steps" => encoded(step),
        for step in [f64::from_bits(1), 1e-310, 1e-12, 1e-3, 0.1, 1.0, 1e9, f64::MAX];
    READ, "steps and angles of all extremes: off, in steps or the angle itself if they are finer than it" =>
        all_encoded();
    "sensing::Stream::symmetric_uniform", "seed {seed}, trial {trial}: mean of {DRAWS} uniform draws" =>
        mean(seed, trial), for (seed, trial) in SEEDS;
}

fn mean(seed: u64, trial: u64) -> Answer {
    let mut stream = Stream::new(seed, trial, Channel::Pixel);
    let sum: f64 = (0..DRAWS).map(|_| stream.symmetric_uniform()).sum();
    // Five standard deviations of the mean.
    let bound = 5.0 / (3.0 * DRAWS as f64).sqrt();
    Answer::at_scale(sum / DRAWS as f64, 0.0, 1.0).within(bound)
}

/// Draws of a rate, times what makes their standard deviation the level.
fn turned(distribution: Distribution, level: f64, scale: f64) -> Answer {
    let error = AngularVelocityError::new(distribution, level).unwrap();
    root_mean_square(level, |stream| {
        let drawn = error.draw(stream, 1.0) * scale;
        [drawn.x, drawn.y]
    })
}

fn drawn(level: f64) -> Answer {
    let error = GaussianError::new(level).unwrap();
    root_mean_square(level, |stream| [error.draw(stream)])
}

fn placed(level: f64) -> Answer {
    let error = PositionError::new(Distribution::Gaussian, level, PositionAxes::Xyz).unwrap();
    root_mean_square(level, |stream| {
        let read = error.read(stream, &Point3::origin());
        [read.x, read.y, read.z]
    })
}

/// It is the stated one within five standard deviations of its own, `√(1/2n)` of a Gaussian.
fn root_mean_square<N: IntoIterator<Item = f64>>(
    level: f64,
    draw: impl Fn(&mut Stream) -> N,
) -> Answer {
    let mut stream = Stream::new(7, 0, Channel::Position);
    let scale = if level > 0.0 { level } else { 1.0 };
    let drawn: Vec<f64> = (0..DRAWS).flat_map(|_| draw(&mut stream)).collect();
    let squares: f64 = drawn.iter().map(|drawn| (drawn / scale).powi(2)).sum();
    let found = (squares / drawn.len() as f64).sqrt();
    let stated = if level > 0.0 { 1.0 } else { 0.0 };
    let bound = 5.0 / (2.0 * drawn.len() as f64).sqrt();
    Answer::at_scale(found, stated, 1.0)
        .within(bound)
        .also(drawn)
}

/// A step finer than the angle's last place reads the angle itself; a coarser one at most a step beside it.
fn encoded(step: f64) -> Answer {
    let angle = FRAC_1_PI;
    let read = count(step, angle, -angle);
    let bound = if step < f64::EPSILON * angle {
        1e-15
    } else {
        step / angle
    };
    Answer::all_at_scale([(read.x, angle), (read.y, -angle)], angle).within(bound)
}

/// An encoder errs by a step at most, and by the last place of what it reads.
fn all_encoded() -> Answer {
    let steps = EXTREME
        .into_iter()
        .filter(|step| Encoder::new(*step).is_ok());
    let angles = EXTREME.into_iter().filter(|angle| angle.is_finite());
    let pairs = steps.flat_map(|step| angles.clone().map(move |angle| (step, angle)));
    let off = pairs.map(|(step, angle)| {
        let allowed = step.max(f64::EPSILON * angle.abs());
        (
            (count(step, angle, 0.0).x - angle) / allowed.max(f64::from_bits(1)),
            0.0,
        )
    });
    Answer::all_at_scale(off, 1.0).within(1.0)
}

fn count(step: f64, x: f64, y: f64) -> Vector2<f64> {
    let mut stream = Stream::new(7, 0, Channel::EncoderPhase);
    Encoder::new(step)
        .unwrap()
        .read(&mut stream, &Vector2::new(x, y))
}

fn unit_normals(std_rad: f64) -> Answer {
    let sensor = NormalError::new(std_rad).unwrap();
    let mut stream = Stream::new(7, 0, Channel::Normal);
    let normals = [Vector3::x(), Vector3::y(), -Vector3::z()];
    let reads = (0..DRAWS).map(|draw| sensor.read(&mut stream, &normals[draw as usize % 3]));
    Answer::all_near(reads.map(|read| (read.norm(), 1.0)).collect::<Vec<_>>()).within(1e-15)
}

fn wrist(level: f64) -> Answer {
    let radius = 1e-3;
    let sensor = Wrist::new(level * radius, radius).unwrap();
    let mut stream = Stream::new(7, 0, Channel::WristContact);
    let shift = Vector2::new(0.3, -0.2) * radius;
    let reads: Vec<Vector2<f64>> = (0..DRAWS)
        .map(|_| sensor.read(&mut stream, &shift))
        .collect();
    let numbers = reads.iter().flat_map(|read| [read.x, read.y]);
    if level == 0.0 {
        let pairs = reads
            .iter()
            .flat_map(|read| [(read.x, shift.x), (read.y, shift.y)]);
        return Answer::all_at_scale(pairs, radius).within(1e-15);
    }
    let farthest = reads.iter().map(|read| read.norm()).fold(0.0, f64::max);
    let half_turn = std::f64::consts::PI * radius;
    Answer::at_scale(farthest.max(half_turn), half_turn, radius)
        .within(1e-14)
        .also(numbers)
}

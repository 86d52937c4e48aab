//! Workloads with rolls of a sphere of radius 1, and with estimates from such rolls (EP1).

use std::hint::black_box;
use std::num::NonZeroUsize;

use anyhow::{Context, Result, bail};
use nalgebra::Vector2;
use palpate::SceneTrial;
use palpate::recorded::{RollOptions, RollRecording, estimate_roll};
use palpate_geometry::{Graph, Shape, Sphere};
use palpate_rolling::{Fingertip, Glider, Motion, Roller, Rolls};
use palpate_scene::{RollScene, Scene, Scenes};
use palpate_sensing::{Channel, PadLayout, PadOffset, Pads, Stream};
use palpate_study::config;
use palpate_sweep::{Cell, CellStatistics, Observation, Record, RunOptions, Runner, Trial};

pub use palpate_rolling::{Chart, Model};

use crate::contact_reference::RollEnd;
use crate::timing::Evaluation;

/// Rate of every roll, rad/s.
pub const RATE: f64 = 0.1;
/// Direction of every roll, rad.
pub const DIRECTION: f64 = 0.7;

/// A sphere of radius 1 as the object.
///
/// # Errors
/// An error if the radius of the sphere is invalid.
pub fn sphere() -> Result<Shape> {
    Ok(Shape::Sphere(Sphere::new(1.0)?))
}

/// The paraboloid z = −r².
///
/// # Errors
/// An error if the coefficient of the paraboloid is invalid.
pub fn paraboloid() -> Result<Shape> {
    Ok(Shape::Paraboloid(Graph::paraboloid(1.0)?))
}

/// A roll by this angle (rad) at [`RATE`].
pub fn motion(angle_rad: f64) -> Motion {
    Motion::rolling(DIRECTION, RATE, angle_rad / RATE)
}

/// A probe of radius 1 on top of an object, for a roll by this angle.
///
/// # Errors
/// An error if the model cannot compute the roll.
pub fn roller(object: Shape, model: Model, angle_rad: f64) -> Result<Roller> {
    let rolls = [vec![motion(angle_rad)]];
    let rolls = Rolls::exact(&rolls);
    let probe = Sphere::new(1.0)?;
    Ok(Roller::new(probe, object, (0.0, 0.0), model, rolls)?)
}

/// Error of a roll that starts at the top of the sphere or the paraboloid. The last contact points on the object and on
/// the probe are compared with closed-form solutions. The error is the largest difference of a coordinate.
///
/// # Errors
/// An error if there is no closed-form solution for the object, or if the roll fails.
pub fn error(roller: &Roller, angle_rad: f64) -> Result<f64> {
    let end = match roller.object() {
        Shape::Sphere(ball) => RollEnd::on_ball(ball.radius(), DIRECTION, angle_rad),
        Shape::Paraboloid(_) => RollEnd::on_paraboloid(1.0, DIRECTION, angle_rad),
        other => bail!("no closed-form solution for a roll over a {}", other.name()),
    };
    let contact = roller.roll(&[motion(angle_rad)])?;
    let off_object = (contact.on_object - end.on_object).amax();
    Ok(off_object.max((contact.on_probe(1.0) - end.on_probe).amax()))
}

/// A trial of an estimate from rolls (EP1): eight probes of radius 1 roll by 0.1 rad on a sphere of radius 5.
pub struct Ep1(SceneTrial);

impl Ep1 {
    /// Config of the noise: each component of the angular velocity has a uniform error of at most 1 % of the rolling
    /// rate.
    pub const UNIFORM: &str =
        "noise = { angular_velocity = { kind = \"uniform\", fraction = 0.01 } }";
    /// Config of the sensor: an array of pads that measures the contact's position.
    pub const PADS: &str = "sensor = { kind = \"pads\", pitch = 0.01, offset = \"random\" }";

    /// Sets up the trial. `setting` is TOML text with the noise or the sensor of the scene.
    ///
    /// # Errors
    /// An error if `setting` is invalid.
    pub fn new(setting: &str) -> Result<Self> {
        let text = format!(
            "name = \"hot\"\n[scene]\nkind = \"roll\"\nprobe = {{ kind = \"sphere\", radius = 1.0 }}\n\
             object = {{ kind = \"sphere\", radius = 5.0 }}\n\
             motion = {{ rate_rad_per_s = 0.1, duration_s = 1.0 }}\n{setting}\n"
        );
        Ok(Self(SceneTrial {
            scene: config::parse("hot.toml", &text)?.scene(0)?,
            arch: palpate_scene::Arch::new(),
        }))
    }

    /// Root mean square of the relative error of the estimated normal curvature over `trials` trials. As in the sweep
    /// runner, several trials are computed at once with vector instructions. `None` if some trials cannot be computed
    /// in this way.
    pub fn relative_rms_error(&self, trials: u64) -> Option<f64> {
        let mut sum = 0.0;
        let computed =
            self.roll()?
                .side_by_side(palpate_scene::Arch::new(), 0..trials, |observed| {
                    let [normal_curvature_u, ..] = black_box(observed);
                    for estimate in normal_curvature_u.estimates {
                        let error = estimate / normal_curvature_u.truth - 1.0;
                        sum += error * error;
                    }
                    normal_curvature_u.estimates.len()
                });
        if computed != trials {
            return None;
        }
        Some((sum / trials as f64).sqrt())
    }

    /// Runs trials without statistics. Several trials are computed at once with vector instructions; trials for which
    /// this is not possible are computed one by one.
    fn run(&self, trials: u64) -> Option<()> {
        let roll = self.roll()?;
        let together = roll.side_by_side(palpate_scene::Arch::new(), 0..trials, |observed| {
            black_box(observed)[0].estimates.len()
        });
        for trial in together..trials {
            let _ = black_box(roll.outcomes(trial));
        }
        Some(())
    }

    fn roll(&self) -> Option<&RollScene> {
        match &self.0.scene {
            Scene::Roll(roll) => Some(roll),
            _ => None,
        }
    }

    /// Statistics of the estimates in `trials` trials, which run on one thread.
    ///
    /// # Errors
    /// An error if no thread can be started.
    pub fn statistics(&self, trials: u64) -> Result<CellStatistics> {
        statistics(&self.0, trials)
    }
}

fn statistics(trial: &dyn Trial, trials: u64) -> Result<CellStatistics> {
    let options = RunOptions {
        threads: NonZeroUsize::new(1),
        whole_blocks: true,
    };
    let cells = [Cell { trials, trial }];
    let statistics = Runner::new(&options)?.run(&cells, &|_| ());
    statistics.into_iter().next().context("no cell")
}

/// A trial that simulates nothing, for measuring the cost of statistics. It returns five quantities, whose errors are
/// distributed almost uniformly.
pub struct Statistics;

impl Statistics {
    const QUANTITIES: usize = 5;
    const TRUTH: f64 = 5.0;

    /// Statistics of `trials` trials that simulate nothing. The trials run on one thread.
    ///
    /// # Errors
    /// An error if no thread can be started.
    pub fn of(trials: u64) -> Result<CellStatistics> {
        statistics(&Self, trials)
    }
}

impl Trial for Statistics {
    fn quantities(&self) -> usize {
        Self::QUANTITIES
    }

    fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
        for quantity in 0..Self::QUANTITIES {
            // The errors are multiples of the golden ratio, modulo 1, because such multiples fill an interval evenly
            // without random numbers.
            let step = (trial * 5 + quantity as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11;
            let error = step as f64 / (1u64 << 53) as f64 - 0.5;
            let observation = Observation {
                estimate: Self::TRUTH + 0.1 * error,
                truth: Self::TRUTH,
                std: Some(0.03),
                interval_holds: None,
            };
            record.observe(quantity, observation);
        }
        Ok(())
    }
}

/// The workload of one roll over an object.
///
/// # Errors
/// An error if the model cannot compute the roll.
pub fn roll(name: &str, object: Shape, model: Model, angle_rad: f64) -> Result<Evaluation> {
    let roller = roller(object, model, angle_rad)?;
    let motion = motion(angle_rad);
    Ok(Evaluation::new(name, move || {
        roller.roll(black_box(&[motion]))
    }))
}

/// The workload of estimates from rolls (EP1), without statistics.
///
/// # Errors
/// An error if `setting` is invalid.
pub fn trials(name: &str, setting: &str, trials: u64) -> Result<Evaluation> {
    let trial = Ep1::new(setting)?;
    Ok(Evaluation::new(name, move || trial.run(black_box(trials))))
}

/// The workload of an estimate with its p-value from eight recorded rolls. The settings are passed by name, as in a
/// call from Python.
///
/// # Errors
/// An error if the estimate fails.
pub fn recorded(name: &str) -> Result<Evaluation> {
    let rolls = (0..8).map(|roll| {
        let (sine, cosine) = libm::sincos(f64::from(roll) * std::f64::consts::FRAC_PI_4);
        let along = 0.1 / (1.0 + 1.0 / 5.0) + 1e-4 * f64::from(roll % 3 - 1);
        ([0.1 * sine, -0.1 * cosine], [along * cosine, along * sine])
    });
    let (rotations, shifts): (Vec<_>, Vec<_>) = rolls.unzip();
    let settings = [("probe_radius", 1.0), ("shift_std", 1e-4)];
    let settings = settings.map(|(key, value)| (key.to_owned(), value.into()));
    let settings = serde_json::Map::from_iter(settings);
    let estimate = move || {
        let options = RollOptions::with_settings(None, black_box(&settings), None)?;
        let readings = RollRecording::new(&rotations, black_box(&shifts), None)?;
        let estimate = estimate_roll(readings, &options)?;
        let p_value = estimate.p_value().context("noise is stated")?;
        anyhow::Ok((p_value, estimate.values()))
    };
    estimate()?;
    Ok(Evaluation::new(name, estimate))
}

/// The workload of computing statistics alone. The trials simulate nothing.
pub fn statistics_alone(name: &str, trials: u64) -> Evaluation {
    Evaluation::new(name, move || Statistics::of(black_box(trials)))
}

/// The workload that reads contacts with a pad array. The pitch of the pads is 1/100 of the array's radius.
///
/// # Errors
/// An error if the array is invalid.
pub fn pads(name: &str, layout: PadLayout, readings: u32) -> Result<Evaluation> {
    let pads = Pads::new(10.0, 0.1, layout, PadOffset::Random, 1.5)?;
    let placement = pads.place(&mut Stream::new(1, 0, Channel::PadOffset));
    Ok(Evaluation::new(name, move || {
        (0..readings).for_each(|reading| {
            let displacement = Vector2::new(2.3, 0.01 * f64::from(reading));
            let _ = black_box(pads.read(&placement, black_box(&displacement)));
        });
    }))
}

/// The workload that finds the contacts of a round fingertip at successive places of a saddle.
///
/// # Errors
/// An error if the tip or the saddle is invalid.
pub fn touches(name: &str, touches: u32) -> Result<Evaluation> {
    let saddle = Shape::Saddle(Graph::saddle(0.1)?);
    let glider = Glider::new(saddle, Fingertip::Sphere { radius: 0.5 })?;
    Ok(Evaluation::new(name, move || {
        (0..touches).for_each(|touch| {
            let _ = black_box(glider.touch(0.1 * f64::from(touch), black_box(0.3)));
        });
    }))
}

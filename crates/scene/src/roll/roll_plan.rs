//! Builds a [`RollScene`] from its config, and compares the models that can compute its rolls.

use nalgebra::Vector2;
use palpate_ep1::{LeastSquares, ReadingNoise};
use palpate_geometry::{Shape, Sphere, Surface};
use palpate_rolling::{
    Chart, HeldAxis, InvalidRoll, Model, Motion, RollError, Roller, Rolls, Terrain,
};
use palpate_sensing::{AngularVelocityError, Distribution};

use super::linear_rolls::LinearRolls;
use super::motion_noise::{MotionNoise, Roll, lasting};
use super::roll_sensor::{RollSensor, RotationSensor};
use super::roll_trial::{RollFit, RollScene, Truth};
use super::sampled_rolls::SampledRolls;
use crate::config_conversion::{range_error, sensor_error, shape};
use crate::ladder::{Accuracy, Ladder, Rung};
use palpate_study::FieldError;
use palpate_study::config::{
    self, AngularVelocityNoise, ModelConfig, ObjectConfig, ProbeConfig, RollAxis, RollConfig,
    RollModelConfig, RollMotionConfig, Side, When,
};

fn roll_error(object: &ObjectConfig, error: InvalidRoll) -> FieldError {
    let path = match (&error, object) {
        (InvalidRoll::FirstContact(_), ObjectConfig::HeightField { .. }) => "scene.object.formula",
        (InvalidRoll::FirstContact(_), _) => "scene.object_contact",
        (InvalidRoll::Fault(_), _) => "scene.object",
        (InvalidRoll::Unsupported { .. }, _) => "scene.model.kind",
        (InvalidRoll::Tolerance(_), _) => "scene.model.tolerance",
    };
    FieldError::at(path, error)
}

impl RollScene {
    /// Builds the scene of a config. `seed` is the seed of its random numbers.
    ///
    /// # Errors
    /// [`FieldError`] with the path of the invalid field.
    pub fn new(config: &RollConfig, seed: u64) -> Result<Self, FieldError> {
        let ProbeConfig::Sphere { radius } = config.probe;
        let probe = Sphere::new(radius)
            .map_err(|error| range_error("scene.probe.radius", error.expected, error.value))?;
        let object = shape(&config.object)?;
        let noise = motion_noise(config)?;
        let sensor = RollSensor::new(&config.sensor, radius)?;
        let rotation_sensor = RotationSensor::new(&config.noise)?;

        let (roller, commands) = roller(config, probe, object, noise)?;
        let reading_noise = ReadingNoise {
            // The config states the noise as a fraction of the whole rate of rotation, including spin. Convert it to a
            // fraction of the tangential part of the rate.
            relative_rotation_std: noise.map_or(0.0, |noise| noise.relative_rotation_std())
                * libm::hypot(config.motion.spin_rad_per_s / rate(&config.motion), 1.0),
            rotation_std_rad: rotation_sensor.std_rad(),
            is_rotation_measured: noise.is_some_and(|noise| noise.side == Side::Measurement),
            ..sensor.shift_noise()
        };
        let (rolls, truth) = noiseless(&roller, &commands, noise.as_ref())
            .map_err(|error| FieldError::at("scene.motion", error))?;
        let rotations: Vec<_> = rolls.iter().map(|roll| roll.rotation).collect();
        let fit = LeastSquares::new(radius, reading_noise, &rotations)
            .map_or_else(RollFit::NoFit, RollFit::Fit);
        let sampled = SampledRolls::new(
            config,
            &roller,
            &rolls,
            (&sensor, &rotation_sensor),
            reading_noise.relative_rotation_std,
        )?;
        let has_series = sampled
            .as_ref()
            .is_some_and(|sampled| sampled.method.is_some());
        let linear = match rotation_sensor.is_exact() && !has_series {
            true => LinearRolls::new(&roller, &rolls, noise.as_ref()),
            false => None,
        };
        Ok(Self {
            seed,
            fit,
            linear,
            series_noise: sampled.as_ref().map(|sampled| sampled.noise),
            sampled,
            estimator: config.estimator.clone(),
            roller,
            rolls,
            noise,
            sensor,
            rotation_sensor,
            reading_noise,
            truth,
            has_principal: config.principal_curvatures,
            directions_path: match config.motion.rolls {
                Some(_) => "scene.motion.rolls",
                None => "scene.motion.directions_deg",
            },
            tolerance: match config.model {
                RollModelConfig::Auto { tolerance, .. } => Some(tolerance),
                _ => None,
            },
            chart: ladder_chart(config),
        })
    }

    /// Commanded motion of each probe, without noise. Each motion is divided into pieces. If there is noise, each piece
    /// has its own error.
    pub fn noiseless(&self) -> Vec<Vec<Motion>> {
        let pieces = self.noise.map_or(1, |noise| noise.pieces());
        let commands: Vec<Motion> = self.commands().copied().collect();
        distinct(&commands, pieces)
    }

    pub(super) fn measured_ladder(&self) -> Ladder {
        let rolls = self.noiseless();
        let rolls = Rolls {
            rolls: &rolls,
            has_noise: self.noise.is_some_and(|noise| noise.is_of_motion()),
        };
        let measured = self.roller.ladder(self.chart, rolls);
        let choice = self.roller.choice();
        let rungs = measured.into_iter().map(|rung| Rung {
            name: rung.name,
            model: ModelConfig::Roll(named(rung.model)),
            accuracy: Accuracy::from(rung.outcome),
        });
        let taken = ModelConfig::Roll(named(choice.model));
        Ladder::new(
            rungs.collect(),
            &taken,
            choice.reason.clone(),
            self.tolerance,
        )
    }
}

fn motion_noise(config: &RollConfig) -> Result<Option<MotionNoise>, FieldError> {
    let Some(noise) = &config.noise.angular_velocity else {
        return Ok(None);
    };
    let (distribution, draws) = match noise {
        AngularVelocityNoise::Uniform(draws) => (Distribution::Uniform, draws),
        AngularVelocityNoise::Gaussian(draws) => (Distribution::Gaussian, draws),
    };
    let error = AngularVelocityError::new(distribution, draws.fraction)
        .map_err(|error| sensor_error("scene.noise.angular_velocity", error))?;
    if draws.fraction == 0.0 {
        return Ok(None);
    }
    let noise = MotionNoise {
        error,
        instants: match draws.when {
            When::PerProbe => 1,
            When::PerInstant => draws.instants,
        },
        side: draws.side,
    };
    if noise.pieces() > 1 && config.motion.axis == RollAxis::Chart {
        let message = "\"per-instant\" noise of the motion needs axis = \"transported\": with the axis held \
                       in the chart, a motion cannot be cut into pieces";
        return Err(FieldError::at("scene.noise.angular_velocity.when", message));
    }
    Ok(Some(noise))
}

/// Form of the contact equations for the integrators that are compared: the form that the config states. If the config
/// states none, it is `Free` for a rotation axis that is constant in the transported frame, and `Montana` for an axis
/// that is constant in the probe's chart.
fn ladder_chart(config: &RollConfig) -> Chart {
    let axis = config.motion.axis;
    let form = config.model.chart().unwrap_or(match axis {
        RollAxis::Transported => config::Chart::Free,
        RollAxis::Chart => config::Chart::Montana,
    });
    chart(form, axis)
}

fn chart(chart: config::Chart, axis: RollAxis) -> Chart {
    match chart {
        config::Chart::Free => Chart::Free,
        config::Chart::Montana => Chart::Montana(match axis {
            RollAxis::Transported => HeldAxis::Transported,
            RollAxis::Chart => HeldAxis::Chart,
        }),
    }
}

fn model(config: &RollModelConfig, axis: RollAxis) -> Model {
    let chart = |form| chart(form, axis);
    match *config {
        RollModelConfig::Auto {
            tolerance,
            chart: form,
        } => Model::Auto {
            tolerance,
            chart: chart(form),
        },
        RollModelConfig::ClosedForm {} => Model::ClosedForm,
        RollModelConfig::Meridian {} => Model::Meridian,
        RollModelConfig::Rk4 { steps, chart: form } => Model::Rk4 {
            steps: steps as usize,
            chart: chart(form),
        },
        RollModelConfig::Dop853 {
            tolerance,
            chart: form,
        } => Model::Dop853 {
            tolerance,
            chart: chart(form),
        },
    }
}

/// Builds the roller and the commanded motions. If the config states an arc length, the motions are such that rolls
/// without noise have this length.
fn roller(
    config: &RollConfig,
    probe: Sphere,
    object: Shape,
    noise: Option<MotionNoise>,
) -> Result<(Roller, Vec<Motion>), FieldError> {
    let contact = config
        .object_contact
        .map_or(object.default_contact(), |[x, y]| (x, y));
    let model = model(&config.model, config.motion.axis);
    let pieces = noise.map_or(1, |noise| noise.pieces());
    let set_up = |commands: &[Motion]| {
        let rolls = distinct(commands, pieces);
        Roller::new(
            probe,
            object.clone(),
            contact,
            model,
            Rolls {
                rolls: &rolls,
                has_noise: noise.is_some_and(|noise| noise.is_of_motion()),
            },
        )
        .map_err(|error| roll_error(&config.object, error))
    };
    let mut commands = commands(&config.motion);
    let mut roller = set_up(&commands)?;
    if let Some(arc_length) = config.motion.arc_length {
        let mut durations: Vec<(Motion, f64)> = Vec::new();
        for command in &mut commands {
            let found = durations.iter().find(|(same, _)| same == command);
            let duration_s = match found {
                Some((_, duration_s)) => *duration_s,
                None => roller
                    .duration_for_arc(command, arc_length)
                    .map_err(|error| FieldError::at("scene.motion.arc_length", error))?,
            };
            durations.push((*command, duration_s));
            command.duration_s = duration_s;
        }
        // The choice of the model depends on the durations of the rolls, which have just been computed. So set up the
        // roller again.
        roller = set_up(&commands)?;
    }
    Ok((roller, commands))
}

/// Rate of rotation, rad/s. If the config states no rate, the rate is 1; the results do not depend on this value.
fn rate(config: &RollMotionConfig) -> f64 {
    config.rate_rad_per_s.unwrap_or(1.0)
}

/// The commanded motions, with the duration or the angle that the config states. If the config states an arc length
/// instead, the motions rotate by 1 rad, and their durations are corrected later.
fn commands(config: &RollMotionConfig) -> Vec<Motion> {
    let rate = rate(config);
    let angle_rad = config.angle_deg.map_or(1.0, f64::to_radians);
    let duration_s = config.duration_s.unwrap_or(angle_rad / rate);
    config
        .directions()
        .iter()
        .map(|direction| {
            let mut motion = Motion::rolling(direction.to_radians(), rate, duration_s);
            motion.angular_velocity.z = config.spin_rad_per_s;
            motion
        })
        .collect()
}

/// The different commanded motions: equal motions occur only once. Each motion is divided into `pieces` shorter
/// motions.
fn distinct(commands: &[Motion], pieces: u32) -> Vec<Vec<Motion>> {
    let mut rolls: Vec<Vec<Motion>> = Vec::new();
    for command in commands {
        let piece = lasting(command, command.duration_s / f64::from(pieces));
        if !rolls.iter().any(|roll| roll.first() == Some(&piece)) {
            rolls.push(vec![piece; pieces as usize]);
        }
    }
    rolls
}

/// Computes the commanded rolls without noise, and the true values of the estimated quantities.
fn noiseless(
    roller: &Roller,
    commands: &[Motion],
    noise: Option<&MotionNoise>,
) -> Result<(Vec<Roll>, Truth), String> {
    let first = roller.first_contact();
    let (_, curvature) = roller
        .object()
        .curvature_along(&first.on_object, &first.x_axis)
        .map_err(|error| error.to_string())?;
    let radius = roller.probe().radius();
    let stray = |rotation: &Vector2<f64>| noise.map_or(0.0, |noise| noise.stray(radius, rotation));
    let mut rolls: Vec<(Roll, f64)> = Vec::with_capacity(commands.len());
    for (probe, &command) in commands.iter().enumerate() {
        if let Some(same) = rolls.iter().find(|(roll, _)| roll.command == command) {
            rolls.push(same.clone());
            continue;
        }
        let fail = |error: RollError| format!("probe {probe} cannot roll: {error}");
        let shift = roller.shift(&[command]);
        if shift.is_err() {
            // If the probe already overlaps the object at the start, report the overlap instead of the error of the
            // roll.
            let start = lasting(&command, 0.0);
            terrain(roller, &start, 0.0).map_err(fail)?;
        }
        let shift = shift.map_err(fail)?;
        let rotation = command.rotation();
        let roll = Roll {
            command,
            rotation,
            displacement: shift.displacement,
            terrain: terrain(roller, &command, stray(&rotation)).map_err(fail)?,
        };
        rolls.push((roll, shift.arc_length));
    }
    let (rolls, lengths): (Vec<Roll>, Vec<f64>) = rolls.into_iter().unzip();
    let arc_length = lengths.iter().sum::<f64>() / commands.len() as f64;
    Ok((
        rolls,
        Truth {
            curvature,
            arc_length,
        },
    ))
}

/// Heights of the object along a roll (`Terrain`), if noise may make the probe penetrate the object beside the contact.
/// Noise moves the probe by at most `stray` (length). The result is `None` if, in the commanded roll, the object beside
/// the contact is always at least this far from the probe.
fn terrain(roller: &Roller, command: &Motion, stray: f64) -> Result<Option<Terrain>, RollError> {
    let motions = [*command];
    let Some(terrain) = roller.terrain(&motions, stray)? else {
        return Ok(None);
    };
    let clearance = roller.clearance(&motions, &terrain, stray)?;
    Ok((clearance < stray).then_some(terrain))
}

fn named(model: Model) -> RollModelConfig {
    let config_chart = |chart: Chart| match chart {
        Chart::Free => config::Chart::Free,
        Chart::Montana(_) => config::Chart::Montana,
    };
    match model {
        Model::Auto { tolerance, chart } => RollModelConfig::Auto {
            tolerance,
            chart: config_chart(chart),
        },
        Model::ClosedForm => RollModelConfig::ClosedForm {},
        Model::Meridian => RollModelConfig::Meridian {},
        Model::Rk4 { steps, chart } => RollModelConfig::Rk4 {
            steps: u32::try_from(steps).unwrap_or(u32::MAX),
            chart: config_chart(chart),
        },
        Model::Dop853 { tolerance, chart } => RollModelConfig::Dop853 {
            tolerance,
            chart: config_chart(chart),
        },
    }
}

//! Rolls in closed form, where the contact's path is a constant matrix times the rotation.

use std::convert::Infallible;

use nalgebra::{Matrix2, Vector2};
use palpate_ep1::{LANES, Lanes, Moments, ProbeGroup};
use palpate_rolling::{Motion, Roller, Shift};
use palpate_sensing::{Channel, Distribution, Stream};

use super::noise::MotionNoise;

/// Steady rolls on a plane, sphere, dish or cylinder, whose reported rotations do not err.
#[derive(Clone, Debug)]
pub(super) struct LinearRolls {
    radius: f64,
    mobility: Matrix2<f64>,
    groups: Vec<Group>,
    /// Of the error of each component of the rotation, if there is one.
    error: Option<Distribution>,
}

/// Probes side by side.
#[derive(Clone, Debug)]
struct Group {
    /// How many there are.
    probes: usize,
    /// `[−Δθ_y, Δθ_x]` as commanded, rad; zero in the lanes without a probe, as is the error.
    drive: [Lanes; 2],
    /// Size of the error of each component, rad.
    error: Lanes,
    reported: ProbeGroup,
}

impl LinearRolls {
    /// For probes that are told `commands` and report `rotations`; `None` where a roll is not
    /// linear: on other objects, or where its motion changes on the way or is measured with errors.
    pub(super) fn new(
        roller: &Roller,
        commands: &[Motion],
        rotations: &[Vector2<f64>],
        noise: &MotionNoise,
    ) -> Option<Self> {
        let error = match noise {
            MotionNoise::None => None,
            MotionNoise::Motion { error, instants: 1 } => Some(error),
            MotionNoise::Motion { .. } | MotionNoise::Measurement { .. } => return None,
        };
        let fraction = error.map_or(0.0, |error| error.fraction());
        let radius = roller.probe().radius();
        let group = |(commands, rotations): (&[Motion], &[Vector2<f64>])| {
            let mut group = Group {
                probes: commands.len(),
                drive: Default::default(),
                error: Default::default(),
                reported: ProbeGroup::new(radius, rotations),
            };
            for (lane, command) in commands.iter().enumerate() {
                let rotation = command.rotation();
                group.drive[0][lane] = -rotation.y;
                group.drive[1][lane] = rotation.x;
                group.error[lane] = fraction * command.angular_velocity.norm() * command.duration_s;
            }
            group
        };
        Some(Self {
            radius,
            mobility: *roller.linear()?,
            groups: commands
                .chunks(LANES)
                .zip(rotations.chunks(LANES))
                .map(group)
                .collect(),
            error: error.map(|error| error.distribution()),
        })
    }

    /// Rolls every probe. `None` where a contact passes half way round its probe, so that the shift
    /// is not the path.
    #[inline(always)]
    pub(super) fn short(&self, seed: u64, trial: u64) -> Option<Moments> {
        let half_turn = std::f64::consts::PI * self.radius;
        let mut moments = Moments::default();
        let mut longest = Lanes::default();
        self.roll(seed, trial, |group, paths| {
            let [u, v] = &paths;
            for ((longest, u), v) in longest.iter_mut().zip(u).zip(v) {
                let square = u * u + v * v;
                *longest = if square > *longest { square } else { *longest };
            }
            moments.add_group(&group.reported, &paths);
            Ok::<(), Infallible>(())
        })
        .ok()?;
        let is_short = longest
            .iter()
            .all(|square| *square <= half_turn * half_turn);
        is_short.then_some(moments)
    }

    /// Rolls every probe; `read` turns the contact's displacement on the probe (logarithm map) into
    /// what the sensor tells.
    pub(super) fn sensed<E>(
        &self,
        seed: u64,
        trial: u64,
        mut read: impl FnMut(Vector2<f64>) -> Result<Vector2<f64>, E>,
    ) -> Result<Moments, E> {
        let mut moments = Moments::default();
        self.roll(seed, trial, |group, mut shifts| {
            let [u, v] = &mut shifts;
            for (u, v) in u.iter_mut().zip(v).take(group.probes) {
                let path = Vector2::new(*u, *v);
                let shift = read(Shift::along_great_circle(path, self.radius).displacement)?;
                (*u, *v) = (shift.x, shift.y);
            }
            moments.add_group(&group.reported, &shifts);
            Ok(())
        })?;
        Ok(moments)
    }

    /// Tells the contacts' paths along u and v, group by group, with the errors of a trial.
    #[inline(always)]
    fn roll<E>(
        &self,
        seed: u64,
        trial: u64,
        each: impl FnMut(&Group, [Lanes; 2]) -> Result<(), E>,
    ) -> Result<(), E> {
        let stream = || Stream::new(seed, trial, Channel::AngularVelocity);
        match self.error {
            None => self.disturbed(|| 0.0, each),
            Some(Distribution::Uniform) => {
                let mut stream = stream();
                self.disturbed(|| stream.symmetric_uniform(), each)
            }
            Some(Distribution::Gaussian) => {
                let mut stream = stream();
                self.disturbed(|| stream.standard_normal(), each)
            }
        }
    }

    /// The same with a source of errors in units of their size.
    #[inline(always)]
    fn disturbed<E>(
        &self,
        mut draw: impl FnMut() -> f64,
        mut each: impl FnMut(&Group, [Lanes; 2]) -> Result<(), E>,
    ) -> Result<(), E> {
        for group in &self.groups {
            each(group, self.paths(group, &mut draw))?;
        }
        Ok(())
    }

    /// The paths of a group's contacts along u and v.
    #[inline(always)]
    fn paths(&self, group: &Group, mut draw: impl FnMut() -> f64) -> [Lanes; 2] {
        let driven = std::array::from_fn::<_, LANES, _>(|lane| {
            let (error_x, error_y) = (draw(), draw());
            let size = group.error[lane];
            let g1 = group.drive[0][lane] - size * error_y;
            let g2 = group.drive[1][lane] + size * error_x;
            [
                self.mobility.m11 * g1 + self.mobility.m12 * g2,
                self.mobility.m21 * g1 + self.mobility.m22 * g2,
            ]
        });
        [driven.map(|[u, _]| u), driven.map(|[_, v]| v)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{RollScene, Scene, config};

    fn scene(duration_s: f64, noise: &str) -> RollScene {
        let text = format!(
            "name = \"test\"\n[scene]\nkind = \"roll\"\n\
             probe = {{ kind = \"sphere\", radius = 1.0 }}\n\
             object = {{ kind = \"cylinder\", radius = 5.0, direction_deg = 20 }}\n\
             motion = {{ rate_rad_per_s = 0.1, duration_s = {duration_s:?}, \
             directions_deg = [0, 50, 120] }}\n\
             noise = {{ {noise} }}\n"
        );
        let study = config::parse("test.toml", &text).unwrap();
        let Scene::Roll(roll) = study.scene(0).unwrap();
        roll
    }

    const NOISES: [&str; 3] = [
        "",
        "angular_velocity = { kind = \"uniform\", fraction = 0.1 }",
        "angular_velocity = { kind = \"gaussian\", fraction = 0.1 }",
    ];

    #[test]
    fn an_ideal_sensor_tells_the_paths() {
        for noise in NOISES {
            let scene = scene(1.0, noise);
            let linear = scene.linear.as_ref().unwrap();
            for trial in 0..20 {
                let sensed = linear.sensed(scene.seed, trial, Ok::<_, Infallible>);
                assert_eq!(linear.short(scene.seed, trial), sensed.ok());
            }
        }
    }

    #[test]
    fn a_trial_is_that_of_the_general_law() {
        for noise in NOISES {
            for duration_s in [1.0, 25.0, 40.0] {
                let mut scene = scene(duration_s, noise);
                let linear: Vec<_> = (0..20).map(|trial| scene.outcomes(trial)).collect();
                scene.linear = None;
                for (trial, linear) in linear.into_iter().enumerate() {
                    match (linear, scene.outcomes(trial as u64)) {
                        (Ok(linear), Ok(general)) => {
                            for (linear, general) in linear.iter().zip(&general) {
                                let scale = 1.0 + general.estimate.abs();
                                let difference = (linear.estimate - general.estimate).abs();
                                assert!(difference < 1e-9 * scale, "{linear:?} {general:?}");
                            }
                        }
                        (linear, general) => assert_eq!(linear, general),
                    }
                }
            }
        }
    }

    #[test]
    fn half_a_turn_is_not_short() {
        let linear = |duration_s| scene(duration_s, "").linear.unwrap();
        assert!(linear(31.0).short(1, 0).is_some());
        assert!(linear(32.0).short(1, 0).is_none());
    }
}

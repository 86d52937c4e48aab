//! Rolls in closed form, where the contact's path is a constant matrix times the rotation.

use std::convert::Infallible;

use nalgebra::{Matrix2, Vector2};
use palpate_ep1::{Lanes, Moments, Number, ProbeRotation};
use palpate_rolling::{Motion, Roller, Shift};
use palpate_sensing::{Channel, Distribution, Stream, Streams};

use super::noise::MotionNoise;

/// Steady rolls on a plane, sphere, dish or cylinder, whose reported rotations do not err.
#[derive(Clone, Debug)]
pub(super) struct LinearRolls {
    radius: f64,
    probes: Vec<LinearRoll>,
    /// Distribution of the error of each component of the rotation, if there is one.
    error: Option<Distribution>,
}

/// The roll of one probe.
#[derive(Clone, Debug)]
struct LinearRoll {
    /// Path of the contact as commanded, along u and v.
    commanded: [f64; 2],
    /// Change of that path per unit of error of the rotation about x.
    per_error_x: [f64; 2],
    /// Change of that path per unit of error of the rotation about y.
    per_error_y: [f64; 2],
    reported: ProbeRotation,
}

impl LinearRoll {
    fn new(
        mobility: &Matrix2<f64>,
        radius: f64,
        error: f64,
        command: &Motion,
        reported: &Vector2<f64>,
    ) -> Self {
        let size = error * command.angular_velocity.norm() * command.duration_s;
        // A contact is driven by (−Δθ_y, Δθ_x).
        let path = |rotation: Vector2<f64>| -> [f64; 2] {
            (mobility * Vector2::new(-rotation.y, rotation.x)).into()
        };
        Self {
            commanded: path(command.rotation()),
            per_error_x: path(Vector2::new(size, 0.0)),
            per_error_y: path(Vector2::new(0.0, size)),
            reported: ProbeRotation::new(radius, reported),
        }
    }

    /// The path with an error of the rotation in units of its size.
    #[inline(always)]
    fn path<N: Number>(&self, [error_x, error_y]: [N; 2]) -> [N; 2] {
        let along = |axis: usize| {
            N::of(self.commanded[axis])
                + N::of(self.per_error_x[axis]) * error_x
                + N::of(self.per_error_y[axis]) * error_y
        };
        [along(0), along(1)]
    }
}

impl LinearRolls {
    /// Rolls of probes that are told `commands` and report `rotations`; `None` where a roll is not linear: on other
    /// objects, or where its motion changes on the way or is measured with errors.
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
        let mobility = roller.linear()?;
        let probes = commands.iter().zip(rotations);
        Some(Self {
            radius,
            probes: probes
                .map(|(command, reported)| {
                    LinearRoll::new(mobility, radius, fraction, command, reported)
                })
                .collect(),
            error: error.map(|error| error.distribution()),
        })
    }

    /// Rolls every probe. `None` where a contact passes half way round its probe, so that the shift is not the path.
    #[inline(always)]
    pub(super) fn short(&self, seed: u64, trial: u64) -> Option<Moments> {
        let mut stream = Stream::new(seed, trial, Channel::AngularVelocity);
        self.all_short(|distribution| distribution.draw(&mut stream))
    }

    /// Moments of [`LinearRolls::short`] for the trials from `first` on, side by side; `None` where any of them gives
    /// none.
    #[inline(always)]
    pub(super) fn side_by_side(&self, seed: u64, first: u64) -> Option<Moments<Lanes>> {
        let mut streams = Streams::new(seed, first, Channel::AngularVelocity);
        self.all_short(|distribution| Lanes(distribution.draw_each(&mut streams)))
    }

    #[inline(always)]
    fn all_short<N: Number>(&self, draw: impl FnMut(Distribution) -> N) -> Option<Moments<N>> {
        let mut moments = Moments::default();
        let mut longest = N::default();
        self.roll(draw, |probe, path| {
            let [u, v] = path;
            longest = longest.larger(u * u + v * v);
            moments.add_shifts(&probe.reported, path);
            Ok::<(), Infallible>(())
        })
        .ok()?;
        let half_turn = std::f64::consts::PI * self.radius;
        let too_long = N::of((half_turn * half_turn).next_up());
        N::all(longest.is_below(too_long)).then_some(moments)
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
        let mut stream = Stream::new(seed, trial, Channel::AngularVelocity);
        self.roll(
            |distribution| distribution.draw(&mut stream),
            |probe, path: [f64; 2]| {
                let shift = Shift::along_great_circle(path.into(), self.radius);
                let shift = read(shift.displacement)?;
                moments.add_shifts(&probe.reported, shift.into());
                Ok(())
            },
        )?;
        Ok(moments)
    }

    /// Tells the contacts' paths along u and v, probe by probe, with errors from `draw`.
    #[inline(always)]
    fn roll<N: Number, E>(
        &self,
        mut draw: impl FnMut(Distribution) -> N,
        each: impl FnMut(&LinearRoll, [N; 2]) -> Result<(), E>,
    ) -> Result<(), E> {
        use Distribution::{Gaussian, Uniform};
        // The distribution is known where errors are drawn.
        match self.error {
            None => self.disturbed(N::default, each),
            Some(Uniform) => self.disturbed(|| draw(Uniform), each),
            Some(Gaussian) => self.disturbed(|| draw(Gaussian), each),
        }
    }

    /// Tells the contacts' paths with errors from `error`, in units of their size.
    #[inline(always)]
    fn disturbed<N: Number, E>(
        &self,
        mut error: impl FnMut() -> N,
        mut each: impl FnMut(&LinearRoll, [N; 2]) -> Result<(), E>,
    ) -> Result<(), E> {
        for probe in &self.probes {
            each(probe, probe.path([error(), error()]))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Arch, LANES, RollScene, Scene, Scenes};
    use palpate_study::config;

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
        let Scene::Roll(roll) = study.scene(0).unwrap() else {
            panic!("not a roll");
        };
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
    fn side_by_side_is_one_by_one_to_the_last_bit() {
        for noise in NOISES {
            // Rolls of 31 s end near half a turn: some fall short of it, some do not.
            for duration_s in [1.0, 31.0] {
                let scene = scene(duration_s, noise);
                let (mut trial, mut together) = (0, 0);
                while trial < 50 {
                    let mut first = trial;
                    let taken = scene.side_by_side(Arch::new(), trial..50, |observed| {
                        for lane in 0..LANES {
                            let outcomes = scene.outcomes(first + lane as u64).unwrap();
                            for (side_by_side, outcome) in observed.iter().zip(outcomes) {
                                assert_eq!(side_by_side.estimates[lane], outcome.estimate);
                                assert_eq!(side_by_side.truth, outcome.truth);
                                assert_eq!(side_by_side.stds.map(|stds| stds[lane]), outcome.std);
                            }
                        }
                        first += LANES as u64;
                        true
                    });
                    assert_eq!(first, trial + taken);
                    together += taken;
                    trial += taken.max(1);
                }
                assert!(
                    if duration_s == 1.0 {
                        together == 48
                    } else {
                        together > 0
                    },
                    "{noise}: {together}"
                );
            }
        }
    }

    #[test]
    fn what_is_not_taken_does_not_count() {
        let scene = scene(1.0, NOISES[1]);
        let mut offers = 0;
        let taken = scene.side_by_side(Arch::new(), 3..50, |_| {
            offers += 1;
            offers < 3
        });
        assert_eq!((offers, taken), (3, 2 * LANES as u64));
        assert_eq!(
            scene.side_by_side(Arch::new(), 3..3 + LANES as u64 - 1, |_| true),
            0
        );
    }

    #[test]
    fn half_a_turn_is_not_short() {
        let linear = |duration_s| scene(duration_s, "").linear.unwrap();
        assert!(linear(31.0).short(1, 0).is_some());
        assert!(linear(32.0).short(1, 0).is_none());
    }
}

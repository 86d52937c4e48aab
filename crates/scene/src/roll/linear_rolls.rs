//! Rolls with a linear closed form: the displacement of the contact is a constant matrix times the rotation.

use nalgebra::{Matrix2, Vector2};
use palpate_ep1::{BATCH_SIZE, BatchMoments, Moments, ProbeRotation};
use palpate_rolling::{Roller, Shift};
use palpate_sensing::{Channel, Distribution, Stream, Streams};
use palpate_study::config::Side;

use super::motion_noise::{MotionNoise, Roll};

/// Steady rolls on a plane, sphere, dish or cylinder, with the closed form. The sensor reports the commanded rotations.
#[derive(Clone, Debug)]
pub(super) struct LinearRolls {
    radius: f64,
    probes: Vec<LinearRoll>,
    error: Option<Distribution>,
}

#[derive(Clone, Copy, Debug)]
struct LinearRoll {
    commanded: [f64; 2],
    /// Change of the contact's displacement (length) per unit of the rotation's error about x. The unit is the standard
    /// deviation of the error or, for a uniform error, its bound.
    per_error_x: [f64; 2],
    per_error_y: [f64; 2],
    reported: ProbeRotation,
}

impl LinearRoll {
    fn new(
        mobility: &Matrix2<f64>,
        radius: f64,
        error: f64,
        Roll {
            command, rotation, ..
        }: &Roll,
    ) -> Self {
        let size = error * command.angular_velocity.norm() * command.duration_s;
        // If the probe turns by Δθ, the contact moves by the matrix `mobility` (displacement per radian) times (−Δθ_y,
        // Δθ_x).
        let path = |rotation: Vector2<f64>| -> [f64; 2] {
            (mobility * Vector2::new(-rotation.y, rotation.x)).into()
        };
        Self {
            commanded: path(command.rotation()),
            per_error_x: path(Vector2::new(size, 0.0)),
            per_error_y: path(Vector2::new(0.0, size)),
            reported: ProbeRotation::new(radius, rotation),
        }
    }

    #[inline(always)]
    fn path(&self, [error_x, error_y]: [f64; 2]) -> [f64; 2] {
        // Do not use a closure here. A closure that is not inlined would be compiled without the vector instructions of
        // its caller.
        let ([u, v], [u_x, v_x], [u_y, v_y]) = (self.commanded, self.per_error_x, self.per_error_y);
        [
            u + u_x * error_x + u_y * error_y,
            v + v_x * error_x + v_y * error_y,
        ]
    }
}

impl LinearRolls {
    /// Builds the closed form of the rolls of a scene. Returns `None` in three cases: the rolls have no linear closed
    /// form, the noise changes during a roll, or the noise is an error of the measured rotation.
    pub(super) fn new(
        roller: &Roller,
        rolls: &[Roll],
        noise: Option<&MotionNoise>,
    ) -> Option<Self> {
        let error = match noise {
            None => None,
            Some(MotionNoise {
                error,
                instants: 1,
                side: Side::Motion,
            }) => Some(error),
            Some(_) => return None,
        };
        let fraction = error.map_or(0.0, |error| error.fraction());
        let radius = roller.probe().radius();
        let mobility = roller.linear()?;
        Some(Self {
            radius,
            probes: rolls
                .iter()
                .map(|roll| LinearRoll::new(mobility, radius, fraction, roll))
                .collect(),
            error: error.map(|error| error.distribution()),
        })
    }

    /// Rolls every probe and returns the moments of the readings, that is, the sums from which least squares estimates
    /// the curvature. Returns `None` if a contact moves more than halfway around its probe, because the sensor would
    /// then read the shorter way around the probe instead of the path.
    #[inline(always)]
    pub(super) fn short(&self, seed: u64, trial: u64) -> Option<Moments> {
        let mut moments = Moments::default();
        let half_turn = self.half_turn_squared();
        let mut are_short = true;
        let mut stream = Stream::new(seed, trial, Channel::AngularVelocity);
        for probe in &self.probes {
            let path = probe.path(self.errors(&mut stream));
            are_short &= is_short(path, half_turn);
            moments.add_shifts(&probe.reported, path);
        }
        are_short.then_some(moments)
    }

    /// Rolls the probes in up to [`BATCH_SIZE`] trials, starting with trial number `first`. The moments of the readings
    /// (the sums that least squares needs) are stored in `many`. Returns the number of trials before the first trial
    /// for which [`LinearRolls::short`] would return `None`.
    ///
    /// The function is inlined, so that it uses the vector instructions of its caller.
    #[inline(always)]
    pub(super) fn side_by_side(
        &self,
        seed: u64,
        first: u64,
        count: usize,
        many: &mut ManyRolls,
    ) -> usize {
        let count = count.min(BATCH_SIZE);
        let half_turn = self.half_turn_squared();
        let mut streams = Streams::new(seed, first, Channel::AngularVelocity);
        for (number, &probe) in self.probes.iter().enumerate() {
            // Draw all errors in one loop and compute all paths in another. Processors execute several iterations of a
            // short loop at the same time.
            many.draw(self.error, &mut streams, count);
            match number {
                0 => many.add::<true>(probe, half_turn, count),
                _ => many.add::<false>(probe, half_turn, count),
            }
        }
        let long = &many.long[..count];
        // A path that is longer than halfway around the probe is very rare. So first test the number of such paths in
        // all trials, which is almost always 0.
        match long.iter().sum::<u64>() {
            0 => long.len(),
            _ => long.iter().take_while(|&&long| long == 0).count(),
        }
    }

    fn half_turn_squared(&self) -> f64 {
        let half_turn = std::f64::consts::PI * self.radius;
        half_turn * half_turn
    }

    /// Draws the errors of both components of a rotation, in units of the error's size (standard deviation or bound).
    #[inline(always)]
    fn errors(&self, stream: &mut Stream) -> [f64; 2] {
        match self.error {
            None => [0.0; 2],
            Some(distribution) => [distribution.draw(stream), distribution.draw(stream)],
        }
    }

    /// Rolls every probe and returns the moments of the readings, that is, the sums from which least squares estimates
    /// the curvature. The function `read` converts the displacement of the contact on the probe (logarithm map) to the
    /// reading of the sensor.
    pub(super) fn read<E>(
        &self,
        seed: u64,
        trial: u64,
        mut read: impl FnMut(Vector2<f64>) -> Result<Vector2<f64>, E>,
    ) -> Result<Moments, E> {
        let mut moments = Moments::default();
        let mut stream = Stream::new(seed, trial, Channel::AngularVelocity);
        for probe in &self.probes {
            let path = probe.path(self.errors(&mut stream));
            let shift = Shift::along_great_circle(path.into(), self.radius);
            let shift = read(shift.displacement)?;
            moments.add_shifts(&probe.reported, shift.into());
        }
        Ok(moments)
    }
}

#[inline(always)]
fn is_short([u, v]: [f64; 2], half_turn_squared: f64) -> bool {
    u * u + v * v <= half_turn_squared
}

#[derive(Clone, Debug)]
pub(super) struct ManyRolls {
    pub(super) moments: BatchMoments,
    long: [u64; BATCH_SIZE],
    /// For each trial, the errors of both components of the current probe's rotation. The unit is the standard
    /// deviation of the error or, for a uniform error, its bound.
    errors: [[f64; BATCH_SIZE]; 2],
}

impl Default for ManyRolls {
    fn default() -> Self {
        Self {
            moments: BatchMoments::default(),
            long: [0; BATCH_SIZE],
            errors: [[0.0; BATCH_SIZE]; 2],
        }
    }
}

impl ManyRolls {
    /// Draws the errors of a probe's rotation in the first `count` trials. If `error` is `None`, nothing is drawn.
    #[inline(always)]
    fn draw(
        &mut self,
        error: Option<Distribution>,
        streams: &mut Streams<BATCH_SIZE>,
        count: usize,
    ) {
        // Match the distribution outside of the loops, so that no loop has to test it.
        match error {
            None => (),
            Some(Distribution::Uniform) => {
                for place in 0..count {
                    self.errors[0][place] = streams.symmetric_uniform(place);
                    self.errors[1][place] = streams.symmetric_uniform(place);
                }
            }
            Some(Distribution::Gaussian) => {
                for place in 0..count {
                    self.errors[0][place] = streams.standard_normal(place);
                    self.errors[1][place] = streams.standard_normal(place);
                }
            }
        }
    }

    /// Adds the roll of a probe to the moments of each trial, that is, to the sums that least squares needs. If
    /// `IS_FIRST`, the old values of the sums are ignored, and the sums start from 0.
    #[inline(always)]
    fn add<const IS_FIRST: bool>(
        &mut self,
        probe: LinearRoll,
        half_turn_squared: f64,
        count: usize,
    ) {
        for place in 0..count {
            let path = probe.path([self.errors[0][place], self.errors[1][place]]);
            let (mut moments, long) = match IS_FIRST {
                true => Default::default(),
                false => (self.moments.at(place), self.long[place]),
            };
            moments.add_shifts(&probe.reported, path);
            self.moments.put(place, moments);
            self.long[place] = long + u64::from(!is_short(path, half_turn_squared));
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Arch, RollScene, Scene, Scenes};
    use palpate_study::config;
    use std::convert::Infallible;

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
    fn an_ideal_sensor_reads_the_paths() {
        for noise in NOISES {
            let scene = scene(1.0, noise);
            let linear = scene.linear.as_ref().unwrap();
            for trial in 0..20 {
                let reading = linear.read(scene.seed, trial, Ok::<_, Infallible>);
                assert_eq!(linear.short(scene.seed, trial), reading.ok());
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
            // Rolls of 31 s end about halfway around the probe. In some trials, they end beyond this point, and in
            // other trials before it.
            for duration_s in [1.0, 31.0] {
                let scene = scene(duration_s, noise);
                let (mut trial, mut together) = (0, 0);
                while trial < 500 {
                    let mut first = trial;
                    let taken = scene.side_by_side(Arch::new(), trial..500, |observed| {
                        let count = observed[0].estimates.len();
                        for place in 0..count {
                            let outcomes = scene.outcomes(first + place as u64).unwrap();
                            for (side_by_side, outcome) in observed.iter().zip(outcomes) {
                                assert_eq!(side_by_side.estimates[place], outcome.estimate);
                                assert_eq!(side_by_side.truth, outcome.truth);
                                assert_eq!(side_by_side.stds.map(|stds| stds[place]), outcome.std);
                            }
                        }
                        first += count as u64;
                        count
                    });
                    assert_eq!(first, trial + taken);
                    together += taken;
                    trial += taken.max(1);
                }
                assert!(
                    if duration_s == 1.0 {
                        together == 500
                    } else {
                        together > 0
                    },
                    "{noise}: {together}"
                );
            }
        }
    }

    #[test]
    fn trials_that_are_not_accepted_do_not_count() {
        let scene = scene(1.0, NOISES[1]);
        let mut offers = Vec::new();
        let taken = scene.side_by_side(Arch::new(), 3..1000, |observed| {
            offers.push(observed[4].estimates.len());
            if offers.len() < 3 { offers[0] } else { 5 }
        });
        assert_eq!(offers, [offers[0]; 3]);
        assert_eq!(taken, 2 * offers[0] as u64 + 5);
        assert_eq!(scene.side_by_side(Arch::new(), 3..3, |_| panic!("none")), 0);
    }

    #[test]
    fn half_a_turn_is_not_short() {
        let linear = |duration_s| scene(duration_s, "").linear.unwrap();
        assert!(linear(31.0).short(1, 0).is_some());
        assert!(linear(32.0).short(1, 0).is_none());
    }
}

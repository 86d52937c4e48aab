//! Rolls with a linear closed form: the displacement of the contact is a constant matrix times the rotation.

use nalgebra::{Matrix2, Vector2};
use palpate_ep1::{BATCH_SIZE, BatchMoments, Moments, ProbeRotation};
use palpate_rolling::{Roller, Shift};
use palpate_sensing::{Channel, Distribution, Stream};
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
            error: error.map(|error| error.distribution),
        })
    }

    /// Rolls the probes in up to [`BATCH_SIZE`] trials, starting with trial number `first`. The moments of the readings
    /// (the sums that least squares needs) are stored in `many`. Returns the number of trials before the first trial in
    /// which a contact moves more than halfway around its probe. The sensor would then read the shorter way around the
    /// probe instead of the path.
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
        let mut streams: [Stream; BATCH_SIZE] = std::array::from_fn(|place| {
            Stream::new(
                seed,
                first.wrapping_add(place as u64),
                Channel::AngularVelocity,
            )
        });
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
    #[inline(always)]
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
        streams: &mut [Stream; BATCH_SIZE],
        count: usize,
    ) {
        // Match the distribution outside of the loops, so that no loop has to test it.
        match error {
            None => (),
            Some(Distribution::Uniform) => {
                for (place, stream) in streams[..count].iter_mut().enumerate() {
                    self.errors[0][place] = stream.symmetric_uniform();
                    self.errors[1][place] = stream.symmetric_uniform();
                }
            }
            Some(Distribution::Gaussian) => {
                for (place, stream) in streams[..count].iter_mut().enumerate() {
                    self.errors[0][place] = stream.standard_normal();
                    self.errors[1][place] = stream.standard_normal();
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

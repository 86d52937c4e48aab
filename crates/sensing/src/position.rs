//! Errors of measured positions and displacements.

use nalgebra::{Point3, Vector3};
use palpate_statistics::BadSetting;

use crate::{Channel, Distribution, GaussianError, Stream};

/// The axes along which a measured position has an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PositionAxes {
    /// The position has errors along x, y and z. The three errors are independent and have the same size.
    Xyz,
    /// The position has an error along z, but not along x or y.
    Z,
}

/// Independent errors of the coordinates of a measured point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositionError {
    /// Distribution of the error of each component.
    pub distribution: Distribution,
    size: f64,
    /// Components of the position that have an error.
    pub axes: PositionAxes,
}

impl PositionError {
    /// An error of the size `size` (length) along each of the axes `axes`. The size is the standard deviation of a
    /// Gaussian, or the bound of a uniform distribution.
    ///
    /// # Errors
    /// [`BadSetting`] unless the size is from 0 to 10¹⁵⁰.
    pub fn new(
        distribution: Distribution,
        size: f64,
        axes: PositionAxes,
    ) -> Result<Self, BadSetting<String>> {
        let holds = (0.0..=1e150).contains(&size);
        BadSetting::unless(holds, "size", size, "from 0 to 1e150")?;
        Ok(Self {
            distribution,
            size,
            axes,
        })
    }

    /// Whether the error is random, that is, its size is not 0. Without an error, readings are exact, and no random
    /// numbers are drawn.
    pub fn is_random(&self) -> bool {
        self.size > 0.0
    }

    /// The measured position of `point`. Draws one random number for each axis with an error.
    #[inline]
    pub fn read(&self, stream: &mut Stream, point: &Point3<f64>) -> Point3<f64> {
        if !self.is_random() {
            return *point;
        }
        let mut draw = || self.size * self.distribution.draw(stream);
        let error = match self.axes {
            PositionAxes::Xyz => Vector3::new(draw(), draw(), draw()),
            PositionAxes::Z => Vector3::new(0.0, 0.0, draw()),
        };
        point + error
    }
}

/// Errors of the displacements of markers under a skin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MarkerNoise {
    /// Error of a marker's displacement along the normal of the skin.
    pub normal: GaussianError,
    /// Error of each component of a marker's displacement along the skin.
    pub tangential: GaussianError,
    /// Error of the sensor's gain, by which all normal displacements are multiplied.
    pub gain: GaussianError,
    /// Number of markers whose readings are outliers.
    pub outliers: usize,
    /// Additional error of each number in the reading of an outlier.
    pub outlier: GaussianError,
}

impl MarkerNoise {
    /// Adds the errors of a trial to the readings of all markers. A reading consists of the normal displacement and both
    /// components of the displacement along the skin; it is `None` for a marker that is not tracked. Errors are drawn
    /// for all markers. Therefore, the error of a marker does not depend on the tracking of other markers.
    pub fn add_to(&self, readings: &mut [Option<[f64; 3]>], seed: u64, trial: u64) {
        let stream = |channel| Stream::new(seed, trial, channel);
        let gain = 1.0 + self.gain.draw(&mut stream(Channel::Gain));
        let mut normals = stream(Channel::NormalDisplacement);
        let mut tangentials = stream(Channel::TangentialDisplacement);
        for reading in readings.iter_mut() {
            let normal = self.normal.draw(&mut normals);
            let [x, y] = [(); 2].map(|()| self.tangential.draw(&mut tangentials));
            if let Some(reading) = reading {
                *reading = [reading[0] * gain + normal, reading[1] + x, reading[2] + y];
            }
        }
        if self.outliers > 0 {
            let mut stream = stream(Channel::WrongMarkers);
            for marker in stream.choose(self.outliers, readings.len()) {
                let errors = [(); 3].map(|()| self.outlier.draw(&mut stream));
                if let Some(reading) = &mut readings[marker] {
                    *reading = std::array::from_fn(|number| reading[number] + errors[number]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Channel;
    use approx::assert_relative_eq;

    const POINT: Point3<f64> = Point3::new(0.5, -0.25, 2.0);

    #[test]
    fn errors_have_the_stated_size_along_the_stated_axes() {
        for distribution in [Distribution::Uniform, Distribution::Gaussian] {
            for (axes, erring) in [
                (PositionAxes::Xyz, [true; 3]),
                (PositionAxes::Z, [false, false, true]),
            ] {
                let sensor = PositionError::new(distribution, 0.3, axes).unwrap();
                let mut stream = Stream::new(11, 0, Channel::Position);
                let count = 100_000;
                let errors: Vec<Vector3<f64>> = (0..count)
                    .map(|_| sensor.read(&mut stream, &POINT) - POINT)
                    .collect();
                let mean = |value: &dyn Fn(&Vector3<f64>) -> f64| {
                    errors.iter().map(value).sum::<f64>() / f64::from(count)
                };
                for axis in 0..3 {
                    if !erring[axis] {
                        assert!(errors.iter().all(|error| error[axis] == 0.0));
                        continue;
                    }
                    assert!(mean(&|error| error[axis]).abs() < 0.004);
                    let std = mean(&|error| error[axis].powi(2)).sqrt();
                    assert_relative_eq!(std, distribution.std(0.3), max_relative = 0.01);
                    let next = (axis + 1) % 3;
                    assert!(mean(&|error| error[axis] * error[next]).abs() < 0.001);
                }
                let largest = errors.iter().map(|error| error.amax()).fold(0.0, f64::max);
                assert_eq!(largest <= 0.3, distribution == Distribution::Uniform);
            }
        }
    }
}

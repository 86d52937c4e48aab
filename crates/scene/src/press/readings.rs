//! Readings of a press, and their errors.

use palpate_sensing::{Channel, GaussianError, InvalidSensor, Stream};
use palpate_study::config::{GainNoise, LengthNoise, PressNoiseConfig};

use super::camera::Sight;
use palpate_estimators::MarkerImages;
use palpate_study::FieldError;

/// Readings of one press, and the other inputs of the estimator.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MarkerReadings {
    /// Indices of the tracked markers, in ascending order; `None` if all are tracked.
    pub(super) tracked: Option<Vec<usize>>,
    pub(super) normal: Vec<f64>,
    pub(super) tangential: Vec<[f64; 2]>,
    /// Indentation given to the estimator.
    pub(super) indentation: f64,
    /// The camera's reading of the markers; `None` with a direct sensor.
    pub(super) sight: Option<Sight>,
    /// MarkerImages of all markers of the layout; `None` with a direct sensor.
    pub(super) pictures: Option<MarkerImages>,
}

impl MarkerReadings {
    /// Removes the markers that were not tracked.
    pub(super) fn keep_tracked(&mut self) {
        if let Some(tracked) = &self.tracked {
            self.normal = tracked.iter().map(|&marker| self.normal[marker]).collect();
            self.tangential = tracked
                .iter()
                .map(|&marker| self.tangential[marker])
                .collect();
        }
    }
}

/// Errors of the readings of a press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MarkerNoise {
    /// Error of each normal displacement.
    pub(super) normal: GaussianError,
    /// Error of each component of each tangential displacement.
    pub(super) tangential: GaussianError,
    /// Error of the given indentation.
    pub(super) indentation: GaussianError,
    /// Error of the factor on all normal displacements.
    pub(super) gain: GaussianError,
    /// Number of outliers among the markers.
    pub(super) wrong_markers: usize,
    /// Additional error of the outliers.
    pub(super) wrong: GaussianError,
}

impl MarkerNoise {
    /// Noise of a config for this number of markers, averaged over `frames`.
    pub(super) fn of(
        config: &PressNoiseConfig,
        frames: u32,
        markers: usize,
    ) -> Result<Self, FieldError> {
        let length = |noise: &Option<LengthNoise>, key: &str| {
            gaussian(
                noise.as_ref().map(|LengthNoise::Gaussian { std }| *std),
                key,
            )
        };
        let gain = config.gain.as_ref().map(|GainNoise::Gaussian { std }| *std);
        let wrong = config.wrong_markers.as_ref();
        Ok(Self {
            wrong_markers: count_of(wrong.map(|wrong| wrong.count), "wrong_markers", markers)?,
            normal: length(&config.normal_displacement, "normal_displacement")?.averaged(frames),
            tangential: length(&config.tangential_displacement, "tangential_displacement")?
                .averaged(frames),
            indentation: length(&config.indentation, "indentation")?,
            gain: gaussian(gain, "gain")?,
            wrong: gaussian(wrong.map(|wrong| wrong.std), "wrong_markers")?,
        })
    }

    /// Whether trials differ; the flags state whether tangential displacements and the indentation are read.
    pub(super) fn is_random(&self, tangential: bool, indentation: bool) -> bool {
        self.normal.is_random()
            || (tangential && self.tangential.is_random())
            || (indentation && self.indentation.is_random())
            || self.gain.is_random()
            || self.errs_wildly()
    }

    fn errs_wildly(&self) -> bool {
        self.wrong_markers > 0 && self.wrong.is_random()
    }

    /// Adds the errors of a trial. Values that are not read draw too, so that scenes share random numbers.
    pub(super) fn add_to(&self, readings: &mut MarkerReadings, seed: u64, trial: u64) {
        let stream = |channel| Stream::new(seed, trial, channel);
        let gain = 1.0 + self.gain.draw(&mut stream(Channel::Gain));
        let mut of_normal = stream(Channel::NormalDisplacement);
        for normal in &mut readings.normal {
            *normal = *normal * gain + self.normal.draw(&mut of_normal);
        }
        let mut of_tangential = stream(Channel::TangentialDisplacement);
        for component in readings.tangential.iter_mut().flatten() {
            *component += self.tangential.draw(&mut of_tangential);
        }
        if self.errs_wildly() {
            let mut of_wrong = stream(Channel::WrongMarkers);
            for marker in of_wrong.choose(self.wrong_markers, readings.normal.len()) {
                readings.normal[marker] += self.wrong.draw(&mut of_wrong);
                for component in &mut readings.tangential[marker] {
                    *component += self.wrong.draw(&mut of_wrong);
                }
            }
        }
    }

    /// The error of the given indentation in a trial.
    pub(super) fn of_indentation(&self, seed: u64, trial: u64) -> f64 {
        let mut stream = Stream::new(seed, trial, Channel::Indentation);
        self.indentation.draw(&mut stream)
    }

    /// Line for `palpate check`: the errors, if there are any.
    pub(super) fn need(&self) -> Option<String> {
        let mut errors = Vec::new();
        let mut add = |is_random: bool, what: &str| {
            if is_random {
                errors.push(what.to_owned());
            }
        };
        add(
            self.normal.is_random(),
            "normal displacements, drawn per marker",
        );
        add(
            self.tangential.is_random(),
            "tangential displacements, drawn per marker and component",
        );
        add(self.indentation.is_random(), "the given indentation");
        add(self.gain.is_random(), "the gain of a press");
        add(self.errs_wildly(), "some markers, which are wrong");
        (!errors.is_empty()).then(|| format!("noise: Gaussian errors of {}", errors.join("; of ")))
    }
}

/// Gaussian error with this standard deviation, 0 by default; `noise` names its config field.
pub(super) fn gaussian(std: Option<f64>, noise: &str) -> Result<GaussianError, FieldError> {
    GaussianError::new(std.unwrap_or(0.0))
        .map_err(|error: InvalidSensor| FieldError::at(format!("scene.noise.{noise}.std"), error))
}

/// Number of markers that a noise affects; an error if it exceeds `markers`.
pub(super) fn count_of(
    count: Option<u32>,
    noise: &str,
    markers: usize,
) -> Result<usize, FieldError> {
    let count = count.unwrap_or(0) as usize;
    if count <= markers {
        return Ok(count);
    }
    let message = format!("must be at most the number of markers {markers}, is {count}");
    Err(FieldError::at(
        format!("scene.noise.{noise}.count"),
        message,
    ))
}

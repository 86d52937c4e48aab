//! The sensor of the 2020 paper, and simulated readings of its markers.

use std::f64::consts::FRAC_PI_2;

use palpate_press::{Body, Contact, ForwardFit, Markers, Measured, Reading, Skin};
use palpate_sensing::{Channel, Stream};

/// Radius of the skin, mm.
pub(crate) const RADIUS: f64 = 20.0;
/// Depth of the markers under the skin, mm.
pub(crate) const DEPTH: f64 = 2.0;

/// The 77 markers of the 2020 paper: one at the apex, and rows of 1, 3, 3, 5 and 7 markers in each of four gores
/// (quarters of the hemisphere). The rows are 11.9° of polar angle apart.
pub(crate) fn published() -> Markers {
    let mut positions = vec![[0.0, 0.0]];
    for gore in 0..4 {
        for (row, count) in [1, 3, 3, 5, 7].into_iter().enumerate() {
            let polar = 11.9 * (row + 1) as f64;
            for marker in 0..count {
                let share = (f64::from(marker) + 0.5) / f64::from(count);
                let azimuth = FRAC_PI_2 * (f64::from(gore) + share);
                positions.push(at(polar, azimuth.to_degrees()));
            }
        }
    }
    Markers::new(Skin::new(RADIUS).unwrap(), &positions).unwrap()
}

/// Markers on a great circle through the apex, at the distances `distances` from the apex along the skin.
pub(crate) fn along(distances: &[f64]) -> Markers {
    let positions: Vec<[f64; 2]> = distances.iter().map(|&distance| [distance, 0.0]).collect();
    Markers::new(Skin::new(RADIUS).unwrap(), &positions).unwrap()
}

/// Skin coordinates of the point at the polar angle `polar` and the azimuth `azimuth`, both in degrees.
pub(crate) fn at(polar: f64, azimuth: f64) -> [f64; 2] {
    let distance = RADIUS * polar.to_radians();
    let (sine, cosine) = libm::sincos(azimuth.to_radians());
    [distance * cosine, distance * sine]
}

pub(crate) fn half_space() -> Body {
    Body::half_space(0.5, DEPTH).unwrap()
}

pub(crate) fn fit_of(body: &Body, std: f64) -> ForwardFit {
    ForwardFit {
        normal_std: Some(std),
        ..ForwardFit::new(body.clone())
    }
}

/// Kolmogorov distance of the distribution of the p-values from the uniform distribution.
pub(crate) fn distance_from_uniform(mut p_values: Vec<f64>) -> f64 {
    p_values.sort_by(f64::total_cmp);
    let count = p_values.len() as f64;
    let apart = |(index, p_value): (usize, &f64)| {
        let rank = index as f64;
        (p_value - rank / count).max((rank + 1.0) / count - p_value)
    };
    p_values.iter().enumerate().map(apart).fold(0.0, f64::max)
}

/// Share of the trials with a misfit, which is a contradiction between readings and model. If `code` is given, only
/// misfits with this code count; with `None`, all misfits count.
pub(crate) fn misfit_share(codes: &[Vec<&str>], code: Option<&str>) -> f64 {
    let has = |one: &&Vec<&str>| code.map_or(!one.is_empty(), |code| one.contains(&code));
    codes.iter().filter(has).count() as f64 / codes.len() as f64
}

#[derive(Clone)]
pub(crate) struct Readings {
    pub(crate) normal: Vec<f64>,
    pub(crate) tangential: Vec<[f64; 2]>,
}

impl Readings {
    /// Readings that contain only inward displacements.
    pub(crate) fn inward(normal: Vec<f64>) -> Self {
        let tangential = Vec::new();
        Self { normal, tangential }
    }

    pub(crate) fn of(markers: &Markers, contact: &Contact<'_>, at: [f64; 2]) -> Self {
        let moved = markers.displacements(contact, at);
        Self {
            normal: moved.iter().map(|moved| moved.normal).collect(),
            tangential: moved.iter().map(|moved| moved.tangential).collect(),
        }
    }

    pub(crate) fn noisy(&self, std: f64, trial: u64) -> Self {
        let mut stream = Stream::new(2020, trial, Channel::Position);
        let mut readings = self.clone();
        for normal in &mut readings.normal {
            *normal += std * stream.standard_normal();
        }
        readings
    }

    pub(crate) fn noisy_along(&self, std: f64, tangential_std: f64, trial: u64) -> Self {
        let mut stream = Stream::new(2020, trial, Channel::Normal);
        let mut readings = self.noisy(std, trial);
        for along in readings.tangential.iter_mut().flatten() {
            *along += tangential_std * stream.standard_normal();
        }
        readings
    }

    pub(crate) fn reading<'a>(
        &'a self,
        markers: &'a Markers,
        indentation: Option<Measured>,
    ) -> Reading<'a> {
        Reading {
            markers,
            normal: &self.normal,
            tangential: None,
            indentation,
        }
    }
}

pub(crate) fn exactly(value: f64) -> Option<Measured> {
    measured(value, 0.0)
}

pub(crate) fn measured(value: f64, std: f64) -> Option<Measured> {
    Some(Measured { value, std })
}

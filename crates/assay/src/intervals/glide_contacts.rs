//! Contacts of fingers that slide over a random surface: paths, noise, and the noise that the estimator gets.

use nalgebra::Vector3;
use palpate_ep2::{Contact, Noise};
use palpate_sensing::{
    Channel, Distribution, InvalidSensor, NormalError, PositionAxes, PositionError, Stream,
};

use super::Draws;
use super::surface::{Place, Surface};

/// Standard deviations of positions, in finger distances, and of normals, degrees.
const NOISE_LEVELS: [(f64, Option<f64>); 9] = [
    (0.005, Some(0.5)),
    (0.02, Some(1.0)),
    (0.05, Some(2.0)),
    (0.1, Some(5.0)),
    (0.005, Some(5.0)),
    (0.1, Some(0.5)),
    (0.005, None),
    (0.02, None),
    (0.1, None),
];
/// Smallest and largest number of contacts of a finger.
const CONTACTS: [f64; 2] = [8.0, 14.0];
/// Smallest and largest half side of the patch, in finger distances.
const HALF_SIDES: [f64; 2] = [1.2, 1.8];
/// Side of the map of curvatures, as a share of the side of the patch.
const MAP_SHARE: f64 = 2.0 / 3.0;
/// Number of places along a side of the map.
const MAP_SIDE: usize = 10;

/// Number of fingers, and the noise of their contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GlideSetup {
    /// Number of fingers.
    pub(super) fingers: usize,
    /// Standard deviation of a coordinate, in finger distances.
    pub(super) position_std: f64,
    /// Distribution of the coordinates' errors.
    pub(super) distribution: Distribution,
    /// Standard deviation of the normals, degrees; `None` without normals.
    pub(super) normal_std_deg: Option<f64>,
    /// Whether the noise is stated to the estimator.
    pub(super) states_noise: bool,
}

/// All cases.
pub(super) fn cases() -> impl Iterator<Item = GlideSetup> {
    let noises = [Distribution::Gaussian, Distribution::Uniform];
    let noises = noises
        .into_iter()
        .flat_map(|distribution| [(distribution, false), (distribution, true)]);
    noises.flat_map(|(distribution, states_noise)| {
        [3, 5].into_iter().flat_map(move |fingers| {
            NOISE_LEVELS
                .into_iter()
                .map(move |(position_std, normal_std_deg)| GlideSetup {
                    fingers,
                    position_std,
                    distribution,
                    normal_std_deg,
                    states_noise,
                })
        })
    })
}

/// Path of the fingers over a surface.
pub(super) struct Path {
    half: f64,
    contacts: usize,
}

impl Path {
    /// The path over the surface with this number.
    pub(super) fn random(seed: u64, index: u64) -> Self {
        let mut draws = Draws::new(seed, index, Channel::PadOffset);
        Self {
            half: draws.between(HALF_SIDES),
            contacts: draws.between(CONTACTS) as usize,
        }
    }

    /// Places of the map of curvatures.
    pub(super) fn map_places(&self, surface: &Surface) -> Vec<Place> {
        let at = |index: usize| MAP_SHARE * self.half * share(index, MAP_SIDE);
        (0..MAP_SIDE * MAP_SIDE)
            .map(|index| surface.at(at(index / MAP_SIDE), at(index % MAP_SIDE)))
            .collect()
    }

    /// Places that the fingers touch, each with its finger.
    pub(super) fn contact_places(
        &self,
        surface: &Surface,
        fingers: usize,
    ) -> impl Iterator<Item = (usize, Place)> {
        (0..fingers * self.contacts).map(move |index| {
            let (finger, contact) = (index / self.contacts, index % self.contacts);
            let x = self.half * share(contact, self.contacts);
            (finger, surface.at(x, self.half * share(finger, fingers)))
        })
    }
}

/// Coordinate of one of `count` equally spaced places from −1 to 1.
fn share(index: usize, count: usize) -> f64 {
    2.0 * index as f64 / (count - 1) as f64 - 1.0
}

impl GlideSetup {
    /// Name of the setup in the tables.
    pub(super) fn name(&self) -> String {
        let normals = self
            .normal_std_deg
            .map_or("no normals".to_owned(), |std| format!("normals {std} deg"));
        let distribution = match self.distribution {
            Distribution::Gaussian => "Gaussian",
            Distribution::Uniform => "uniform",
        };
        let noise = if self.states_noise { "told" } else { "found" };
        format!(
            "{} fingers, {distribution} {} %, {normals}, noise {noise}",
            self.fingers,
            100.0 * self.position_std
        )
    }

    /// Noise that is stated to the estimator.
    pub(super) fn stated_noise(&self) -> Noise {
        if !self.states_noise {
            return Noise::default();
        }
        Noise {
            position_std: Some(self.position_std),
            normal_std_rad: self.normal_std_deg.map(f64::to_radians),
        }
    }

    /// Contacts of a trial.
    ///
    /// # Errors
    /// If a standard deviation is invalid.
    pub(super) fn contacts(
        &self,
        surface: &Surface,
        path: &Path,
        seed: u64,
        trial: u64,
    ) -> Result<Vec<Contact>, InvalidSensor> {
        let size = match self.distribution {
            Distribution::Gaussian => self.position_std,
            Distribution::Uniform => 3.0_f64.sqrt() * self.position_std,
        };
        let position = PositionError::new(self.distribution, size, PositionAxes::Xyz)?;
        let normal = self.normal_std_deg.map(f64::to_radians);
        let normal = normal.map(NormalError::new).transpose()?;
        let mut positions = Stream::new(seed, trial, Channel::Position);
        let mut normals = Stream::new(seed, trial, Channel::Normal);
        let places = path.contact_places(surface, self.fingers);
        Ok(places
            .map(|(finger, place)| {
                let point = position.read(&mut positions, &place.point);
                let reading: Option<Vector3<f64>> =
                    normal.map(|normal| normal.read(&mut normals, &place.normal));
                Contact::new(finger, point, reading)
            })
            .collect())
    }
}

#[cfg(test)]
impl GlideSetup {
    /// Configs of glides over a ball and a saddle, each with the kind of its surface.
    pub(super) fn configs(&self) -> [(&'static str, String); 2] {
        let half = 0.5 * (HALF_SIDES[0] + HALF_SIDES[1]);
        let fingers: Vec<f64> = (0..self.fingers)
            .map(|finger| half * share(finger, self.fingers))
            .collect();
        let (kind, size, field) = match self.distribution {
            Distribution::Gaussian => ("gaussian", self.position_std, "std"),
            Distribution::Uniform => ("uniform", 3.0_f64.sqrt() * self.position_std, "bound"),
        };
        let normals = self.normal_std_deg.is_some();
        let normal = self.normal_std_deg.unwrap_or(0.0);
        let noise = match (self.states_noise, normals) {
            (false, _) => String::new(),
            (true, false) => format!(", position_std = {}", self.position_std),
            (true, true) => format!(
                ", position_std = {}, normal_std_deg = {normal}",
                self.position_std
            ),
        };
        let objects = [
            ("ball", "kind = \"sphere\", radius = 20.0"),
            ("quadric and waves", "kind = \"saddle\", a = 0.12"),
        ];
        objects.map(|(on, object)| {
            let text = format!(
                r#"
                name = "a-glide"
                [scene]
                kind = "glide"
                probe = {{ kind = "point" }}
                object = {{ {object} }}
                motion = {{ finger_positions = {fingers:?}, inter_finger_distance = 1.0, patch_length = {}, contacts_per_finger = 10 }}
                sensor = {{ kind = "ideal", normals = {normals} }}
                noise = {{ position = {{ kind = "{kind}", {field} = {size} }}, normal = {{ kind = "gaussian", std_deg = {normal} }} }}
                estimator = {{ kind = "penalised"{noise} }}
                evaluate = {{ half_width = 0.5, gaussian_threshold = 0.01, mean_threshold = 0.1 }}
                "#,
                2.0 * half
            );
            (on, text)
        })
    }
}

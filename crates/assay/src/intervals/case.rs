//! Fingers, noise and what is told of it.

use nalgebra::Vector3;
use palpate_ep2::{Contact, Noise};
use palpate_sensing::{
    Channel, Distribution, InvalidSensor, NormalError, PositionAxes, PositionError, Stream,
};

use super::draws::Draws;
use super::surface::{Place, Surface};

/// Noise of positions, in distances between fingers, and of normals, degrees.
const LEVELS: [(f64, Option<f64>); 9] = [
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
/// Contacts of a finger: fewest and most.
const CONTACTS: [f64; 2] = [8.0, 14.0];
/// Half the side of the patch, in distances between fingers: smallest and largest.
const HALF_SIDES: [f64; 2] = [1.2, 1.8];
/// Part of the patch, along both sides, over which curvatures are asked.
const ASKED: f64 = 2.0 / 3.0;
/// Places a side of the map.
const SIDE: usize = 10;

/// Fingers that slide over a surface, and their noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Case {
    /// Number of fingers.
    pub(super) fingers: usize,
    /// Standard deviation of a coordinate, in distances between fingers.
    pub(super) position_std: f64,
    /// Distribution of the coordinates' errors.
    pub(super) distribution: Distribution,
    /// Standard deviation of the normals, degrees; `None` where there are none.
    pub(super) normal_std_deg: Option<f64>,
    /// Whether the estimator is told the noise.
    pub(super) is_told: bool,
}

/// All cases.
pub(super) fn cases() -> impl Iterator<Item = Case> {
    let noises = [Distribution::Gaussian, Distribution::Uniform];
    let told = noises
        .into_iter()
        .flat_map(|distribution| [(distribution, false), (distribution, true)]);
    told.flat_map(|(distribution, is_told)| {
        [3, 5].into_iter().flat_map(move |fingers| {
            LEVELS
                .into_iter()
                .map(move |(position_std, normal_std_deg)| Case {
                    fingers,
                    position_std,
                    distribution,
                    normal_std_deg,
                    is_told,
                })
        })
    })
}

/// Fingers' places on a surface.
pub(super) struct Sweep {
    half: f64,
    contacts: usize,
}

impl Sweep {
    /// The places on the surface of this number.
    pub(super) fn random(seed: u64, index: u64) -> Self {
        let mut draws = Draws::new(seed, index, Channel::PadOffset);
        Self {
            half: draws.between(HALF_SIDES),
            contacts: draws.between(CONTACTS) as usize,
        }
    }

    /// Places at which curvatures are asked.
    pub(super) fn asked(&self, surface: &Surface) -> Vec<Place> {
        let at = |index: usize| ASKED * self.half * share(index, SIDE);
        (0..SIDE * SIDE)
            .map(|index| surface.at(at(index / SIDE), at(index % SIDE)))
            .collect()
    }

    /// Fingers, and the places that they touch.
    pub(super) fn touched(
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

/// The place of one of equally spaced items from −1 to 1.
fn share(index: usize, count: usize) -> f64 {
    2.0 * index as f64 / (count - 1) as f64 - 1.0
}

impl Case {
    /// The case in words.
    pub(super) fn name(&self) -> String {
        let normals = self
            .normal_std_deg
            .map_or("no normals".to_owned(), |std| format!("normals {std} deg"));
        let distribution = match self.distribution {
            Distribution::Gaussian => "Gaussian",
            Distribution::Uniform => "uniform",
        };
        let told = if self.is_told { "told" } else { "found" };
        format!(
            "{} fingers, {distribution} {} %, {normals}, noise {told}",
            self.fingers,
            100.0 * self.position_std
        )
    }

    /// Noise that the estimator is told.
    pub(super) fn told(&self) -> Noise {
        if !self.is_told {
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
    /// None that a case of these makes.
    pub(super) fn contacts(
        &self,
        surface: &Surface,
        sweep: &Sweep,
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
        let touched = sweep.touched(surface, self.fingers);
        Ok(touched
            .map(|(finger, place)| {
                let point = position.read(&mut positions, &place.point);
                let sensed: Option<Vector3<f64>> =
                    normal.map(|normal| normal.read(&mut normals, &place.normal));
                Contact::new(finger, point, sensed)
            })
            .collect())
    }
}

#[cfg(test)]
impl Case {
    /// Glides over a ball and a saddle as configs, with the surfaces' name.
    pub(super) fn texts(&self) -> [(&'static str, String); 2] {
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
        let told = match (self.is_told, normals) {
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
                estimator = {{ kind = "penalised"{told} }}
                evaluate = {{ half_width = 0.5, gaussian_threshold = 0.01, mean_threshold = 0.1 }}
                "#,
                2.0 * half
            );
            (on, text)
        })
    }
}

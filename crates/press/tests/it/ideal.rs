//! A simple camera for tests. It computes the image of a marker by a formula, and the sensor can have any size.

use std::sync::Arc;

use palpate_press::{Body, ImageFit, MarkerDisplacement, Markers, SensorState, Skin, View};

/// Radius of the skin, in multiples of `Ideal::unit`.
pub(crate) const RADIUS: f64 = 20.0;
/// Standard deviations of the readings of a marker: both centroid coordinates (px), hue (turns), and logarithm of the
/// size.
pub(crate) const STDS: [f64; 4] = [0.01, 0.01, 1e-4, 4e-4];
/// Standard deviations of the uncertain sensor parameters: both disc depths (in multiples of `Ideal::unit`), both
/// coordinates of the image centre, and pixels per radian.
pub(crate) const ROUGHLY: [f64; 5] = [0.02, 0.02, 0.3, 0.3, 0.01];
/// Depths of the magenta and the yellow discs, in multiples of `Ideal::unit`.
const DEPTHS: [f64; 2] = [3.0, 1.0];

/// A simple camera. The centroid of an image is the position midway between the marker's two discs. The hue is a
/// function of the distance between the discs, and the size is a function of the discs' distance from the camera.
#[derive(Clone, Debug)]
pub(crate) struct Ideal {
    /// Unit of length of the sensor. All lengths that are constants of this module are in this unit.
    pub(crate) unit: f64,
    pub(crate) places: Vec<[f64; 2]>,
}

impl Ideal {
    pub(crate) fn new(unit: f64) -> Self {
        let place = |i: i32| [i % 9 - 4, i / 9 - 4].map(|step| 2.0 * f64::from(step) * unit);
        Self {
            unit,
            places: (0..81).map(place).collect(),
        }
    }

    pub(crate) fn skin(&self) -> Skin {
        Skin::new(RADIUS * self.unit).unwrap()
    }

    pub(crate) fn markers(&self) -> Markers {
        Markers::new(self.skin(), &self.places).unwrap()
    }

    /// Models of the soft body for both discs, at the depths [`DEPTHS`] plus `deeper`. If `layer` contains a thickness,
    /// the bodies are bonded layers of this thickness; otherwise they are half-spaces. Lengths are in multiples of
    /// `unit`.
    pub(crate) fn bodies(&self, layer: Option<f64>, deeper: [f64; 2]) -> [Body; 2] {
        [0, 1].map(|disc| {
            let depth = (DEPTHS[disc] + deeper[disc]) * self.unit;
            match layer {
                Some(thickness) => Body::bonded_layer(thickness * self.unit, depth),
                None => Body::half_space(0.5, depth),
            }
            .unwrap()
        })
    }

    pub(crate) fn fit(&self, layer: Option<f64>, common_stds: [f64; 5]) -> ImageFit {
        let [magenta, yellow, rest @ ..] = common_stds;
        let [magenta, yellow] = [magenta, yellow].map(|std| std * self.unit);
        let deeper = 0.02;
        ImageFit {
            view: Arc::new(self.clone()),
            markers: self.markers(),
            bodies: self.bodies(layer, [0.0; 2]),
            deeper: Some((deeper * self.unit, self.bodies(layer, [deeper; 2]))),
            common_stds: [magenta, yellow].into_iter().chain(rest).collect(),
            departure_prior: None,
            misalignment_std: 0.02,
            shift_std: 0.0,
        }
    }
}

impl View for Ideal {
    fn pictures(
        &self,
        sensor: &SensorState<'_>,
        moved: &[[MarkerDisplacement; 2]],
    ) -> Option<Vec<Option<[f64; 4]>>> {
        let [magenta_deeper, yellow_deeper, x, y, scale] = sensor.common.try_into().ok()?;
        let radius = RADIUS * self.unit;
        let markers = self.places.iter().zip(moved).zip(sensor.misalignments);
        let picture =
            |((place, discs), misaligned): ((&[f64; 2], &[MarkerDisplacement; 2]), &[f64; 2])| {
                let [magenta, yellow] = discs;
                let along = |axis: usize| {
                    let middle = 0.5 * (magenta.tangential[axis] + yellow.tangential[axis]);
                    300.0
                        * (1.0 + scale)
                        * ((place[axis] + middle) / radius + 0.5 * misaligned[axis])
                };
                let apart = |axis: usize| {
                    misaligned[axis] + (yellow.tangential[axis] - magenta.tangential[axis]) / radius
                };
                let near = [
                    17.0 - (magenta_deeper + magenta.normal) / self.unit,
                    19.0 - (yellow_deeper + yellow.normal) / self.unit,
                ];
                let nearness = libm::log(near[0] * near[1]);
                let gap = near[1] - near[0];
                Some([
                    x + along(0),
                    -y - along(1),
                    (0.95 + 0.02 * gap + 0.3 * apart(0) + 0.2 * apart(1)).rem_euclid(1.0),
                    6.0 - nearness,
                ])
            };
        Some(markers.map(picture).collect())
    }
}

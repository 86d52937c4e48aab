//! The true values of a press: its geometry, its contact, and the displacements of markers and discs.

use std::f64::consts::FRAC_PI_2;

use palpate_chromatouch::{DiscMotion, MarkerMotion};
use palpate_estimators::{body_error, sensor_body, within_sensor};
use palpate_press::{
    Body, MarkerDisplacement, Markers, ObjectContact, ObjectPress, PressError, skin_widening,
};
use palpate_statistics::Number;
use palpate_study::FieldError;
use palpate_study::config::{DiscsConfig, PressConfig, PressModelConfig, PressObjectConfig};

use super::plan::PressSetup;

/// True values of a press. The sensor reads them with errors; the estimator does not receive them.
#[derive(Clone, Debug)]
pub(super) struct TruePress {
    pub(super) geometry: ObjectPress,
    pub(super) contact_radius: f64,
    /// Contact force divided by Young's modulus of the soft body (length²); `None` if it is not finite.
    pub(super) force_per_young: Option<f64>,
    /// Displacements of the markers, at the points midway between their two discs.
    pub(super) markers: Vec<MarkerDisplacement>,
    /// Motions of both discs of each marker; empty if there is no camera.
    pub(super) discs: Vec<MarkerMotion>,
}

impl TruePress {
    /// Computes the true values of a press from its true contact. If there is a camera, `discs` contains the discs of
    /// the markers.
    pub(super) fn new(
        setup: &PressSetup<'_>,
        contact: &ObjectContact<'_>,
        discs: Option<&DiscMarkers<'_>>,
    ) -> Result<Self, PressError> {
        let geometry = setup.geometry;
        let motions = discs.map(|discs| discs.motions(geometry));
        Ok(Self {
            geometry: *geometry,
            contact_radius: contact.radius(),
            force_per_young: contact.force(1.0),
            markers: geometry.displacements_by(contact, setup.body, setup.markers)?,
            discs: motions.transpose()?.unwrap_or_default(),
        })
    }
}

/// The object of a config and its press into a skin with the radius `radius`.
pub(super) fn object_press(config: &PressConfig, radius: f64) -> Result<ObjectPress, FieldError> {
    let motion = &config.motion;
    if motion.shift.abs() >= radius {
        let [radius, shift] = [radius, motion.shift].map(Number);
        let message = format!("|shift| must be less than the sensor's radius {radius}, is {shift}");
        return Err(FieldError::at("scene.motion.shift", message));
    }
    let (unequal, axis) = unequal_curvatures(&config.object).unzip();
    let curvature = match unequal {
        Some([smaller, larger]) => 0.5 * smaller + 0.5 * larger,
        None => object_radius(&config.object).map_or(0.0, f64::recip),
    };
    Ok(ObjectPress {
        curvature,
        unequal,
        axis: axis.unwrap_or(0.0),
        indentation: motion.indentation,
        at: contact_place(motion.contact_deg, radius)?,
        shift: motion.shift,
    })
}

/// Radius R_o of the object, negative for a dish; `None` for a plane, and for an object with two different curvatures.
pub(super) fn object_radius(config: &PressObjectConfig) -> Option<f64> {
    match *config {
        PressObjectConfig::Sphere { radius } => Some(radius),
        PressObjectConfig::Dish { radius } => Some(-radius),
        PressObjectConfig::Ellipsoid {
            semi_axes: [x, y, z],
        } => (x == y).then(|| x * (x / z)),
        PressObjectConfig::Plane {} | PressObjectConfig::Cylinder { .. } => None,
    }
}

/// The smaller and the larger curvature of the object, and the angle (radians) between the direction of the smaller one
/// and the x axis; `None` for an object with the same curvature in all directions.
fn unequal_curvatures(config: &PressObjectConfig) -> Option<([f64; 2], f64)> {
    match *config {
        PressObjectConfig::Cylinder {
            radius,
            direction_deg,
        } => Some(([0.0, radius.recip()], direction_deg.to_radians())),
        PressObjectConfig::Ellipsoid {
            semi_axes: [x, y, z],
        } if x != y => Some(match ((z / x) / x, (z / y) / y) {
            (along_x, along_y) if along_x < along_y => ([along_x, along_y], 0.0),
            (along_x, along_y) => ([along_y, along_x], FRAC_PI_2),
        }),
        _ => None,
    }
}

/// Chart coordinates of the point of the skin at the angles `polar` and `azimuth`.
fn contact_place([polar, azimuth]: [f64; 2], radius: f64) -> Result<[f64; 2], FieldError> {
    if !(0.0..=180.0).contains(&polar) {
        let message = format!(
            "the polar angle must be from 0 to 180, is {}",
            Number(polar)
        );
        return Err(FieldError::at("scene.motion.contact_deg", message));
    }
    if polar == 0.0 {
        return Ok([0.0; 2]);
    }
    if radius == f64::INFINITY {
        let message = "must be 0 on a flat pad, which has no polar angles";
        return Err(FieldError::at("scene.motion.contact_deg", message));
    }
    let distance = radius * polar.to_radians();
    let (sine, cosine) = libm::sincos(azimuth.to_radians());
    Ok([distance * cosine, distance * sine])
}

/// Builds the soft body for a model, and for a sensor with the radius `radius`. Displacements are computed at the depth
/// `depth` under the skin. If the body is a layer, `layer` builds it from its thickness and this depth.
pub(super) fn soft_body(
    model: &PressModelConfig,
    radius: f64,
    depth: f64,
    layer: impl Fn(f64, f64) -> Result<Body, PressError>,
) -> Result<Body, FieldError> {
    if let Some(thickness) = model.thickness() {
        within_sensor("scene.model.thickness", thickness, radius)?;
    }
    sensor_body(model, depth, layer).map_err(|error| body_error("scene.model", error))
}

struct Discs {
    body: Body,
    /// Computes the strain of the discs from the strain of the skin; `None` if the discs do not follow the strain of
    /// the skin.
    strain: Option<DiscStrain>,
}

impl Discs {
    fn motions(
        &self,
        markers: &Markers,
        geometry: &ObjectPress,
    ) -> Result<Vec<DiscMotion>, PressError> {
        let mut motions = disc_motions(&geometry.displacements(&self.body, markers)?);
        if let Some(strain) = &self.strain {
            let widened = strain.skin_stretches(markers, geometry)?;
            for (motion, skin) in motions.iter_mut().zip(widened) {
                (motion.stretch, motion.skin_stretch) = (strain.share * skin, skin);
            }
        }
        Ok(motions)
    }
}

/// Motions of discs that do not follow the strain of the skin.
pub(super) fn disc_motions(moved: &[MarkerDisplacement]) -> Vec<DiscMotion> {
    let motion = |moved: &MarkerDisplacement| DiscMotion {
        normal: moved.normal,
        tangential: moved.tangential,
        ..DiscMotion::default()
    };
    moved.iter().map(motion).collect()
}

pub(super) fn marker_motions([magenta, yellow]: [Vec<DiscMotion>; 2]) -> Vec<MarkerMotion> {
    let discs = magenta.into_iter().zip(yellow);
    discs
        .map(|(magenta, yellow)| MarkerMotion { magenta, yellow })
        .collect()
}

pub(super) struct DiscMarkers<'a> {
    markers: &'a Markers,
    midway: &'a Body,
    magenta: Discs,
    yellow: Discs,
}

impl<'a> DiscMarkers<'a> {
    pub(super) fn new(setup: &PressSetup<'a>) -> Result<Self, FieldError> {
        let (sphere, model) = (setup.sphere, setup.model);
        let depths = sphere.disc_depths()?;
        let layer = |thickness, depth| setup.models.layer(thickness, depth);
        let body = |depth: f64| soft_body(model, sphere.radius, depth, layer);
        let deepest = model.thickness().unwrap_or(sphere.radius);
        let strains = sphere.discs.and_then(DiscsConfig::strains);
        let discs = |depth, colour: usize| {
            let strain = strains.map(|shares| {
                DiscStrain::new(shares[colour], depth, (sphere.radius, deepest), body)
            });
            Ok(Discs {
                strain: strain.transpose()?,
                body: body(depth)?,
            })
        };
        Ok(Self {
            markers: setup.markers,
            midway: setup.body,
            magenta: discs(depths.magenta, 0)?,
            yellow: discs(depths.yellow, 1)?,
        })
    }

    pub(super) fn displacements(
        &self,
        geometry: &ObjectPress,
    ) -> Result<Vec<MarkerDisplacement>, PressError> {
        geometry.displacements(self.midway, self.markers)
    }

    pub(super) fn motions(&self, geometry: &ObjectPress) -> Result<Vec<MarkerMotion>, PressError> {
        let magenta = self.magenta.motions(self.markers, geometry)?;
        let yellow = self.yellow.motions(self.markers, geometry)?;
        Ok(marker_motions([magenta, yellow]))
    }

    pub(super) fn nearest(&self, place: [f64; 2]) -> Option<usize> {
        let distances = self.markers.distances(place);
        (0..distances.len()).min_by(|one, other| distances[*one].total_cmp(&distances[*other]))
    }
}

/// Distance from a disc, as a share of the sensor's radius. The displacements of the skin at this distance above and
/// below the disc determine the strain of the disc.
const STRAIN_STEP: f64 = 0.0025;

/// Models of the skin just above and just below the discs of one colour. The difference between the displacements of
/// the two models determines the strain of the discs.
struct DiscStrain {
    /// Strain of the discs, divided by the strain of the skin. 1 means that the discs strain as much as the skin.
    share: f64,
    above: Body,
    below: Body,
    /// Difference (length) between the depths at which `above` and `below` compute displacements.
    apart: f64,
}

impl DiscStrain {
    /// Models of the skin just above and just below discs at the depth `depth`. The depth of the lower model is at most
    /// `deepest`. The function `body` builds the soft body for a depth.
    fn new(
        share: f64,
        depth: f64,
        (radius, deepest): (f64, f64),
        body: impl Fn(f64) -> Result<Body, FieldError>,
    ) -> Result<Self, FieldError> {
        let step = STRAIN_STEP * radius;
        let [above, below] = [(depth - step).max(0.0), (depth + step).min(deepest)];
        Ok(Self {
            share,
            above: body(above)?,
            below: body(below)?,
            apart: below - above,
        })
    }

    /// Relative widening of the skin around each disc in a press.
    fn skin_stretches(
        &self,
        markers: &Markers,
        geometry: &ObjectPress,
    ) -> Result<Vec<f64>, PressError> {
        let above = geometry.displacements(&self.above, markers)?;
        let below = geometry.displacements(&self.below, markers)?;
        Ok(skin_widening(&above, &below, self.apart))
    }
}

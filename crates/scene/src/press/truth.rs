//! The true values of a press: its geometry, its contact, and the displacements of markers and discs.

use std::f64::consts::FRAC_PI_2;

use palpate_chromatouch::{DiscMotion, MarkerMotion};
use palpate_estimators::{MarkerSphere, body_error, sensor_body, within_sensor};
use palpate_press::{
    Body, Contact, Displacement, EllipticContact, MarkerDisplacement, Markers, PressError,
    skin_widening, within_object,
};
use palpate_statistics::Number;
use palpate_study::FieldError;
use palpate_study::config::{DiscsConfig, PressConfig, PressModelConfig, PressObjectConfig};

use crate::cache::SharedModels;

/// True values of a press. The sensor reads them with errors; the estimator does not receive them.
#[derive(Clone, Debug)]
pub(super) struct TruePress {
    pub(super) geometry: PressGeometry,
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
        body: &Body,
        markers: &Markers,
        geometry: &PressGeometry,
        contact: &TrueContact<'_>,
        discs: Option<&DiscMarkers<'_>>,
    ) -> Result<Self, PressError> {
        let motions = discs.map(|discs| discs.motions(geometry));
        Ok(Self {
            geometry: *geometry,
            contact_radius: contact.radius(),
            force_per_young: contact.force(1.0),
            markers: geometry.displacements_by(contact, body, markers)?,
            discs: motions.transpose()?.unwrap_or_default(),
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TouchedObject {
    /// Curvature 1/R_o of the object, positive if the object is convex. If the object has two different curvatures,
    /// `curvature` is their mean.
    pub(super) curvature: f64,
    /// Radius R_o of the object, negative for a dish; `None` for a plane, and for an object with two different
    /// curvatures.
    pub(super) radius: Option<f64>,
    /// The principal curvatures of the object; `None` if they are equal.
    pub(super) principal: Option<UnequalCurvatures>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct UnequalCurvatures {
    pub(super) smaller: f64,
    pub(super) larger: f64,
    /// Angle between the direction of the smaller curvature and the x axis at the contact (radians).
    pub(super) axis: f64,
}

impl TouchedObject {
    const PLANE: Self = Self {
        curvature: 0.0,
        radius: None,
        principal: None,
    };

    fn new(config: &PressObjectConfig) -> Self {
        let round = |radius: f64| Self {
            curvature: radius.recip(),
            radius: Some(radius),
            principal: None,
        };
        let unequal = |smaller: f64, larger: f64, axis: f64| Self {
            curvature: 0.5 * smaller + 0.5 * larger,
            radius: None,
            principal: Some(UnequalCurvatures {
                smaller,
                larger,
                axis,
            }),
        };
        match *config {
            PressObjectConfig::Sphere { radius } => round(radius),
            PressObjectConfig::Dish { radius } => round(-radius),
            PressObjectConfig::Plane {} => Self::PLANE,
            PressObjectConfig::Cylinder {
                radius,
                direction_deg,
            } => unequal(0.0, radius.recip(), direction_deg.to_radians()),
            PressObjectConfig::Ellipsoid {
                semi_axes: [x, y, z],
            } => match ((z / x) / x, (z / y) / y) {
                _ if x == y => round(x * (x / z)),
                (along_x, along_y) if along_x < along_y => unequal(along_x, along_y, 0.0),
                (along_x, along_y) => unequal(along_y, along_x, FRAC_PI_2),
            },
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PressGeometry {
    pub(super) object: TouchedObject,
    pub(super) indentation: f64,
    /// Coordinates of the contact in the chart of the skin.
    pub(super) at: [f64; 2],
    /// Sideways displacement (length) of the object along x, which begins after the object has touched the skin.
    pub(super) shift: f64,
}

impl PressGeometry {
    pub(super) fn new(config: &PressConfig, radius: f64) -> Result<Self, FieldError> {
        let motion = &config.motion;
        if motion.shift.abs() >= radius {
            let [radius, shift] = [radius, motion.shift].map(Number);
            let message =
                format!("|shift| must be less than the sensor's radius {radius}, is {shift}");
            return Err(FieldError::at("scene.motion.shift", message));
        }
        Ok(Self {
            object: TouchedObject::new(&config.object),
            indentation: motion.indentation,
            at: contact_place(motion.contact_deg, radius)?,
            shift: motion.shift,
        })
    }

    pub(super) const fn on_plane(indentation: f64) -> Self {
        Self {
            object: TouchedObject::PLANE,
            indentation,
            at: [0.0; 2],
            shift: 0.0,
        }
    }

    pub(super) fn contact<'b>(
        &self,
        body: &'b Body,
        markers: &Markers,
    ) -> Result<TrueContact<'b>, PressError> {
        let skin = markers.skin();
        if let Some(principal) = self.object.principal {
            let what = "a layer has no model of an object with two different curvatures";
            let half_space = body.sideways().ok_or(PressError::Undetermined { what });
            let (poisson, depth) = half_space?;
            let curvatures = [principal.smaller, principal.larger];
            let contact = skin.elliptic_contact(poisson, curvatures, self.indentation)?;
            return Ok(TrueContact::Elliptic(contact, depth));
        }
        let object = self.object.curvature;
        let contact = skin.contact(body, object, self.indentation)?;
        within_object(object, contact.radius)?;
        Ok(TrueContact::Round(contact))
    }

    /// Displacements of the markers by the contact and by the sideways shift of the object. During the shift, the skin
    /// sticks to the object.
    fn displacements_by(
        &self,
        contact: &TrueContact<'_>,
        body: &Body,
        markers: &Markers,
    ) -> Result<Vec<MarkerDisplacement>, PressError> {
        let Self { at, shift, .. } = *self;
        let axis = self.object.principal.map_or(0.0, |both| both.axis);
        let mut moved = match contact {
            TrueContact::Round(contact) => markers.displacements(contact, at),
            TrueContact::Elliptic(contact, depth) => {
                markers.elliptic_displacements(contact, at, axis, *depth)
            }
        };
        if let Some((poisson, depth)) = body.sideways().filter(|_| shift != 0.0) {
            let sideways = markers.shifted(poisson, depth, contact.radius(), at, shift)?;
            for (moved, more) in moved.iter_mut().zip(sideways) {
                moved.normal += more.normal;
                moved.tangential =
                    [0, 1].map(|axis| moved.tangential[axis] + more.tangential[axis]);
            }
        }
        Ok(moved)
    }

    pub(super) fn displacements(
        &self,
        body: &Body,
        markers: &Markers,
    ) -> Result<Vec<MarkerDisplacement>, PressError> {
        self.displacements_by(&self.contact(body, markers)?, body, markers)
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

#[derive(Clone, Debug)]
pub(super) enum TrueContact<'b> {
    /// Contact with an object that has the same curvature in all directions.
    Round(Contact<'b>),
    /// Contact with an object that has two different curvatures. The number is the depth under the skin at which
    /// displacements are computed.
    Elliptic(EllipticContact, f64),
}

impl TrueContact<'_> {
    /// Radius of the contact. For an elliptic contact, the radius is the geometric mean of the semi-axes.
    pub(super) fn radius(&self) -> f64 {
        match self {
            Self::Round(contact) => contact.radius,
            Self::Elliptic(contact, _) => contact.radius(),
        }
    }

    /// Force between the bodies; `None` if it is not finite. `young` is the Young's modulus of the soft body. The unit
    /// of the force is the unit of `young` times length².
    fn force(&self, young: f64) -> Option<f64> {
        match self {
            Self::Round(contact) => contact.force(young),
            Self::Elliptic(contact, _) => Some(contact.force(young)).filter(|one| one.is_finite()),
        }
    }

    /// Displacement of points at a fixed depth under the skin, at the distance `distance` from the middle of the
    /// contact. For an elliptic contact, the distance is along the longer axis.
    pub(super) fn displacement(&self, distance: f64) -> Displacement {
        match self {
            Self::Round(contact) => contact.displacement(distance),
            Self::Elliptic(contact, depth) => {
                let moved = contact.displacement(distance, 0.0, *depth);
                Displacement {
                    normal: moved.normal,
                    radial: moved.tangential[0],
                }
            }
        }
    }
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
        geometry: &PressGeometry,
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
    pub(super) fn new(
        sphere: &MarkerSphere<'_>,
        model: &PressModelConfig,
        markers: &'a Markers,
        midway: &'a Body,
        models: &SharedModels,
    ) -> Result<Self, FieldError> {
        let depths = sphere.disc_depths()?;
        let layer = |thickness, depth| models.layer(thickness, depth);
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
            markers,
            midway,
            magenta: discs(depths.magenta, 0)?,
            yellow: discs(depths.yellow, 1)?,
        })
    }

    pub(super) fn displacements(
        &self,
        geometry: &PressGeometry,
    ) -> Result<Vec<MarkerDisplacement>, PressError> {
        geometry.displacements(self.midway, self.markers)
    }

    pub(super) fn motions(
        &self,
        geometry: &PressGeometry,
    ) -> Result<Vec<MarkerMotion>, PressError> {
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
        geometry: &PressGeometry,
    ) -> Result<Vec<f64>, PressError> {
        let above = geometry.displacements(&self.above, markers)?;
        let below = geometry.displacements(&self.below, markers)?;
        Ok(skin_widening(&above, &below, self.apart))
    }
}

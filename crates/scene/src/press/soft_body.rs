//! The soft body of a sensor: how a press displaces points at a depth under its skin.

use palpate_number::{BadSetting, Number};
use palpate_press::{Body, Contact, MarkerDisplacement, Markers, PressError, within_object};
use palpate_study::config::PressModelConfig;

use super::method::body_of;
use super::pressed::Pressed;
use crate::plan::PlanError;

/// Soft body of one model that displaces points at one depth.
#[derive(Clone, Debug)]
pub(super) struct SoftBody {
    pub(super) body: Body,
    /// Poisson's ratio, and the depth of the points in the model; `None` if the body cannot be moved sideways.
    sideways: Option<(f64, f64)>,
}

impl SoftBody {
    /// Builds the body of a model for a sensor of `radius`; `layer` builds a layer from its thickness and depth.
    pub(super) fn of(
        model: &PressModelConfig,
        radius: f64,
        depth: f64,
        layer: impl Fn(f64, f64) -> Result<Body, PressError>,
    ) -> Result<Self, PlanError> {
        if let Some(thickness) = model.thickness() {
            within_sensor("scene.model.thickness", thickness, radius)?;
        }
        let sideways = match model.reference() {
            PressModelConfig::HalfSpace { poisson } => Some((poisson, depth)),
            PressModelConfig::Hertz { poisson } => Some((poisson, 0.0)),
            PressModelConfig::BondedLayer { .. } | PressModelConfig::Auto { .. } => None,
        };
        let body = body_of(model, depth, layer).map_err(|error| of_body("scene.model", error))?;
        Ok(Self { body, sideways })
    }

    /// The contact of a press with the skin of these markers.
    pub(super) fn contact(
        &self,
        markers: &Markers,
        pressed: &Pressed,
    ) -> Result<Contact<'_>, PressError> {
        let object = pressed.object.curvature;
        let contact = markers
            .skin()
            .contact(&self.body, object, pressed.indentation)?;
        within_object(object, contact.radius)?;
        Ok(contact)
    }

    /// Displacements of the markers by this contact and the object's sideways shift, during which it sticks.
    pub(super) fn moved(
        &self,
        markers: &Markers,
        pressed: &Pressed,
        contact: &Contact<'_>,
    ) -> Result<Vec<MarkerDisplacement>, PressError> {
        let Pressed { at, shift, .. } = *pressed;
        let mut moved = markers.displacements(contact, at);
        if let Some((poisson, depth)) = self.sideways.filter(|_| shift != 0.0) {
            let sideways = markers.shifted(poisson, depth, contact.radius, at, shift)?;
            for (moved, more) in moved.iter_mut().zip(sideways) {
                moved.normal += more.normal;
                moved.tangential =
                    [0, 1].map(|axis| moved.tangential[axis] + more.tangential[axis]);
            }
        }
        Ok(moved)
    }

    /// Displacements of the markers by a press.
    pub(super) fn displacements(
        &self,
        markers: &Markers,
        pressed: &Pressed,
    ) -> Result<Vec<MarkerDisplacement>, PressError> {
        self.moved(markers, pressed, &self.contact(markers, pressed)?)
    }
}

pub(super) fn within_sensor(path: &str, thickness: f64, radius: f64) -> Result<(), PlanError> {
    if thickness <= radius {
        return Ok(());
    }
    let message = format!(
        "must be at most the sensor's radius {}, is {}",
        Number(radius),
        Number(thickness)
    );
    Err(PlanError::at(path, message))
}

/// Converts an error of the body to one at its config field.
pub(super) fn of_body(table: &str, error: PressError) -> PlanError {
    match error {
        PressError::BadSetting(BadSetting {
            setting: "depth", ..
        }) => PlanError::at("scene.probe.marker_depth", error),
        PressError::BadSetting(BadSetting { setting, .. }) => {
            PlanError::at(format!("{table}.{setting}"), error)
        }
        _ => PlanError::at(table, error),
    }
}

//! The soft body of a sensor: how a press displaces points at a depth under its skin.

use palpate_estimators::{body_error, sensor_body, within_sensor};
use palpate_press::{Body, Contact, MarkerDisplacement, Markers, PressError, within_object};
use palpate_study::config::PressModelConfig;

use super::pressed::Pressed;
use palpate_study::FieldError;

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
    ) -> Result<Self, FieldError> {
        if let Some(thickness) = model.thickness() {
            within_sensor("scene.model.thickness", thickness, radius)?;
        }
        let sideways = match model.reference() {
            PressModelConfig::HalfSpace { poisson } => Some((poisson, depth)),
            PressModelConfig::Hertz { poisson } => Some((poisson, 0.0)),
            PressModelConfig::BondedLayer { .. } | PressModelConfig::Auto { .. } => None,
        };
        let body =
            sensor_body(model, depth, layer).map_err(|error| body_error("scene.model", error))?;
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

//! Markers of two discs, and the bodies that move them.

use palpate_chromatouch::{DiscMotion, MarkerMotion};
use palpate_press::{MarkerDisplacement, Markers, PressError};
use palpate_study::config::PressModelConfig;

use super::super::parts::Parts;
use super::super::pressed::Pressed;
use super::super::soft_body::SoftBody;
use super::straining::Straining;
use palpate_estimators::MarkerSphere;
use palpate_study::FieldError;

/// Markers of two discs, and the bodies that move them.
pub(super) struct DiscMarkers<'a> {
    pub(super) markers: &'a Markers,
    /// Soft body at the depth of the markers, midway between their discs.
    midway: &'a SoftBody,
    magenta: SoftBody,
    yellow: SoftBody,
    /// Strain of the magenta and the yellow discs; `None` if the skin does not strain them.
    straining: Option<[Straining; 2]>,
}

impl<'a> DiscMarkers<'a> {
    pub(super) fn of(
        sphere: &MarkerSphere<'_>,
        model: &PressModelConfig,
        markers: &'a Markers,
        midway: &'a SoftBody,
        parts: &Parts,
    ) -> Result<Self, FieldError> {
        let depths = sphere.disc_depths()?;
        let layer = |thickness, depth| parts.layer(thickness, depth);
        let body = |depth: f64| SoftBody::of(model, sphere.radius, depth, layer);
        let deepest = model.thickness().unwrap_or(sphere.radius);
        let about = |depth| Straining::of(sphere.strain(), depth, (sphere.radius, deepest), body);
        let is_strained = sphere.strain() > 0.0;
        let straining = is_strained.then(|| Ok([about(depths.magenta)?, about(depths.yellow)?]));
        Ok(Self {
            straining: straining.transpose()?,
            markers,
            midway,
            magenta: body(depths.magenta)?,
            yellow: body(depths.yellow)?,
        })
    }

    /// Displacements of the markers, midway between their discs.
    pub(super) fn displacements(
        &self,
        pressed: &Pressed,
    ) -> Result<Vec<MarkerDisplacement>, PressError> {
        self.midway.displacements(self.markers, pressed)
    }

    /// Displacements of the discs of each marker.
    pub(super) fn motions(&self, pressed: &Pressed) -> Result<Vec<MarkerMotion>, PressError> {
        let magenta = self.magenta.displacements(self.markers, pressed)?;
        let yellow = self.yellow.displacements(self.markers, pressed)?;
        let [wider_magenta, wider_yellow] = match &self.straining {
            None => [None, None],
            Some([of_magenta, of_yellow]) => [
                Some(of_magenta.stretches(self.markers, pressed)?),
                Some(of_yellow.stretches(self.markers, pressed)?),
            ],
        };
        let motion =
            |moved: MarkerDisplacement, wider: &Option<Vec<f64>>, marker: usize| DiscMotion {
                normal: moved.normal,
                tangential: moved.tangential,
                stretch: wider.as_ref().map_or(0.0, |wider| wider[marker]),
            };
        let pairs = magenta.into_iter().zip(yellow).enumerate();
        Ok(pairs
            .map(|(marker, (magenta, yellow))| MarkerMotion {
                magenta: motion(magenta, &wider_magenta, marker),
                yellow: motion(yellow, &wider_yellow, marker),
            })
            .collect())
    }

    /// The marker nearest to a place on the skin.
    pub(super) fn nearest(&self, place: [f64; 2]) -> Option<usize> {
        let distances = self.markers.distances(place);
        (0..distances.len()).min_by(|one, other| distances[*one].total_cmp(&distances[*other]))
    }
}

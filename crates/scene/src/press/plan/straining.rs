//! Discs that the skin strains in a press.

use palpate_press::{Markers, PressError};

use super::super::pressed::Pressed;
use super::super::soft_body::SoftBody;
use palpate_study::FieldError;

/// Distance above and below a disc at which the skin's displacement is computed, in sensor radii.
const BESIDE: f64 = 0.0025;

/// Skin just above and below the discs of one colour; its displacements yield the strain.
pub(super) struct Straining {
    /// Fraction of the skin's strain that the discs follow.
    share: f64,
    above: SoftBody,
    below: SoftBody,
    /// Distance between `above` and `below`, length.
    apart: f64,
}

impl Straining {
    /// Skin around discs at `depth`, no deeper than `deepest`; `body` builds the body at a depth.
    pub(super) fn of(
        share: f64,
        depth: f64,
        (radius, deepest): (f64, f64),
        body: impl Fn(f64) -> Result<SoftBody, FieldError>,
    ) -> Result<Self, FieldError> {
        let beside = BESIDE * radius;
        let [above, below] = [(depth - beside).max(0.0), (depth + beside).min(deepest)];
        Ok(Self {
            share,
            above: body(above)?,
            below: body(below)?,
            apart: below - above,
        })
    }

    /// Relative widening of each disc in a press. If an incompressible skin is compressed along its normal, it widens
    /// in both tangential directions by half that strain.
    pub(super) fn stretches(
        &self,
        markers: &Markers,
        pressed: &Pressed,
    ) -> Result<Vec<f64>, PressError> {
        let above = self.above.displacements(markers, pressed)?;
        let below = self.below.displacements(markers, pressed)?;
        let squeezed = above.iter().zip(&below);
        Ok(squeezed
            .map(|(above, below)| 0.5 * self.share * (above.normal - below.normal) / self.apart)
            .collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_press::{Body, Skin};
    use palpate_study::config::PressModelConfig;

    /// Half the area strain of a half-space, by finite differences of its radial displacement: (r u_r)′ / 2r.
    fn widened(markers: &[[f64; 2]], depth: f64, pressed: &Pressed) -> Vec<f64> {
        const STEP: f64 = 1e-3;
        let body = half_space(depth);
        let outward = |more: f64| -> Vec<f64> {
            let places: Vec<[f64; 2]> = markers.iter().map(|[x, _]| [x + more, 0.0]).collect();
            let moved = body.displacements(&on_skin(&places), pressed).unwrap();
            std::iter::zip(moved, &places)
                .map(|(moved, [x, _])| x * moved.tangential[0])
                .collect()
        };
        let (far, near) = (outward(STEP), outward(-STEP));
        std::iter::zip(markers, std::iter::zip(far, near))
            .map(|([x, _], (far, near))| (far - near) / (4.0 * STEP * x))
            .collect()
    }

    fn half_space(depth: f64) -> SoftBody {
        let model = PressModelConfig::HalfSpace { poisson: 0.5 };
        SoftBody::of(&model, 20.0, depth, Body::bonded_layer).unwrap()
    }

    fn on_skin(places: &[[f64; 2]]) -> Markers {
        Markers::new(Skin::new(20.0).unwrap(), places).unwrap()
    }

    #[test]
    fn an_incompressible_skin_widens_as_it_is_squeezed() {
        let places: Vec<[f64; 2]> = [0.05, 1.0, 2.0, 3.5, 6.0].map(|x| [x, 0.0]).to_vec();
        let pressed = Pressed::on_plane(1.0);
        for depth in [1.0, 3.0] {
            let body = |depth| Ok(half_space(depth));
            let straining = Straining::of(1.0, depth, (20.0, 20.0), body).unwrap();
            let told = straining.stretches(&on_skin(&places), &pressed).unwrap();
            let known = widened(&places, depth, &pressed);
            for (told, known) in told.iter().zip(&known) {
                assert!((told - known).abs() < 1e-3, "{depth}: {told} {known}");
            }
            assert!(told[0] > 0.02, "{told:?}");
            let half = Straining::of(0.5, depth, (20.0, 20.0), body).unwrap();
            let half = half.stretches(&on_skin(&places), &pressed).unwrap();
            assert!((half[0] / told[0] - 0.5).abs() < 1e-12);
        }
    }
}

//! The ladder of press models: a list of compared models of the soft body under the skin.

use std::cell::OnceCell;

use anyhow::{Context, Result};
use palpate_press::{Body, Skin};

use super::ladder::{Ease, Ladder, Rung, SceneRungs};
use super::scene_trials::at_least_rounding;
use crate::paraboloid_reference::{self, ParaboloidPress, largest_error};

const RADIUS: f64 = 20.0;
const POISSON: f64 = 0.5;
/// Number of distances from the contact at which displacements are computed. It equals the number of markers of the
/// published sensor.
const PLACES: usize = 77;
/// Largest distance (mm) from the contact at which displacements are computed.
const REACH: f64 = 20.0;

/// Each entry has the text that is added to the name of a model, and a factor by which the model's number of quadrature
/// nodes is multiplied. The factors apply only to contacts that are solved directly instead of interpolated.
const RESOLUTIONS: [(&str, f64); 5] = [
    (" × 1/4", 0.25),
    (" × 3/8", 0.375),
    (" × 1/2", 0.5),
    (" × 3/4", 0.75),
    ("", 1.0),
];

#[derive(Clone, Copy)]
struct Press {
    ease: Ease,
    scene: &'static str,
    thickness: f64,
    depth: f64,
    object_curvature: f64,
    indentation: f64,
}

const PRESSES: [Press; 3] = [
    Press {
        ease: Ease::Easy,
        scene: "ball of radius 80 mm, pressed 0.2 mm into a layer of 100 mm; displacements of its surface",
        thickness: 100.0,
        depth: 0.0,
        object_curvature: 1.0 / 80.0,
        indentation: 0.2,
    },
    Press {
        ease: Ease::Typical,
        scene: "plane, pressed 1 mm into a layer of 10 mm; displacements at the depth 2 mm",
        thickness: 10.0,
        depth: 2.0,
        object_curvature: 0.0,
        indentation: 1.0,
    },
    Press {
        ease: Ease::Hard,
        scene: "dish of radius 40 mm, pressed 1 mm into a layer of 4 mm; displacements at the depth 3 mm",
        thickness: 4.0,
        depth: 3.0,
        object_curvature: -1.0 / 40.0,
        indentation: 1.0,
    },
];

pub(super) fn ladder() -> Ladder {
    Ladder {
        name: "press-models",
        title: "Which model of a press?",
        error: "largest error of a displacement over the largest displacement; true: quadrature over wavenumbers",
        evaluation: "one press: 77 displacements",
        scenes: PRESSES.iter().map(Press::stage).collect(),
    }
}

/// Displacements at each distance from the contact: inward (along the normal), and outward (along the skin, away from
/// the contact).
type Profile = Vec<[f64; 2]>;

impl Press {
    fn stage(&self) -> SceneRungs {
        let press = *self;
        let solid = |depth: f64| {
            move || -> Result<Profile> {
                let body = Body::half_space(POISSON, depth)?;
                press.profile(&body)
            }
        };
        let from_table = OnceCell::new();
        let with_table = move || {
            let body = from_table.get_or_init(|| press.layer().ok());
            press.profile(body.as_ref().context("no layer")?)
        };
        let mut rungs = vec![
            press.rung("Hertz", solid(0.0), solid(0.0)),
            press.rung("half-space", solid(press.depth), solid(press.depth)),
            press.rung(
                "layer, table",
                move || press.profile(&press.layer()?),
                with_table,
            ),
            press.rung(
                "layer, first table",
                move || press.profile(&press.layer()?),
                move || press.profile(&press.layer()?),
            ),
        ];
        rungs.extend(RESOLUTIONS.map(|(nodes, resolution)| {
            let solved = move || {
                let (thickness, depth) = (press.thickness, press.depth);
                press.profile(&Body::solved_layer_at(thickness, depth, resolution)?)
            };
            press
                .rung(&format!("layer, solved{nodes}"), solved, solved)
                .set(resolution)
        }));
        SceneRungs::new(press.ease, press.scene, rungs)
    }

    fn rung(
        self,
        name: &str,
        errs: impl Fn() -> Result<Profile> + 'static,
        costs: impl Fn() -> Result<Profile> + 'static,
    ) -> Rung {
        let error = move || at_least_rounding(largest_error(&errs()?, &self.truth()?));
        Rung::new(name, error, costs)
    }

    fn relative_curvature(&self) -> f64 {
        RADIUS.recip() + self.object_curvature
    }

    fn layer(&self) -> Result<Body> {
        Ok(Body::bonded_layer(self.thickness, self.depth)?)
    }

    fn profile(&self, body: &Body) -> Result<Profile> {
        let skin = Skin::new(RADIUS)?;
        let contact = skin.contact(body, self.object_curvature, self.indentation)?;
        Ok(places()
            .map(|r| {
                let moved = contact.displacement(r);
                [moved.normal, moved.radial]
            })
            .collect())
    }

    /// The true displacements at all distances from the contact, computed by quadrature over wavenumbers.
    fn truth(&self) -> Result<Profile> {
        let layer = paraboloid_reference::Body::Layer {
            thickness: self.thickness,
        };
        let press = ParaboloidPress::new(layer, self.relative_curvature(), self.indentation)?;
        press.displacements(self.depth, &places().collect::<Vec<f64>>())
    }
}

fn places() -> impl Iterator<Item = f64> {
    (0..PLACES).map(|at| REACH * at as f64 / (PLACES - 1) as f64)
}

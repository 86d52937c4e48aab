//! Models of the soft body, and a contact with it.

use std::f64::consts::FRAC_2_PI;
use std::sync::Arc;

use crate::bonded_layer::{BondedLayer, LayerContact};
use crate::{PressError, half_space};

/// Distance from a contact beyond which displacements are set to 0, length.
const MAX_DISTANCE: f64 = 1e50;

/// A model of the soft body: the displacement of the skin, at the markers' depth, under a press.
///
/// All bodies scale in the same way: with the contact's radius a and the relative curvature C_r, the displacement is
/// C_r F(a, r) and the indentation is C_r D(a).
///
/// ```
/// use palpate_press::Body;
///
/// // Hertz: a² = δ/C_r, and the surface moves by δ − C_r r²/2 within the contact.
/// let body = Body::hertz(0.5)?;
/// let contact = body.press(0.25, 1.0)?;
/// assert_eq!(contact.radius, 2.0);
/// assert!((contact.displacement(0.0).normal - 1.0).abs() < 1e-11);
/// assert!((contact.displacement(1.0).normal - 0.875).abs() < 1e-11);
/// // The force is 4/3 E/(1 − ν²) C_r a³.
/// assert!(contact.force(9.0).is_some_and(|force| (force - 32.0).abs() < 1e-12));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Body(Rung);

#[derive(Clone, Debug)]
enum Rung {
    HalfSpace {
        poisson: f64,
        depth: f64,
    },
    BondedLayer {
        layer: Arc<BondedLayer>,
        how: Layers,
    },
    Gaussian {
        c: f64,
    },
}

/// Method for contacts with a layer.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Layers {
    /// Interpolation in tables; faster for many contacts.
    Tables,
    /// Solution of the equations of each contact; faster for few contacts.
    Solved,
}

/// A contact of an object with the body.
#[derive(Clone, Debug)]
pub struct Contact<'b> {
    body: &'b Body,
    /// The contact with the layer, if the body is a layer.
    layer: Option<LayerContact>,
    /// 1/R_s + 1/R_o, 1/length.
    pub relative_curvature: f64,
    /// Approach of the bodies since first touch, length.
    pub indentation: f64,
    /// Radius of the contact, length.
    pub radius: f64,
}

/// Displacement of a point of the skin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Displacement {
    /// Inward, length.
    pub normal: f64,
    /// Along the skin, away from the contact, length.
    pub radial: f64,
}

/// Displacement at a distance from the middle of a contact, with its derivatives by the distance and by the contact's
/// radius, divided by the relative curvature: F(a, r) in u = C_r F. Units: length² for displacements, length for derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Field {
    /// Inward displacement.
    pub(crate) normal: f64,
    /// Derivative of the inward displacement by the distance.
    pub(crate) normal_per_r: f64,
    /// Derivative of the inward displacement by the contact's radius.
    pub(crate) normal_per_a: f64,
    /// Displacement along the skin, away from the contact.
    pub(crate) radial: f64,
    /// Derivative of the displacement along the skin by the distance.
    pub(crate) radial_per_r: f64,
    /// Derivative of the displacement along the skin by the contact's radius.
    pub(crate) radial_per_a: f64,
}

impl Body {
    /// An elastic half-space with displacements at its surface.
    ///
    /// # Errors
    /// [`PressError::BadSetting`] for `poisson` outside [0, 0.5].
    pub fn hertz(poisson: f64) -> Result<Self, PressError> {
        Self::half_space(poisson, 0.0)
    }

    /// An elastic half-space with displacements at this depth.
    ///
    /// # Errors
    /// [`PressError::BadSetting`] for `poisson` outside [0, 0.5] and a `depth` that is negative or beyond 1e50.
    pub fn half_space(poisson: f64, depth: f64) -> Result<Self, PressError> {
        let good = (0.0..=0.5).contains(&poisson);
        PressError::unless_good("poisson", poisson, good, "from 0 to 0.5")?;
        let good = (0.0..=1e50).contains(&depth);
        PressError::unless_good("depth", depth, good, "at least 0 and at most 1e50")?;
        Ok(Self(Rung::HalfSpace { poisson, depth }))
    }

    /// An incompressible layer bonded to a rigid core, with displacements at this depth. Contacts are interpolated in tables;
    /// the error is at most 1e-7 of the largest displacement for depths up to 0.8 of the thickness. A contact takes a few
    /// microseconds; the first one in each of nine ranges of radii takes about ten milliseconds, because its table is computed.
    ///
    /// # Errors
    /// [`PressError::BadSetting`] for a `thickness` that is not from 1e-50 to 1e50, or a `depth` outside the layer.
    pub fn bonded_layer(thickness: f64, depth: f64) -> Result<Self, PressError> {
        BondedLayer::new(thickness, depth).map(|layer| Self::layer(layer, Layers::Tables))
    }

    /// Models of one incompressible layer bonded to a rigid core, one for each depth, in the order of the depths. Their
    /// tables are computed together, in little more time than the tables of one depth.
    ///
    /// # Errors
    /// Errors of [`Body::bonded_layer`].
    pub fn bonded_layers(thickness: f64, depths: &[f64]) -> Result<Vec<Self>, PressError> {
        let layers = BondedLayer::at_depths(thickness, depths)?.into_iter();
        Ok(layers
            .map(|layer| Self::layer(layer, Layers::Tables))
            .collect())
    }

    /// The same layer as [`Body::bonded_layer`], but for few contacts: each is solved without tables. The error is at most 1e-9
    /// of the largest displacement at the surface.
    ///
    /// # Errors
    /// Errors of [`Body::bonded_layer`].
    pub fn solved_layer(thickness: f64, depth: f64) -> Result<Self, PressError> {
        Self::solved_layer_at(thickness, depth, 1.0)
    }

    /// The same with `resolution` times the number of nodes. Below 1 the solution is faster and coarser; above 1 it serves as
    /// a check of convergence.
    ///
    /// # Errors
    /// Errors of [`Body::bonded_layer`], and [`PressError::BadSetting`] for a `resolution` that is not from 1/16 to 16.
    pub fn solved_layer_at(
        thickness: f64,
        depth: f64,
        resolution: f64,
    ) -> Result<Self, PressError> {
        let layer = BondedLayer::new(thickness, depth)?.at_resolution(resolution)?;
        Ok(Self::layer(layer, Layers::Solved))
    }

    fn layer(layer: BondedLayer, how: Layers) -> Self {
        Self(Rung::BondedLayer {
            layer: Arc::new(layer),
            how,
        })
    }

    /// The approximation of the 2020 paper, u = δ exp(−r²/2σ²) with σ² = δ R/c, without displacements along the skin. The
    /// paper has c = 1.
    ///
    /// # Errors
    /// [`PressError::BadSetting`] for a `c` that is not finite and positive.
    pub fn gaussian(c: f64) -> Result<Self, PressError> {
        let good = c > 0.0 && c.is_finite();
        PressError::unless_good("c", c, good, "finite and > 0")?;
        Ok(Self(Rung::Gaussian { c }))
    }

    /// The c of a Gaussian; `None` for other bodies.
    pub fn c(&self) -> Option<f64> {
        match self.0 {
            Rung::Gaussian { c } => Some(c),
            _ => None,
        }
    }

    /// Whether the model has displacements along the skin.
    pub fn moves_tangentially(&self) -> bool {
        !matches!(self.0, Rung::Gaussian { .. })
    }

    /// Whether the model is only an approximation, so that its errors are larger than the noise of readings.
    pub(crate) fn is_approximate(&self) -> bool {
        matches!(self.0, Rung::Gaussian { .. })
    }

    /// Poisson's ratio and depth of a body with a model of sideways shifts: a half-space.
    pub(crate) fn sideways(&self) -> Option<(f64, f64)> {
        match self.0 {
            Rung::HalfSpace { poisson, depth } => Some((poisson, depth)),
            Rung::BondedLayer { .. } | Rung::Gaussian { .. } => None,
        }
    }

    /// The contact with an object of this relative curvature at this indentation.
    ///
    /// # Errors
    /// [`PressError::EdgeContact`] or [`PressError::Conforming`] if the relative curvature is not positive,
    /// [`PressError::NoIndentation`], [`PressError::TooDeep`] if the indentation reaches the thickness of a layer,
    /// [`PressError::LayerTooThin`] and [`PressError::OutOfRange`] if the contact's radius cannot be computed.
    pub fn press(
        &self,
        relative_curvature: f64,
        indentation: f64,
    ) -> Result<Contact<'_>, PressError> {
        if !(relative_curvature.is_finite() && indentation.is_finite()) {
            return Err(PressError::OutOfRange);
        }
        if relative_curvature <= 0.0 {
            return Err(if relative_curvature == 0.0 {
                PressError::Conforming { relative_curvature }
            } else {
                PressError::EdgeContact { relative_curvature }
            });
        }
        if indentation <= 0.0 {
            return Err(PressError::NoIndentation { indentation });
        }
        if let Rung::BondedLayer { layer, .. } = &self.0
            && indentation >= layer.thickness()
        {
            return Err(PressError::TooDeep {
                indentation,
                limit: layer.thickness(),
                what: "the layer's thickness",
            });
        }
        let radius = self.contact_radius(indentation / relative_curvature)?;
        if !(1e-50..=1e50).contains(&radius) {
            return Err(PressError::OutOfRange);
        }
        self.contact(relative_curvature, indentation, radius)
    }

    /// The contact of this radius with an object of relative curvature 1; its displacements are F(a, r).
    pub(crate) fn unit_contact(&self, radius: f64) -> Result<Contact<'_>, PressError> {
        let [indentation, _] = self.indentation_of(radius)?;
        self.contact(1.0, indentation, radius)
    }

    fn contact(
        &self,
        relative_curvature: f64,
        indentation: f64,
        radius: f64,
    ) -> Result<Contact<'_>, PressError> {
        let layer = match &self.0 {
            Rung::BondedLayer { layer, how } => Some(match how {
                Layers::Tables => layer.contact(radius)?,
                Layers::Solved => layer.solved(radius)?,
            }),
            Rung::HalfSpace { .. } | Rung::Gaussian { .. } => None,
        };
        Ok(Contact {
            body: self,
            layer,
            relative_curvature,
            indentation,
            radius,
        })
    }

    /// The contact's radius from D = δ R.
    fn contact_radius(&self, indentation_over_curvature: f64) -> Result<f64, PressError> {
        match &self.0 {
            Rung::HalfSpace { .. } | Rung::Gaussian { .. } => Ok(indentation_over_curvature.sqrt()),
            Rung::BondedLayer { layer, how } => match how {
                Layers::Tables => layer.contact_radius(indentation_over_curvature),
                Layers::Solved => layer.solved_contact_radius(indentation_over_curvature),
            },
        }
    }

    /// D and dD/da at a contact radius.
    pub(crate) fn indentation_of(&self, a: f64) -> Result<[f64; 2], PressError> {
        match &self.0 {
            Rung::HalfSpace { .. } | Rung::Gaussian { .. } => Ok([a * a, 2.0 * a]),
            Rung::BondedLayer { layer, how } => match how {
                Layers::Tables => layer.indentation_of(a),
                Layers::Solved => Ok(layer.solved(a)?.indentation()),
            },
        }
    }
}

impl Contact<'_> {
    /// Displacement of the skin at arc distance `r` (length, of either sign) from the contact; 0 if `r` is NaN or beyond
    /// 1e50.
    ///
    /// The relative error is at most 1e-11 for a half-space; for a layer see [`Body::bonded_layer`].
    pub fn displacement(&self, r: f64) -> Displacement {
        let field = self.field(r);
        Displacement {
            normal: self.relative_curvature * field.normal,
            radial: self.relative_curvature * field.radial,
        }
    }

    /// Force between the bodies for a Young's modulus of the soft one, in the unit of the modulus times length². `None` for
    /// the Gaussian, which has no stress, and if the force is not finite.
    pub fn force(&self, young: f64) -> Option<f64> {
        let unit = self.relative_curvature * young;
        let force = match &self.body.0 {
            Rung::HalfSpace { poisson, .. } => {
                Some(unit / (1.0 - poisson * poisson) * 4.0 / 3.0 * self.radius.powi(3))
            }
            Rung::BondedLayer { .. } => Some(unit / 0.75 * self.layer.as_ref()?.force()),
            Rung::Gaussian { .. } => None,
        };
        force.filter(|force| force.is_finite())
    }

    /// Pressure in the middle of the contact for a Young's modulus, in its unit. `None` for the Gaussian, and if the pressure
    /// is not finite.
    pub fn peak_pressure(&self, young: f64) -> Option<f64> {
        let unit = self.relative_curvature * young;
        let pressure = match &self.body.0 {
            Rung::HalfSpace { poisson, .. } => {
                Some(unit / (1.0 - poisson * poisson) * FRAC_2_PI * self.radius)
            }
            Rung::BondedLayer { .. } => Some(unit / 0.75 * self.layer.as_ref()?.peak_pressure()),
            Rung::Gaussian { .. } => None,
        };
        pressure.filter(|pressure| pressure.is_finite())
    }

    // Inlined, so that the compiler removes the parts that a caller does not use.
    #[inline(always)]
    pub(crate) fn field(&self, r: f64) -> Field {
        let (a, r) = (self.radius, r.abs());
        if r.is_nan() || r > MAX_DISTANCE {
            return Field::default();
        }
        if let Some(layer) = &self.layer {
            return layer.field(r);
        }
        match &self.body.0 {
            Rung::HalfSpace { poisson, depth } => half_space::field(*poisson, *depth, a, r),
            Rung::BondedLayer { .. } => Field::default(),
            Rung::Gaussian { c } => {
                let share = libm::exp(-0.5 * c * (r / a) * (r / a));
                Field {
                    normal: a * a * share,
                    normal_per_r: -c * r * share,
                    normal_per_a: (2.0 * a + c * r * r / a) * share,
                    ..Field::default()
                }
            }
        }
    }
}

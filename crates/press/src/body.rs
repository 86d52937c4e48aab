//! Models of the soft body, and the contact of an object with the soft body.

use std::f64::consts::FRAC_2_PI;
use std::sync::Arc;

use crate::bonded_layer::{BondedLayer, ENDS, LayerContact};
use crate::{PressError, half_space};

/// Largest distance (length) from the contact at which displacements are computed. At larger distances, the
/// displacements are set to 0.
const MAX_DISTANCE: f64 = 1e50;

/// A model of the soft body. It computes how far a press displaces the points at the depth of the markers.
///
/// Let a be the contact's radius, r the distance from the middle of the contact, and C_r the relative curvature. In
/// every model, the displacement is C_r F(a, r) and the indentation is C_r D(a). The models differ in the functions F
/// and D.
///
/// ```
/// use palpate_press::Body;
///
/// // Hertz: a² = δ/C_r, and the surface moves by δ − C_r r²/2 within the contact.
/// let body = Body::half_space(0.5, 0.0)?;
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

/// The two methods by which contacts with a bonded layer are computed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Layers {
    /// Each contact is interpolated in a table of solved contacts, which is faster for many contacts.
    Tables,
    /// The equations are solved for each contact, which is more accurate, and faster for few contacts.
    Solved,
}

/// A contact between an object and the soft body.
#[derive(Clone, Debug)]
pub struct Contact<'b> {
    body: &'b Body,
    layer: Option<LayerContact>,
    /// Relative curvature 1/R_s + 1/R_o (1/length), where R_s is the radius of the sensor and R_o the radius of the
    /// object.
    pub relative_curvature: f64,
    /// Distance (length) by which the bodies have approached each other since they first touched.
    pub indentation: f64,
    /// Radius of the contact area (length).
    pub radius: f64,
}

/// Displacement of a point of the skin in a press.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Displacement {
    /// Inward displacement along the normal (length).
    pub normal: f64,
    /// Displacement (length) along the skin, positive away from the contact.
    pub radial: f64,
}

/// Displacement of the skin at the distance r from the middle of a contact of radius a, and its derivatives with
/// respect to r and a. All values are divided by the relative curvature. Therefore displacements have the unit length²,
/// and derivatives the unit length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Field {
    pub(crate) normal: f64,
    pub(crate) normal_per_r: f64,
    pub(crate) normal_per_a: f64,
    /// Displacement along the skin divided by the relative curvature. It is positive if the skin moves away from the
    /// contact.
    pub(crate) radial: f64,
    pub(crate) radial_per_r: f64,
    pub(crate) radial_per_a: f64,
}

impl Body {
    /// An elastic half-space whose displacements are computed at the depth `depth`. `poisson` is Poisson's ratio.
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

    /// An incompressible layer bonded to a rigid core. Its displacements are computed at the depth `depth`. Contacts
    /// are interpolated in tables. For depths up to 0.8 of the layer's thickness, the error is at most 1e-7 of the
    /// largest displacement. The computation of a contact takes a few microseconds. There are nine ranges of contact
    /// radii; the first contact in each range takes about ten milliseconds, because the table of this range is
    /// computed.
    ///
    /// # Errors
    /// [`PressError::BadSetting`] unless `thickness` is from 1e-50 to 1e50 and `depth` is inside the layer.
    pub fn bonded_layer(thickness: f64, depth: f64) -> Result<Self, PressError> {
        BondedLayer::new(thickness, depth).map(|layer| Self::layer(layer, Layers::Tables))
    }

    /// Models of one incompressible layer bonded to a rigid core. Each model computes displacements at one of the
    /// depths `depths`. The models are in the same order as `depths`. The tables of all models are computed together,
    /// in little more time than the tables for one depth.
    ///
    /// # Errors
    /// Errors of [`Body::bonded_layer`].
    pub fn bonded_layers(thickness: f64, depths: &[f64]) -> Result<Vec<Self>, PressError> {
        let layers = BondedLayer::at_depths(thickness, depths)?.into_iter();
        Ok(layers
            .map(|layer| Self::layer(layer, Layers::Tables))
            .collect())
    }

    /// A layer as in [`Body::bonded_layer`], but each contact is solved without tables. This is faster for few
    /// contacts. The error is at most 1e-9 of the largest displacement at the surface.
    ///
    /// # Errors
    /// Errors of [`Body::bonded_layer`].
    pub fn solved_layer(thickness: f64, depth: f64) -> Result<Self, PressError> {
        Self::solved_layer_at(thickness, depth, 1.0)
    }

    /// A layer as in [`Body::solved_layer`], with the number of quadrature nodes multiplied by `resolution`. If
    /// `resolution` is below 1, the solution is faster and less accurate. Values above 1 serve to check the
    /// convergence.
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

    /// The Gaussian approximation of the 2020 paper: the inward displacement is u = δ exp(−r²/2σ²). Here r is the
    /// distance from the contact and δ the indentation. The width σ follows from σ² = δ R/c, with the effective radius
    /// R and a constant c. There are no displacements along the skin. The paper uses c = 1.
    ///
    /// # Errors
    /// [`PressError::BadSetting`] for a `c` that is not finite and positive.
    pub fn gaussian(c: f64) -> Result<Self, PressError> {
        let good = c > 0.0 && c.is_finite();
        PressError::unless_good("c", c, good, "finite and > 0")?;
        Ok(Self(Rung::Gaussian { c }))
    }

    /// The constant c of the Gaussian approximation (see [`Body::gaussian`]); `None` for other bodies.
    pub fn c(&self) -> Option<f64> {
        match self.0 {
            Rung::Gaussian { c } => Some(c),
            _ => None,
        }
    }

    /// `true` for the Gaussian approximation, `false` for the elastic bodies. The own errors of the Gaussian exceed the
    /// usual noise of readings, and it computes no displacements along the skin.
    pub(crate) fn is_approximate(&self) -> bool {
        matches!(self.0, Rung::Gaussian { .. })
    }

    /// Largest ratio of indentation to relative curvature in the tables of a bonded layer; infinite for bodies without
    /// tables. Fits avoid larger ratios, because contacts beyond the tables are solved one by one, which is slow.
    pub(crate) fn end_of_tables(&self) -> f64 {
        let end = match &self.0 {
            Rung::BondedLayer {
                layer,
                how: Layers::Tables,
            } => layer.indentation_of(ENDS[ENDS.len() - 1] * layer.thickness()),
            _ => return f64::INFINITY,
        };
        end.map_or(f64::INFINITY, |[indentation, _]| indentation)
    }

    /// Poisson's ratio of a half-space, and the depth at which its displacements are computed. `None` for other bodies,
    /// because elliptic contacts and sideways shifts of the object are modelled only for a half-space.
    pub fn sideways(&self) -> Option<(f64, f64)> {
        match self.0 {
            Rung::HalfSpace { poisson, depth } => Some((poisson, depth)),
            Rung::BondedLayer { .. } | Rung::Gaussian { .. } => None,
        }
    }

    /// The contact with an object, for a given relative curvature and indentation.
    ///
    /// # Errors
    /// [`PressError::EdgeContact`] or [`PressError::Conforming`] if the relative curvature is not positive,
    /// [`PressError::NoIndentation`] if the indentation is not positive, [`PressError::TooDeep`] if the indentation
    /// reaches the thickness of a layer, [`PressError::LayerTooThin`] and [`PressError::OutOfRange`] if the contact's
    /// radius cannot be computed.
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

    /// The contact with the radius `radius` for a relative curvature of 1. Displacements are proportional to the
    /// relative curvature, so all other contacts of this radius follow from this contact.
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

    fn contact_radius(&self, indentation_over_curvature: f64) -> Result<f64, PressError> {
        match &self.0 {
            Rung::HalfSpace { .. } | Rung::Gaussian { .. } => Ok(indentation_over_curvature.sqrt()),
            Rung::BondedLayer { layer, how } => match how {
                Layers::Tables => layer.contact_radius(indentation_over_curvature),
                Layers::Solved => layer.solved_contact_radius(indentation_over_curvature),
            },
        }
    }

    /// Ratio of the indentation to the relative curvature, for a contact of radius `a`, and the derivative of this
    /// ratio with respect to `a`.
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
    /// Displacement of a point of the skin. `r` is the distance of the point from the contact along the skin (length;
    /// negative on the opposite side of the contact). The displacement is 0 if `r` is NaN or beyond 1e50.
    ///
    /// The relative error is at most 1e-11 for a half-space. For a layer, the documentation of [`Body::bonded_layer`]
    /// states the error.
    pub fn displacement(&self, r: f64) -> Displacement {
        let field = self.field(r);
        Displacement {
            normal: self.relative_curvature * field.normal,
            radial: self.relative_curvature * field.radial,
        }
    }

    /// Force between the object and the soft body. `young` is the Young's modulus of the soft body. The unit of the
    /// force is the unit of `young` times length². The result is `None` for the Gaussian approximation, which has no
    /// stress, and if the force is not finite.
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

    /// Pressure in the middle of the contact. `young` is the Young's modulus of the soft body, and the pressure has the
    /// same unit. The result is `None` for the Gaussian approximation, and if the pressure is not finite.
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

    // Inline this function, so that the compiler removes the parts of its result that a caller does not use.
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

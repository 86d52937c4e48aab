//! Contact with an incompressible elastic layer bonded to a rigid core.
//!
//! The object is modelled as a frictionless rigid paraboloid, whose curvature is the relative curvature of sensor and
//! object. The layer is flat, and depths are measured from its surface. The displacement is the sum of two parts. The
//! first part is the displacement of a half-space under the contact's pressure, which is computed by a formula
//! ([`pressure_field`]). The second part is the effect of the rigid base, which is a sum over wavenumbers
//! ([`reflection`]) or is interpolated in a table ([`contact_table`]).
//!
//! The displacement of a point depends only on three lengths: the contact's radius, the depth of the point and its
//! distance from the contact, each divided by the layer's thickness.

mod contact_table;
mod pressure;
mod pressure_field;
mod reflection;

use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

pub(crate) use contact_table::ENDS;
use contact_table::{Panels, Table};
use pressure::Pressure;
use pressure_field::Term;
use reflection::Waves;

use crate::PressError;
use crate::body::Field;

/// Largest radius of a contact that can be solved, relative to the layer's thickness.
const MAX_RADIUS: f64 = 50.0;
const STEPS: usize = 30;

/// An incompressible layer on a rigid base. Displacements are computed at one depth of the layer.
#[derive(Clone, Debug)]
pub(crate) struct BondedLayer {
    thickness: f64,
    depth: f64,
    /// Factor on the standard number of quadrature nodes, for contacts that are solved without a table.
    resolution: f64,
    /// Data that all models of this layer share; each model computes displacements at another depth. `number` is the
    /// index of this model's depth.
    family: Arc<Family>,
    number: usize,
}

#[derive(Debug)]
struct Family {
    /// Depths at which the models compute displacements, relative to the layer's thickness.
    depths: Vec<f64>,
    /// One entry per range of contact radii: the tables for all depths. The tables of a range are computed when they
    /// are first needed.
    tables: [OnceLock<Result<Vec<Table>, PressError>>; ENDS.len() - 1],
}

impl Family {
    fn table(&self, place: usize, number: usize) -> Result<&Table, PressError> {
        let tables = || Table::all(place, &self.depths);
        let tables = self.tables[place].get_or_init(tables);
        tables
            .as_ref()
            .map(|tables| &tables[number])
            .map_err(|error| *error)
    }
}

/// A contact with a [`BondedLayer`], for a relative curvature of 1.
#[derive(Clone, Debug)]
pub(crate) struct LayerContact {
    thickness: f64,
    /// Depth of the markers, relative to the thickness of the layer. The lengths in the fields below are also relative
    /// to the thickness.
    depth: f64,
    contact: f64,
    /// Four values that are computed from the pressure: the indentation, its derivative with respect to the contact's
    /// radius, ∫ φ dt (proportional to the force), and −∫ φ'/t dt (proportional to the peak pressure). φ(t) is the
    /// function that describes the pressure; see [`pressure`].
    numbers: [f64; 4],
    terms: Vec<Term>,
    base: Base,
}

/// Method for the effect of the rigid base on the displacement: a sum over wavenumbers, or interpolation in a table.
#[derive(Clone, Debug)]
enum Base {
    Waves(Waves),
    Panels(Panels),
}

impl BondedLayer {
    pub(crate) fn new(thickness: f64, depth: f64) -> Result<Self, PressError> {
        let mut layers = Self::at_depths(thickness, &[depth])?;
        layers.pop().ok_or(PressError::OutOfRange)
    }

    /// Models of one layer: one model for each depth in `depths`, in the order of `depths`. The tables of all models
    /// are computed together, in little more time than the tables for one depth.
    pub(crate) fn at_depths(thickness: f64, depths: &[f64]) -> Result<Vec<Self>, PressError> {
        let good = (1e-50..=1e50).contains(&thickness);
        PressError::unless_good("thickness", thickness, good, "from 1e-50 to 1e50")?;
        for &depth in depths {
            let good = (0.0..=thickness).contains(&depth);
            PressError::unless_good("depth", depth, good, "from 0 to the layer's thickness")?;
        }
        let family = Arc::new(Family {
            depths: depths.iter().map(|depth| depth / thickness).collect(),
            tables: Default::default(),
        });
        let layer = |(number, &depth): (usize, &f64)| Self {
            thickness,
            depth,
            resolution: 1.0,
            family: Arc::clone(&family),
            number,
        };
        Ok(depths.iter().enumerate().map(layer).collect())
    }

    /// This layer with the standard number of quadrature nodes multiplied by `resolution`. Only contacts that are
    /// solved without a table use this number; the tables do not change. If `resolution` is below 1, the solution is
    /// faster and less accurate. Values above 1 serve to check the convergence.
    pub(crate) fn at_resolution(self, resolution: f64) -> Result<Self, PressError> {
        let good = (0.0625..=16.0).contains(&resolution);
        PressError::unless_good("resolution", resolution, good, "from 1/16 to 16")?;
        Ok(Self { resolution, ..self })
    }

    pub(crate) const fn thickness(&self) -> f64 {
        self.thickness
    }

    /// Ratio of the indentation to the relative curvature, for a contact of radius `a > 0`, and the derivative of this
    /// ratio with respect to `a`. Divided by a², the ratio decreases from 1 for a ≪ t (half-space) to 1/4 for a ≫ t
    /// (thin layer), where t is the layer's thickness.
    pub(crate) fn indentation_of(&self, a: f64) -> Result<[f64; 2], PressError> {
        let [indentation, slope] = self.scaled_indentation(self.scaled(a)?)?;
        Ok([
            indentation * self.thickness * self.thickness,
            slope * self.thickness,
        ])
    }

    /// The contact's radius, computed from the ratio of the indentation to the relative curvature. The relative error
    /// is at most 1e-12.
    pub(crate) fn contact_radius(
        &self,
        indentation_over_curvature: f64,
    ) -> Result<f64, PressError> {
        self.radius_by(indentation_over_curvature, |contact| {
            self.scaled_indentation(contact)
        })
    }

    /// The contact's radius as in [`Self::contact_radius`], but computed without a table. Newton's method needs a few
    /// steps, and each step solves a contact.
    pub(crate) fn solved_contact_radius(
        &self,
        indentation_over_curvature: f64,
    ) -> Result<f64, PressError> {
        self.radius_by(indentation_over_curvature, |contact| {
            let pressure = Pressure::solve(contact, self.resolution)?;
            Ok([pressure.indentation, pressure.slope])
        })
    }

    fn radius_by(
        &self,
        indentation: f64,
        scaled_indentation: impl Fn(f64) -> Result<[f64; 2], PressError>,
    ) -> Result<f64, PressError> {
        if indentation.is_nan() || indentation <= 0.0 {
            return Err(PressError::NoIndentation { indentation });
        }
        let root = indentation.sqrt() / self.thickness;
        let mut contact = guessed_contact(root);
        if contact > 1.2 * MAX_RADIUS {
            return Err(too_thin(contact));
        }
        // Newton's method is applied to the logarithms of the contact's radius and of the indentation, because the
        // relation between the logarithms is almost a straight line.
        for _ in 0..STEPS {
            let tried = contact.min(MAX_RADIUS);
            let [reached, slope] = scaled_indentation(tried)?;
            let power = reached / (tried * slope);
            contact = tried * libm::pow(root / reached.sqrt(), 2.0 * power);
            if tried == MAX_RADIUS && contact > MAX_RADIUS * (1.0 + 1e-12) {
                return Err(too_thin(contact));
            }
            if (contact - tried).abs() <= 1e-14 * tried {
                break;
            }
        }
        Ok(contact.min(MAX_RADIUS) * self.thickness)
    }

    /// A contact of radius `a` from a table, for use in fits. The error is at most 1e-7 of the largest displacement for
    /// depths up to 0.8 of the thickness. The computation takes a few microseconds. There are nine ranges of contact
    /// radii; the first contact in each range takes about ten milliseconds, because the table of this range is
    /// computed. There are no tables for radii above 12 thicknesses; such contacts are solved by [`Self::solved`].
    pub(crate) fn contact(&self, a: f64) -> Result<LayerContact, PressError> {
        let contact = self.scaled(a)?;
        let Some(place) = Table::place(contact) else {
            return self.solved(a);
        };
        let entry = self.table(place)?.entry(contact);
        Ok(LayerContact {
            thickness: self.thickness,
            depth: self.depth / self.thickness,
            contact,
            numbers: entry.numbers,
            terms: entry.terms,
            base: Base::Panels(entry.panels),
        })
    }

    /// A contact of radius `a`, solved without a table. The error is at most 1e-9 of the largest displacement at the
    /// surface.
    pub(crate) fn solved(&self, a: f64) -> Result<LayerContact, PressError> {
        let contact = self.scaled(a)?;
        let depth = self.depth / self.thickness;
        let pressure = Pressure::solve(contact, self.resolution)?;
        Ok(LayerContact {
            thickness: self.thickness,
            depth,
            contact,
            numbers: [
                pressure.indentation,
                pressure.slope,
                pressure.force,
                pressure.peak,
            ],
            terms: pressure.terms.clone(),
            base: Base::Waves(Waves::new(pressure, depth, self.resolution)),
        })
    }

    fn scaled(&self, a: f64) -> Result<f64, PressError> {
        let contact = a / self.thickness;
        if contact.is_nan() || contact <= 0.0 {
            return Err(PressError::OutOfRange);
        }
        if contact > MAX_RADIUS {
            return Err(too_thin(contact));
        }
        Ok(contact)
    }

    fn scaled_indentation(&self, contact: f64) -> Result<[f64; 2], PressError> {
        if let Some(place) = Table::place(contact) {
            let [indentation, slope, ..] = self.table(place)?.numbers(contact);
            return Ok([indentation, slope]);
        }
        Pressure::solve(contact, 1.0).map(|pressure| [pressure.indentation, pressure.slope])
    }

    fn table(&self, place: usize) -> Result<&Table, PressError> {
        self.family.table(place, self.number)
    }
}

impl LayerContact {
    pub(crate) fn indentation(&self) -> [f64; 2] {
        let [indentation, slope, ..] = self.numbers;
        let thickness = self.thickness;
        [indentation * thickness * thickness, slope * thickness]
    }

    /// The force, divided by the relative curvature and by the effective modulus E* = E/(1 − ν²) = 4E/3.
    pub(crate) fn force(&self) -> f64 {
        PI * self.numbers[2] * self.thickness.powi(3)
    }

    /// The pressure in the middle of the contact, divided by the relative curvature and by the effective modulus E*. It
    /// is the highest pressure of the contact.
    pub(crate) fn peak_pressure(&self) -> f64 {
        0.5 * self.numbers[3] * self.thickness
    }

    /// Displacements at the distance `r` from the contact (negative on the opposite side of the contact), and their
    /// derivatives with respect to `r` and the contact's radius. The displacements are 0 at the rigid base. Beyond 30
    /// thicknesses from the contact's edge, they are set to 0, because they are negligible there.
    pub(crate) fn field(&self, r: f64) -> Field {
        let r = r.abs() / self.thickness;
        if r.is_nan() || r > self.contact + reflection::BEYOND || self.depth == 1.0 {
            return Field::default();
        }
        let half_space = pressure_field::field(self.contact, &self.terms, self.depth, r);
        let base = match &self.base {
            Base::Waves(waves) => waves.field(r),
            Base::Panels(panels) => panels.field(r),
        };
        let (length, area) = (self.thickness, self.thickness * self.thickness);
        Field {
            normal: area * (half_space.normal + base.normal),
            normal_per_r: length * (half_space.normal_per_r + base.normal_per_r),
            normal_per_a: length * (half_space.normal_per_a + base.normal_per_a),
            radial: area * (half_space.radial + base.radial),
            radial_per_r: length * (half_space.radial_per_r + base.radial_per_r),
            radial_per_a: length * (half_space.radial_per_a + base.radial_per_a),
        }
    }
}

/// Start value for the contact's radius, with an error of a few per cent. `root` is √(indentation / relative
/// curvature). Lengths are relative to the thickness.
fn guessed_contact(root: f64) -> f64 {
    let mut contact = root;
    for _ in 0..STEPS {
        contact = root / (0.25 + 0.75 / (1.0 + 1.15 * contact)).sqrt();
    }
    contact
}

const fn too_thin(ratio: f64) -> PressError {
    PressError::LayerTooThin {
        ratio,
        limit: MAX_RADIUS,
    }
}

//! Interpolates contacts in a table, which is fast enough for fits. The table contains solved contacts for a few radii;
//! contacts with other radii are interpolated by polynomials.
//!
//! For each solved contact, the table contains the coefficients of the pressure's series and the effect of the rigid
//! base on the displacements. These values are smooth functions of the contact's radius, and the effect of the base is
//! also a smooth function of the distance. The displacement of a half-space under the pressure is not smooth at the
//! edge of the contact, so it is computed from the interpolated coefficients of the pressure.

use std::f64::consts::PI;

use super::pressure::Pressure;
use super::pressure_field::Term;
use super::reflection::{BEYOND, Spectrum, Wave, bessel};
use crate::PressError;
use crate::body::Field;

/// Ends of the ranges of contact radii, relative to the layer's thickness. Each range has its own tables.
pub(crate) const ENDS: [f64; 10] = [0.0, 0.75, 1.5, 3.0, 4.5, 6.0, 7.5, 9.0, 10.5, 12.0];
/// Number of interpolation nodes. A table contains solved contacts with this number of contact radii. In each panel (an
/// interval of distances from the contact), the table contains values at this number of distances.
const NODES: usize = 16;
/// Width of a panel within the contact and near it, relative to the layer's thickness. A panel is an interval of
/// distances from the contact that has its own polynomial.
const PANEL: f64 = 1.0;
/// Ratio of the widths of neighbouring panels (intervals of distances) far from the contact.
const GROWTH: f64 = 1.5;
/// Terms of the pressure's series are omitted if their ratio to the largest term is below this value.
const RELATIVE_CUTOFF: f64 = 1e-12;

/// Table of solved contacts with radii in one range, for displacements at one depth.
#[derive(Clone, Debug)]
pub(super) struct Table {
    range: [f64; 2],
    /// Ends of the panels, which are intervals of distances from the contact.
    panels: Vec<f64>,
    terms: usize,
    rows: Vec<Vec<f64>>,
}

#[derive(Clone, Debug)]
pub(super) struct Entry {
    /// Four results of [`Pressure`]: the indentation, its derivative with respect to the contact's radius, and two
    /// integrals to which the force and the peak pressure are proportional.
    pub(super) numbers: [f64; 4],
    pub(super) terms: Vec<Term>,
    pub(super) panels: Panels,
}

/// Effect of the rigid base on the displacement, as polynomials of the distance from the contact.
#[derive(Clone, Debug)]
pub(super) struct Panels {
    ends: Vec<f64>,
    coefficients: Vec<f64>,
}

impl Table {
    /// Index of the table that contains contacts with the radius `contact`; `None` if the radius is beyond all tables.
    pub(super) fn place(contact: f64) -> Option<usize> {
        ENDS[1..].iter().position(|end| contact <= *end)
    }

    /// The tables for one range of contact radii: one table for each depth. Each contact is solved once, and the
    /// solution is used for all depths.
    pub(super) fn all(place: usize, depths: &[f64]) -> Result<Vec<Self>, PressError> {
        let range = [ENDS[place], ENDS[place + 1]];
        let panels = panels(range[1]);
        let distances: Vec<f64> = panels
            .windows(2)
            .flat_map(|ends| nodes([ends[0], ends[1]]))
            .collect();
        let mut pressures = Vec::new();
        for contact in nodes(range) {
            pressures.push(Pressure::solve(contact, 1.0)?);
        }
        let terms = pressures.iter().map(terms).max().unwrap_or(1);
        let deepest = depths.iter().copied().fold(0.0, f64::max);
        let (mut bessels, polynomials) = (Vec::new(), Polynomials::new());
        let mut tables: Vec<Self> = depths
            .iter()
            .map(|_| Self {
                range,
                panels: panels.clone(),
                terms,
                rows: Vec::new(),
            })
            .collect();
        for pressure in &pressures {
            // All depths use the same wavenumbers, so the Bessel functions are evaluated only once. These wavenumbers
            // are sufficient for the widest contact and the largest depth.
            let reach = range[1] + panels[panels.len() - 1] - pressure.contact;
            let spectrum = Spectrum::new(pressure, deepest, reach, 1.0);
            for (table, depth) in tables.iter_mut().zip(depths) {
                let waves = spectrum.waves(*depth);
                if bessels.is_empty() {
                    let at = |r: &f64| {
                        let waves = waves.iter();
                        waves.map(|wave| bessel(wave.wavenumber * r)).collect()
                    };
                    bessels = distances.iter().map(at).collect();
                }
                table
                    .rows
                    .push(row(pressure, terms, &waves, &bessels, &polynomials));
            }
        }
        Ok(tables)
    }

    pub(super) fn entry(&self, contact: f64) -> Entry {
        let mut row = vec![0.0; self.rows[0].len()];
        self.interpolate(contact, &mut row);
        let (numbers, rest) = row.split_at(4);
        let (terms, coefficients) = rest.split_at(2 * self.terms);
        let a = contact;
        let terms = terms
            .chunks_exact(2)
            .map(|term| [term[0] * a * a, term[1] * a]);
        Entry {
            numbers: numbers_of(numbers, a),
            terms: terms.collect(),
            panels: Panels {
                ends: self.panels.clone(),
                coefficients: coefficients
                    .chunks_exact(4 * NODES)
                    .flat_map(|panel| {
                        panel
                            .iter()
                            .enumerate()
                            .map(|(i, c)| c * a * a * if i < 2 * NODES { a } else { 1.0 })
                    })
                    .collect(),
            },
        }
    }

    pub(super) fn numbers(&self, contact: f64) -> [f64; 4] {
        let mut row = [0.0; 4];
        self.interpolate(contact, &mut row);
        numbers_of(&row, contact)
    }

    fn interpolate(&self, contact: f64, row: &mut [f64]) {
        for (share, stored) in lagrange(self.range, contact).iter().zip(&self.rows) {
            for (sum, value) in row.iter_mut().zip(stored) {
                *sum += share * value;
            }
        }
    }
}

fn numbers_of(row: &[f64], a: f64) -> [f64; 4] {
    [row[0] * a * a, row[1] * a, row[2] * a * a * a, row[3] * a]
}

impl Panels {
    /// Effect of the rigid base on the displacement at the distance `r` from the contact; 0 beyond the last panel.
    pub(super) fn field(&self, r: f64) -> Field {
        let place = self.ends[1..].partition_point(|end| *end < r);
        if place + 1 >= self.ends.len() {
            return Field::default();
        }
        let [from, to] = [self.ends[place], self.ends[place + 1]];
        let (x, per_r) = (position([from, to], r), 2.0 / (to - from));
        let panel = &self.coefficients[4 * NODES * place..4 * NODES * (place + 1)];
        let (normal, rest) = panel.split_at(NODES);
        let (radial, rest) = rest.split_at(NODES);
        let (normal_per_a, radial_per_a) = rest.split_at(NODES);
        let [normal, normal_slope] = chebyshev(normal, x);
        let [radial, radial_slope] = chebyshev(radial, x);
        Field {
            normal,
            normal_per_r: normal_slope * per_r,
            normal_per_a: chebyshev(normal_per_a, x)[0],
            radial,
            radial_per_r: radial_slope * per_r,
            radial_per_a: chebyshev(radial_per_a, x)[0],
        }
    }
}

/// A row of a table, for one contact radius a. It contains, in this order: the values [`Entry::numbers`], the terms of
/// the series of φ and of ∂φ/∂a, and Chebyshev coefficients for each panel of distances. The function φ describes the
/// pressure; see [`Pressure`]. The coefficients describe the effect of the rigid base on the normal and the radial
/// displacement, and the derivatives of this effect with respect to the contact's radius. Each value is divided by the
/// power of the radius to which it is proportional for small contacts.
fn row(
    pressure: &Pressure,
    terms: usize,
    waves: &[Wave],
    bessels: &[Vec<[f64; 3]>],
    polynomials: &Polynomials,
) -> Vec<f64> {
    let a = pressure.contact;
    let mut row = vec![
        pressure.indentation / (a * a),
        pressure.slope / a,
        pressure.force / (a * a * a),
        pressure.peak / a,
    ];
    let padded = pressure
        .terms
        .iter()
        .copied()
        .chain(std::iter::repeat([0.0; 2]));
    row.extend(
        padded
            .take(terms)
            .flat_map(|[curved, flat]| [curved / (a * a), flat / a]),
    );
    for panel in bessels.chunks_exact(NODES) {
        let mut values = [[0.0; NODES]; 4];
        for (node, bessels) in panel.iter().enumerate() {
            for (wave, [j0, j1, _]) in waves.iter().zip(bessels) {
                values[0][node] += wave.strength[0] * j0;
                values[1][node] += wave.strength[1] * j1;
                values[2][node] += wave.per_contact[0] * j0;
                values[3][node] += wave.per_contact[1] * j1;
            }
        }
        for (values, power) in values.iter().zip([a * a * a, a * a * a, a * a, a * a]) {
            row.extend(polynomials.coefficients(values).map(|c| c / power));
        }
    }
    row
}

/// Number of terms of the pressure's series up to the last term that is not negligible.
fn terms(pressure: &Pressure) -> usize {
    let largest = |column: usize| {
        let sizes = pressure.terms.iter().map(|term| term[column].abs());
        RELATIVE_CUTOFF * sizes.fold(0.0, f64::max)
    };
    let small = [largest(0), largest(1)];
    let counts = |term: &Term| (0..2).any(|column| term[column].abs() > small[column]);
    pressure
        .terms
        .iter()
        .rposition(counts)
        .map_or(1, |last| last + 1)
}

fn panels(contact: f64) -> Vec<f64> {
    let mut ends = vec![0.0];
    let (mut end, mut width) = (0.0, PANEL);
    while end < contact + BEYOND {
        end += width;
        ends.push(end);
        if end > contact + 2.0 * PANEL {
            width *= GROWTH;
        }
    }
    ends
}

/// Relative position of a value in an interval: −1 at the end `from`, and 1 at the end `to`.
fn position([from, to]: [f64; 2], value: f64) -> f64 {
    (2.0 * value - from - to) / (to - from)
}

fn angle(node: usize) -> f64 {
    PI * (node as f64 + 0.5) / NODES as f64
}

/// Chebyshev nodes in the interval from `from` to `to`.
fn nodes([from, to]: [f64; 2]) -> [f64; NODES] {
    std::array::from_fn(|node| 0.5 * (from + to) + 0.5 * (to - from) * libm::cos(angle(node)))
}

/// Weights with which the values at [`nodes`] contribute to the interpolating polynomial at `value` (Lagrange's
/// barycentric formula).
fn lagrange(range: [f64; 2], value: f64) -> [f64; NODES] {
    let x = position(range, value);
    let mut sign = -1.0;
    let mut shares: [f64; NODES] = std::array::from_fn(|node| {
        sign = -sign;
        let (sine, cosine) = libm::sincos(angle(node));
        sign * sine / (x - cosine)
    });
    if let Some(node) = shares.iter().position(|share| share.is_infinite()) {
        shares = std::array::from_fn(|other| f64::from(other == node));
    }
    let sum: f64 = shares.iter().sum();
    shares.map(|share| share / sum)
}

/// Values of the Chebyshev polynomials T₀, T₁, … at [`nodes`], one row per polynomial.
struct Polynomials([[f64; NODES]; NODES]);

impl Polynomials {
    fn new() -> Self {
        Self(std::array::from_fn(|order| {
            std::array::from_fn(|node| libm::cos(order as f64 * angle(node)))
        }))
    }

    /// Chebyshev coefficients of a function from its values at [`nodes`]. The first coefficient is the mean of these
    /// values.
    fn coefficients(&self, values: &[f64; NODES]) -> [f64; NODES] {
        std::array::from_fn(|order| {
            let products = values.iter().zip(&self.0[order]);
            let sum: f64 = products.map(|(value, polynomial)| value * polynomial).sum();
            sum * if order == 0 { 1.0 } else { 2.0 } / NODES as f64
        })
    }
}

/// Value of a Chebyshev series at x and its derivative with respect to x, computed by Clenshaw's recurrence.
fn chebyshev(coefficients: &[f64], x: f64) -> [f64; 2] {
    let ([mut b, mut b_next], [mut d, mut d_next]) = ([0.0; 2], [0.0; 2]);
    for c in coefficients[1..].iter().rev() {
        (d, d_next) = (2.0 * b + 2.0 * x * d - d_next, d);
        (b, b_next) = (c + 2.0 * x * b - b_next, b);
    }
    [coefficients[0] + x * b - b_next, b + x * d - d_next]
}

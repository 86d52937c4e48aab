//! Displacements of an incompressible half-space under the pressure of a contact.
//!
//! A point at the depth z and at the distance r from the axis is displaced by Φ − z ∂Φ/∂z inward and by −z ∂Φ/∂r
//! outward. The potential is Φ = ∫₀^a φ(t) Re[r² + (z + it)²]^{−1/2} dt, where a is the contact's radius and φ the
//! function that describes the pressure. If φ is a series of Legendre polynomials, Φ is a series of oblate spheroidal
//! harmonics (Hobson 1931, §251): for φ = Σ (−1)ʲ cₙ Pₙ(t/a) with n = 2j, z = aξη and r² = a²(1 + ξ²)(1 − η²),
//!
//! ```text
//! Φ = Σ cₙ Pₙ(η) qₙ(ξ)      (n + 1) qₙ₊₁ = n qₙ₋₁ − (2n + 1) ξ qₙ      q₀ = acot ξ
//! ```
//!
//! The terms of the sum do not grow, because |Pₙ| ≤ 1 and qₙ decreases as e^{−nϑ} with ϑ = asinh ξ. The recurrence of
//! qₙ is computed upward as long as e^{nϑ} is small, and downward otherwise.

use crate::body::Field;
use crate::half_space::{self, Spheroidal};

/// Below this ratio of the contact's radius to the distance of a point from the contact, the contact is treated as a
/// point force.
const POINT: f64 = 1e-10;
/// Limit for the upward recurrence of the radial functions qₙ of the spheroidal harmonics. The upward recurrence is
/// used if it amplifies rounding errors by at most the factor e^`UPWARD`. Otherwise a downward recurrence is used.
const UPWARD: f64 = 9.0;
/// The series ends at the order at which its terms have decayed by the factor e^−`NEGLIGIBLE`.
const NEGLIGIBLE: f64 = 32.0;
/// The downward recurrence starts at a higher order than needed, so that the error of its start value decays to e^(−2
/// `START_DECAY`).
const START_DECAY: f64 = 15.0;
/// Up to this number of orders, the values of the recurrence are stored on the stack instead of the heap.
const FEW: usize = 64;
/// Lower limit of the divisor ξ² + η², where ξ and η are spheroidal coordinates. It limits the loss of digits near the
/// contact's edge.
const EDGE: f64 = 1e-7;

/// Coefficients (−1)ʲ cₙ of the Legendre polynomial Pₙ (n = 2j) in two series: of the function φ that describes the
/// pressure, and of its derivative ∂φ/∂a.
pub(super) type Term = [f64; 2];

/// The displacements, and their derivatives, at the distance `r` and the depth `z` in a half-space. A pressure with the
/// coefficients `terms` acts within the radius `a`.
pub(super) fn field(a: f64, terms: &[Term], z: f64, r: f64) -> Field {
    if a * a < POINT * POINT * (r * r + z * z) {
        return half_space::field(0.5, z, a, r);
    }
    let mut place = Spheroidal::new(a, z, r);
    place.edge = place.edge.max(EDGE);
    let mut few = [0.0; FEW];
    let mut many = Vec::new();
    let orders = 2 * terms.len();
    let q = if orders <= FEW {
        &mut few[..orders]
    } else {
        many.resize(orders, 0.0);
        &mut many[..]
    };
    let kept = second_kind(place.xi, q);
    let [curved, flat] = sums(terms, place, &q[..kept]);
    let [normal_per_a, radial_per_a] = flat.displacement(place);
    Field {
        normal_per_a,
        radial_per_a,
        ..curved.field(place, a)
    }
}

/// Computes the radial functions q₀, q₁, … of the spheroidal harmonics at ξ = `xi` and stores them in `q`. Returns the
/// number of functions that are not negligible.
fn second_kind(xi: f64, q: &mut [f64]) -> usize {
    let angle = libm::log(xi + (1.0 + xi * xi).sqrt());
    let zeroth = libm::atan2(1.0_f64, xi);
    let last = q.len() - 1;
    if angle * last as f64 <= UPWARD {
        (q[0], q[1]) = (zeroth, 1.0 - xi * zeroth);
        for n in 1..last {
            let inverse = 1.0 / (n + 1) as f64;
            q[n + 1] = (1.0 - inverse) * q[n - 1] - (2.0 - inverse) * xi * q[n];
        }
        return last + 1;
    }
    let top = last.min((NEGLIGIBLE / angle).ceil() as usize).max(1);
    let start = top + (START_DECAY / angle).ceil() as usize;
    let (mut above, mut here) = (0.0, 1e-150);
    let mut step = |n: usize| {
        let inverse = 1.0 / n as f64;
        let below = (1.0 + inverse) * above + (2.0 + inverse) * xi * here;
        (above, here) = (here, below);
        above
    };
    for n in (top + 1..=start).rev() {
        step(n);
    }
    for n in (1..=top).rev() {
        q[n] = step(n);
    }
    let scale = zeroth / here;
    for value in &mut q[1..=top] {
        *value *= scale;
    }
    q[0] = zeroth;
    top + 1
}

#[derive(Default)]
struct Sums {
    value: f64,
    by_xi: f64,
    by_eta: f64,
    by_both: f64,
    /// The sum Σ n(n+1) cₙ Pₙ qₙ over all terms cₙ Pₙ qₙ of the series of the potential Φ. The second derivatives of Φ
    /// follow from this sum by Legendre's equation.
    weighted: f64,
}

/// The harmonic potential Φ of a pressure with the coefficients `terms`, and its derivatives, at a point. The first
/// result is for the function φ that describes the pressure. The second result is for ∂φ/∂a, where a is the contact's
/// radius, and does not contain second derivatives.
fn sums(terms: &[Term], place: Spheroidal, q: &[f64]) -> [Sums; 2] {
    let Spheroidal { xi, eta, .. } = place;
    let [mut curved, mut flat] = [Sums::default(), Sums::default()];
    // `here` and `slope` are the Legendre polynomial of the current order and its derivative. `before` and
    // `slope_before` are the polynomial of the previous order and its derivative.
    let ([mut before, mut slope_before], [mut here, mut slope]) = ([0.0, 0.0], [1.0, 0.0]);
    let mut q_before = 0.0;
    let mut n = 0.0;
    for ([c, c_flat], q) in terms.iter().zip(q.chunks(2)) {
        // `q_slope` is the derivative qₙ' of the Legendre function qₙ(ξ), multiplied by 1 + ξ². It equals n (ξ qₙ −
        // qₙ₋₁), or −1 for n = 0.
        let q_slope = if n == 0.0 {
            -1.0
        } else {
            n * (xi * q[0] - q_before)
        };
        let (value, by_xi, by_eta) = (here * q[0], here * q_slope, slope * q[0]);
        curved.value += c * value;
        curved.by_xi += c * by_xi;
        curved.by_eta += c * by_eta;
        curved.by_both += c * slope * q_slope;
        curved.weighted += c * n * (n + 1.0) * value;
        flat.value += c_flat * value;
        flat.by_xi += c_flat * by_xi;
        flat.by_eta += c_flat * by_eta;
        for next in [n + 1.0, n + 2.0] {
            let inverse = 1.0 / next;
            let above = (2.0 - inverse) * eta * here - (1.0 - inverse) * before;
            let slope_above = slope_before + (2.0 * next - 1.0) * here;
            (before, slope_before, here, slope) = (here, slope, above, slope_above);
        }
        n += 2.0;
        q_before = q.get(1).copied().unwrap_or(0.0);
    }
    let per_metric = 1.0 / (1.0 + xi * xi);
    for sums in [&mut curved, &mut flat] {
        sums.by_xi *= per_metric;
        sums.by_both *= per_metric;
    }
    [curved, flat]
}

impl Sums {
    fn displacement(&self, place: Spheroidal) -> [f64; 2] {
        let (xi, eta) = (place.xi, place.eta);
        // `lift` is z/(a (ξ² + η²)), where z is the depth, a the contact's radius, and ξ and η are the spheroidal
        // coordinates.
        let lift = xi * eta / place.edge;
        let down = eta * (1.0 + xi * xi) * self.by_xi + xi * place.off_axis * self.by_eta;
        let outward = xi * self.by_xi - eta * self.by_eta;
        [self.value - lift * down, -lift * place.r * outward]
    }

    fn field(&self, place: Spheroidal, a: f64) -> Field {
        let Spheroidal {
            xi,
            eta,
            off_axis,
            r,
            edge,
        } = place;
        let [normal, radial] = self.displacement(place);
        let metric = 1.0 + xi * xi;
        let lift = xi * eta / edge;
        // The derivatives of the potential Φ are ∂Φ/∂z = `down`/(a `edge`) and ∂Φ/∂r = r `outward`/(a² `edge`). Here z
        // is the depth, r the distance from the axis, a the contact's radius, and `edge` is ξ² + η².
        let down = eta * metric * self.by_xi + xi * off_axis * self.by_eta;
        let outward = xi * self.by_xi - eta * self.by_eta;
        let down_by_xi =
            eta * self.weighted + off_axis * self.by_eta + xi * off_axis * self.by_both;
        let down_by_eta = metric * self.by_xi + eta * metric * self.by_both - xi * self.weighted;
        // `edge` is ξ² + η², with the spheroidal coordinates ξ and η. The operator ξ ∂/∂ξ − η ∂/∂η changes it to 2(ξ² −
        // η²).
        let stretch = 2.0 * (xi * xi - eta * eta) / edge;
        let down_outward = xi * down_by_xi - eta * down_by_eta - stretch * down;
        // `along_xi` is ξ² Φ_ξξ, and `along_eta` is (1 − η²) η² Φ_ηη, with second derivatives of the potential Φ.
        let along_xi = xi * xi * (self.weighted - 2.0 * xi * self.by_xi) / metric;
        let along_eta = eta * eta * (2.0 * eta * self.by_eta - self.weighted);
        let mixed = xi * self.by_xi + eta * self.by_eta - 2.0 * xi * eta * self.by_both;
        let outward_twice = off_axis * (mixed + along_xi - stretch * outward) + along_eta;
        Field {
            normal,
            normal_per_r: r / (a * edge) * (outward - lift * down_outward),
            radial,
            radial_per_r: -lift / a * (outward + metric / edge * outward_twice),
            ..Field::default()
        }
    }
}

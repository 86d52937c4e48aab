//! Oblate spheroidal coordinates about a contact.

/// A place under a contact of radius a: with depth z = aξη and distance r = a √((1 + ξ²)(1 − η²)) from the axis, ξ ≥ 0
/// counts away from the contact, where it is 0, and 0 ≤ η ≤ 1 from the surface around it to the axis.
///
/// The complex distance √(r² + (z + ia)²) is a(ξ + iη).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spheroidal {
    pub(crate) xi: f64,
    pub(crate) eta: f64,
    /// 1 − η², which η near 1 would lose.
    pub(crate) off_axis: f64,
    /// r/a.
    pub(crate) r: f64,
    /// ξ² + η², which is 0 at the edge of the contact.
    pub(crate) edge: f64,
}

impl Spheroidal {
    /// The coordinates, for lengths whose ratios have squares.
    pub(crate) fn new(a: f64, z: f64, r: f64) -> Self {
        let (z, r) = (z / a, r / a);
        let difference = (r - 1.0) * (r + 1.0) + z * z;
        let square = |offset: f64| offset * offset + z * z;
        let edge = square(r + 1.0).sqrt() * square(r - 1.0).sqrt();
        let (xi, eta) = if difference >= 0.0 {
            let xi = (0.5 * (edge + difference)).sqrt();
            (xi, if xi > 0.0 { z / xi } else { 0.0 })
        } else {
            let eta = (0.5 * (edge - difference)).sqrt();
            (z / eta, eta)
        };
        Self {
            xi,
            eta,
            off_axis: r * r / (1.0 + xi * xi),
            r,
            edge,
        }
    }
}

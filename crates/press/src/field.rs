//! Displacement of the skin under a contact, per unit of relative curvature.

/// Displacement at some distance from the middle of a contact, with its derivatives by that distance and by the
/// contact's radius, all divided by the relative curvature: F(a, r) in u = C_r F. Units: length² and length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Field {
    /// Inward displacement.
    pub normal: f64,
    /// Its derivative by the distance.
    pub normal_per_r: f64,
    /// Its derivative by the contact's radius.
    pub normal_per_a: f64,
    /// Displacement along the skin, away from the contact.
    pub radial: f64,
    /// Its derivative by the distance.
    pub radial_per_r: f64,
    /// Its derivative by the contact's radius.
    pub radial_per_a: f64,
}

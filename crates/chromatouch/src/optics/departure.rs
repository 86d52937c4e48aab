//! Departure of a sensor from what is known of it.

/// Departure of a sensor from what is known of it; none by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Departure {
    /// Length by which the magenta and the yellow discs lie deeper.
    pub depths: [f64; 2],
    /// Share by which the magenta and the yellow discs are wider.
    pub diameters: [f64; 2],
    /// Shift of the image's centre, px: columns to the right, rows down.
    pub centre_px: [f64; 2],
    /// Share by which there are more pixels per radian.
    pub px_per_rad: f64,
    /// Shift of the camera, length: along the apex's axes, and toward the apex.
    pub place: [f64; 3],
    /// Turn of the camera, rad: about the same axes.
    pub turn_rad: [f64; 3],
    /// Shares of red, green and blue light that magenta discs let through beyond those that are known.
    pub magenta: [f64; 3],
    /// Shares that yellow discs let through beyond those that are known.
    pub yellow: [f64; 3],
    /// How much larger the odd terms of a fisheye are, k3 and k5 of [`OddTerms`](super::OddTerms).
    pub odd_terms: [f64; 2],
}

impl Departure {
    /// How many numbers it has.
    pub const NUMBERS: usize = 21;

    /// Departure of these numbers, in the order of the fields.
    pub const fn of(
        [
            a,
            b,
            c,
            d,
            e,
            f,
            g,
            h,
            i,
            j,
            k,
            l,
            m,
            n,
            o,
            p,
            q,
            r,
            s,
            t,
            u,
        ]: [f64; Self::NUMBERS],
    ) -> Self {
        Self {
            depths: [a, b],
            diameters: [c, d],
            centre_px: [e, f],
            px_per_rad: g,
            place: [h, i, j],
            turn_rad: [k, l, m],
            magenta: [n, o, p],
            yellow: [q, r, s],
            odd_terms: [t, u],
        }
    }
}

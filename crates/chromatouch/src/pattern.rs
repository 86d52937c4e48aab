//! The flat pattern of a hemispherical skin: polyconic gores, as for paper globes (the 2020 paper, section III-B,
//! Fig. 3).
//!
//! A sphere of radius R is cut into n gores. At the height Rφ above the equator, a gore covers |x| ≤ (πR/n) cos φ. Its
//! outline is drawn as chords between m equal steps of the quarter circle. The gores are arranged around their common
//! apex. They never overlap: a gore spans the angle 2 atan(π/n) at the apex, less than its share 2π/n of the turn.

mod drawing;
mod error;
mod sheet;
mod strain;

use std::f64::consts::{FRAC_PI_2, PI, TAU};

pub use error::PatternError;
pub use sheet::{CuttingSheet, Discs};
pub use strain::FoldStrain;

use crate::LayoutError;

/// Least number of gores of a pattern.
pub const FEWEST_GORES: u32 = 3;

/// Largest number of gores of a pattern.
pub const MOST_GORES: u32 = 360;

/// Largest number of steps in which the quarter circle is drawn.
pub const MOST_SAMPLES: u32 = 1000;

/// Flat gores that fold to a hemisphere.
///
/// ```
/// use palpate_chromatouch::Pattern;
///
/// // A quarter of the equator of a sphere of radius 20 is 10 π wide, half of it on either side of the gore's middle.
/// let pattern = Pattern::new(4, 8, 20.0)?;
/// let [right, height] = pattern.gore()[0];
/// assert!((right - 5.0 * std::f64::consts::PI).abs() < 1e-12 && height == 0.0);
/// // The middle of the first gore is at 45° from +x.
/// let flat = pattern.flatten([3.0, 3.0])?;
/// assert_eq!(flat.gore, 0);
/// assert!(flat.across.abs() < 1e-12);
/// assert!((flat.from_apex - 18.0_f64.sqrt()).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pattern {
    gores: u32,
    samples: u32,
    radius: f64,
}

/// Point of the flat pattern for a point of the skin.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FlatPlace {
    /// Number of the gore, from 0, counter-clockwise from +x. The apex belongs to gore 0.
    pub gore: u32,
    /// Distance from the gore's middle meridian, counter-clockwise about the apex, length.
    pub across: f64,
    /// Distance from the apex along the gore's middle meridian, length.
    pub from_apex: f64,
    /// Coordinates (x, y) on the assembled pattern: the apex in the origin, seen from outside the skin.
    pub assembled: [f64; 2],
}

impl Pattern {
    /// A pattern of `gores` gores per turn. Their outlines have `samples` steps from the apex to the equator. The radius, a
    /// length, is that of the layer to be cut.
    ///
    /// # Errors
    /// [`PatternError::TooFewGores`], [`PatternError::TooManyGores`]; [`LayoutError::BadSetting`] for the others.
    pub fn new(gores: u32, samples: u32, radius: f64) -> Result<Self, PatternError> {
        strain::enough(gores)?;
        if gores > MOST_GORES {
            return Err(PatternError::TooManyGores { gores });
        }
        let good = (1..=MOST_SAMPLES).contains(&samples);
        let expected = format!("from 1 to {MOST_SAMPLES}");
        LayoutError::unless(good, "samples", f64::from(samples), &expected)?;
        let good = (1e-100..=1e100).contains(&radius);
        LayoutError::unless(good, "radius", radius, "a length from 1e-100 to 1e100")?;
        Ok(Self {
            gores,
            samples,
            radius,
        })
    }

    /// Number of gores per turn.
    pub const fn gores(&self) -> u32 {
        self.gores
    }

    /// Radius of the sphere, length.
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    /// Outline of one gore, upright: (across, height above the equator), length. Closed, counter-clockwise from the
    /// right end of the equator's edge up to the apex and down again; 2m + 1 points.
    pub fn gore(&self) -> Vec<[f64; 2]> {
        let height = self.radius * FRAC_PI_2;
        let upright = |[across, from_apex]: [f64; 2]| [across, height - from_apex];
        self.outline().map(upright).collect()
    }

    /// Point of the flat pattern for a point of the skin, given in the chart of [`Layout::places`](crate::Layout::places): the
    /// inverse of folding.
    ///
    /// # Errors
    /// [`PatternError::BeyondTheEquator`], with 0 as the number of the marker.
    pub fn flatten(&self, place: [f64; 2]) -> Result<FlatPlace, PatternError> {
        self.flatten_marker(0, place)
    }

    fn flatten_marker(&self, marker: usize, [x, y]: [f64; 2]) -> Result<FlatPlace, PatternError> {
        let from_apex = libm::hypot(x, y);
        let polar = from_apex / self.radius;
        if !(0.0..=FRAC_PI_2).contains(&polar) {
            let polar_deg = polar.to_degrees();
            return Err(PatternError::BeyondTheEquator { marker, polar_deg });
        }
        let turn = (libm::atan2(y, x) / TAU).rem_euclid(1.0) * f64::from(self.gores);
        let gore = (turn.floor() as u32).min(self.gores - 1);
        let longitude = (turn - f64::from(gore) - 0.5) * TAU / f64::from(self.gores);
        let across = longitude * libm::sin(polar) * self.radius;
        Ok(FlatPlace {
            gore,
            across,
            from_apex,
            assembled: self.assembled(gore, [across, from_apex]),
        })
    }

    /// Outline of one gore: (across, distance from the apex), in the order of [`Self::gore`].
    fn outline(&self) -> impl Iterator<Item = [f64; 2]> {
        let right = (0..=self.samples).rev().map(|step| self.edge(step));
        let left = (1..=self.samples).map(|step| self.edge(step));
        right.chain(left.map(|[across, from_apex]| [-across, from_apex]))
    }

    /// (Half-width, distance from the apex) of a gore after this many steps from its apex, length.
    fn edge(&self, step: u32) -> [f64; 2] {
        let polar = FRAC_PI_2 * f64::from(step) / f64::from(self.samples);
        let half_width = PI / f64::from(self.gores) * libm::sin(polar);
        [half_width * self.radius, polar * self.radius]
    }

    fn assembled(&self, gore: u32, [across, from_apex]: [f64; 2]) -> [f64; 2] {
        let middle = TAU * (f64::from(gore) + 0.5) / f64::from(self.gores);
        let (sin, cos) = libm::sincos(middle);
        [
            from_apex * cos - across * sin,
            from_apex * sin + across * cos,
        ]
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::Layout;
    use approx::assert_relative_eq;

    /// Signed area and length of a closed line.
    pub(super) fn area_and_length(outline: &[[f64; 2]]) -> (f64, f64) {
        let next = outline.iter().cycle().skip(1);
        let sides = outline.iter().zip(next);
        sides.fold((0.0, 0.0), |(area, length), ([x, y], [u, v])| {
            (
                area + 0.5 * (x * v - u * y),
                length + libm::hypot(u - x, v - y),
            )
        })
    }

    /// Complete elliptic integral of the second kind of the parameter m, by the arithmetic-geometric mean.
    fn elliptic_e(parameter: f64) -> f64 {
        let (mut a, mut b, mut sum, mut weight) = (1.0, (1.0 - parameter).sqrt(), parameter, 1.0);
        for _ in 0..8 {
            let c: f64 = 0.5 * (a - b);
            (a, b) = (0.5 * (a + b), (a * b).sqrt());
            weight *= 2.0;
            sum += weight * c * c;
        }
        FRAC_PI_2 / a * (1.0 - 0.5 * sum)
    }

    #[test]
    fn a_gore_of_two_steps_has_five_corners() {
        let (radius, gores) = (20.0, 4);
        let outline = Pattern::new(gores, 2, radius).unwrap().gore();
        let (quarter, height) = (5.0 * PI, 10.0 * PI);
        let half = quarter * 0.5_f64.sqrt();
        let expected = [
            [quarter, 0.0],
            [half, 0.5 * height],
            [0.0, height],
            [-half, 0.5 * height],
            [-quarter, 0.0],
        ];
        assert_eq!(outline.len(), 5);
        for (corner, expected) in outline.iter().zip(&expected) {
            assert_relative_eq!(corner[..], expected[..], epsilon = 1e-13);
        }
        assert_eq!(outline[2], [0.0, height]);
    }

    #[test]
    fn a_gore_is_as_large_as_its_share_of_the_hemisphere() {
        for (gores, samples) in [(3, 1), (4, 7), (12, 1000)] {
            let radius: f64 = 20.0;
            let outline = Pattern::new(gores, samples, radius).unwrap().gore();
            assert_eq!(outline.len(), 2 * samples as usize + 1);
            let (area, _) = area_and_length(&outline);
            // The chords enclose less area than the curve of the sine, by a share of 1 − (h/2) cot(h/2).
            let half_step = 0.25 * PI / f64::from(samples);
            let chords = half_step / libm::tan(half_step);
            let share = TAU * radius * radius / f64::from(gores);
            assert_relative_eq!(area, share * chords, max_relative = 1e-12);
        }
    }

    #[test]
    fn seams_are_as_long_as_the_arc_of_a_cosine() {
        for gores in [3, 4, 12] {
            let outline = Pattern::new(gores, 1000, 20.0).unwrap().gore();
            let (_, length) = area_and_length(&outline);
            let slope = PI / f64::from(gores);
            // ∫ √(1 + a² sin²) over a quarter circle, twice, and the equator's edge.
            let stretched = 1.0 + slope * slope;
            let seam = 20.0 * stretched.sqrt() * elliptic_e(slope * slope / stretched);
            let expected = 2.0 * seam + 2.0 * 20.0 * slope;
            assert_relative_eq!(length, expected, max_relative = 1e-6);
        }
        // E of the parameter 1/2.
        assert_relative_eq!(
            elliptic_e(0.5),
            1.350_643_881_047_675_5,
            max_relative = 1e-14
        );
    }

    #[test]
    fn flattened_markers_fold_back_to_their_places() {
        let radius = 20.0;
        for gores in [3, 4, 5, 360] {
            let pattern = Pattern::new(gores, 8, radius).unwrap();
            for place in Layout::published().places(radius).unwrap() {
                let flat = pattern.flatten(place).unwrap();
                let middle = TAU * (f64::from(flat.gore) + 0.5) / f64::from(gores);
                let height = radius * FRAC_PI_2 - flat.from_apex;
                let shrunk = radius * libm::cos(height / radius);
                let azimuth = middle
                    + if shrunk > 0.0 {
                        flat.across / shrunk
                    } else {
                        0.0
                    };
                assert_relative_eq!(
                    place[0],
                    flat.from_apex * libm::cos(azimuth),
                    epsilon = 1e-12
                );
                assert_relative_eq!(
                    place[1],
                    flat.from_apex * libm::sin(azimuth),
                    epsilon = 1e-12
                );
                let half_width = PI * shrunk / f64::from(gores);
                assert!(flat.across.abs() <= half_width + 1e-12);
                // On the flat sheet, too, a gore lies in its share of the turn.
                let [x, y] = flat.assembled;
                assert_relative_eq!(
                    libm::hypot(x, y),
                    libm::hypot(flat.from_apex, flat.across),
                    epsilon = 1e-12
                );
                let along = x * libm::cos(middle) + y * libm::sin(middle);
                assert_relative_eq!(along, flat.from_apex, epsilon = 1e-12);
            }
        }
    }

    #[test]
    fn three_markers_of_a_row_lie_in_the_middles_of_thirds_of_its_width() {
        let pattern = Pattern::new(4, 8, 20.0).unwrap();
        let places = Layout::published().places(20.0).unwrap();
        // Three markers at 23.8°: thirds of the width 2 · 5π · sin 23.8° = 12.678 mm.
        let across: Vec<f64> = places[5..8]
            .iter()
            .map(|place| pattern.flatten(*place).unwrap().across)
            .collect();
        let expected = [-4.225_916_46, 0.0, 4.225_916_46];
        assert_relative_eq!(across[..], expected[..], epsilon = 1e-8);
    }

    #[test]
    fn impossible_patterns_are_named() {
        for (gores, samples, radius, name) in [
            (0, 8, 20.0, "too-few-gores"),
            (1, 8, 20.0, "too-few-gores"),
            (2, 8, 20.0, "too-few-gores"),
            (361, 8, 20.0, "too-many-gores"),
            (u32::MAX, 8, 20.0, "too-many-gores"),
            (4, 0, 20.0, "bad-setting"),
            (4, 1001, 20.0, "bad-setting"),
            (4, 8, 0.0, "bad-setting"),
            (4, 8, -1.0, "bad-setting"),
            (4, 8, f64::NAN, "bad-setting"),
            (4, 8, f64::INFINITY, "bad-setting"),
            (4, 8, 5e-324, "bad-setting"),
        ] {
            let error = Pattern::new(gores, samples, radius).unwrap_err();
            assert_eq!(error.name(), name, "{error}");
        }
        let pattern = Pattern::new(4, 8, 20.0).unwrap();
        for place in [[31.5, 0.0], [f64::NAN, 0.0], [0.0, f64::INFINITY]] {
            let error = pattern.flatten(place).unwrap_err();
            assert_eq!(error.name(), "beyond-the-equator");
        }
    }

    #[test]
    fn small_and_large_patterns_are_alike() {
        let unit = Pattern::new(5, 9, 1.0).unwrap();
        for scale in [1e-100, 1e-9, 1e9, 1e100] {
            let pattern = Pattern::new(5, 9, scale).unwrap();
            for (corner, unit) in pattern.gore().iter().zip(unit.gore()) {
                assert_relative_eq!(corner[0] / scale, unit[0], epsilon = 1e-14);
                assert_relative_eq!(corner[1] / scale, unit[1], epsilon = 1e-14);
            }
            let flat = pattern.flatten([0.3 * scale, -0.4 * scale]).unwrap();
            let expected = unit.flatten([0.3, -0.4]).unwrap();
            assert_relative_eq!(flat.across / scale, expected.across, epsilon = 1e-14);
        }
    }
}

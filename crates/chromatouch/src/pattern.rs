//! The flat pattern of a hemispherical skin (the 2020 paper, section III-B, Fig. 3).
//!
//! The skin of a sphere of radius R is cut into n gores, which are flat pieces like those of a paper globe. At the
//! distance Rφ above the equator, a gore covers |x| ≤ (πR/n) cos φ. Its outline is drawn as a polygon: each side of a
//! gore has m chords, one for each of m equal steps of latitude. The gores are arranged around their common apex. The
//! gores never overlap: a gore spans the angle 2 atan(π/n) at the apex, which is less than its share 2π/n of the full
//! turn.

mod drawing;
mod sheet;
mod strain;

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use palpate_statistics::Number;
use strum::IntoStaticStr;
use thiserror::Error;

use crate::LayoutError;

pub use sheet::{CuttingSheet, Discs};
pub use strain::FoldStrain;

/// Smallest allowed number of gores (flat pieces of the skin) of a pattern.
pub(crate) const FEWEST_GORES: u32 = 3;

pub(crate) const MOST_GORES: u32 = 360;

/// Largest allowed number of chords for one side of a gore's outline, from the apex to the equator.
const MOST_SAMPLES: u32 = 1000;

/// Flat pieces of skin (gores) that can be folded to a hemisphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pattern {
    gores: u32,
    samples: u32,
    radius: f64,
}

/// The point of the flat pattern that lies at a given point of the skin after folding.
#[derive(Clone, Copy, Debug, PartialEq)]
struct FlatPlace {
    /// Number of the gore (flat piece of the skin), counted from 0 counter-clockwise from +x. The apex belongs to gore
    /// 0.
    gore: u32,
    /// Distance (length) from the gore's middle meridian; positive counter-clockwise around the apex.
    across: f64,
    from_apex: f64,
    /// Coordinates (x, y) on the assembled pattern (length). The apex is at the origin, and the skin is viewed from
    /// outside.
    assembled: [f64; 2],
}

impl Pattern {
    /// A pattern of `gores` gores per turn. The outline of a gore has `samples` steps from the apex to the equator.
    /// `radius` is the radius (length) of the sphere onto which the cut layer is folded.
    ///
    /// # Errors
    /// [`PatternError::TooFewGores`], [`PatternError::TooManyGores`]; [`LayoutError::BadSetting`] if `samples` or
    /// `radius` is out of range.
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

    /// Point of the flat pattern at which the marker with the index `marker` lies. `[x, y]` is the marker's place on
    /// the skin, in the coordinates of [`Layout::places`](crate::Layout::places).
    fn flatten(&self, marker: usize, [x, y]: [f64; 2]) -> Result<FlatPlace, PatternError> {
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

    /// Closed outline of one gore. Each point consists of two lengths: the distance from the middle meridian and the
    /// distance from the apex. The outline goes from the right end of the gore's edge at the equator up to the apex and
    /// down again. It has 2m + 1 points, where m is the number of steps per side.
    fn outline(&self) -> impl Iterator<Item = [f64; 2]> {
        let right = (0..=self.samples).rev().map(|step| self.edge(step));
        let left = (1..=self.samples).map(|step| self.edge(step));
        right.chain(left.map(|[across, from_apex]| [-across, from_apex]))
    }

    /// Point of the outline that is `step` steps from the apex. It consists of half the width of the gore at this
    /// point, and of the distance from the apex; both are lengths.
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

/// Reason why a flat pattern is impossible.
#[derive(Clone, Debug, Error, IntoStaticStr, PartialEq)]
#[strum(serialize_all = "kebab-case")]
pub enum PatternError {
    /// A setting is out of its range, or the layout is impossible.
    #[error(transparent)]
    #[strum(transparent)]
    Layout(#[from] LayoutError),
    /// There are too few gores. They would be so wide that folding would stretch the skin to more than twice its length
    /// in some places.
    #[error("gores is {gores}; it must be at least {FEWEST_GORES}{}", stretched(*.strain))]
    TooFewGores {
        /// Requested number of gores.
        gores: u32,
        /// Largest strain of a skin that is folded from this number of gores; `None` for 0 gores.
        strain: Option<f64>,
    },
    /// There are more gores than allowed.
    #[error("gores is {gores}; a pattern has at most {MOST_GORES}")]
    TooManyGores {
        /// Requested number of gores.
        gores: u32,
    },
    /// A marker is beyond the equator, where the gores end.
    #[error("marker {marker} lies {polar_deg:.4} degrees from the apex; the gores end at 90")]
    BeyondTheEquator {
        /// Index of the marker in the layout, from 0.
        marker: usize,
        /// Polar angle of the marker, degrees.
        polar_deg: f64,
    },
    /// The discs of two markers overlap on the flat pattern.
    #[error(
        "the discs of markers {first} and {second} overlap: their diameter is {diameter}, their \
         distance is {distance}",
        diameter = Number(*diameter), distance = Number(*distance)
    )]
    DiscsOverlap {
        /// Index of one marker in the layout, from 0.
        first: usize,
        /// Index of the other marker in the layout, from 0.
        second: usize,
        /// Distance (length) between the centres of the two markers' discs on the flat pattern.
        distance: f64,
        /// Diameter of the larger disc of each marker (length).
        diameter: f64,
    },
    /// A disc would be cut, because it crosses the edge of its gore. The disc at the apex is an exception.
    #[error(
        "the disc of marker {marker} would be cut: its diameter is {diameter}, but its centre is \
         only {distance} inside the gore's edge",
        diameter = Number(*diameter), distance = Number(*distance)
    )]
    DiscAcrossEdge {
        /// Index of the marker in the layout, from 0.
        marker: usize,
        /// Distance (length) from the disc's centre to the nearest edge of the gore.
        distance: f64,
        /// Diameter of the larger disc of the marker (length).
        diameter: f64,
    },
    /// The drawing is too small or too large for a file in millimetres.
    #[error(
        "the sphere's radius would be {radius_mm} mm; a drawing needs from {least} to {most}",
        radius_mm = Number(*radius_mm), least = Number(*least), most = Number(*most)
    )]
    NotDrawable {
        /// Radius of the sphere, mm.
        radius_mm: f64,
        /// Smallest allowed radius (mm) of the sphere whose pattern is drawn.
        least: f64,
        /// Largest allowed radius (mm) of the sphere whose pattern is drawn.
        most: f64,
    },
}

fn stretched(strain: Option<f64>) -> String {
    strain.map_or_else(String::new, |strain| {
        format!(
            " (folding would stretch gores of this width by up to {:.0} %)",
            100.0 * strain
        )
    })
}

impl PatternError {}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::Layout;
    use approx::assert_relative_eq;

    #[test]
    fn flattened_markers_fold_back_to_their_places() {
        let radius = 20.0;
        for gores in [3, 4, 5, 360] {
            let pattern = Pattern::new(gores, 8, radius).unwrap();
            for place in Layout::published().places(radius).unwrap() {
                let flat = pattern.flatten(0, place).unwrap();
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
                // The gores (flat pieces of the skin) do not overlap on the sheet, because each gore stays within its
                // share of the full turn.
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
    fn impossible_patterns_are_named() {
        for (gores, samples, radius, name) in [
            (0, 8, 20.0, "too-few-gores"),
            (2, 8, 20.0, "too-few-gores"),
            (361, 8, 20.0, "too-many-gores"),
            (4, 0, 20.0, "bad-setting"),
            (4, 1001, 20.0, "bad-setting"),
            (4, 8, 0.0, "bad-setting"),
            (4, 8, f64::NAN, "bad-setting"),
            (4, 8, 5e-324, "bad-setting"),
        ] {
            let error = Pattern::new(gores, samples, radius).unwrap_err();
            assert_eq!(<&str>::from(&error), name, "{error}");
        }
        let pattern = Pattern::new(4, 8, 20.0).unwrap();
        for place in [[31.5, 0.0], [f64::NAN, 0.0], [0.0, f64::INFINITY]] {
            let error = pattern.flatten(0, place).unwrap_err();
            assert_eq!(<&str>::from(&error), "beyond-the-equator");
        }
    }
}

//! The cutting sheet of a skin: the assembled gores, with fold marks and discs.

use std::f64::consts::FRAC_PI_2;

use super::{FlatPlace, Pattern, PatternError};
use crate::layout::too_close;
use crate::{Layout, LayoutError};

/// Diameters of a marker's two discs (length). The discs are drawn as circles on the sheet, and are sheared when the
/// sheet is folded onto the sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Discs {
    /// Diameter of the inner disc, which is nearer to the camera.
    pub magenta: f64,
    /// Diameter of the outer disc, which is nearer to the surface of the skin.
    pub yellow: f64,
}

/// A flat pattern for cutting, with the markers of a layout.
///
/// ```
/// use palpate_chromatouch::{Discs, Layout, Pattern};
///
/// // In millimetres: a skin of radius 20, cut in four gores.
/// let discs = Discs { magenta: 2.0, yellow: 2.0 };
/// let sheet = Pattern::new(4, 24, 20.0)?.sheet(&Layout::published(), discs)?;
/// assert_eq!(sheet.svg(1.0)?.matches("<polygon").count(), 4);
/// assert!(sheet.svg(1.0)?.contains("MAGENTA"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CuttingSheet {
    radius: f64,
    discs: Discs,
    cuts: Vec<Vec<[f64; 2]>>,
    marks: Vec<[[f64; 2]; 2]>,
    centres: Vec<[f64; 2]>,
}

impl Pattern {
    /// The assembled pattern, with both discs of each marker of the layout. All gores meet at the apex. A disc at the
    /// apex is drawn as a full circle, although its parts in the gaps between the gores are cut off.
    ///
    /// # Errors
    /// [`PatternError`] if the layout or the discs are impossible, if a marker is beyond the equator, or if discs
    /// overlap or cross an edge.
    pub fn sheet(&self, layout: &Layout, discs: Discs) -> Result<CuttingSheet, PatternError> {
        for (setting, diameter) in [("magenta", discs.magenta), ("yellow", discs.yellow)] {
            let good = diameter > 0.0 && diameter.is_finite();
            LayoutError::unless(good, setting, diameter, "finite and > 0")?;
        }
        let places = layout.places(self.radius)?;
        let markers = places.into_iter().enumerate();
        let flat: Vec<FlatPlace> = markers
            .map(|(marker, place)| self.flatten(marker, place))
            .collect::<Result<_, _>>()?;
        let centres: Vec<[f64; 2]> = flat.iter().map(|place| place.assembled).collect();
        let diameter = discs.magenta.max(discs.yellow);
        apart(&centres, diameter, 1e-9 * self.radius)?;
        self.within_edges(&flat, diameter)?;
        let gores = 0..self.gores;
        Ok(CuttingSheet {
            radius: self.radius,
            discs,
            cuts: gores.clone().map(|gore| self.cut(gore)).collect(),
            marks: gores.flat_map(|gore| self.marks(gore)).collect(),
            centres,
        })
    }

    fn cut(&self, gore: u32) -> Vec<[f64; 2]> {
        let outline = self.outline();
        outline.map(|place| self.assembled(gore, place)).collect()
    }

    /// The middle meridian of a gore, and marks on both of its seams. The marks are at one third and two thirds of the
    /// distance from the apex to the equator. The length of a mark is 1/20 of half the gore's width. The marks of
    /// neighbouring gores meet after folding.
    fn marks(&self, gore: u32) -> Vec<[[f64; 2]; 2]> {
        let equator = self.radius * FRAC_PI_2;
        let mut marks = vec![[[0.0, 0.0], [0.0, equator]]];
        for share in [1.0 / 3.0, 2.0 / 3.0] {
            let half_width = self.chord_half_width(share);
            for side in [-half_width, half_width] {
                marks.push([side, 0.95 * side].map(|across| [across, share * equator]));
            }
        }
        let place = |mark: [[f64; 2]; 2]| mark.map(|end| self.assembled(gore, end));
        marks.into_iter().map(place).collect()
    }

    /// Half the width of a gore as drawn, that is, with chords instead of curved edges. `share` (less than 1) is the
    /// distance from the apex, divided by the distance between apex and equator.
    fn chord_half_width(&self, share: f64) -> f64 {
        let steps = share * f64::from(self.samples);
        let [inner, outer] = [0, 1].map(|more| self.edge(steps.floor() as u32 + more)[0]);
        inner + (outer - inner) * steps.fract()
    }

    /// Checks that each disc is inside the drawn outline of its gore, which is convex. A disc at the apex may cross the
    /// seams.
    fn within_edges(&self, places: &[FlatPlace], diameter: f64) -> Result<(), PatternError> {
        let chords: Vec<[[f64; 2]; 2]> = (0..self.samples)
            .map(|step| [self.edge(step), self.edge(step + 1)])
            .collect();
        for (marker, place) in places.iter().enumerate() {
            let equator = self.radius * FRAC_PI_2 - place.from_apex;
            let beside = [place.across.abs(), place.from_apex];
            let at_apex = place.from_apex == 0.0;
            let seams = chords.iter().filter(|_| !at_apex);
            let distance = seams
                .map(|chord| inside(chord, beside))
                .fold(equator, f64::min);
            if distance < 0.5 * diameter {
                return Err(PatternError::DiscAcrossEdge {
                    marker,
                    distance,
                    diameter,
                });
            }
        }
        Ok(())
    }
}

/// Distance of a point from the line through a chord of a gore's right edge, positive if the point is inside the gore.
/// `across` is the distance of the point from the gore's middle meridian, and `from_apex` its distance from the apex.
fn inside(&[[x, y], [u, v]]: &[[f64; 2]; 2], [across, from_apex]: [f64; 2]) -> f64 {
    let length = libm::hypot(u - x, v - y);
    (u - x) / length * (from_apex - y) - (v - y) / length * (across - x)
}

/// Checks that discs with the diameter `diameter` do not overlap. Discs overlap if their centres are closer than the
/// diameter.
fn apart(centres: &[[f64; 2]], diameter: f64, narrowest: f64) -> Result<(), PatternError> {
    match too_close(centres, diameter, narrowest) {
        None => Ok(()),
        Some(pair) => Err(PatternError::DiscsOverlap {
            first: pair.first,
            second: pair.second,
            distance: pair.distance,
            diameter,
        }),
    }
}

impl CuttingSheet {
    /// Closed outlines of the gores, as points in counter-clockwise order. The coordinates (x, y) of a point are
    /// lengths. The apex is at the origin, and the skin is viewed from outside.
    pub(super) fn cuts(&self) -> &[Vec<[f64; 2]>] {
        &self.cuts
    }

    pub(super) fn marks(&self) -> &[[[f64; 2]; 2]] {
        &self.marks
    }

    pub(super) fn centres(&self) -> &[[f64; 2]] {
        &self.centres
    }

    pub(super) const fn discs(&self) -> Discs {
        self.discs
    }

    pub(super) const fn radius(&self) -> f64 {
        self.radius
    }

    pub(super) fn scaled(&self, factor: f64) -> Self {
        let place = |place: &[f64; 2]| place.map(|coordinate| coordinate * factor);
        let cut = |outline: &Vec<[f64; 2]>| outline.iter().map(place).collect();
        let mark = |ends: &[[f64; 2]; 2]| ends.map(|end| place(&end));
        Self {
            radius: self.radius * factor,
            discs: Discs {
                magenta: self.discs.magenta * factor,
                yellow: self.discs.yellow * factor,
            },
            cuts: self.cuts.iter().map(cut).collect(),
            marks: self.marks.iter().map(mark).collect(),
            centres: self.centres.iter().map(place).collect(),
        }
    }

    /// Half the side of a square around the apex that contains the drawing and a margin.
    pub(super) fn half_side(&self) -> f64 {
        let corners = self.cuts.iter().flatten();
        1.05 * corners
            .map(|[x, y]| libm::hypot(*x, *y))
            .fold(0.0, f64::max)
    }
}

//! The displacement field of the skin, interpolated between the displacements of the markers.

use palpate_statistics::Number;
use spade::{DelaunayTriangulation, FloatTriangulation, HasPosition, Point2, Triangulation};
use thiserror::Error;

use crate::camera::great_circle;

/// A place on the skin, with the displacement of the skin at this place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Displaced {
    /// Coordinates (rad) of the place at rest: the direction from the apex, with the angle from the apex as length
    /// (logarithm map).
    pub place: [f64; 2],
    /// Displacement along the skin (length). Its components are along the axes at the apex, parallel-transported along
    /// the meridian to the place.
    pub tangential: [f64; 2],
    /// Inward displacement of the skin at the place (length).
    pub normal: f64,
}

/// Reason why a displacement field cannot be computed.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum FieldError {
    /// There are no markers between which a field can be interpolated.
    #[error("a displacement field needs at least one marker, but there is none")]
    NoMarkers,
    /// A displacement or coordinate of a marker is not finite or too large, or the marker is more than half a turn away
    /// from the apex.
    #[error(
        "marker {marker} (counting from 0): its displacement is not finite or beyond 1e100, or \
         its position is more than half a turn from the apex"
    )]
    OutOfRange {
        /// Index of the wrong marker, counted from 0.
        marker: usize,
    },
    /// Two markers have the same place.
    #[error("marker {marker} (counting from 0) has the same place as an earlier marker")]
    Coincident {
        /// The larger of the indices of the two markers, counted from 0.
        marker: usize,
    },
    /// The standard deviation of the smoothing filter is out of range.
    #[error(
        "the filter's standard deviation is {value} rad; it must be at least 0 and finite",
        value = Number(*value)
    )]
    BadFilter {
        /// Standard deviation of the smoothing filter, rad.
        value: f64,
    },
}

/// The displacement field of the skin. Between the markers, the displacements are interpolated by natural-neighbour
/// interpolation. The interpolation is continuous everywhere, and smooth except at the markers. Outside of the convex
/// hull of the markers, the field is not defined.
///
/// ```
/// use palpate_tracking::{Displaced, Field};
///
/// let markers = [[0.0, 0.0], [0.2, 0.0], [0.0, 0.2], [0.2, 0.2]].map(|[x, y]| Displaced {
///     place: [x, y],
///     tangential: [0.0, 0.0],
///     normal: 1.0 - x + 0.5 * y,
/// });
/// let field = Field::new(&markers)?;
/// // Natural-neighbour interpolation is exact for linear fields. Outside the convex hull there is no displacement.
/// let found = field.at([0.05, 0.1]).ok_or("outside")?;
/// assert!((found.normal - 1.0).abs() < 1e-9);
/// assert_eq!(field.at([0.3, 0.1]), None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Field {
    markers: Vec<Displaced>,
    triangulation: DelaunayTriangulation<Site>,
}

#[derive(Clone, Copy, Debug)]
struct Site {
    at: Point2<f64>,
    marker: usize,
}

impl HasPosition for Site {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.at
    }
}

impl Field {
    /// Creates the displacement field that interpolates between `markers`.
    ///
    /// # Errors
    /// [`FieldError`] if there are no markers, if a number is out of range, or if two markers have the same place.
    pub fn new(markers: &[Displaced]) -> Result<Self, FieldError> {
        if markers.is_empty() {
            return Err(FieldError::NoMarkers);
        }
        let mut triangulation = DelaunayTriangulation::new();
        for (marker, displaced) in markers.iter().enumerate() {
            let ([x, y], [along_x, along_y]) = (displaced.place, displaced.tangential);
            let is_sound = [along_x, along_y, displaced.normal]
                .iter()
                .all(|one| one.abs() <= 1e100)
                && libm::hypot(x, y) <= std::f64::consts::PI;
            let out_of_range = FieldError::OutOfRange { marker };
            if !is_sound {
                return Err(out_of_range);
            }
            let site = Site {
                at: site(displaced.place),
                marker,
            };
            triangulation.insert(site).map_err(|_| out_of_range)?;
            if triangulation.num_vertices() <= marker {
                return Err(FieldError::Coincident { marker });
            }
        }
        Ok(Self {
            markers: markers.to_vec(),
            triangulation,
        })
    }

    /// The markers between which the field is interpolated.
    pub fn markers(&self) -> &[Displaced] {
        &self.markers
    }

    /// Returns a smoothed displacement field, in which the displacement of each marker is replaced by a weighted mean
    /// of the displacements of all markers. The weights are a Gaussian function of the great-circle distance, with the
    /// standard deviation `std_rad`. If `std_rad` is 0, the field does not change.
    ///
    /// # Errors
    /// [`FieldError::BadFilter`] unless `std_rad` is finite and at least 0.
    pub fn smoothed(&self, std_rad: f64) -> Result<Self, FieldError> {
        if !(std_rad >= 0.0 && std_rad.is_finite()) {
            return Err(FieldError::BadFilter { value: std_rad });
        }
        let mean = |centre: &Displaced| {
            let weights = self.markers.iter().map(|marker| {
                let [x, y] = great_circle(centre.place, marker.place);
                let distance = libm::hypot(x, y);
                if distance == 0.0 {
                    1.0
                } else {
                    libm::exp(-0.5 * (distance / std_rad).powi(2))
                }
            });
            let weights: Vec<f64> = weights.collect();
            self.mean(centre.place, weights.into_iter().enumerate())
        };
        Ok(Self {
            markers: self.markers.iter().map(mean).collect(),
            triangulation: self.triangulation.clone(),
        })
    }

    /// The displacement at a place; `None` outside the markers' convex hull.
    pub fn at(&self, place: [f64; 2]) -> Option<Displaced> {
        if !place.iter().all(|one| one.is_finite()) {
            return None;
        }
        let weights = self.weights(site(place));
        let found = (!weights.is_empty()).then(|| self.mean(place, weights.into_iter()))?;
        let [x, y] = found.tangential;
        (x + y + found.normal).is_finite().then_some(found)
    }

    /// Interpolation weights of the markers at a point; empty if the point is outside the markers' convex hull.
    fn weights(&self, point: Point2<f64>) -> Vec<(usize, f64)> {
        // A single marker is treated separately, because its triangulation has no edges.
        if let [marker] = self.markers[..] {
            let is_there = site(marker.place) == point;
            return is_there.then_some((0, 1.0)).into_iter().collect();
        }
        let mut weights = Vec::new();
        let natural = self.triangulation.natural_neighbor();
        natural.get_weights(point, &mut weights);
        let is_mean = |(_, weight): &(_, f64)| (-1e-6..=1.0 + 1e-6).contains(weight);
        if !weights.iter().all(is_mean) {
            // In a very thin triangle, the radius of the circumcircle overflows, and natural-neighbour weights are then
            // not between 0 and 1. In this case, use the barycentric weights of the triangle.
            let corners = self.triangulation.barycentric();
            corners.get_weights(point, &mut weights);
        }
        let marker = |vertex| self.triangulation.vertex(vertex).data().marker;
        weights
            .into_iter()
            .map(|(vertex, weight)| (marker(vertex), weight))
            .collect()
    }

    /// Displacements on a grid of `count` by `count` places, row by row with increasing y. The grid covers the bounding
    /// rectangle of the markers. Places outside the convex hull of the markers are omitted.
    pub fn grid(&self, count: usize) -> Vec<Displaced> {
        let [columns, rows] = [0, 1].map(|axis| self.steps(axis, count));
        let places = rows
            .iter()
            .flat_map(|&y| columns.iter().map(move |&x| [x, y]));
        places.filter_map(|place| self.at(place)).collect()
    }

    /// The `count` coordinates of the grid along an axis, evenly spaced from the smallest to the largest coordinate of
    /// the markers.
    fn steps(&self, axis: usize, count: usize) -> Vec<f64> {
        let all = || self.markers.iter().map(|marker| marker.place[axis]);
        let low = all().fold(f64::INFINITY, f64::min);
        let high = all().fold(f64::NEG_INFINITY, f64::max);
        let middle = 0.5 * (low + high);
        match count {
            1 => vec![middle],
            // This form of the linear interpolation has no rounding error at its ends, which are the smallest and the
            // largest coordinate.
            _ => (0..count)
                .map(|step| step as f64 / (count as f64 - 1.0))
                .map(|share| low * (1.0 - share) + high * share)
                .collect(),
        }
    }

    fn mean(&self, place: [f64; 2], weights: impl Iterator<Item = (usize, f64)>) -> Displaced {
        let mut sum = [0.0; 4];
        for (marker, weight) in weights {
            let displaced = self.markers[marker];
            let [x, y] = displaced.tangential;
            for (sum, part) in sum.iter_mut().zip([x, y, displaced.normal, 1.0]) {
                *sum += weight * part;
            }
        }
        let [x, y, normal, total] = sum;
        Displaced {
            place,
            tangential: [x / total, y / total],
            normal: normal / total,
        }
    }

    /// Mean displacement of the skin (length) away from the centre of the contact, along the skin. The marker with the
    /// largest normal displacement counts as the centre of the contact. The mean is over all other markers, weighted by
    /// their inward displacements. A positive result means that the skin slips on the object, or that the object pushes
    /// the skin aside. The result is `None` if no other marker was displaced inward.
    pub fn outward(&self) -> Option<f64> {
        let normals = self.markers.iter().map(|marker| marker.normal).enumerate();
        let (centre, largest) = normals.fold((0, f64::NEG_INFINITY), |best, one| {
            if one.1 > best.1 { one } else { best }
        });
        let away = |marker: &Displaced| {
            let [x, y] = great_circle(marker.place, self.markers[centre].place);
            let distance = libm::hypot(x, y);
            if distance == 0.0 {
                return 0.0;
            }
            let [along_x, along_y] = marker.tangential;
            -(along_x * (x / distance) + along_y * (y / distance))
        };
        let markers = self.markers.iter().enumerate();
        let others = markers.filter(|(marker, _)| *marker != centre && largest > 0.0);
        let (sum, total) = others.fold((0.0, 0.0), |(sum, total), (_, marker)| {
            let weight = (marker.normal / largest).max(0.0);
            (sum + weight * away(marker), total + weight)
        });
        (total > 0.0).then(|| sum / total)
    }
}

/// A place on the skin as a point of the triangulation. Coordinates with a magnitude below 1e-30 are replaced by 0,
/// because the triangulation rejects very small numbers.
fn site(place: [f64; 2]) -> Point2<f64> {
    let [x, y] = place.map(|one| if one.abs() < 1e-30 { 0.0 } else { one });
    Point2::new(x, y)
}

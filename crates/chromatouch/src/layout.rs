//! Layouts of markers on a spherical skin.

use std::collections::HashMap;
use std::f64::consts::TAU;

use palpate_sensing::UniformLattice;
use palpate_statistics::BadSetting;

use crate::LayoutError;

pub(crate) const MOST_MARKERS: usize = 100_000;

/// An arrangement of markers around the apex of a spherical skin.
///
/// ```
/// use palpate_chromatouch::Layout;
///
/// // The apex, and 1 + 3 + 3 + 5 + 7 markers in each of four gores.
/// let places = Layout::published().places(20.0)?;
/// assert_eq!(places.len(), 77);
/// assert_eq!(places[0], [0.0, 0.0]);
/// // The first row lies 11.9° from the apex along the skin.
/// let [x, y] = places[1];
/// assert!((libm::hypot(x, y) - 20.0 * 11.9_f64.to_radians()).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Layout {
    /// One marker at the apex, and rows of markers in each of several equal gores. A gore is a flat piece of the skin;
    /// the gores are folded onto the sphere.
    Gores {
        /// Number of gores (flat pieces of the skin) around the sphere.
        gores: u32,
        /// Number of markers in each row of a gore, starting with the row next to the apex. The markers of a row are
        /// evenly spaced over the gore's width.
        rows: Vec<u32>,
        /// Angle at the sphere's centre between neighbouring rows, degrees.
        row_spacing_deg: f64,
    },
    /// Markers that are spread evenly over a spherical cap around the apex. On average, there is one marker per area of
    /// pitch².
    Lattice {
        /// Distance between neighbouring markers (length).
        pitch: f64,
        /// Polar angle of the cap's rim, degrees.
        cap_deg: f64,
    },
    /// A rectangular grid of markers, with rows along x and columns along y and the apex in the middle.
    Grid {
        /// Distance between neighbouring markers (length).
        pitch: f64,
        /// Distances (length) between the outermost markers of the grid, along x and along y.
        size: [f64; 2],
    },
    /// Equally spaced markers on a great circle that passes through the apex along x. The apex is in the middle.
    Line {
        /// Number of markers on the line.
        markers: u32,
        /// Distance (length) between the first and the last marker along the skin.
        length: f64,
    },
    /// Equally spaced markers along +x, starting at the apex.
    Radius {
        /// Number of markers along +x.
        markers: u32,
        /// Distance (length) between the first and the last marker along the skin.
        length: f64,
    },
}

impl Layout {
    /// The 77 visible markers of the sensor in the 2020 paper, estimated from its photograph. One marker is at the
    /// apex. Each of the four gores (flat pieces of the skin) has rows of 1, 3, 3, 5 and 7 markers. The rows are 11.9°
    /// apart.
    pub fn published() -> Self {
        Self::Gores {
            gores: 4,
            rows: vec![1, 3, 3, 5, 7],
            row_spacing_deg: 11.9,
        }
    }

    /// Skin coordinates (x, y) of the markers (lengths). `sensor_radius` is the radius of the skin (length), which is
    /// infinite for a flat skin. A marker lies in the direction (x, y) from the apex, at the distance √(x² + y²) along
    /// the skin (the logarithm map of the sphere at the apex). The markers are sorted from the apex outward.
    /// Exceptions: the markers of a [`Layout::Line`] are sorted along +x, and the markers of a [`Layout::Grid`] by y
    /// and then by x.
    ///
    /// # Errors
    /// [`LayoutError`] if the radius is out of range or the layout is impossible.
    pub fn places(&self, sensor_radius: f64) -> Result<Vec<[f64; 2]>, LayoutError> {
        // The radius is limited so that the circumference of the sphere does not overflow.
        let is_flat = sensor_radius == f64::INFINITY;
        let good = sensor_radius > 0.0 && sensor_radius <= 1e300 || is_flat;
        LayoutError::unless(good, "radius", sensor_radius, "above 0 and at most 1e300")?;
        match self {
            Self::Gores { .. } | Self::Lattice { .. } if is_flat => Err(LayoutError::NoAngles),
            Self::Gores {
                gores,
                rows,
                row_spacing_deg,
            } => in_gores(*gores, rows, *row_spacing_deg, sensor_radius),
            Self::Lattice { pitch, cap_deg } => on_lattice(*pitch, *cap_deg, sensor_radius),
            Self::Grid { pitch, size } => in_grid(*pitch, *size, sensor_radius),
            Self::Line { markers, length } => {
                let steps = equal_steps(*markers, *length, 0.5 * length, sensor_radius)?;
                Ok(steps.map(|along| [along - 0.5 * length, 0.0]).collect())
            }
            Self::Radius { markers, length } => {
                let steps = equal_steps(*markers, *length, *length, sensor_radius)?;
                Ok(steps.map(|along| [along, 0.0]).collect())
            }
        }
    }
}

fn few_enough(markers: f64) -> Result<(), LayoutError> {
    if markers <= MOST_MARKERS as f64 {
        return Ok(());
    }
    Err(LayoutError::TooManyMarkers {
        markers,
        limit: MOST_MARKERS,
    })
}

fn within_half_turn(setting: &'static str, reach_deg: f64) -> Result<(), LayoutError> {
    if reach_deg < 180.0 {
        return Ok(());
    }
    Err(LayoutError::AroundTheSphere { setting, reach_deg })
}

fn in_gores(
    gores: u32,
    rows: &[u32],
    row_spacing_deg: f64,
    sensor_radius: f64,
) -> Result<Vec<[f64; 2]>, LayoutError> {
    LayoutError::unless(gores >= 1, "gores", f64::from(gores), "at least 1")?;
    let good = row_spacing_deg > 0.0 && row_spacing_deg.is_finite();
    LayoutError::unless(good, "row_spacing_deg", row_spacing_deg, "finite and > 0")?;
    within_half_turn("row_spacing_deg", row_spacing_deg * rows.len() as f64)?;
    let per_gore: f64 = rows.iter().map(|&markers| f64::from(markers)).sum();
    few_enough(1.0 + per_gore * f64::from(gores))?;

    let mut places = vec![[0.0, 0.0]];
    for (row, &markers) in rows.iter().enumerate() {
        let distance = sensor_radius * (row_spacing_deg * (row + 1) as f64).to_radians();
        for gore in 0..gores {
            for marker in 0..markers {
                let share = (f64::from(marker) + 0.5) / f64::from(markers);
                let azimuth = TAU * (f64::from(gore) + share) / f64::from(gores);
                places.push([distance * libm::cos(azimuth), distance * libm::sin(azimuth)]);
            }
        }
    }
    Ok(places)
}

fn on_lattice(pitch: f64, cap_deg: f64, sensor_radius: f64) -> Result<Vec<[f64; 2]>, LayoutError> {
    let good = cap_deg > 0.0 && cap_deg <= 180.0;
    LayoutError::unless(good, "cap_deg", cap_deg, "above 0 and at most 180")?;
    let half_cap = 0.5 * cap_deg.to_radians();
    // The area of a cap with its rim at the polar angle θ is sin²(θ/2) times the area of the sphere.
    let share = libm::sin(half_cap) * libm::sin(half_cap);
    let good = pitch > 0.0 && pitch.is_finite();
    LayoutError::unless(good, "pitch", pitch, "finite and > 0")?;
    let pitch_rad = pitch / sensor_radius;
    few_enough((2.0 * TAU / (pitch_rad * pitch_rad) * share).floor())?;
    let lattice = UniformLattice::with_pitch(pitch_rad).map_err(|_| BadSetting {
        setting: "pitch",
        value: pitch,
        expected: format!(
            "between {:e} and {:e}",
            1.2e-7 * sensor_radius,
            2.5 * sensor_radius
        ),
    })?;
    let places: Vec<[f64; 2]> = (0..lattice.pads())
        .map(|marker| lattice.direction(marker))
        .map(|direction| (direction, libm::hypot(direction.x, direction.y)))
        .take_while(|(direction, across)| libm::atan2(*across, direction.z) <= 2.0 * half_cap)
        .map(|(direction, across)| {
            let distance = sensor_radius * libm::atan2(across, direction.z);
            [direction.x, direction.y].map(|component| distance * component / across)
        })
        .collect();
    if places.is_empty() {
        return Err(LayoutError::NoMarker { pitch, cap_deg });
    }
    Ok(places)
}

fn in_grid(pitch: f64, size: [f64; 2], sensor_radius: f64) -> Result<Vec<[f64; 2]>, LayoutError> {
    let good = pitch > 0.0 && pitch.is_finite();
    LayoutError::unless(good, "pitch", pitch, "finite and > 0")?;
    for (setting, length) in ["width", "height"].into_iter().zip(size) {
        let good = (0.0..=1e300).contains(&length);
        LayoutError::unless(good, setting, length, "at least 0 and at most 1e300")?;
    }
    // Without the small term 1e-9, rounding errors could remove the last marker of a row.
    let [columns, rows] = size.map(|length| (length / pitch + 1e-9).floor());
    few_enough((columns + 1.0) * (rows + 1.0))?;
    let corner = 0.5 * pitch * libm::hypot(columns, rows);
    within_half_turn("width", (corner / sensor_radius).to_degrees())?;
    let place = |step: u32, steps: f64| pitch * (f64::from(step) - 0.5 * steps);
    let row = |row: u32| {
        (0..=columns as u32).map(move |column| [place(column, columns), place(row, rows)])
    };
    Ok((0..=rows as u32).flat_map(row).collect())
}

/// Distances of equally spaced markers from the first marker. There are `markers` distances, from 0 to `length`.
/// `reach` is the distance of the farthest marker from the apex; it must be less than half the circumference of the
/// sensor.
fn equal_steps(
    markers: u32,
    length: f64,
    reach: f64,
    sensor_radius: f64,
) -> Result<impl Iterator<Item = f64>, LayoutError> {
    let count = f64::from(markers);
    LayoutError::unless(markers >= 2, "markers", count, "at least 2")?;
    few_enough(count)?;
    let good = length > 0.0 && length.is_finite();
    LayoutError::unless(good, "length", length, "finite and > 0")?;
    within_half_turn("length", (reach / sensor_radius).to_degrees())?;
    let share = move |marker: u32| f64::from(marker) / (count - 1.0);
    Ok((0..markers).map(move |marker| length * share(marker)))
}

pub(crate) struct TooClose {
    /// The smaller index of the two points that are too close to each other, counted from 0.
    pub(crate) first: usize,
    pub(crate) second: usize,
    pub(crate) distance: f64,
}

/// Returns a pair of points whose distance is below `reach`; `None` if there is no such pair. If there are several
/// pairs, the function returns the pair with the smallest index `second`. For a fast search, the points are sorted into
/// square grid cells. The width of a grid cell is `reach`. If `reach` is smaller than `narrowest`, the width is
/// `narrowest`, so that the index of a grid cell fits into an integer.
pub(crate) fn too_close<const D: usize>(
    points: &[[f64; D]],
    reach: f64,
    narrowest: f64,
) -> Option<TooClose> {
    let width = reach.max(narrowest);
    let mut cells: HashMap<[i64; D], Vec<usize>> = HashMap::new();
    for (second, point) in points.iter().enumerate() {
        let cell = point.map(|coordinate| (coordinate / width).floor() as i64);
        for around in 0..3_usize.pow(D as u32) {
            let neighbour = std::array::from_fn(|axis| {
                let step = around / 3_usize.pow(axis as u32) % 3;
                cell[axis] + step as i64 - 1
            });
            for &first in cells.get(&neighbour).into_iter().flatten() {
                let distance = distance(&points[first], point);
                if distance < reach {
                    return Some(TooClose {
                        first,
                        second,
                        distance,
                    });
                }
            }
        }
        cells.entry(cell).or_default().push(second);
    }
    None
}

fn distance<const D: usize>(one: &[f64; D], other: &[f64; D]) -> f64 {
    let steps = one.iter().zip(other).map(|(one, other)| one - other);
    steps.fold(0.0, libm::hypot)
}

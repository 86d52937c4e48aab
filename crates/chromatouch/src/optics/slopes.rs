//! Derivatives of the markers' features with respect to the sensor's parameters and to the motions of the discs.
//!
//! Three numbers describe a disc: two for its direction and one for its angular radius. The derivatives of these
//! numbers are computed by exact formulas. The derivatives of the features with respect to the six numbers of both
//! discs are finite differences.

use nalgebra::{Matrix3, Matrix4x2, Matrix4x3, SMatrix, Vector4};

use super::array::MarkerSight;
use super::colours::Contrasts;
use super::projection::MarkerProjection;
use super::sight_slopes::{COLUMNS, DEEPER, INWARD, PLACE, TURN, WIDER, X};
use super::{Departure, MarkerMotion, Optics, OpticsError, SeenMarker};

/// Finite-difference step of the two components of a disc's direction (rad) and of the logarithm of the disc's angular
/// radius.
const STEP: f64 = 1e-7;
const SHARE: f64 = 1e-6;
const ODD: f64 = 1e-6;

/// Index of the first transmittance among the values of a [`Departure`].
const COLOURS: usize = 13;
/// Index of the lens's term k3 (the first odd term) among the values of a [`Departure`].
const ODD_TERMS: usize = 19;

/// The features of a marker, and their derivatives. Each matrix of derivatives has four rows, one per feature: column
/// and row of the centroid (px), hue (turns), and natural logarithm of the size.
#[derive(Clone, Debug, PartialEq)]
pub struct MarkerSlopes {
    /// The features of the marker's image.
    pub seen: SeenMarker,
    /// Derivatives of the four features with respect to the values of the [`Departure`], one column per value. The
    /// columns of values that the caller did not request are 0.
    pub by_departure: SMatrix<f64, 4, { Departure::NUMBERS }>,
    /// Derivatives of the four features with respect to the two components of the marker's misalignment, per rad (see
    /// [`MarkerArray::misalignments`](super::MarkerArray::misalignments)).
    pub by_misalignment: Matrix4x2<f64>,
    /// Derivatives of the four features with respect to the motions of the magenta and of the yellow disc, per length.
    /// The columns are for the motion inward and for the motions along the two axes of the skin.
    pub by_motion: [Matrix4x3<f64>; 2],
}

struct Shared<'a> {
    optics: &'a Optics,
    departure: &'a Departure,
    turns: [Matrix3<f64>; 3],
    /// For each requested transmittance: its index among the values of the [`Departure`], and the contributions of the
    /// marker's regions to size and hue. These contributions are computed after one finite-difference step of the
    /// transmittance.
    colours: Vec<(usize, Contrasts)>,
    requested: &'a [usize],
}

impl Optics {
    /// The features of the markers, as in [`Optics::project`], and the derivatives of these features with respect to
    /// parameters of the sensor. `departure` contains the differences between the real and the nominal parameters of
    /// the sensor. `requested` contains the indices of the parameters for which derivatives are computed. The result is
    /// `None` for markers that are not visible.
    ///
    /// The error of the derivatives is about 5e-5 of the largest derivative. The error is larger where the edges of two
    /// discs touch, because the features have a kink there.
    ///
    /// # Errors
    /// Errors of [`Optics::departed`] and of [`Optics::project`]; [`OpticsError::BadSetting`] if an index in
    /// `requested` is not less than [`Departure::NUMBERS`].
    pub fn slopes(
        &self,
        departure: &Departure,
        motions: &[Option<MarkerMotion>],
        requested: &[usize],
    ) -> Result<Vec<Option<MarkerSlopes>>, OpticsError> {
        for &number in requested {
            let good = number < Departure::NUMBERS;
            OpticsError::unless(
                good,
                "requested",
                number as f64,
                "the number of a departure",
            )?;
        }
        let optics = self.departed(departure)?;
        let is_colour = |number: &&usize| (COLOURS..ODD_TERMS).contains(*number);
        let colours = requested.iter().filter(is_colour).map(|&number| {
            let mut colours = optics.colours;
            let [magenta, yellow] = [&mut colours.magenta, &mut colours.yellow];
            let share = number - COLOURS;
            let colour = if share < 3 { magenta } else { yellow };
            colour[share % 3] += SHARE;
            (number, colours.contrasts())
        });
        let shared = Shared {
            departure,
            turns: optics.pose().per_turn(),
            colours: colours.collect(),
            requested,
            optics: &optics,
        };
        palpate_statistics::work::projected(motions.len() as u64);
        let mut slopes = Vec::with_capacity(motions.len());
        for (marker, (sight, motion)) in optics.sights(motions)?.zip(motions).enumerate() {
            let seen = sight?.zip(motion.as_ref());
            slopes.push(seen.and_then(|(sight, motion)| shared.marker(marker, &sight, motion)));
        }
        for &number in requested.iter().filter(|number| **number >= ODD_TERMS) {
            let mut beside = *departure;
            beside.odd_terms[number - ODD_TERMS] += ODD;
            let beside = self.departed(&beside)?.project(motions)?;
            for (slopes, beside) in slopes.iter_mut().zip(&beside) {
                if let (Some(slopes), Some(beside)) = (slopes, beside) {
                    let column = difference(beside, &slopes.seen) / ODD;
                    slopes.by_departure.set_column(number, &column);
                }
            }
        }
        Ok(slopes)
    }
}

impl Shared<'_> {
    fn marker(
        &self,
        marker: usize,
        sight: &MarkerSight,
        motion: &MarkerMotion,
    ) -> Option<MarkerSlopes> {
        let (camera, contrasts) = (&self.optics.camera, &self.optics.contrasts);
        let projection = MarkerProjection::new(camera, sight)?;
        let seen = projection.features(camera, contrasts)?;
        let (array, pose) = (&self.optics.array, self.optics.pose());
        let by_sights = array.sight_slopes(marker, sight, motion, &pose, &self.turns);
        let by_discs = [0, 1].map(|disc| {
            let mut by_disc = Matrix4x3::zeros();
            for number in 0..3 {
                let beside = by_sights[disc].beside(sight, disc, number, STEP);
                let beside = projection.beside(camera, &beside, disc);
                if let Some(beside) = beside.features(camera, contrasts) {
                    by_disc.set_column(number, &(difference(&beside, &seen) / STEP));
                }
            }
            by_disc
        });
        let [magenta, yellow] = [0, 1].map(|disc| by_discs[disc] * by_sights[disc].by);
        let mut slopes = MarkerSlopes {
            seen,
            by_departure: SMatrix::zeros(),
            by_misalignment: yellow.fixed_columns::<2>(X)
                * (array.layers()[1].distance * (1.0 + motion.yellow.skin_stretch)),
            by_motion: [magenta, yellow].map(|by| by.fixed_columns::<3>(INWARD).into()),
        };
        self.by_departure(&mut slopes, [&magenta, &yellow]);
        for (number, contrasts) in &self.colours {
            if let Some(beside) = projection.features(camera, contrasts) {
                let column = difference(&beside, &seen) / SHARE;
                slopes.by_departure.set_column(*number, &column);
            }
        }
        Some(slopes)
    }

    /// Writes the requested derivatives of the marker's features into `slopes`. These are the derivatives with respect
    /// to the depths and diameters of the discs, and to the camera's position, rotation, centre and scale. `by`
    /// contains one matrix per disc, with one column per variable of `SightSlopes::by`. A column contains the
    /// derivatives of the features with respect to this variable if only the view of this disc changes, that is, its
    /// direction and its angular radius.
    fn by_departure(&self, slopes: &mut MarkerSlopes, by: [&SMatrix<f64, 4, COLUMNS>; 2]) {
        let [magenta, yellow] = by;
        let centre = self.optics.camera.centre_px();
        let seen = slopes.seen.centroid_px;
        let both = |column: usize| magenta.column(column) + yellow.column(column);
        let wider = |disc: usize| by[disc].column(WIDER) / (1.0 + self.departure.diameters[disc]);
        for &number in self.requested {
            let column = match number {
                0 => magenta.column(DEEPER).into(),
                1 => yellow.column(DEEPER).into(),
                2 | 3 => wider(number - 2),
                4 => Vector4::x(),
                5 => Vector4::y(),
                6 => {
                    // All lengths in the image are proportional to the number of pixels per radian, which is the
                    // nominal number times s. So the derivative of a length with respect to s is the length divided by
                    // s, and the derivative of the logarithm of an area is 2/s.
                    let [x, y] = [0, 1].map(|axis| seen[axis] - centre[axis]);
                    Vector4::new(x, y, 0.0, 2.0) / (1.0 + self.departure.px_per_rad)
                }
                7..10 => both(PLACE + number - 7),
                10..COLOURS => both(TURN + number - 10),
                _ => continue,
            };
            slopes.by_departure.set_column(number, &column);
        }
    }
}

/// Difference between the features of two nearly equal markers, to first order. Rows: centroid (px), hue (turns),
/// logarithm of the size.
fn difference(one: &SeenMarker, other: &SeenMarker) -> Vector4<f64> {
    let turn = one.hue_turns - other.hue_turns;
    Vector4::new(
        one.centroid_px[0] - other.centroid_px[0],
        one.centroid_px[1] - other.centroid_px[1],
        turn - (turn + 0.5).floor(),
        one.size_px2 / other.size_px2 - 1.0,
    )
}

//! Slopes of the markers' pictures by what their sensor departs by, and by how their discs move.
//!
//! How a disc is seen, three numbers, follows in closed form from its motion and from the sensor; how a picture follows from
//! the six numbers of both discs is told by differences.

use nalgebra::{Matrix3, Matrix4x2, Matrix4x3, SMatrix, Vector4};

use super::array::MarkerSight;
use super::colours::Contrasts;
use super::projected::Glimpse;
use super::sight_slopes::{COLUMNS, DEEPER, INWARD, PLACE, TURN, WIDER, X};
use super::{Departure, MarkerMotion, Optics, OpticsError, SeenMarker};

/// Step of directions, rad, and of the logarithm of a disc's width.
const STEP: f64 = 1e-7;
/// Step of shares of light.
const SHARE: f64 = 1e-6;
/// Step of the odd terms of a lens.
const ODD: f64 = 1e-6;

/// First of the numbers of a [`Departure`] that are shares of light, and first of those that are odd terms.
const COLOURS: usize = 13;
const ODD_TERMS: usize = 19;

/// A marker's picture with its slopes. Rows: both coordinates of the centroid, px; hue, turns; natural logarithm of the size.
#[derive(Clone, Debug, PartialEq)]
pub struct MarkerSlopes {
    /// The marker as it is seen.
    pub seen: SeenMarker,
    /// Slopes by the numbers of the [`Departure`], a column for each; 0 for those that are not asked for.
    pub by_departure: SMatrix<f64, 4, { Departure::NUMBERS }>,
    /// Slopes by the misalignment of the discs, per rad, as
    /// [`MarkerArray::misalignments`](super::MarkerArray::misalignments) has it.
    pub by_misalignment: Matrix4x2<f64>,
    /// Slopes by the motions of the magenta and of the yellow disc, per length: inward, and along both axes of the skin.
    pub by_motion: [Matrix4x3<f64>; 2],
}

/// Parts that the slopes of all markers share.
struct Shared<'a> {
    optics: &'a Optics,
    departure: &'a Departure,
    turns: [Matrix3<f64>; 3],
    /// Contrasts of colours that are a little more, for each share of light that is asked for.
    colours: Vec<(usize, Contrasts)>,
    asked: &'a [usize],
}

impl Optics {
    /// Pictures of the markers of a sensor that departs so from this one, as [`Optics::projected`] has them, with their slopes
    /// by the numbers of the departure that are asked for. `None` for markers that are not seen.
    ///
    /// Slopes are right to about 5e-5 of the largest, but where the edges of two discs touch, at which pictures bend.
    ///
    /// # Errors
    /// Errors of [`Optics::departed`] and of [`Optics::projected`]; [`OpticsError::BadSetting`] for `asked` unless each is less
    /// than [`Departure::NUMBERS`].
    pub fn slopes(
        &self,
        departure: &Departure,
        motions: &[Option<MarkerMotion>],
        asked: &[usize],
    ) -> Result<Vec<Option<MarkerSlopes>>, OpticsError> {
        for &number in asked {
            let good = number < Departure::NUMBERS;
            OpticsError::unless(good, "asked", number as f64, "the number of a departure")?;
        }
        let optics = self.departed(departure)?;
        let is_colour = |number: &&usize| (COLOURS..ODD_TERMS).contains(*number);
        let colours = asked.iter().filter(is_colour).map(|&number| {
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
            asked,
            optics: &optics,
        };
        palpate_statistics::work::projected(motions.len() as u64);
        let mut slopes = Vec::with_capacity(motions.len());
        for (marker, (sight, motion)) in optics.sights(motions)?.zip(motions).enumerate() {
            let seen = sight?.zip(motion.as_ref());
            slopes.push(seen.and_then(|(sight, motion)| shared.marker(marker, &sight, motion)));
        }
        for &number in asked.iter().filter(|number| **number >= ODD_TERMS) {
            let mut beside = *departure;
            beside.odd_terms[number - ODD_TERMS] += ODD;
            let beside = self.departed(&beside)?.projected(motions)?;
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
        let Optics {
            array,
            camera,
            contrasts,
            ..
        } = self.optics;
        let glimpse = Glimpse::new(camera, sight)?;
        let seen = glimpse.features(camera, contrasts)?;
        let pose = self.optics.pose();
        let by_sights = array.sight_slopes(marker, sight, motion, &pose, &self.turns);
        let by_discs = [0, 1].map(|disc| {
            let mut by_disc = Matrix4x3::zeros();
            for number in 0..3 {
                let beside = by_sights[disc].beside(sight, disc, number, STEP);
                let beside = glimpse.beside(camera, &beside, disc);
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
            by_misalignment: yellow.fixed_columns::<2>(X) * array.layers()[1].distance,
            by_motion: [magenta, yellow].map(|by| by.fixed_columns::<3>(INWARD).into()),
        };
        self.by_departure(&mut slopes, [&magenta, &yellow]);
        for (number, contrasts) in &self.colours {
            if let Some(beside) = glimpse.features(camera, contrasts) {
                let column = difference(&beside, &seen) / SHARE;
                slopes.by_departure.set_column(*number, &column);
            }
        }
        Some(slopes)
    }

    /// Slopes by what moves, widens or shifts pictures.
    fn by_departure(&self, slopes: &mut MarkerSlopes, by: [&SMatrix<f64, 4, COLUMNS>; 2]) {
        let [magenta, yellow] = by;
        let centre = self.optics.camera.centre_px();
        let seen = slopes.seen.centroid_px;
        let both = |column: usize| magenta.column(column) + yellow.column(column);
        let wider = |disc: usize| by[disc].column(WIDER) / (1.0 + self.departure.diameters[disc]);
        for &number in self.asked {
            let column = match number {
                0 => magenta.column(DEEPER).into(),
                1 => yellow.column(DEEPER).into(),
                2 | 3 => wider(number - 2),
                4 => Vector4::x(),
                5 => Vector4::y(),
                6 => {
                    // All lengths in the image are proportional to it.
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

/// One picture less another, to first order.
fn difference(one: &SeenMarker, other: &SeenMarker) -> Vector4<f64> {
    let turn = one.hue_turns - other.hue_turns;
    Vector4::new(
        one.centroid_px[0] - other.centroid_px[0],
        one.centroid_px[1] - other.centroid_px[1],
        turn - (turn + 0.5).floor(),
        one.size_px2 / other.size_px2 - 1.0,
    )
}

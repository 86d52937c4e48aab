//! Arrays of pads on a fingertip. The pad nearest to the contact reports its own centre as the reading (Charlebois,
//! Gupta and Payandeh 1996, section 4.1.3).

use nalgebra::{UnitQuaternion, Vector2, Vector3};
use palpate_statistics::{BadSetting, Number};

use crate::{BeyondPads, Stream, UniformLattice, direction_at, displacement_between};

/// Smallest allowed pitch, relative to the fingertip's radius. Double-precision numbers do not resolve positions on
/// smaller pads.
const FINEST: f64 = 1e-15;

/// The pattern in which pads tile the fingertip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PadLayout {
    /// A square grid, as in the paper of Charlebois, Gupta and Payandeh (1996). Its coordinates are arc lengths on the
    /// fingertip, along great circles from the middle of the array. Therefore pads far from the middle are narrower on
    /// the sphere.
    Square,
    /// Hexagons in the same coordinates as the square grid, with rows of neighbouring pads along x. Therefore hexagons
    /// far from the middle of the array are also narrower on the sphere.
    Hexagonal,
    /// A near-uniform lattice: a spherical Fibonacci lattice with one pad per area of pitch².
    Uniform,
}

/// Position of the first contact on the pads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PadOffset {
    /// The first contact is at the centre of a pad.
    Centred,
    /// The first contact is at a random place within a pad, drawn for each roll.
    Random,
    /// The first contact is at a random place within a pad, drawn once for all rolls of a trial.
    RandomPerTrial,
}

/// An array of pads on a spherical cap of a fingertip, around the first contact.
///
/// ```
/// use std::f64::consts::FRAC_PI_2;
/// use nalgebra::Vector2;
/// use palpate_sensing::{Channel, PadLayout, PadOffset, Pads, Stream};
///
/// // Pads 1 apart on a fingertip of radius 10 round a shift to whole pads.
/// let pads = Pads::new(10.0, 1.0, PadLayout::Square, PadOffset::Centred, FRAC_PI_2)?;
/// let placement = pads.place(&mut Stream::new(1, 0, Channel::PadOffset));
/// let shift = pads.read(&placement, &Vector2::new(2.3, -0.6))?;
/// assert_eq!(shift, Vector2::new(2.0, -1.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Pads {
    radius: f64,
    pitch: f64,
    cap_rad: f64,
    /// Position of the first contact relative to the pads: at the centre of a pad, or at a random place.
    pub offset: PadOffset,
    tiling: Tiling,
}

#[derive(Clone, Debug)]
enum Tiling {
    Square,
    Hexagonal,
    Uniform(UniformLattice),
}

/// Position and orientation of the array of pads relative to the first contact of a roll.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PadPlacement(Placement);

#[derive(Clone, Copy, Debug, PartialEq)]
enum Placement {
    /// For a square grid: offset of the first contact from the centre of the nearest pad, in pitches.
    Square(Vector2<f64>),
    /// For hexagonal pads: position of the first contact relative to the centre of a pad, in pitches.
    Hexagonal(Vector2<f64>),
    /// For a uniform lattice: rotation from the contact frame to the lattice's frame, and direction of the pad at the
    /// first contact in the lattice's frame.
    Uniform {
        lattice_from_contact: UnitQuaternion<f64>,
        first_pad: Vector3<f64>,
    },
}

impl Pads {
    /// Pads with this `pitch` on a cap of a fingertip of `radius`. `cap_rad` is the angle between the middle and the
    /// edge of the cap.
    ///
    /// # Errors
    /// [`BadSetting`] unless the radius is finite and positive, `cap_rad` is in (0, π], and the pitch is from 1e-15
    /// to 1 times the radius (for a uniform lattice, from 1.2e-7).
    pub fn new(
        radius: f64,
        pitch: f64,
        layout: PadLayout,
        offset: PadOffset,
        cap_rad: f64,
    ) -> Result<Self, BadSetting<String>> {
        BadSetting::unless(
            radius > 0.0 && (radius * std::f64::consts::TAU).is_finite(),
            "radius",
            radius,
            "> 0 and have a finite circumference",
        )?;
        let fits = pitch > 0.0 && pitch <= radius;
        BadSetting::unless(
            fits,
            "pitch",
            pitch,
            format!("> 0 and at most the probe's radius, {}", Number(radius)),
        )?;
        let resolved = pitch / radius >= FINEST;
        let expected = "at least 1e-15 of the probe's radius";
        BadSetting::unless(resolved, "pitch", pitch, expected)?;
        let cap = cap_rad > 0.0 && cap_rad <= std::f64::consts::PI;
        BadSetting::unless(cap, "cap_deg", cap_rad.to_degrees(), "> 0 and at most 180")?;
        let tiling = match layout {
            PadLayout::Square => Tiling::Square,
            PadLayout::Hexagonal => Tiling::Hexagonal,
            PadLayout::Uniform => Tiling::Uniform(UniformLattice::with_pitch(pitch / radius)?),
        };
        Ok(Self {
            radius,
            pitch,
            cap_rad,
            offset,
            tiling,
        })
    }

    /// Distance (length) between neighbouring pads.
    pub const fn pitch(&self) -> f64 {
        self.pitch
    }

    /// Errors of a contact position that these pads report, divided by the errors of square pads with the same pitch.
    /// The first ratio is for the standard deviation per axis, the second for the largest error along an axis. A shift
    /// is the difference of two positions, so it has such an error at its start and at its end.
    pub fn rounding(&self) -> [f64; 2] {
        match self.tiling {
            // The variance of a reading's error per axis is 5/72 pitch² for hexagonal pads and 1/12 pitch² for square
            // pads. The largest errors are 1/√3 pitches (at a corner of a hexagon) and half a pitch (at an edge of a
            // square).
            Tiling::Hexagonal => [(5.0_f64 / 6.0).sqrt(), 2.0 / 3.0_f64.sqrt()],
            Tiling::Square | Tiling::Uniform(_) => [1.0; 2],
        }
    }

    /// Chooses the position of the array of pads relative to a first contact. Random numbers are drawn only if this
    /// position is random.
    pub fn place(&self, stream: &mut Stream) -> PadPlacement {
        PadPlacement(match (&self.tiling, self.offset) {
            (Tiling::Square, PadOffset::Centred) => Placement::Square(Vector2::zeros()),
            (Tiling::Square, PadOffset::Random | PadOffset::RandomPerTrial) => {
                let mut half = || 0.5 * stream.symmetric_uniform();
                Placement::Square(Vector2::new(half(), half()))
            }
            (Tiling::Hexagonal, PadOffset::Centred) => Placement::Hexagonal(Vector2::zeros()),
            (Tiling::Hexagonal, PadOffset::Random | PadOffset::RandomPerTrial) => {
                // The hexagonal pattern repeats in a rectangle of one pitch by √3 pitches, which contains two pads.
                let mut half = || 0.5 * stream.symmetric_uniform();
                Placement::Hexagonal(Vector2::new(half(), 3.0_f64.sqrt() * half()))
            }
            (Tiling::Uniform(lattice), PadOffset::Centred) => {
                let first_pad = lattice.direction(0);
                Placement::Uniform {
                    lattice_from_contact: turn_to(&first_pad),
                    first_pad,
                }
            }
            (Tiling::Uniform(lattice), PadOffset::Random | PadOffset::RandomPerTrial) => {
                // The first contact is drawn uniformly from a disc with a radius of four pitches. The lattice is not
                // periodic, but the disc covers many pads, so every position within a pad is about equally likely.
                let reach = (4.0 * self.pitch / self.radius).min(0.5);
                let (distance, azimuth, turn) = (
                    reach * (0.5 + 0.5 * stream.symmetric_uniform()).sqrt(),
                    std::f64::consts::PI * stream.symmetric_uniform(),
                    std::f64::consts::PI * stream.symmetric_uniform(),
                );
                let middle = direction_at(
                    &(Vector2::new(libm::cos(azimuth), libm::sin(azimuth)) * distance),
                );
                let spin = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn);
                let lattice_from_contact = turn_to(&middle) * spin;
                let first_pad = lattice.direction(lattice.nearest(&middle));
                Placement::Uniform {
                    lattice_from_contact,
                    first_pad,
                }
            }
        })
    }

    /// The reading of the pads for a true `displacement` of the contact: the displacement (length) from the centre of
    /// the pad at the first contact to the centre of the pad at the last contact. The result is in the tangent basis at
    /// the first contact.
    ///
    /// On a square grid, the largest error is half a pitch along each axis if the first contact is centred, and
    /// otherwise one pitch. On hexagons, the largest error is 0.58 pitches for each end of the displacement that is not
    /// at the centre of a pad. On a uniform lattice, it is 1.05 pitches for each such end. For a contact at the angle θ
    /// from the first contact, the bound of the uniform lattice is multiplied by θ/sin θ.
    ///
    /// # Errors
    /// [`BeyondPads`] if the contact is outside of the cap.
    pub fn read(
        &self,
        placement: &PadPlacement,
        displacement: &Vector2<f64>,
    ) -> Result<Vector2<f64>, BeyondPads> {
        self.unless_beyond_cap(displacement)?;
        match (&self.tiling, &placement.0) {
            (
                Tiling::Uniform(lattice),
                Placement::Uniform {
                    lattice_from_contact,
                    first_pad,
                },
            ) => {
                let contact = lattice_from_contact * direction_at(&(displacement / self.radius));
                let pad = lattice.direction(lattice.nearest(&contact));
                let back = lattice_from_contact.inverse();
                Ok(displacement_between(&(back * first_pad), &(back * pad)) * self.radius)
            }
            (Tiling::Hexagonal, Placement::Hexagonal(first)) => {
                let pad = nearest_hexagon(&(displacement / self.pitch + first));
                Ok((pad - nearest_hexagon(first)) * self.pitch)
            }
            (_, placement) => {
                let pads =
                    |length: f64, offset: f64| self.pitch * (length / self.pitch + offset).round();
                Ok(displacement.zip_map(&placement.offset(), pads))
            }
        }
    }

    /// Centres of the active pads at all samples of one roll, and the position of the first contact. `contacts` are the
    /// displacements of the contact from the first contact. The results are great-circle displacements (length) from
    /// the pads' origin, the centre of the pad at the first contact; in these coordinates, the edges of square and
    /// hexagonal pads are straight. A uniform lattice has neither square nor hexagonal pads; this function returns the
    /// centres of square pads for it.
    ///
    /// # Errors
    /// [`BeyondPads`] if a contact is outside of the cap.
    pub fn read_samples(
        &self,
        placement: &PadPlacement,
        contacts: &[Vector2<f64>],
    ) -> Result<(Vec<Vector2<f64>>, Vector2<f64>), BeyondPads> {
        let first = match &placement.0 {
            Placement::Square(offset) => offset * self.pitch,
            Placement::Hexagonal(first) => (first - nearest_hexagon(first)) * self.pitch,
            Placement::Uniform { .. } => Vector2::zeros(),
        };
        // Parallel-transport the axes of the pad array from the array's origin to the first contact, along a great
        // circle.
        let first_direction = direction_at(&(first / self.radius));
        let origin_from_first = UnitQuaternion::rotation_between(&Vector3::z(), &first_direction);
        let origin_from_first = origin_from_first.unwrap_or_default();
        let active = |contact: &Vector2<f64>| {
            let direction = origin_from_first * direction_at(&(contact / self.radius));
            let place = displacement_between(&Vector3::z(), &direction) * self.radius;
            self.unless_beyond_cap(&place)?;
            let in_pitches = place / self.pitch;
            Ok(match self.tiling {
                Tiling::Hexagonal => nearest_hexagon(&in_pitches),
                Tiling::Square | Tiling::Uniform(_) => in_pitches.map(f64::round),
            } * self.pitch)
        };
        let centres = contacts.iter().map(active).collect::<Result<_, _>>()?;
        Ok((centres, first))
    }

    /// Whether the pads are hexagons; `None` for a uniform lattice.
    pub const fn are_hexagons(&self) -> Option<bool> {
        match self.tiling {
            Tiling::Square => Some(false),
            Tiling::Hexagonal => Some(true),
            Tiling::Uniform(_) => None,
        }
    }

    fn unless_beyond_cap(&self, displacement: &Vector2<f64>) -> Result<(), BeyondPads> {
        let angle_rad = (displacement / self.radius).norm();
        if angle_rad <= self.cap_rad {
            return Ok(());
        }
        Err(BeyondPads {
            angle_rad,
            cap_rad: self.cap_rad,
        })
    }
}

impl Placement {
    /// Offset of the first contact from the centre of the nearest pad on a square grid, in pitches. For hexagonal pads
    /// and for a uniform lattice, the result is zero.
    fn offset(&self) -> Vector2<f64> {
        match self {
            Self::Square(offset) => *offset,
            Self::Hexagonal(_) | Self::Uniform { .. } => Vector2::zeros(),
        }
    }
}

/// Centre (in pitches) of the hexagon that contains a position. The centres of all hexagons form two rectangular grids
/// with a spacing of 1 by √3.
fn nearest_hexagon(place: &Vector2<f64>) -> Vector2<f64> {
    let period = Vector2::new(1.0, 3.0_f64.sqrt());
    let nearest = |corner: Vector2<f64>| {
        (place - corner)
            .component_div(&period)
            .map(f64::round)
            .component_mul(&period)
            + corner
    };
    let [one, other] = [nearest(Vector2::zeros()), nearest(0.5 * period)];
    if (place - one).norm_squared() <= (place - other).norm_squared() {
        one
    } else {
        other
    }
}

fn turn_to(direction: &Vector3<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::rotation_between(&Vector3::z(), direction).unwrap_or_else(|| {
        UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
    })
}

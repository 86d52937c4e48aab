//! The markers of a sensor, and the directions and angular radii of their discs after a press.

use std::f64::consts::{PI, TAU};

use nalgebra::Vector3;
use palpate_sensing::{Channel, Stream};

use super::OpticsError;
use super::pose::Pose;
use super::sines::sinc_and_cosine;
use crate::Discs;
use crate::layout::{MOST_MARKERS, too_close};

/// Allowed values of the lengths that describe a sensor. The limits ensure that the product of a few lengths neither
/// overflows nor underflows.
const LENGTHS: std::ops::RangeInclusive<f64> = 1e-50..=1e50;

/// Smallest allowed ratio of a disc's radius to its distance from the sensor's centre.
const MIN_HALF_WIDTH: f64 = 1e-9;

/// Depths of a marker's two discs under the skin (length).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscDepths {
    /// Depth of the magenta disc under the skin (length).
    pub magenta: f64,
    /// Depth of the yellow disc under the skin (length).
    pub yellow: f64,
}

/// Displacement of one disc in a press. By default, all components are 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DiscMotion {
    /// Displacement of the disc toward the sensor's centre (length).
    pub normal: f64,
    /// Displacement along the skin (length): the length of the disc's arc around the sensor's centre. The components
    /// are along the x and y axes of the marker. These are the axes at the apex after parallel transport along the
    /// meridian to the marker.
    pub tangential: [f64; 2],
    /// Relative increase of the disc's diameter due to the strain of the skin. The model assumes that the disc stays a
    /// circle.
    pub stretch: f64,
    /// Relative stretch of the skin around the disc. The misalignment between the marker's two discs grows by the
    /// factor 1 + `skin_stretch`.
    pub skin_stretch: f64,
}

impl DiscMotion {
    /// Position of a disc after a press, relative to its marker at rest: two angles (rad) at the sensor's centre, along
    /// the marker's axes. `moved` is the motion of the disc. `misalignment` is the offset of the disc at rest, which
    /// grows with the stretch of the skin.
    #[inline]
    pub(super) fn moved_offset(&self, moved: [f64; 2], misalignment: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| moved[axis] + misalignment[axis] * (1.0 + self.skin_stretch))
    }
}

/// Displacements of the two discs of a marker in a press. By default, all components are 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MarkerMotion {
    /// Displacement of the magenta disc.
    pub magenta: DiscMotion,
    /// Displacement of the yellow disc.
    pub yellow: DiscMotion,
}

/// The markers of a sensor. Each marker has two flat discs, which are perpendicular to the sensor's radius through
/// their centres.
#[derive(Clone, Debug, PartialEq)]
pub struct MarkerArray {
    radius: f64,
    places: Vec<[f64; 2]>,
    magenta: Layer,
    yellow: Layer,
    stands: Vec<Stand>,
}

/// All discs of one colour: one disc of each marker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layer {
    name: &'static str,
    /// Distance (length) between the sensor's centre and the middle of each disc at rest.
    pub(super) distance: f64,
    /// Ratio of a disc's radius to its distance from the sensor's centre.
    half_width: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stand {
    pub(super) direction: Vector3<f64>,
    pub(super) x_axis: Vector3<f64>,
    pub(super) y_axis: Vector3<f64>,
    /// Displacement of the yellow disc relative to the magenta disc along the skin. The components are angles (rad) at
    /// the sensor's centre, along both tangent axes.
    pub(super) misalignment: [f64; 2],
}

/// A disc as viewed from the camera: the direction of its middle, and the sine and the cosine of its angular radius.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight {
    pub(super) direction: Vector3<f64>,
    pub(super) sine: f64,
    pub(super) cosine: f64,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct MarkerSight {
    pub(super) magenta: Sight,
    pub(super) yellow: Sight,
}

impl MarkerArray {
    /// Markers at `places` on the skin of a sensor. The places are in the skin coordinates of
    /// [`Layout::places`](crate::Layout::places). All markers have discs with the same diameters at the same depths.
    ///
    /// # Errors
    /// [`OpticsError::BadSetting`] for `radius`, `magenta_diameter`, `yellow_diameter`; [`OpticsError::BadDepth`]
    /// unless each depth is at least 0 and less than the radius; [`OpticsError::OffTheSkin`];
    /// [`OpticsError::TooManyMarkers`]; [`OpticsError::DiscsOverlap`] if discs of two markers overlap in the view from
    /// the centre.
    pub fn new(
        sensor_radius: f64,
        places: &[[f64; 2]],
        discs: Discs,
        depths: DiscDepths,
    ) -> Result<Self, OpticsError> {
        let good = LENGTHS.contains(&sensor_radius);
        OpticsError::unless(good, "radius", sensor_radius, "between 1e-50 and 1e50")?;
        if places.len() > MOST_MARKERS {
            return Err(OpticsError::TooManyMarkers {
                markers: places.len(),
                limit: MOST_MARKERS,
            });
        }
        for (disc, depth) in [("magenta", depths.magenta), ("yellow", depths.yellow)] {
            if !(0.0..sensor_radius).contains(&depth) {
                return Err(OpticsError::BadDepth {
                    disc,
                    depth,
                    radius: sensor_radius,
                });
            }
        }
        let layer = |name, setting, diameter, depth| {
            let distance = sensor_radius - depth;
            let half_width = 0.5 * diameter / distance;
            let good = (MIN_HALF_WIDTH..=1.0).contains(&half_width);
            let expected = "between 1e-9 and 1 times twice the disc's distance from the centre";
            OpticsError::unless(good, setting, diameter, expected).map(|_| Layer {
                name,
                distance,
                half_width,
            })
        };
        let magenta = layer("magenta", "magenta_diameter", discs.magenta, depths.magenta)?;
        let yellow = layer("yellow", "yellow_diameter", discs.yellow, depths.yellow)?;
        let stands = places.iter().enumerate();
        let stands: Vec<Stand> = stands
            .map(|(marker, place)| stand(marker, *place, sensor_radius))
            .collect::<Result<_, _>>()?;
        let wider = if magenta.half_width > yellow.half_width {
            magenta
        } else {
            yellow
        };
        apart(&stands, wider)?;
        Ok(Self {
            radius: sensor_radius,
            places: places.to_vec(),
            magenta,
            yellow,
            stands,
        })
    }

    /// Returns the markers with random misalignments of their discs, as from manufacture. `seed` and the number `trial`
    /// of the simulated experiment select the random numbers. The yellow disc of each marker is displaced along the
    /// skin relative to the magenta disc. The displacement is uniformly distributed in a circle, whose radius is `most`
    /// times the diameter of the yellow discs. The random misalignments replace earlier misalignments.
    ///
    /// # Errors
    /// [`OpticsError::BadSetting`] for `misalignment` unless it is from 0 to 1.
    pub fn misaligned(mut self, most: f64, seed: u64, trial: u64) -> Result<Self, OpticsError> {
        let good = (0.0..=1.0).contains(&most);
        OpticsError::unless(good, "misalignment", most, "from 0 to 1")?;
        let most_rad = most * 2.0 * self.yellow.half_width;
        let mut stream = Stream::new(seed, trial, Channel::Misalignment);
        for stand in &mut self.stands {
            // The area of a circle is proportional to the square of its radius. Therefore the square root of a uniform
            // number, used as the radius, gives a uniform density of points.
            let share = 0.5 * (stream.symmetric_uniform() + 1.0);
            let (sine, cosine) = libm::sincos(PI * stream.symmetric_uniform());
            let size = most_rad * share.sqrt();
            stand.misalignment = [size * cosine, size * sine];
        }
        Ok(self)
    }

    /// Misalignment of each marker: the displacement of its yellow disc relative to its magenta disc along the skin. It
    /// is an angle at the sensor's centre, rad. The components are along the axes at the apex, parallel-transported
    /// along the meridian to the marker.
    pub fn misalignments(&self) -> Vec<[f64; 2]> {
        self.stands.iter().map(|stand| stand.misalignment).collect()
    }

    /// Returns the markers with other misalignments, rad (see [`MarkerArray::misalignments`]). If there are fewer
    /// misalignments than markers, the remaining markers keep their misalignments.
    ///
    /// # Errors
    /// [`OpticsError::BadSetting`] for `misalignment` unless each component is from -1 to 1.
    pub(super) fn with_misalignments(
        mut self,
        misalignments: &[[f64; 2]],
    ) -> Result<Self, OpticsError> {
        for (stand, misalignment) in self.stands.iter_mut().zip(misalignments) {
            for component in misalignment {
                let good = component.abs() <= 1.0;
                OpticsError::unless(good, "misalignment", *component, "from -1 to 1 rad")?;
            }
            stand.misalignment = *misalignment;
        }
        Ok(self)
    }

    /// Returns the markers with other depths and diameters of their discs. `deeper` contains the increases of the
    /// depths of the magenta and the yellow discs (length), and `wider` the relative increases of the two diameters.
    ///
    /// # Errors
    /// [`OpticsError::BadDepth`] and [`OpticsError::BadSetting`], as in [`MarkerArray::new`].
    pub(super) fn remade(mut self, deeper: [f64; 2], wider: [f64; 2]) -> Result<Self, OpticsError> {
        let radius = self.radius;
        let layers = [&mut self.magenta, &mut self.yellow];
        for ((layer, deeper), wider) in layers.into_iter().zip(deeper).zip(wider) {
            let distance = layer.distance - deeper;
            let good = distance > 0.0 && distance <= radius;
            if !good {
                return Err(OpticsError::BadDepth {
                    disc: layer.name,
                    depth: radius - distance,
                    radius,
                });
            }
            let half_width = layer.half_width * layer.distance / distance * (1.0 + wider);
            let good = (MIN_HALF_WIDTH..=1.0).contains(&half_width);
            let expected = "between 1e-9 and 1 times the disc's distance from the centre";
            OpticsError::unless(good, "half_width", half_width, expected)?;
            layer.distance = distance;
            layer.half_width = half_width;
        }
        Ok(self)
    }

    /// Positions (x, y) of the markers on the skin (length). A marker lies in the direction (x, y) from the apex, at
    /// the distance √(x² + y²) along the skin.
    pub fn places(&self) -> &[[f64; 2]] {
        &self.places
    }

    pub(super) const fn radius(&self) -> f64 {
        self.radius
    }

    pub(super) fn stand(&self, marker: usize) -> &Stand {
        &self.stands[marker]
    }

    pub(super) const fn layers(&self) -> [&Layer; 2] {
        [&self.magenta, &self.yellow]
    }

    pub(super) fn nearest(&self) -> f64 {
        self.magenta.distance.min(self.yellow.distance)
    }

    pub(super) fn sight(
        &self,
        marker: usize,
        motion: &MarkerMotion,
        pose: Option<&Pose>,
    ) -> Result<MarkerSight, OpticsError> {
        let stand = &self.stands[marker];
        let seen = |layer: &Layer, motion: &DiscMotion, offset| {
            layer
                .sight(stand, motion, offset)
                .and_then(|sight| match pose {
                    None => Ok(sight),
                    Some(pose) => layer.seen_beside(&sight, motion, pose),
                })
                .map_err(|motion| OpticsError::ImpossibleMotion {
                    marker,
                    disc: layer.name,
                    motion,
                    distance: layer.distance,
                })
        };
        Ok(MarkerSight {
            magenta: seen(&self.magenta, &motion.magenta, [0.0; 2])?,
            yellow: seen(&self.yellow, &motion.yellow, stand.misalignment)?,
        })
    }
}

impl Layer {
    /// Direction and angular radius of a disc of this layer's colour, as viewed from the sensor's centre. `offset` is
    /// the misalignment of the disc, rad. If the disc moves by more than its distance from the sensor's centre, the
    /// motion is impossible, and the function returns the length of the motion as the error.
    #[inline]
    fn sight(&self, stand: &Stand, motion: &DiscMotion, offset: [f64; 2]) -> Result<Sight, f64> {
        let inward = motion.normal / self.distance;
        let [x, y] = motion.tangential.map(|along| along / self.distance);
        // Both comparisons are false for NaN, so a motion that contains NaN is rejected.
        let (shorter, beside) = (inward.abs() < 1.0, x * x + y * y < 1.0);
        if !shorter {
            return Err(motion.normal);
        }
        if !beside {
            return Err(libm::hypot(motion.tangential[0], motion.tangential[1]));
        }
        let half_width = self.stretched(motion)?;
        let [x, y] = motion.moved_offset([x, y], offset);
        // Compute the direction of the moved disc by following a great circle from the marker's place (the exponential
        // map).
        let (sinc, cosine) = sinc_and_cosine(x * x + y * y);
        let along = stand.x_axis * (x * sinc) + stand.y_axis * (y * sinc);
        let distance = 1.0 - inward;
        let slant = (distance * distance + half_width * half_width).sqrt();
        Ok(Sight {
            direction: stand.direction * cosine + along,
            sine: half_width / slant,
            cosine: distance / slant,
        })
    }

    /// Radius of a disc after a motion, divided by the distance of the resting disc from the centre of the sensor. If
    /// the stretch of the disc is impossible, the error value is the distance by which the stretch would move the
    /// disc's edge.
    #[inline]
    fn stretched(&self, motion: &DiscMotion) -> Result<f64, f64> {
        for stretch in [motion.stretch, motion.skin_stretch] {
            let is_possible = stretch.abs() < 1.0;
            if !is_possible {
                return Err(stretch * self.half_width * self.distance);
            }
        }
        Ok(self.half_width * (1.0 + motion.stretch))
    }

    /// A disc as viewed from a camera that is not in the sensor's centre. The view is computed from `sight`, the view
    /// from the sensor's centre. The disc is approximated by a circular cap with the same solid angle. This
    /// approximation is correct to first order in the solid angle. For a disc that moves behind the camera, the
    /// function returns the disc's inward displacement as the error.
    fn seen_beside(&self, sight: &Sight, motion: &DiscMotion, pose: &Pose) -> Result<Sight, f64> {
        let away = self.distance - motion.normal;
        let ray = sight.direction * away - pose.place;
        let distance = ray.norm();
        let facing = ray.dot(&sight.direction) / distance;
        let is_before = facing > 0.0;
        if !is_before {
            return Err(motion.normal);
        }
        let tangent = self.stretched(motion)? * self.distance * facing.sqrt() / distance;
        let slant = (1.0 + tangent * tangent).sqrt();
        Ok(Sight {
            direction: pose.turned(&(ray / distance)),
            sine: tangent / slant,
            cosine: slant.recip(),
        })
    }
}

fn stand(marker: usize, place: [f64; 2], sensor_radius: f64) -> Result<Stand, OpticsError> {
    let [x, y] = place.map(|coordinate| coordinate / sensor_radius);
    let angle = libm::hypot(x, y);
    let on_the_skin = angle < PI;
    if !on_the_skin {
        return Err(OpticsError::OffTheSkin {
            marker,
            place,
            limit: 0.5 * TAU * sensor_radius,
        });
    }
    let [along_x, along_y] = if angle > 0.0 {
        [x / angle, y / angle]
    } else {
        [1.0, 0.0]
    };
    let (sine, cosine) = libm::sincos(angle);
    let meridian = Vector3::new(along_x * cosine, along_y * cosine, -sine);
    let across = Vector3::new(-along_y, along_x, 0.0);
    Ok(Stand {
        direction: Vector3::new(along_x * sine, along_y * sine, cosine),
        x_axis: meridian * along_x - across * along_y,
        y_axis: meridian * along_y + across * along_x,
        misalignment: [0.0; 2],
    })
}

fn apart(stands: &[Stand], layer: Layer) -> Result<(), OpticsError> {
    let directions: Vec<[f64; 3]> = stands.iter().map(|stand| stand.direction.into()).collect();
    // On the unit sphere, two caps with the angular radius α touch if the chord between their middles has the length 2
    // sin α.
    let reach = 2.0 * layer.half_width / libm::hypot(layer.half_width, 1.0);
    match too_close(&directions, reach, 1e-9) {
        None => Ok(()),
        Some(pair) => Err(OpticsError::DiscsOverlap {
            first: pair.first,
            second: pair.second,
            distance: pair.distance * layer.distance,
            diameter: 2.0 * layer.half_width * layer.distance,
        }),
    }
}

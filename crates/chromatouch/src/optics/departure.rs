//! Departures of a sensor: differences between its real parameters and their nominal values.

use super::{Camera, Colours, OddTerms, Optics, OpticsError};

/// Differences between the parameters of a sensor and their nominal values. By default, all are 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Departure {
    /// Additional depths (length) of the magenta discs and of the yellow discs.
    pub depths: [f64; 2],
    /// Relative difference of the diameters of the magenta discs and of the yellow discs.
    pub diameters: [f64; 2],
    /// Shift of the image's centre, px: columns to the right, rows down.
    pub centre_px: [f64; 2],
    /// Relative difference of the focal length in pixels per radian.
    pub px_per_rad: f64,
    /// Shift of the camera (length): along the x and y axes at the apex, and toward the apex.
    pub place: [f64; 3],
    /// Rotation vector (rad) of the camera. Its components belong to the same three axes as the components of `place`.
    pub turn_rad: [f64; 3],
    /// Difference of the transmittances of magenta discs for red, green and blue light.
    pub magenta: [f64; 3],
    /// Difference of the transmittances of yellow discs for red, green and blue light.
    pub yellow: [f64; 3],
    /// Difference of the odd terms k3 and k5 of a fisheye, see [`OddTerms`].
    pub odd_terms: [f64; 2],
}

impl Departure {
    /// Number of values of a departure: the total number of components of its fields.
    pub const NUMBERS: usize = 21;
}

/// Builds a departure from its values, which are in the order of the fields.
impl From<[f64; Self::NUMBERS]> for Departure {
    fn from(n: [f64; Self::NUMBERS]) -> Self {
        Self {
            depths: [n[0], n[1]],
            diameters: [n[2], n[3]],
            centre_px: [n[4], n[5]],
            px_per_rad: n[6],
            place: [n[7], n[8], n[9]],
            turn_rad: [n[10], n[11], n[12]],
            magenta: [n[13], n[14], n[15]],
            yellow: [n[16], n[17], n[18]],
            odd_terms: [n[19], n[20]],
        }
    }
}

impl Camera {
    fn departed(self, [k3, k5]: [f64; 2]) -> Result<Self, OpticsError> {
        if [k3, k5] == [0.0; 2] {
            return Ok(self);
        }
        let known = self.lens.odd_terms().unwrap_or_default();
        self.with_odd_terms(OddTerms {
            k3: known.k3 + k3,
            k5: known.k5 + k5,
        })
    }
}

impl Optics {
    /// Returns the optics of a sensor whose parameters are those of this sensor plus the differences `departure`.
    /// Transmittances may be a little outside of the range from 0 to 1, so that the markers' features are smooth
    /// functions at these limits; a fit needs smooth functions. [`Optics::possible`] restricts a departure to
    /// physically possible sensors.
    ///
    /// # Errors
    /// [`OpticsError::BadDepth`], [`OpticsError::BadSetting`] and [`OpticsError::FoldedLens`] if no sensor has these
    /// parameters, or if a transmittance is below -1 or above 2.
    pub fn departed(&self, departure: &Departure) -> Result<Self, OpticsError> {
        let middle = 0.5 * (f64::from(self.camera.size_px()) - 1.0);
        let centre = self.camera.centre_px();
        let offset = [0, 1].map(|axis| centre[axis] - middle + departure.centre_px[axis]);
        let focal = self.camera.px_per_rad() * (1.0 + departure.px_per_rad);
        let share = |colour: [f64; 3], more: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|channel| colour[channel] + more[channel])
        };
        let colours = Colours {
            magenta: share(self.colours.magenta, departure.magenta),
            yellow: share(self.colours.yellow, departure.yellow),
            ..self.colours
        };
        for (setting, colour) in [("magenta", colours.magenta), ("yellow", colours.yellow)] {
            for share in colour {
                let good = (-1.0..=2.0).contains(&share);
                OpticsError::unless(good, setting, share, "shares from -1 to 2")?;
            }
        }
        let optics = Self {
            array: self
                .array
                .clone()
                .remade(departure.depths, departure.diameters)?,
            camera: self
                .camera
                .departed(departure.odd_terms)?
                .adjusted(offset, focal)?,
            colours,
            blemishes: self.blemishes,
            contrasts: colours.contrasts(),
            pose: None,
        };
        optics.seen_from(self.pose().moved(departure.place, departure.turn_rad))
    }

    /// The departure that is nearest to `departure` among those for which the sensor is physically possible: all
    /// transmittances must be from 0 to 1.
    pub fn possible(&self, departure: Departure) -> Departure {
        let within = |colour: [f64; 3], more: [f64; 3]| {
            std::array::from_fn(|at| (colour[at] + more[at]).clamp(0.0, 1.0) - colour[at])
        };
        Departure {
            magenta: within(self.colours.magenta, departure.magenta),
            yellow: within(self.colours.yellow, departure.yellow),
            ..departure
        }
    }

    /// Returns the optics of this sensor with other misalignments (rad) of its markers (see
    /// [`MarkerArray::misalignments`](super::MarkerArray::misalignments)). If there are fewer misalignments than
    /// markers, the remaining markers keep their misalignments.
    ///
    /// # Errors
    /// [`OpticsError::BadSetting`] for `misalignment` unless each component is from -1 to 1.
    pub fn misaligned(&self, misalignments: &[[f64; 2]]) -> Result<Self, OpticsError> {
        Ok(Self {
            array: self.array.clone().with_misalignments(misalignments)?,
            ..self.clone()
        })
    }
}

//! Sensors that depart from a known one.

use super::{Camera, Colours, Departure, OddTerms, Optics, OpticsError};

impl Camera {
    /// This camera with odd terms that are so much larger.
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
    /// A sensor that departs so from this one. Shares of light may leave the range from 0 to 1 a little, as those of fits do
    /// whose pictures go on smoothly there: [`Optics::possible`] has departures of sensors that can be.
    ///
    /// # Errors
    /// [`OpticsError::BadDepth`], [`OpticsError::BadSetting`] and [`OpticsError::FoldedLens`] where there is no such sensor, and
    /// for a share of light below -1 or above 2.
    pub fn departed(&self, departure: &Departure) -> Result<Self, OpticsError> {
        let Departure {
            depths,
            diameters,
            centre_px,
            px_per_rad,
            place,
            turn_rad,
            magenta,
            yellow,
            odd_terms,
        } = *departure;
        let middle = 0.5 * (f64::from(self.camera.size_px()) - 1.0);
        let centre = self.camera.centre_px();
        let offset = [0, 1].map(|axis| centre[axis] - middle + centre_px[axis]);
        let focal = self.camera.px_per_rad() * (1.0 + px_per_rad);
        let share = |colour: [f64; 3], more: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|channel| colour[channel] + more[channel])
        };
        let colours = Colours {
            magenta: share(self.colours.magenta, magenta),
            yellow: share(self.colours.yellow, yellow),
            ..self.colours
        };
        for (setting, colour) in [("magenta", colours.magenta), ("yellow", colours.yellow)] {
            for share in colour {
                let good = (-1.0..=2.0).contains(&share);
                OpticsError::unless(good, setting, share, "shares from -1 to 2")?;
            }
        }
        let optics = Self {
            array: self.array.clone().remade(depths, diameters)?,
            camera: self.camera.departed(odd_terms)?.adjusted(offset, focal)?,
            colours,
            blemishes: self.blemishes,
            contrasts: colours.contrasts(),
            pose: None,
        };
        optics.seen_from(self.pose().moved(place, turn_rad))
    }

    /// The nearest departure whose shares of light stay between 0 and 1.
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

    /// Optics of this sensor with other misalignments of its markers, as
    /// [`MarkerArray::with_misalignments`](super::MarkerArray::with_misalignments) takes them.
    ///
    /// # Errors
    /// [`OpticsError::BadSetting`] for `misalignment`.
    pub fn misaligned(&self, misalignments: &[[f64; 2]]) -> Result<Self, OpticsError> {
        Ok(Self {
            array: self.array.clone().with_misalignments(misalignments)?,
            ..self.clone()
        })
    }
}

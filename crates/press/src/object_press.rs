//! A press of an object into the skin: its contact, and the displacements of the markers.

use crate::regime::within_object;
use crate::{
    Body, Bounds, Contact, Displacement, EllipticContact, ForwardFit, MarkerDisplacement, Markers,
    PressError,
};

/// A press of an object into the skin. The default is an empty press on a plane, at the apex of the skin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ObjectPress {
    /// Curvature 1/R_o of the object, positive if the object is convex. If the object has two different curvatures,
    /// `curvature` is their mean.
    pub curvature: f64,
    /// The smaller and the larger curvature of the object; `None` if they are equal.
    pub unequal: Option<[f64; 2]>,
    /// Angle between the direction of the smaller curvature and the x axis at the contact (radians); 0 if the
    /// curvatures are equal.
    pub axis: f64,
    /// Indentation of the skin (length).
    pub indentation: f64,
    /// Coordinates of the contact in the chart of the skin.
    pub at: [f64; 2],
    /// Sideways displacement (length) of the object along x, which begins after the object has touched the skin.
    pub shift: f64,
}

/// Contact of the skin with an object.
#[derive(Clone, Debug)]
pub enum ObjectContact<'b> {
    /// Contact with an object that has the same curvature in all directions.
    Round(Contact<'b>),
    /// Contact with an object that has two different curvatures. The number is the depth under the skin at which
    /// displacements are computed.
    Elliptic(EllipticContact, f64),
}

impl ObjectPress {
    /// Contact of the object with the soft body under the skin.
    ///
    /// # Errors
    /// [`PressError`] if the press is impossible, or if the body has no model of an object with two different
    /// curvatures.
    pub fn contact<'b>(
        &self,
        body: &'b Body,
        markers: &Markers,
    ) -> Result<ObjectContact<'b>, PressError> {
        let skin = markers.skin();
        if let Some(curvatures) = self.unequal {
            let what = "only a half-space has a model of an object with two different curvatures";
            let half_space = body.sideways().ok_or(PressError::Undetermined { what });
            let (poisson, depth) = half_space?;
            let contact = skin.elliptic_contact(poisson, curvatures, self.indentation)?;
            return Ok(ObjectContact::Elliptic(contact, depth));
        }
        let contact = skin.contact(body, self.curvature, self.indentation)?;
        within_object(self.curvature, contact.radius)?;
        Ok(ObjectContact::Round(contact))
    }

    /// Displacements of the markers, at the depth for which `body` is built.
    ///
    /// # Errors
    /// [`PressError`] if the press is impossible.
    pub fn displacements(
        &self,
        body: &Body,
        markers: &Markers,
    ) -> Result<Vec<MarkerDisplacement>, PressError> {
        self.displacements_by(&self.contact(body, markers)?, body, markers)
    }

    /// Displacements of the markers by the contact and by the sideways shift of the object. During the shift, the skin
    /// sticks to the object.
    ///
    /// # Errors
    /// [`PressError`] if the shift is out of its range.
    pub fn displacements_by(
        &self,
        contact: &ObjectContact<'_>,
        body: &Body,
        markers: &Markers,
    ) -> Result<Vec<MarkerDisplacement>, PressError> {
        let Self {
            axis, at, shift, ..
        } = *self;
        let mut moved = match contact {
            ObjectContact::Round(contact) => markers.displacements(contact, at),
            ObjectContact::Elliptic(contact, depth) => {
                markers.elliptic_displacements(contact, at, axis, *depth)
            }
        };
        if let Some((poisson, depth)) = body.sideways().filter(|_| shift != 0.0) {
            let sideways = markers.shifted(poisson, depth, contact.radius(), at, shift)?;
            for (moved, more) in moved.iter_mut().zip(sideways) {
                moved.normal += more.normal;
                moved.tangential =
                    [0, 1].map(|axis| moved.tangential[axis] + more.tangential[axis]);
            }
        }
        Ok(moved)
    }
}

impl ObjectContact<'_> {
    /// Radius of the contact. For an elliptic contact, the radius is the geometric mean of the semi-axes.
    pub fn radius(&self) -> f64 {
        match self {
            Self::Round(contact) => contact.radius,
            Self::Elliptic(contact, _) => contact.radius(),
        }
    }

    /// Force between the bodies; `None` if it is not finite. `young` is the Young's modulus of the soft body. The unit
    /// of the force is the unit of `young` times length².
    pub fn force(&self, young: f64) -> Option<f64> {
        match self {
            Self::Round(contact) => contact.force(young),
            Self::Elliptic(contact, _) => Some(contact.force(young)).filter(|one| one.is_finite()),
        }
    }

    /// Displacement of points at a fixed depth under the skin, at the distance `distance` from the middle of the
    /// contact. For an elliptic contact, the distance is along the longer axis.
    pub fn displacement(&self, distance: f64) -> Displacement {
        match self {
            Self::Round(contact) => contact.displacement(distance),
            Self::Elliptic(contact, depth) => {
                let moved = contact.displacement(distance, 0.0, *depth);
                Displacement {
                    normal: moved.normal,
                    radial: moved.tangential[0],
                }
            }
        }
    }
}

impl ForwardFit {
    /// Cramér–Rao bounds for the press `press` with the contact `contact`; [`ForwardFit::bounds`] describes the other
    /// arguments. `None` if the fit has one curvature and the object has two.
    pub fn press_bounds(
        &self,
        markers: &Markers,
        press: &ObjectPress,
        contact: &ObjectContact<'_>,
        tangential: bool,
        indentation_std: Option<f64>,
    ) -> Option<Bounds> {
        let of_ellipse = |contact: &EllipticContact, axis| {
            self.elliptic_bounds(
                markers,
                contact,
                (press.at, axis),
                tangential,
                indentation_std,
            )
        };
        match contact {
            ObjectContact::Round(contact) if self.is_elliptic => {
                let curvatures = [contact.relative_curvature; 2];
                let (poisson, _) = self.body.sideways()?;
                let contact = EllipticContact::new(poisson, curvatures, contact.indentation);
                of_ellipse(&contact.ok()?, 0.0)
            }
            ObjectContact::Round(contact) => {
                self.bounds(markers, contact, press.at, tangential, indentation_std)
            }
            ObjectContact::Elliptic(contact, _) => {
                self.is_elliptic.then(|| of_ellipse(contact, press.axis))?
            }
        }
    }
}

//! The surface that a method fits to a patch.

use crate::{
    Agreement, Ep2Error, NoiseEstimate, Patch, PatchFrame, Posterior, Status, TensorSpline,
};

/// A way from the contacts of a patch to its surface.
pub trait Method {
    /// The surface through the contacts of a patch.
    ///
    /// # Errors
    /// [`Ep2Error`] where the contacts do not determine it, or a setting is out of its range.
    fn fit(&self, patch: &Patch) -> Result<Fit, Ep2Error>;

    /// Goodness of the fit to a patch, and the ways in which the contacts contradict its model; neither of methods that do
    /// not test it. Takes about as long as the fit, which it makes anew.
    ///
    /// # Errors
    /// Errors of [`Method::fit`].
    fn agreement(&self, _patch: &Patch) -> Result<Agreement, Ep2Error> {
        Ok(Agreement::default())
    }
}

/// The surface of a patch, as a graph in the patch's frame.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The frame; its scale is the length that counts as 1 in the spline.
    pub frame: PatchFrame,
    /// The rectangle that holds the contacts: smallest and largest u, smallest and largest v.
    pub domain: [[f64; 2]; 2],
    /// The surface w(u, v).
    pub spline: TensorSpline,
    /// Uncertainty of the surface that the contacts leave, if the method states it.
    pub posterior: Option<Posterior>,
    /// Noise of the contacts, if the method finds it.
    pub noise: Option<NoiseEstimate>,
    /// Effective number of unknowns that the fit has taken up: the trace of the map from the
    /// observations to the fit.
    pub effective_unknowns: f64,
    /// Whether the method's smoothing splines met their sums of squares, if it has such: of the
    /// first one that did not, else of the last. The curvature is of no use where one did not.
    pub status: Option<Status>,
}

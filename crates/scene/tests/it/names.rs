//! Names of errors, as `failures.csv` has them.

use palpate_chromatouch::OpticsError;
use palpate_ep1::Ep1Error;
use palpate_ep2::Ep2Error;
use palpate_geometry::SurfaceError;
use palpate_press::PressError;
use palpate_rolling::{GlideError, RollFault};
use palpate_tracking::TrackingError;
use strum::VariantNames;

#[test]
fn names_in_tables_do_not_change() {
    let names = [
        Ep1Error::VARIANTS,
        SurfaceError::VARIANTS,
        RollFault::VARIANTS,
        GlideError::VARIANTS,
        Ep2Error::VARIANTS,
        PressError::VARIANTS,
        OpticsError::VARIANTS,
        TrackingError::VARIANTS,
    ];
    // In place of `surface` stands the name of the surface's error.
    let expected = "too-few-probes unresolvable-set unresolved not-rolling not-finite out-of-range\n\
        off-domain chart-singular no-closest-point\n\
        conforming surface too-many-steps singular not-finite\n\
        surface contact-lost two-contacts no-convergence\n\
        too-few-contacts not-finite bad-weight bad-normal missing-normal coincident collinear folded no-plane no-side \
        undetermined bad-setting out-of-range\n\
        bad-setting not-finite off-skin no-indentation conforming edge-contact too-deep too-wide layer-too-thin \
        too-few-markers no-contact one-marker off-markers undetermined out-of-range\n\
        bad-setting bad-depth off-the-skin too-many-markers discs-overlap wrong-count impossible-motion\n\
        empty-image too-small too-large mask-outside marker-diameter no-markers too-many";
    assert_eq!(names.map(|names| names.join(" ")).join("\n"), expected);
    let off = SurfaceError::OffDomain { x: 0.0, y: 0.0 };
    assert_eq!(RollFault::Surface(off).name(), "off-domain");
    assert_eq!(GlideError::Surface(off).name(), "off-domain");
}

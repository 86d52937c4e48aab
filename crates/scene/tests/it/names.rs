//! Names of errors, as they are written in `failures.csv`.

use palpate_chromatouch::OpticsError;
use palpate_ep1::{Ep1Error, SeriesError};
use palpate_ep2::Ep2Error;
use palpate_geometry::{ShapeClass, SurfaceError};
use palpate_press::{ContactRegime, PressError, Verdict};
use palpate_rolling::{GlideError, RollFault};
use palpate_tracking::TrackingError;

use palpate_scene::quantities_of;
use palpate_study::Quantity;
use palpate_study::config::parse;
use palpate_study::glossary::meaning;
use strum::VariantNames;

/// Names that palpate prints and that `VariantNames` does not list, because they are not names of error variants.
const PRINTED: &str = "beyond-pads out-of-field not-seen tracked lost merged split new \
    polynomial interpolating smoothing knots-exhausted unsettled \
    roll glide press fingertip least-squares pad-edge trajectory quadric penalised two-pass half-space bonded-layer gaussian hertz \
    direct projected rendered saddle usage work stopped never-enough negative-std unknown-quantity";

/// The names of errors in tables.
const ERRORS: [&[&str]; 8] = [
    Ep1Error::VARIANTS,
    SurfaceError::VARIANTS,
    RollFault::VARIANTS,
    GlideError::VARIANTS,
    Ep2Error::VARIANTS,
    PressError::VARIANTS,
    OpticsError::VARIANTS,
    TrackingError::VARIANTS,
];

#[test]
fn every_name_is_explained() {
    let verdicts = [
        Verdict::Convex,
        Verdict::Concave,
        Verdict::FlatWithinNoise,
        Verdict::NotResolved,
    ];
    // Names of the contact regimes of a sensor with the curvature 1.
    let regimes =
        [1.0, 0.0, -0.5, -1.0, -2.0].map(|object| <&str>::from(ContactRegime::of(1.0, object)));
    let names = ERRORS
        .into_iter()
        .chain([SeriesError::VARIANTS])
        .flatten()
        .copied()
        .filter(|name| *name != "surface")
        .chain(ShapeClass::ALL.map(ShapeClass::name))
        .chain(verdicts.map(<&str>::from))
        .chain(regimes)
        .chain(PRINTED.split_whitespace());
    let unknown: Vec<&str> = names.filter(|name| meaning(name).is_none()).collect();
    assert!(unknown.is_empty(), "{unknown:?}");
}

#[test]
fn quantities_are_those_of_their_scenes() {
    let scenes = [
        (
            "roll",
            "probe = { kind = \"sphere\", radius = 1.0 }\nobject = { kind = \"sphere\", radius = 4.0 }\nmotion = { rate_rad_per_s = 0.1, duration_s = 1.0 }\nprincipal_curvatures = true",
        ),
        (
            "glide",
            "probe = { kind = \"sphere\", radius = 1.0 }\nobject = { kind = \"sphere\", radius = 4.0 }\nmotion = { finger_positions = [0.0], inter_finger_distance = 1.0, patch_length = 1.0, contacts_per_finger = 3 }\nevaluate = { grid = 3, half_width = 0.2, gaussian_threshold = 0.1, mean_threshold = 0.1 }\nprincipal_curvatures = true",
        ),
        (
            "press",
            "probe = { kind = \"marker-sphere\", radius = 20.0, marker_depth = 2.0, layout = \"published\" }\nobject = { kind = \"sphere\", radius = 4.0 }\nmotion = { indentation = 1.0 }\nsensor = { kind = \"projected\" }",
        ),
        (
            "fingertip",
            "probe = { kind = \"marker-sphere\", radius = 20.0, marker_depth = 2.0, layout = \"published\" }",
        ),
    ];
    for (kind, rest) in scenes {
        let text = format!("name = \"a\"\n[scene]\nkind = \"{kind}\"\n{rest}\n");
        let study = parse("a.toml", &text).unwrap_or_else(|error| panic!("{error}"));
        let found = quantities_of(&study.config.scene);
        for quantity in Quantity::ALL {
            assert!(
                !found.contains(quantity) || quantity.scenes.contains(&kind),
                "{kind}: {}",
                quantity.name
            );
        }
        // The quantities of a press depend on its object, model and estimator. The quantities of a fingertip depend on
        // its parts.
        let listed = Quantity::ALL
            .iter()
            .filter(|quantity| quantity.scenes.contains(&kind));
        assert!(
            ["press", "fingertip"].contains(&kind) || listed.count() == found.len(),
            "{kind}"
        );
    }
}

#[test]
fn names_in_tables_do_not_change() {
    // The variant `surface` wraps a `SurfaceError`. Tables contain the name of the wrapped error and never `surface`.
    let expected = "too-few-probes unresolvable-set noisy-rotations unresolved not-rolling not-finite out-of-range\n\
        off-domain chart-singular no-closest-point\n\
        conforming overlapping surface too-many-steps singular not-finite\n\
        surface contact-lost two-contacts no-convergence\n\
        too-few-contacts not-finite bad-weight bad-normal missing-normal coincident collinear folded no-plane no-side tip-too-large \
        undetermined bad-setting out-of-range\n\
        bad-setting not-finite off-skin no-indentation conforming edge-contact too-deep too-wide layer-too-thin \
        too-few-markers no-contact other-body off-markers hidden-marker undetermined out-of-range\n\
        bad-setting folded-lens bad-depth off-the-skin too-many-markers discs-overlap wrong-count impossible-motion\n\
        empty-image too-small too-large mask-outside no-markers too-many";
    assert_eq!(ERRORS.map(|names| names.join(" ")).join("\n"), expected);
    let off = SurfaceError::OffDomain { x: 0.0, y: 0.0 };
    assert_eq!(<&str>::from(RollFault::Surface(off)), "off-domain");
    assert_eq!(<&str>::from(GlideError::Surface(off)), "off-domain");
}

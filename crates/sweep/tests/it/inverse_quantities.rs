//! Statistics of inverse quantities, such as radii.

use palpate_sweep::{Summary, drop_undefined_moments};

fn radius_of(mean: f64, std: Option<f64>) -> Summary {
    let all = |mean: f64, std: Option<f64>| Summary {
        observations: 9,
        mean: Some(mean),
        std,
        rms_error: Some(1.0),
        q50: Some(20.0),
        ..Summary::default()
    };
    let mut summaries = [all(mean, std), all(2e4, Some(1e6))];
    let curvature = summaries[0];
    drop_undefined_moments(&mut summaries, |place| (place == 1).then_some(0));
    assert_eq!(summaries[0], curvature);
    summaries[1]
}

#[test]
fn a_radius_near_flat_has_quantiles_and_no_mean() {
    for mean in [0.039, -0.039, 0.0] {
        let radius = radius_of(mean, Some(0.01));
        assert_eq!(
            (radius.mean, radius.std, radius.rms_error),
            (None, None, None)
        );
        assert_eq!((radius.q50, radius.observations), (Some(20.0), 9));
    }
}

#[test]
fn a_radius_of_a_known_sign_keeps_its_mean() {
    for (mean, std) in [
        (0.041, Some(0.01)),
        (-0.041, Some(0.01)),
        (0.05, Some(0.0)),
        (0.05, None),
    ] {
        assert_eq!(radius_of(mean, std).mean, Some(2e4));
    }
}

//! Compares the reference for presses on a paraboloid with independent programs.

use palpate_assay::paraboloid_reference::{Body, ParaboloidPress};

fn off(found: &[[f64; 2]], truth: &[[f64; 2]]) -> f64 {
    let pairs = found.iter().flatten().zip(truth.iter().flatten());
    pairs.fold(0.0, |most: f64, (found, truth)| {
        most.max((found - truth).abs())
    })
}

#[test]
fn a_half_space_agrees_with_independent_programs() {
    let press = ParaboloidPress::new(Body::HalfSpace { poisson: 0.5 }, 0.05, 1.0).unwrap();
    let found = press
        .displacements(2.0, &[0.0, 1.0, 2.5, 5.0, 10.0])
        .unwrap();
    let truth = [
        [0.870_528_639_1, 0.0],
        [0.848_373_640_9, 0.048_664_340_35],
        [0.736_308_985_4, 0.109_459_103_9],
        [0.442_277_599_4, 0.118_283_342_8],
        [0.197_951_768_9, 0.037_565_625_39],
    ];
    assert!(off(&found, &truth) < 1e-9, "{found:?}");
}

#[test]
fn a_layer_agrees_with_independent_programs() {
    let layer = Body::Layer { thickness: 5.0 };
    let press = ParaboloidPress::new(layer, 0.05, 1.0).unwrap();
    assert!((press.radius() / 6.176_79 - 1.0).abs() < 3e-3);
    for (depth, truth) in [
        (0.5, [0.9038, 0.881_19, 0.813_25, 0.537_76, 0.080_62]),
        (2.0, [0.532_80, 0.518_62, 0.475_54, 0.298_95, f64::NAN]),
    ] {
        let found = press
            .displacements(depth, &[0.0, 1.0, 2.0, 4.0, 6.0])
            .unwrap();
        for ([normal, _], truth) in found.iter().zip(truth) {
            assert!(
                truth.is_nan() || (normal - truth).abs() < 3e-3,
                "{normal} {truth}"
            );
        }
    }
}

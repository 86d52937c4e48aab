//! Tests which roll model `auto` chooses if the rolls are too long to measure the errors of the models.

use palpate_geometry::Sphere;
use palpate_rolling::{Chart, Model, Motion, Roller, Rolls};

use crate::scenes::{auto, ellipsoid};

const FREE: Chart = Chart::Free;

/// Four rolls in different directions. The probe makes `turns` turns in each roll.
fn turns(turns: f64) -> Vec<Vec<Motion>> {
    let angle = turns * std::f64::consts::TAU;
    let directions = [0.2, 1.7, 3.3, 4.9];
    directions
        .map(|direction| vec![Motion::rolling(direction, 1.0, angle)])
        .to_vec()
}

#[test]
fn long_rolls_are_not_rolled_to_choose_how() {
    let start = |turned: f64, tolerance: f64| {
        let rolls = turns(turned);
        let auto = auto(tolerance);
        let probe = Sphere::new(1.0).unwrap();
        let rolls = Rolls::exact(&rolls);
        let roller = Roller::new(probe, ellipsoid(5.0, 4.0, 3.0), (1.0, 0.5), auto, rolls);
        roller.unwrap()
    };
    for tolerance in [1e-6_f64, 1e-14] {
        for turned in [200.0, 1e3, 1e6, 1e12] {
            let taken = (1e-3 * tolerance / turned).max(1e-14);
            let choice = start(turned, tolerance).choice().clone();
            let Model::Dop853 { tolerance: set, .. } = choice.model else {
                panic!("{choice:?}");
            };
            assert!((set / taken - 1.0).abs() < 1e-12, "{turned}: {choice:?}");
            assert!(choice.reason.contains("too long"), "{choice:?}");
        }
    }
    // For long rolls, `auto` chooses a model without measuring its error. Even so, the error must be within the
    // tolerance.
    let rolls = turns(100.0);
    let rolls = Rolls::exact(&rolls);
    let roller = start(100.0, 1e-6);
    assert!(roller.choice().reason.contains("too long"));
    let taken = roller
        .measure(&[roller.choice().model], FREE, rolls)
        .remove(0);
    assert!(taken.outcome.is_ok_and(|error| error <= 1e-6));
    // A roll that consists of many short motions does not count as long, so its models are measured.
    let pieces = vec![vec![Motion::rolling(0.2, 1.0, 1e-3); 3000]];
    let auto = auto(1e-6);
    let roller = roller.on(auto, Rolls::exact(&pieces)).unwrap();
    assert!(matches!(roller.choice().model, Model::Rk4 { steps: 1, .. }));
}

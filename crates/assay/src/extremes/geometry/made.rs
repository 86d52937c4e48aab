//! Constructors, with what makes no surface.

use palpate_geometry::ShapeThresholds;
use palpate_geometry::surfaces::{Cylinder, Dish, Ellipsoid, Graph, Sphere, Torus};

use super::super::Case;
use super::super::hostile::{NO_LENGTHS, NOT_FINITE};

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for bad in NO_LENGTHS {
        let input = format!("radius {bad:e}");
        let mut refuse = |entry, attempt: fn(f64) -> bool| {
            cases.push(Case::refusal(entry, input.clone(), move || {
                if attempt(bad) {
                    Err(InvalidShape)
                } else {
                    Ok(())
                }
            }));
        };
        refuse("geometry::Sphere::new", |bad| Sphere::new(bad).is_err());
        refuse("geometry::Dish::new", |bad| Dish::new(bad).is_err());
        refuse("geometry::Cylinder::new", |bad| {
            Cylinder::new(bad, 0.0).is_err()
        });
        refuse("geometry::Torus::new", |bad| {
            Torus::new(bad, 1e-3).is_err() && Torus::new(1e3, bad).is_err()
        });
        refuse("geometry::Ellipsoid::new", |bad| {
            let axes = [[bad, 1.0, 1.0], [1.0, bad, 1.0], [1.0, 1.0, bad]];
            axes.into_iter().all(|axes| Ellipsoid::new(axes).is_err())
        });
    }
    for bad in NOT_FINITE {
        let input = format!("{bad:e}");
        cases.push(Case::refusal(
            "geometry::Cylinder::new",
            format!("direction {bad:e}"),
            move || Cylinder::new(1.0, bad),
        ));
        cases.push(Case::refusal(
            "geometry::Graph::paraboloid",
            input.clone(),
            move || Graph::paraboloid(bad),
        ));
        cases.push(Case::refusal(
            "geometry::Graph::saddle",
            input.clone(),
            move || Graph::saddle(bad),
        ));
    }
    for (gaussian, mean) in [
        (f64::NAN, 0.0),
        (0.0, f64::NAN),
        (f64::INFINITY, 0.0),
        (1.0, f64::INFINITY),
        (-1e-310, 0.0),
        (0.0, 1e-9),
        (1e300, 1e200),
    ] {
        cases.push(Case::refusal(
            "geometry::ShapeThresholds::new",
            format!("gaussian {gaussian:e}, mean {mean:e}"),
            move || ShapeThresholds::new(gaussian, mean),
        ));
    }
    cases
}

/// The name under which these constructors refuse.
#[derive(Debug)]
struct InvalidShape;

//! Answers of a fit at one place, for the tables.

use palpate_ep2::{Contact, Ep2Error, MapPoint, Method, Patch, Penalised, Quadric, TwoPass};
use palpate_verdict::Answer;

/// Rounding of numbers that should fit together.
pub(super) const FITS: f64 = 1e-12;
pub(super) const METHOD: &str = "ep2::Method::fit";

/// All methods by name, with their default settings.
pub(super) fn methods() -> [(&'static str, Box<dyn Method>); 3] {
    [
        ("quadric", Box::new(Quadric::default())),
        ("penalised", Box::new(Penalised::default())),
        ("two-pass", Box::new(TwoPass::default())),
    ]
}

/// Whether the numbers over the middle of the contacts fit together.
pub(super) fn centre(method: &dyn Method, contacts: &[Contact]) -> Result<Answer, Ep2Error> {
    let fit = method.fit(&Patch::new(contacts, &nalgebra::Vector3::z())?)?;
    Ok(consistent(&fit.centre()?).also([fit.effective_unknowns]))
}

/// Consistency of the results at one place of a map: `K = k_min k_max`, H is their mean, and the normal and both
/// directions are an orthonormal triple.
pub(super) fn consistent(point: &MapPoint) -> Answer {
    let (least, most) = (point.k_min, point.k_max);
    let scale = least.abs().max(most.abs()).max(f64::MIN_POSITIVE);
    let [least, most] = [least / scale, most / scale];
    let [normal, u, v] = [point.normal, point.direction_of_min, point.direction_of_max];
    let pairs = [
        (point.curvature.gaussian / scale / scale, least * most),
        (point.curvature.mean / scale, 0.5 * (least + most)),
        (normal.norm(), 1.0),
        (u.norm(), 1.0),
        (v.norm(), 1.0),
        (normal.dot(&u), 0.0),
        (normal.dot(&v), 0.0),
        (u.dot(&v), 0.0),
    ];
    Answer::all_at_scale(pairs, 1.0)
        .within(FITS)
        .also(numbers(point))
}

pub(super) fn numbers(point: &MapPoint) -> Vec<f64> {
    let mut numbers = vec![
        point.curvature.gaussian,
        point.curvature.mean,
        point.k_min,
        point.k_max,
    ];
    numbers.extend(point.shape_index);
    numbers.extend(point.position.iter().copied());
    let stated = point.curvature.uncertainty.iter();
    numbers.extend(stated.flat_map(|one| [one.gaussian_std, one.mean_std, one.correlation]));
    numbers
}

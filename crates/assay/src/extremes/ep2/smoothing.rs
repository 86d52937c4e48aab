//! Smoothing splines with all or nothing to smooth.

use palpate_ep2::{Ep2Error, Smoothed, SmoothingSpline, WeightedPoint};

use crate::extremes::{Answer, Case};

/// 12 × 12 points of a height over a square of this size.
fn points(size: f64, height: impl Fn(f64, f64) -> f64) -> Vec<WeightedPoint> {
    let at = |index: usize| index as f64 / 11.0;
    let point = |index: usize| {
        let (u, v) = (at(index % 12), at(index / 12));
        WeightedPoint {
            u: size * u,
            v: size * v,
            w: size * height(u, v),
            weight: 1.0 / size,
        }
    };
    (0..144).map(point).collect()
}

/// A cubic, which bicubic splines hold.
fn cubic(u: f64, v: f64) -> f64 {
    u * u * u - 2.0 * u * v * v + 0.5 * v + 0.25
}

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for size in [1e-100, 1e-9, 1.0, 1e9, 1e100] {
        for smoothing in [0.0, 1e-20, 1e-3, 1.0, 1e300, f64::INFINITY] {
            cases.push(Case::value(
                "ep2::SmoothingSpline::fit",
                format!("a cubic over a square of {size:e}, smoothing {smoothing:e}"),
                move || polynomial(size, smoothing),
            ));
        }
    }
    for smoothing in [0.0, 1e-12, 1e-3, 1e300] {
        cases.push(Case::value(
            "ep2::SmoothingSpline::fit",
            format!(
                "a wave, smoothing {smoothing:e}: the sum of squares, aimed at or in another unit"
            ),
            move || wave(smoothing),
        ));
    }
    for (name, value) in [("NaN", f64::NAN), ("-1", -1.0), ("-inf", f64::NEG_INFINITY)] {
        cases.push(Case::refusal(
            "ep2::SmoothingSpline::fit",
            format!("smoothing {name}"),
            move || SmoothingSpline::new(3, value).fit(&points(1.0, cubic)),
        ));
        for place in 0..4 {
            if place < 3 && value == -1.0 {
                continue;
            }
            cases.push(Case::refusal(
                "ep2::SmoothingSpline::fit",
                format!("number {place} of a point is {name}"),
                move || {
                    let mut points = points(1.0, cubic);
                    let point = &mut points[7];
                    *[&mut point.u, &mut point.v, &mut point.w, &mut point.weight][place] = value;
                    SmoothingSpline::new(3, 1.0).fit(&points)
                },
            ));
        }
    }
    for degree in [0, 6, usize::MAX] {
        cases.push(Case::refusal(
            "ep2::SmoothingSpline::fit",
            format!("degree {degree}"),
            move || SmoothingSpline::new(degree, 1.0).fit(&points(1.0, cubic)),
        ));
    }
    cases.push(Case::refusal(
        "ep2::SmoothingSpline::fit",
        "all points in one place",
        || {
            SmoothingSpline::new(3, 1.0).fit(
                &points(1.0, cubic)
                    .iter()
                    .map(|_| alike())
                    .collect::<Vec<_>>(),
            )
        },
    ));
    for weight in [f64::from_bits(1), 1e-300, 1e-150, 1e150] {
        cases.push(Case::new(
            "ep2::SmoothingSpline::fit",
            format!("one weight of {weight:e}: a cubic all the same"),
            move || weighted(weight).into(),
        ));
    }
    cases
}

const fn alike() -> WeightedPoint {
    WeightedPoint {
        u: 1.0,
        v: 2.0,
        w: 3.0,
        weight: 1.0,
    }
}

fn polynomial(size: f64, smoothing: f64) -> Result<Answer, Ep2Error> {
    let found = SmoothingSpline::new(3, smoothing).fit(&points(size, cubic))?;
    let answer = Answer::all_at_scale(on_the_cubic(&found, size), 1.0);
    Ok(answer
        .within(1e-11)
        .also([found.residual_sum, found.effective_unknowns]))
}

/// Values of a spline over a square of side `size` at three places, each beside the value of the cubic there.
fn on_the_cubic(found: &Smoothed, size: f64) -> [(f64, f64); 3] {
    let at = [(0.0, 0.0), (0.31, 0.77), (1.0, 0.5)];
    at.map(|(u, v)| (found.spline.value(size * u, size * v) / size, cubic(u, v)))
}

/// Beside a weight that outweighs all digits of the others nothing is left of them.
fn weighted(weight: f64) -> Result<Answer, Ep2Error> {
    let mut points = points(1.0, cubic);
    points[7].weight = weight;
    let found = SmoothingSpline::new(3, 1e-3).fit(&points)?;
    let answer = Answer::all_at_scale(on_the_cubic(&found, 1.0), 1.0).within(1e-11);
    let answer = answer.also(found.spline.coefficients);
    Ok(answer.conditioned(weight.max(1.0)).or_no_digits())
}

/// Sum of squares over that aimed at, within the tolerance of a thousandth; beyond it, where the polynomial
/// meets it, the same in any unit.
fn wave(smoothing: f64) -> Result<Answer, Ep2Error> {
    let height = |u: f64, v: f64| libm::sin(5.0 * u) * libm::cos(4.0 * v);
    let found = SmoothingSpline::new(3, smoothing).fit(&points(1.0, height))?;
    if found.status.is_met() && found.status != palpate_ep2::Status::Polynomial && smoothing > 0.0 {
        return Ok(Answer::near(found.residual_sum, smoothing).within(1.001e-3));
    }
    // The same in another unit of height, a power of two, which changes no digit.
    let unit = 2f64.powi(20);
    let of_unit = |u, v| height(u, v) * unit;
    let same = SmoothingSpline::new(3, smoothing * unit * unit).fit(&points(1.0, of_unit))?;
    let pair = (same.residual_sum / unit / unit, found.residual_sum);
    Ok(Answer::all_near([pair])
        .within(1e-12)
        .also(found.spline.coefficients))
}

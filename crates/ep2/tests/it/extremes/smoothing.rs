//! Smoothing splines with all or nothing to smooth.

use palpate_ep2::{Ep2Error, Smoothed, SmoothingSpline, Status, WeightedPoint};
use palpate_verdict::{Answer, rows};

const FIT: &str = "ep2::SmoothingSpline::fit";
const NAMES: [(&str, f64); 3] = [("NaN", f64::NAN), ("-1", -1.0), ("-inf", f64::NEG_INFINITY)];

rows! {
    FIT, "a cubic over a square of {size:e}, smoothing {smoothing:e}" => polynomial(size, smoothing),
        for size in [1e-100, 1e-9, 1.0, 1e9, 1e100], for smoothing in [0.0, 1e-20, 1e-3, 1.0, 1e300, f64::INFINITY];
    FIT, "a wave, smoothing {smoothing:e}: the sum of squares, aimed at or in another unit" => wave(smoothing),
        for smoothing in [0.0, 1e-12, 1e-3, 1e300];
    FIT, "smoothing {name}", "bad-setting" => fit(3, bad, &points(1.0, cubic)), for (name, bad) in NAMES;
    FIT, "number {place} of a point is {name}", "not-finite" => fit(3, 1.0, &with(place, bad)),
        for (name, bad) in [NAMES[0], NAMES[2]], for place in 0..3;
    FIT, "number 3 of a point is {name}", error => fit(3, 1.0, &with(3, bad)),
        for ((name, bad), error) in NAMES.into_iter().zip(["not-finite", "bad-weight", "bad-weight"]);
    FIT, "degree {degree}", "bad-setting" => fit(degree, 1.0, &points(1.0, cubic)), for degree in [0, 6, usize::MAX];
    FIT, "all points in one place", "coincident" => fit(3, 1.0, &[points(1.0, cubic)[7]; 144]);
    FIT, "one weight of {weight:e}: a cubic all the same" => weighted(weight),
        for weight in [f64::from_bits(1), 1e-300, 1e-150, 1e150];
}

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

/// Points of a cubic, with a number of one of them replaced.
fn with(place: usize, bad: f64) -> Vec<WeightedPoint> {
    let mut points = points(1.0, cubic);
    let WeightedPoint { u, v, w, weight } = &mut points[7];
    *[u, v, w, weight][place] = bad;
    points
}

fn fit(degree: usize, smoothing: f64, points: &[WeightedPoint]) -> Result<Smoothed, Ep2Error> {
    SmoothingSpline::new(degree, smoothing).fit(points)
}

fn polynomial(size: f64, smoothing: f64) -> Result<Answer, Ep2Error> {
    let found = fit(3, smoothing, &points(size, cubic))?;
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
    let found = fit(3, 1e-3, &points)?;
    let answer = Answer::all_at_scale(on_the_cubic(&found, 1.0), 1.0).within(1e-11);
    let answer = answer.also(found.spline.coefficients);
    Ok(answer.conditioned(weight.max(1.0)).or_no_digits())
}

/// Sum of squares over that aimed at, within the tolerance of a thousandth; beyond it, where the polynomial
/// meets it, the same in any unit.
fn wave(smoothing: f64) -> Result<Answer, Ep2Error> {
    let height = |u: f64, v: f64| libm::sin(5.0 * u) * libm::cos(4.0 * v);
    let found = fit(3, smoothing, &points(1.0, height))?;
    if found.status.is_met() && found.status != Status::Polynomial && smoothing > 0.0 {
        return Ok(Answer::near(found.residual_sum, smoothing).within(1.001e-3));
    }
    // The same in another unit of height, a power of two, which changes no digit.
    let unit = 2f64.powi(20);
    let of_unit = |u, v| height(u, v) * unit;
    let same = fit(3, smoothing * unit * unit, &points(1.0, of_unit))?;
    let pair = (same.residual_sum / unit / unit, found.residual_sum);
    Ok(Answer::all_near([pair])
        .within(1e-12)
        .also(found.spline.coefficients))
}

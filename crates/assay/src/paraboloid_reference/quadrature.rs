//! Clenshaw–Curtis quadrature on panels, which are subintervals of the integration interval. It is exact up to rounding
//! errors for functions that are smooth on each panel.

use std::f64::consts::{FRAC_PI_2, PI};

const INTERVALS: usize = 24;

/// Nodes (in decreasing order) and weights of the Clenshaw–Curtis quadrature on [−1, 1], including both ends.
/// `intervals` must be even.
fn clenshaw_curtis(intervals: usize) -> Vec<[f64; 2]> {
    let n = intervals as f64;
    let node = |j: usize| {
        let angle = PI * j as f64 / n;
        let half = intervals / 2;
        let terms = (1..=half).map(|b| {
            let size = if b == half { 1.0 } else { 2.0 };
            let b = b as f64;
            size / (4.0 * b * b - 1.0) * libm::cos(2.0 * b * angle)
        });
        let ends = if j == 0 || j == intervals { 1.0 } else { 2.0 };
        [libm::cos(angle), ends / n * (1.0 - terms.sum::<f64>())]
    };
    (0..=intervals).map(node).collect()
}

/// Nodes (in increasing order) and weights of the quadrature on the interval from `from` to `to`.
pub(super) fn over(from: f64, to: f64, intervals: usize) -> impl Iterator<Item = [f64; 2]> {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let nodes = clenshaw_curtis(intervals).into_iter().rev();
    nodes.map(move |[node, weight]| [middle + half * node, half * weight])
}

/// Nodes and weights of the quadrature from 0 to `reach`. The interval is divided into panels that are at most `panel`
/// long.
pub(super) fn on_panels(reach: f64, panel: f64) -> impl Iterator<Item = [f64; 2]> {
    let count = (reach / panel).ceil().max(1.0) as usize;
    let width = reach / count as f64;
    let nodes: Vec<[f64; 2]> = over(0.0, width, INTERVALS).collect();
    (0..count).flat_map(move |panel| {
        let from = panel as f64 * width;
        let shifted: Vec<[f64; 2]> = nodes
            .iter()
            .map(|[k, weight]| [from + k, *weight])
            .collect();
        shifted
    })
}

/// Nodes and weights of the quadrature from 0 to `end`, for functions that vary over a length of `width` near the
/// position `place`. The interval is divided into panels, which are short near `place` and longer farther away from it.
pub(super) fn around(end: f64, place: f64, width: f64) -> impl Iterator<Item = [f64; 2]> {
    let mut bounds = vec![0.0, end, place];
    let mut reach = width;
    while reach < end + place {
        bounds.extend([place - reach, place + reach]);
        reach *= 2.0;
    }
    bounds.retain(|bound| (0.0..=end).contains(bound));
    bounds.sort_unstable_by(f64::total_cmp);
    bounds.dedup();
    let panels: Vec<[f64; 2]> = bounds.windows(2).map(|pair| [pair[0], pair[1]]).collect();
    panels
        .into_iter()
        .flat_map(|[from, to]| over(from, to, INTERVALS))
}

/// Parts of an integrand with a factor e⁻ᵖ are neglected if p exceeds this number.
pub(super) const NEGLIGIBLE: f64 = 30.0;
/// Largest change (rad) of the integrand's phase over one panel (subinterval of the quadrature).
pub(super) const PHASE: f64 = 12.0;

/// Displacement of a half-space's surface at the distance r from the middle of a contact of radius a. It is the
/// integral of φ(t)/√(r² − t²) from 0 to min(a, r), with the auxiliary function φ of the pressure.
pub(super) fn abel(phi: impl Fn(f64) -> f64, a: f64, r: f64) -> f64 {
    let most = if r > a { libm::asin(a / r) } else { FRAC_PI_2 };
    over(0.0, most, 48)
        .map(|[angle, weight]| weight * phi(r * libm::sin(angle)))
        .sum()
}

/// Two integrals over wavenumbers up to `reach`: the inward displacement (with the Bessel function J₀) and the outward
/// displacement (with J₁). `waves` returns both integrands without their Bessel functions; they must be smooth over
/// wavenumber intervals of the length `smooth`.
pub(super) fn sum(
    reach: f64,
    smooth: f64,
    contact: f64,
    distances: &[f64],
    waves: impl Fn(f64) -> [f64; 2],
) -> Vec<[f64; 2]> {
    let farthest = distances.iter().fold(0.0, |most: f64, r| most.max(*r));
    let panel = smooth.min(PHASE / (contact + farthest));
    let waves: Vec<[f64; 3]> = on_panels(reach, panel)
        .map(|[k, weight]| {
            let [normal, radial] = waves(k);
            [k, weight * normal, weight * radial]
        })
        .collect();
    let at = |r: &f64| {
        waves
            .iter()
            .fold([0.0; 2], |[inward, outward], [k, normal, radial]| {
                [
                    inward + normal * libm::j0(k * r),
                    outward + radial * libm::j1(k * r),
                ]
            })
    };
    distances.iter().map(at).collect()
}

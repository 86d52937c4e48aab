//! Objects that stick and move sideways, and the relations at the surface.

use palpate_press::hertz::{published_parabola, sneddon_indentation};
use palpate_press::shear::{StuckShift, followed, stuck_shift};
use palpate_press::{Markers, PressError, Skin};
use palpate_verdict::{Answer, Precise, rows};

const STUCK: &str = "press::shear::stuck_shift";
const SNEDDON: &str = "press::hertz::sneddon_indentation";
const SHIFTED: &str = "press::Markers::shifted";
const SETTINGS: [&str; 5] = ["poisson", "depth", "radius", "distance", "azimuth"];
const UNKNOWN: [[f64; 3]; 5] = [
    [f64::NAN, 1.0, 1.0],
    [1.0, 0.0, 0.0],
    [f64::INFINITY, 1.0, 0.5],
    [1.0, f64::INFINITY, f64::INFINITY],
    [f64::MAX, f64::from_bits(1), 1.0],
];

rows! {
    "press::shear::followed", "depth {depth:e} radii, radii 1e-30 to 1e30" => on_the_axis(depth),
        for depth in [0.0, 1e-12, 1e-3, 1.0, 1e3, 1e9, 1e15];
    STUCK, "surface, distance {r:e} radii: the object's own shift" => at_the_surface(r),
        for r in [0.0, 1e-12, 0.5, 1.0 - 1e-12, 1.0];
    STUCK, "{setting} {bad}", "bad-setting" => mistaken(place, bad),
        for (place, setting) in SETTINGS.into_iter().enumerate(), for bad in [f64::NAN, f64::INFINITY];
    SNEDDON, "contact {ratio:e} of the radius" => sneddon(ratio),
        for ratio in [0.0, 1e-300, 1e-9, 0.5, 0.999_999, 1.0 - 1e-12];
    SNEDDON, "radius {radius}, contact {a}", "bad-setting" => sneddon_indentation(radius, a),
        for (radius, a) in [(f64::NAN, 0.0), (1.0, 1.0), (1.0, -0.1), (1.0, f64::NAN), (0.0, 0.0)];
    "press::hertz::published_parabola", "indentation {indentation:e}, a {a:e}, r {r:e}: 0 where nothing is known" =>
        Answer::at_scale(published_parabola(indentation, a, r), 0.0, 1.0), for [indentation, a, r] in UNKNOWN;
    SHIFTED, "shift {shift:e}: as many times that of a shift of 1" => shifted(shift),
        for shift in [0.0, f64::from_bits(1)];
    SHIFTED, "shift {shift:e}", "bad-setting" => shifted(shift), for shift in [1e300, f64::INFINITY, f64::NAN];
}

fn mistaken(place: usize, bad: f64) -> Result<StuckShift, PressError> {
    let mut all = [0.3, 1.0, 1.0, 1.0, 1.0];
    all[place] = bad;
    let [poisson, depth, radius, r, azimuth] = all;
    stuck_shift(poisson, depth, radius, r, azimuth)
}

/// π(2 − ν) times the share that follows is 2(2 − ν) atan(1/z) − z/(1 + z²).
fn on_the_axis(depth: f64) -> Result<Answer, PressError> {
    let mut pairs = Vec::new();
    for poisson in [0.0, 0.3, 0.5] {
        for radius in [1e-30, 1.0, 1e30] {
            let z = Precise::new(depth * radius) / radius;
            let two_less = 2.0 - Precise::new(poisson);
            let angle = Precise::pi() * 0.5 - z.atan();
            let share = &two_less * 2.0 * angle - &z / (z.squared() + 1.0);
            let truth = share / (Precise::pi() * two_less);
            pairs.push((followed(poisson, depth * radius, radius)?, truth.to_f64()));
        }
    }
    Ok(Answer::all_near(pairs).within(1e-14))
}

fn at_the_surface(r: f64) -> Result<Answer, PressError> {
    let mut pairs = Vec::new();
    for azimuth in [0.0, 1.0, -1e15, f64::MAX] {
        for radius in [1e-50, 1.0, 1e50] {
            let moved = stuck_shift(0.3, 0.0, radius, r * radius, azimuth)?;
            // At the edge the inward slope is infinite: half an ulp of r beyond it is seen as its root.
            pairs.extend([(moved.along, 1.0), (moved.across, 0.0)]);
        }
    }
    Ok(Answer::all_at_scale(pairs, 1.0).within(1e-7))
}

fn sneddon(ratio: f64) -> Result<Answer, PressError> {
    let mut pairs = Vec::new();
    for radius in [1e-9, 1.0, 20.0, 1e9] {
        let a = ratio * radius;
        let [whole, part] = [radius, a].map(Precise::new);
        let log = ((&whole + &part) / (whole - &part)).ln();
        let truth = (part * log * 0.5).to_f64();
        pairs.push((sneddon_indentation(radius, a)?, truth));
    }
    Ok(Answer::all_near(pairs).within(1e-15))
}

fn shifted(shift: f64) -> Result<Answer, PressError> {
    let places = [[0.0, 0.0], [3.0, 4.0], [-20.0, 1e-9]];
    let markers = Markers::new(Skin::new(20.0)?, &places)?;
    let parts = |shift| {
        let moved = markers.shifted(0.3, 2.0, 4.0, [1.0, 0.0], shift)?;
        let parts =
            (moved.iter()).flat_map(|one| [one.normal, one.tangential[0], one.tangential[1]]);
        Ok::<Vec<f64>, PressError>(parts.collect())
    };
    let truths = parts(1.0)?.into_iter().map(|part| part * shift);
    let pairs = parts(shift)?.into_iter().zip(truths);
    Ok(Answer::all_at_scale(pairs, shift.max(f64::MIN_POSITIVE)).within(1e-14))
}

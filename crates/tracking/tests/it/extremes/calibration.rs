//! Calibrations from points that tell little.

use palpate_tracking::NormalFrom::{Both, Hue, Size};
use palpate_tracking::{
    Calibration, CalibrationError, Change, LateralCalibration, LateralPoint, Line,
    NormalCalibration, NormalFrom, NormalPoint,
};
use palpate_verdict::{Answer, Precise, rows};

const NORMAL_FIT: &str = "tracking::NormalCalibration::fit";
const LATERAL_FIT: &str = "tracking::LateralCalibration::fit";
const NEW: &str = "tracking::Calibration::new";
const NORMAL: &str = "tracking::Calibration::normal";
const TANGENTIAL: &str = "tracking::Calibration::tangential";
const INTERCEPT: &str = "tracking::Line::with_intercept";
/// Draws a line through points.
type Draw = fn(&[[f64; 2]]) -> Result<Line, CalibrationError>;
const LINES: [(&str, Draw); 2] = [
    (INTERCEPT, Line::with_intercept),
    ("tracking::Line::through_rest", Line::through_rest),
];
const LEAST: f64 = f64::from_bits(1);
const BAD: [f64; 3] = [f64::NAN, f64::INFINITY, 1e200];
const SCALES: [f64; 5] = [1e-90, 1e-9, 1.0, 1e9, 1e90];
const MARKERS: [usize; 3] = [0, 1, usize::MAX];
/// Displacements and signals.
const ON_A_LINE: [(f64, f64); 8] = [
    (1.0, 1.0),
    (1e-9, 1e9),
    (1e9, 1e-9),
    (1e-100, 1e-100),
    (1e100, 1e100),
    (1e-100, 1e100),
    (1e-150, 1e-150),
    (LEAST, LEAST),
];
/// Changes of hue and growth alike, and the displacements that they tell.
const TOLD: [(NormalFrom, f64, f64); 5] = [
    (Hue, -1e300, -1e301),
    (Hue, 1e300, 1e301),
    (Size, f64::INFINITY, 5.0),
    (Size, 1e300, 5.0),
    (Both, 1e300, 5e300),
];

rows! {
    entry, "{count} equal points", "too-few-points" => draw(&vec![[1.0, 2.0]; count]),
        for (entry, draw) in LINES, for count in [0, 1];
    entry, "{count} equal points", "one-displacement" => draw(&vec![[1.0, 2.0]; count]),
        for (entry, draw) in LINES, for count in [2, 1000];
    entry, "one displacement, two signals", "one-displacement" => draw(&[[1.0, 2.0], [1.0, 3.0]]),
        for (entry, draw) in LINES;
    entry, "one signal, two displacements", "no-slope" => draw(&[[1.0, 2.0], [3.0, 2.0]]), for (entry, draw) in LINES;
    entry, "signals of 0", "no-slope" => draw(&[[1.0, 0.0], [3.0, -0.0]]), for (entry, draw) in LINES;
    entry, "a displacement of {x:e} and a signal of {y:e}", "not-finite" => draw(&[[1.0, 2.0], [x, y]]),
        for (entry, draw) in LINES, for (x, y) in [(f64::NAN, 3.0), (2.0, f64::INFINITY), (2.0, 1e101)];
    entry, "points on a line, displacements of {x:e} and signals of {y:e}" => on_a_line(draw, x, y),
        for (entry, draw) in LINES, for (x, y) in ON_A_LINE;
    entry, "points on a line, displacements of {x:e} and signals of {y:e}", "out-of-range" => on_a_line(draw, x, y),
        for (entry, draw) in LINES, for (x, y) in [(1e-320, 1.0), (1.0, 1e-320), (1e100, 1e-300)];
    INTERCEPT, "displacements that differ by {step:e} of themselves: slope" => nearly_alike(step),
        for step in [1e-3, 1e-6, 1e-9, 1e-12, 1e-15];
    NORMAL_FIT, "{from:?}, displacements of {scale:e}: those of the points again" => normal(from, scale),
        for from in NormalFrom::ALL, for scale in SCALES;
    NORMAL_FIT, "{from:?}, number {part} of a point is {bad:e}", "not-finite" => mistaken(from, part, bad),
        for from in NormalFrom::ALL, for part in 0..2, for bad in BAD;
    NORMAL_FIT, "{from:?}, number 2 of a point is NaN", "not-finite" => mistaken(from, 2, f64::NAN),
        for from in NormalFrom::ALL;
    NORMAL_FIT, "{from:?}, number 2 of a point is {growth:e}: as without it where it is not used" =>
        mistaken(from, 2, growth), for from in NormalFrom::ALL, for growth in [f64::INFINITY, 1e200];
    NORMAL_FIT, "{from:?}, {count} points", "too-few-points" =>
        NormalCalibration::fit(&normal_points(1.0)[..count], from), for from in NormalFrom::ALL, for count in [0, 1];
    NORMAL_FIT, "{from:?}, 9 equal points", "one-displacement" =>
        NormalCalibration::fit(&[normal_points(1.0)[2]; 9], from), for from in NormalFrom::ALL;
    NORMAL, "{from:?}, a hue and a growth of {change:e}" => of_markers(from, change, truth),
        for (from, change, truth) in TOLD;
    NORMAL, "{from:?}, marker {marker}, a hue and a growth of {change:e}", "none" => read(from, marker, change),
        for from in NormalFrom::ALL, for marker in MARKERS, for change in [f64::NAN, f64::NEG_INFINITY];
    NORMAL, "{from:?}, marker {marker}, a hue and a growth of {change:e}", "none" => read(from, marker, change),
        for (from, change) in [(Hue, f64::INFINITY), (Size, -1e300), (Both, f64::INFINITY), (Both, -1e300)],
        for marker in MARKERS;
    LATERAL_FIT, "displacements of {scale:e}: px per length, at each indentation" => lateral(scale),
        for scale in SCALES;
    LATERAL_FIT, "a shift of {bad:e} px", "not-finite" =>
        shifted(|step, [x, y]| if step == 2 { [x, bad] } else { [x, y] }), for bad in BAD;
    LATERAL_FIT, "shifts of 0", "no-slope" => shifted(|_, _| [0.0; 2]);
    TANGENTIAL, "a shift of {shift:e} px at a normal displacement as much: px per length, from 100 to 120" =>
        tangential(shift), for shift in BAD;
    NEW, "without a part", "too-few-points" => Calibration::new(None, None, Some(usize::MAX));
    NEW, "a slope of {slope:e}", "out-of-range" => of_slope(slope), for slope in [0.0, f64::NAN, f64::INFINITY, LEAST];
    "tracking::Calibration::fits", "{calibrated} markers were calibrated, {found} are found", "another-layout" =>
        calibration(Hue, Some(calibrated)).fits(found),
        for (calibrated, found) in [(0, 1), (usize::MAX, 0), (0, usize::MAX), (77, 60)];
}

/// y = 2 x/X Y at x = X, 2X … 5X.
fn on_a_line(draw: Draw, x: f64, y: f64) -> Result<Answer, CalibrationError> {
    let shares = [1, 2, 3, 4, 5].map(|step| 0.2 * f64::from(step));
    let line = draw(&shares.map(|share| [share * x, share * y]))?;
    let truth = (Precise::new(y) / x).to_f64();
    Ok(Answer::near(line.slope, truth)
        .within(1e-12)
        .also([line.r_squared, line.residual_rms])
        .also(
            [line.slope_std, line.intercept, line.residual_std]
                .into_iter()
                .flatten(),
        ))
}

fn nearly_alike(step: f64) -> Result<Answer, CalibrationError> {
    let displacements = [0, 1, 2, 3, 4].map(|at| 1.0 + step * f64::from(at));
    let line = Line::with_intercept(&displacements.map(|x| [x, 3.0 * x]))?;
    let answer = Answer::near(line.slope, 3.0).within(1e-12);
    Ok(answer.conditioned(1.0 / step).or_no_digits())
}

fn normal_points(scale: f64) -> [NormalPoint; 9] {
    [0, 1, 2, 3, 4, 5, 6, 7, 8].map(|step| {
        let share = f64::from(step) / 8.0;
        NormalPoint {
            marker: Some(step as usize % 2),
            normal: share * scale,
            hue_turns: 0.1 * share,
            growth: -libm::log(1.0 - 0.2 * share),
        }
    })
}

const fn change(hue_turns: f64, growth: f64) -> Change {
    Change {
        shift_px: [0.0; 2],
        hue_turns,
        growth,
    }
}

/// Hue and nearness are both proportional to the displacement.
fn normal(from: NormalFrom, scale: f64) -> Result<Answer, CalibrationError> {
    let points = normal_points(scale);
    let fitted = NormalCalibration::fit(&points, from)?;
    let calibration = Calibration::new(Some(fitted), None, None)?;
    let pairs = points.map(|point| {
        let found = calibration.normal(0, &change(point.hue_turns, point.growth));
        (found.unwrap(), point.normal)
    });
    Ok(Answer::all_at_scale(pairs, scale).within(1e-12))
}

/// The hue alone tells the same whatever the growth.
fn mistaken(from: NormalFrom, part: usize, number: f64) -> Result<Answer, CalibrationError> {
    let mut points = normal_points(1.0);
    let without = NormalCalibration::fit(&points, from)?.line.slope;
    let point = &mut points[3];
    *[&mut point.normal, &mut point.hue_turns, &mut point.growth][part] = number;
    let found = NormalCalibration::fit(&points, from)?;
    let answer = match from {
        Hue => Answer::near(found.line.slope, without),
        Size | Both => Answer::finite([found.line.slope]),
    };
    Ok(answer.also(found.weights))
}

fn calibration(from: NormalFrom, markers: Option<usize>) -> Calibration {
    let normal = NormalCalibration::fit(&normal_points(1.0), from).unwrap();
    Calibration::new(Some(normal), None, markers).unwrap()
}

fn read(from: NormalFrom, marker: usize, number: f64) -> Option<f64> {
    calibration(from, None).normal(marker, &change(number, number))
}

/// A displacement is ten times the turns of the hue, five times the nearness, which is 1 or less, or half of both.
fn of_markers(from: NormalFrom, number: f64, truth: f64) -> Answer {
    let found = MARKERS.map(|marker| (read(from, marker, number).unwrap(), truth));
    Answer::all_near(found).within(1e-12)
}

/// 100 px per length, and 10 % more per unit of the normal displacement.
fn lateral_points(scale: f64) -> [LateralPoint; 8] {
    [1, 2, 3, 4, 5, 6, 7, 8].map(|step| {
        let (share, deep) = (f64::from(step) / 8.0, f64::from(step % 3));
        let slope = 100.0 * (1.0 + 0.1 * deep);
        LateralPoint {
            tangential: [0.6 * share * scale, -0.8 * share * scale],
            shift_px: [0.6 * share * slope, -0.8 * share * slope],
            normal: Some(deep * scale),
        }
    })
}

fn lateral(scale: f64) -> Result<Answer, CalibrationError> {
    let fitted = LateralCalibration::fit(&lateral_points(scale))?;
    let slope = |deep| fitted.slope(deep * scale) * scale;
    let pairs = [0.0, 1.0, 2.0].map(|deep| (slope(deep), 100.0 + 10.0 * deep));
    let answer = Answer::all_near(pairs).within(1e-12);
    Ok(answer.also([fitted.residual_rms]))
}

/// A fit to points whose shifts are replaced.
fn shifted(
    by: impl Fn(usize, [f64; 2]) -> [f64; 2],
) -> Result<LateralCalibration, CalibrationError> {
    let mut points = lateral_points(1.0);
    for (step, point) in points.iter_mut().enumerate() {
        point.shift_px = by(step, point.shift_px);
    }
    LateralCalibration::fit(&points)
}

fn tangential(shift: f64) -> Result<Answer, CalibrationError> {
    let lateral = LateralCalibration::fit(&lateral_points(1.0))?;
    let slope = lateral.slope(shift);
    let calibration = Calibration::new(None, Some(lateral), None)?;
    let read = calibration.tangential([shift, 1.0], shift);
    let answer = Answer::near(slope, slope.clamp(100.0, 120.0)).within(1e-12);
    Ok(answer.also(read.into_iter().flatten()))
}

fn of_slope(slope: f64) -> Result<Calibration, CalibrationError> {
    let mut normal = NormalCalibration::fit(&normal_points(1.0), Hue).unwrap();
    normal.line.slope = slope;
    Calibration::new(Some(normal), None, None)
}

//! Calibrations from points that tell little.

use palpate_tracking::{
    Calibration, CalibrationError, Change, LateralCalibration, LateralPoint, Line,
    NormalCalibration, NormalFrom, NormalPoint,
};

use crate::extremes::Precise;
use crate::extremes::answer::NONE;
use crate::extremes::{Answer, Case, Outcome};

/// Draws a line through points.
type Draw = fn(&[[f64; 2]]) -> Result<Line, CalibrationError>;
const LINES: [(&str, Draw); 2] = [
    ("tracking::Line::with_intercept", Line::with_intercept),
    ("tracking::Line::through_rest", Line::through_rest),
];

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (entry, draw) in LINES {
        for (input, points) in [
            ("no point", vec![]),
            ("one point", vec![[1.0, 2.0]]),
            ("two equal points", vec![[1.0, 2.0]; 2]),
            ("1000 equal points", vec![[1.0, 2.0]; 1000]),
            (
                "one displacement, two signals",
                vec![[1.0, 2.0], [1.0, 3.0]],
            ),
            (
                "one signal, two displacements",
                vec![[1.0, 2.0], [3.0, 2.0]],
            ),
            ("signals of 0", vec![[1.0, 0.0], [3.0, -0.0]]),
            ("a displacement of NaN", vec![[1.0, 2.0], [f64::NAN, 3.0]]),
            ("an infinite signal", vec![[1.0, 2.0], [2.0, f64::INFINITY]]),
            ("a signal of 1e101", vec![[1.0, 2.0], [2.0, 1e101]]),
        ] {
            cases.push(Case::refusal(entry, input, move || draw(&points)));
        }
        for (x, y) in [
            (1.0, 1.0),
            (1e-9, 1e9),
            (1e9, 1e-9),
            (1e-100, 1e-100),
            (1e100, 1e100),
            (1e-100, 1e100),
            (1e-150, 1e-150),
        ] {
            cases.push(Case::value(
                entry,
                format!("points on a line, displacements of {x:e} and signals of {y:e}"),
                move || on_a_line(draw, x, y),
            ));
        }
        for (x, y) in [
            (1e-320, 1.0),
            (1.0, 1e-320),
            (f64::from_bits(1), f64::from_bits(1)),
            (1e100, 1e-300),
        ] {
            cases.push(Case::new(
                entry,
                format!("points on a line, displacements of {x:e} and signals of {y:e}"),
                move || on_a_line(draw, x, y).into(),
            ));
        }
    }
    for step in [1e-3, 1e-6, 1e-9, 1e-12, 1e-15] {
        cases.push(Case::new(
            "tracking::Line::with_intercept",
            format!("displacements that differ by {step:e} of themselves: slope"),
            move || nearly_alike(step).into(),
        ));
    }
    for from in NormalFrom::ALL {
        for scale in [1e-90, 1e-9, 1.0, 1e9, 1e90] {
            cases.push(Case::value(
                "tracking::NormalCalibration::fit",
                format!("{from:?}, displacements of {scale:e}: those of the points again"),
                move || normal(from, scale),
            ));
        }
        for number in [f64::NAN, f64::INFINITY, 1e200] {
            for part in 0..3 {
                cases.push(Case::new(
                    "tracking::NormalCalibration::fit",
                    format!("{from:?}, number {part} of a point is {number:e}: as without it where it is not used"),
                    move || {
                        let mut points = normal_points(1.0);
                        let point = &mut points[3];
                        *[&mut point.normal, &mut point.hue_turns, &mut point.growth][part] =
                            number;
                        let found = NormalCalibration::fit(&points, from);
                        found.map(|found| told(from, &found)).into()
                    },
                ));
            }
        }
        for growth in [f64::NAN, f64::INFINITY, -f64::INFINITY, -1e300, 1e300] {
            cases.push(Case::new(
                "tracking::Calibration::normal",
                format!("{from:?}, a hue and a growth of {growth:e}"),
                move || read_normal(from, growth),
            ));
        }
        for count in [0, 1] {
            cases.push(Case::refusal(
                "tracking::NormalCalibration::fit",
                format!("{from:?}, {count} points"),
                move || NormalCalibration::fit(&normal_points(1.0)[..count], from),
            ));
        }
        cases.push(Case::refusal(
            "tracking::NormalCalibration::fit",
            format!("{from:?}, 9 equal points"),
            move || NormalCalibration::fit(&[normal_points(1.0)[2]; 9], from),
        ));
    }
    for scale in [1e-90, 1e-9, 1.0, 1e9, 1e90] {
        cases.push(Case::value(
            "tracking::LateralCalibration::fit",
            format!("displacements of {scale:e}: px per length, at each indentation"),
            move || lateral(scale),
        ));
    }
    for number in [f64::NAN, f64::INFINITY, 1e200] {
        cases.push(Case::refusal(
            "tracking::LateralCalibration::fit",
            format!("a shift of {number:e} px"),
            move || {
                let mut points = lateral_points(1.0);
                points[2].shift_px[1] = number;
                LateralCalibration::fit(&points)
            },
        ));
        cases.push(Case::value(
            "tracking::Calibration::tangential",
            format!("a shift of {number:e} px at a normal displacement as much: px per length, from 100 to 120"),
            move || {
                let lateral = LateralCalibration::fit(&lateral_points(1.0))?;
                let slope = lateral.slope(number);
                let calibration = Calibration::new(None, Some(lateral), None)?;
                let read = calibration.tangential([number, 1.0], number);
                let answer = Answer::near(slope, slope.clamp(100.0, 120.0)).within(1e-12);
                Ok::<_, CalibrationError>(answer.also(read.into_iter().flatten()))
            },
        ));
    }
    cases.push(Case::refusal(
        "tracking::LateralCalibration::fit",
        "shifts of 0",
        || {
            let mut points = lateral_points(1.0);
            points
                .iter_mut()
                .for_each(|point| point.shift_px = [0.0; 2]);
            LateralCalibration::fit(&points)
        },
    ));
    cases.push(Case::refusal(
        "tracking::Calibration::new",
        "without a part",
        || Calibration::new(None, None, Some(usize::MAX)),
    ));
    for slope in [0.0, f64::NAN, f64::INFINITY, f64::from_bits(1)] {
        cases.push(Case::refusal(
            "tracking::Calibration::new",
            format!("a slope of {slope:e}"),
            move || {
                let mut normal = NormalCalibration::fit(&normal_points(1.0), NormalFrom::Hue)?;
                normal.line.slope = slope;
                Calibration::new(Some(normal), None, None)
            },
        ));
    }
    for (calibrated, found) in [(0, 1), (usize::MAX, 0), (0, usize::MAX), (77, 60)] {
        cases.push(Case::refusal(
            "tracking::Calibration::fits",
            format!("{calibrated} markers were calibrated, {found} are found"),
            move || {
                let normal = NormalCalibration::fit(&normal_points(1.0), NormalFrom::Hue)?;
                Calibration::new(Some(normal), None, Some(calibrated))?.fits(found)
            },
        ));
    }
    cases
}

/// y = 2 x/X Y at x = X, 2X … 5X.
fn on_a_line(draw: Draw, x: f64, y: f64) -> Result<Answer, CalibrationError> {
    let share = |step: i32| 0.2 * f64::from(step);
    let points: Vec<_> = (1..=5)
        .map(|step| [share(step) * x, share(step) * y])
        .collect();
    let line = draw(&points)?;
    let truth = (Precise::new(y) / Precise::new(x)).to_f64();
    Ok(Answer::near(line.slope, truth)
        .within(1e-12)
        .also([line.r_squared, line.residual_rms])
        .also(line.slope_std)
        .also(line.intercept)
        .also(line.residual_std))
}

fn nearly_alike(step: f64) -> Result<Answer, CalibrationError> {
    let points: Vec<_> = (0..5)
        .map(|at| 1.0 + step * f64::from(at))
        .map(|x| [x, 3.0 * x])
        .collect();
    let line = Line::with_intercept(&points)?;
    Ok(Answer::near(line.slope, 3.0)
        .within(1e-12)
        .conditioned(1.0 / step)
        .or_no_digits())
}

fn normal_points(scale: f64) -> Vec<NormalPoint> {
    (0..9)
        .map(|step| {
            let share = f64::from(step) / 8.0;
            NormalPoint {
                marker: Some(step as usize % 2),
                normal: share * scale,
                hue_turns: 0.1 * share,
                growth: -libm::log(1.0 - 0.2 * share),
            }
        })
        .collect()
}

/// Hue and nearness are both proportional to the displacement.
fn normal(from: NormalFrom, scale: f64) -> Result<Answer, CalibrationError> {
    let points = normal_points(scale);
    let fitted = NormalCalibration::fit(&points, from)?;
    let calibration = Calibration::new(Some(fitted), None, None)?;
    let pairs = points.iter().map(|point| {
        let change = Change {
            shift_px: [0.0; 2],
            hue_turns: point.hue_turns,
            growth: point.growth,
        };
        (
            calibration.normal(0, &change).unwrap_or(f64::NAN),
            point.normal,
        )
    });
    Ok(Answer::all_at_scale(pairs, scale).within(1e-12))
}

/// The hue alone tells the same whatever the growth.
fn told(from: NormalFrom, found: &NormalCalibration) -> Answer {
    let numbers = [found.line.slope, found.weights[0], found.weights[1]];
    match NormalCalibration::fit(&normal_points(1.0), from) {
        Ok(without) if from == NormalFrom::Hue => {
            Answer::near(found.line.slope, without.line.slope).also(numbers)
        }
        _ => Answer::finite(numbers),
    }
}

/// From its hue alone a displacement is ten times the turns; from its size alone five times the nearness, 1 or less.
fn read_normal(from: NormalFrom, growth: f64) -> Outcome {
    let fitted = NormalCalibration::fit(&normal_points(1.0), from).expect("points on a line");
    let calibration = Calibration::new(Some(fitted), None, None).expect("a part");
    let change = Change {
        shift_px: [0.0; 2],
        hue_turns: growth,
        growth,
    };
    let read = [0, 1, usize::MAX].map(|marker| calibration.normal(marker, &change));
    let truth = match from {
        NormalFrom::Hue => 10.0 * growth,
        NormalFrom::Size => 5.0 * (1.0 - libm::exp(-growth)),
        NormalFrom::Both => {
            return Outcome::of_all(read.map(|read| read.map(|it| [it]).ok_or(NONE)));
        }
    };
    let read: Vec<_> = read
        .into_iter()
        .flatten()
        .map(|read| (read, truth))
        .collect();
    if read.is_empty() {
        return Err::<Answer, _>(NONE).into();
    }
    Answer::all_near(read).within(1e-12).into()
}

/// 100 px per length, and 10 % more per unit of the normal displacement.
fn lateral_points(scale: f64) -> Vec<LateralPoint> {
    (1..9)
        .map(|step| {
            let (share, deep) = (f64::from(step) / 8.0, f64::from(step % 3));
            let slope = 100.0 * (1.0 + 0.1 * deep);
            LateralPoint {
                tangential: [0.6 * share * scale, -0.8 * share * scale],
                shift_px: [0.6 * share * slope, -0.8 * share * slope],
                normal: Some(deep * scale),
            }
        })
        .collect()
}

fn lateral(scale: f64) -> Result<Answer, CalibrationError> {
    let fitted = LateralCalibration::fit(&lateral_points(scale))?;
    let pairs =
        [0.0, 1.0, 2.0].map(|deep| (fitted.slope(deep * scale) * scale, 100.0 + 10.0 * deep));
    Ok(Answer::all_near(pairs)
        .within(1e-12)
        .also([fitted.residual_rms * 1.0]))
}

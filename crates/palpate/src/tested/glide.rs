//! Glides whose patch is a penalised spline.

use palpate_study::config::{
    CriterionName, FingertipConfig, GlideConfig, GlideEstimatorConfig, GlideSensorConfig,
    LengthUnit, NoiseAxis, NormalNoise, ObjectConfig, PositionNoise, Reports,
};

use super::limits::{Likeness, Limits, unless};

// Draws of the random scenes. Lengths are in shares of half the patch's length, of which 1.5 are the mean of what was drawn
// in distances between fingers.
const HALF: f64 = 1.5;
const FINGERS: [usize; 2] = [3, 5];
const CONTACTS: [f64; 2] = [8.0, 14.0];
/// Half the distance between the outermost fingers, in halves of the patch's length.
const ASPECTS: [f64; 2] = [0.8, 1.25];
const RADII: [f64; 2] = [3.0, 20.0];
/// Largest second derivative of a quadric with one of its waves.
const MOST_BENT: f64 = 0.24 + 0.25;
/// Noise of positions and of normals, degrees.
const LEVELS: [(f64, Option<f64>); 9] = [
    (0.005, Some(0.5)),
    (0.02, Some(1.0)),
    (0.05, Some(2.0)),
    (0.1, Some(5.0)),
    (0.005, Some(5.0)),
    (0.1, Some(0.5)),
    (0.005, None),
    (0.02, None),
    (0.1, None),
];
/// Largest factor between a noise and that of a level.
const NEAR: f64 = 2.5;

/// Family of random scenes that a glide is like, else why there is none.
pub(super) fn family(glide: &GlideConfig, unit: LengthUnit) -> Likeness {
    let mut limits = Limits::new(unit);
    let motion = &glide.motion;
    let half = 0.5 * motion.patch_length;
    let length = half / HALF;
    let fingers = motion.finger_positions.len();
    unless(
        FINGERS.contains(&fingers),
        &format!("{fingers} fingers (random scenes: 3 and 5)"),
    )?;
    let ends = motion
        .finger_positions
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |ends, &at| {
            [ends[0].min(at), ends[1].max(at)]
        });
    let spread = 0.5 * (ends[1] - ends[0]);
    limits.length_within(
        "spread of fingers",
        2.0 * spread,
        ASPECTS.map(|aspect| 2.0 * aspect * half),
    );
    limits.within(
        "contacts",
        f64::from(motion.contacts_per_finger),
        CONTACTS,
        " per finger",
    );
    let GlideSensorConfig::Ideal { normals, reports } = glide.sensor else {
        return Err("pads, whose errors the estimator is not told".to_owned());
    };
    let is_tip = matches!(glide.probe, FingertipConfig::Sphere { .. });
    unless(
        !is_tip || reports == Reports::Contact,
        "lowest points of round tips",
    )?;
    let on = of_object(&glide.object, length, &mut limits)?;
    let (distribution, position) = of_position(glide)?;
    let normal = normals.then(|| {
        let std = glide.noise.normal.as_ref();
        std.map_or(0.0, |NormalNoise::Gaussian { std_deg }| *std_deg)
    });
    let is_told = of_estimator(glide, position, normal)?;
    let (of_position, of_normal) = level(position / length, normal)?;
    let near = |number: f64| [number / NEAR, number * NEAR];
    limits.length_within("noise of positions", position, near(of_position * length));
    if let (Some(std), Some(of_normal)) = (normal, of_normal) {
        limits.within("noise of normals", std, near(of_normal), " deg");
    }
    let normals = of_normal.map_or("no normals".to_owned(), |std| format!("normals {std} deg"));
    let told = if is_told { "told" } else { "found" };
    limits.likeness(format!(
        "{fingers} fingers, {distribution} {} %, {normals}, noise {told}; {on}",
        100.0 * of_position
    ))
}

/// The nearest level of noise.
fn level(position: f64, normal: Option<f64>) -> Result<(f64, Option<f64>), String> {
    unless(position > 0.0, "no noise of positions")?;
    unless(normal != Some(0.0), "no noise of normals")?;
    let apart = |one: f64, other: f64| libm::log(one / other).abs();
    let off = |(of_position, of_normal): &(f64, Option<f64>)| {
        let of_normal = match (of_normal, normal) {
            (Some(one), Some(other)) => apart(*one, other),
            (None, None) => 0.0,
            _ => f64::INFINITY,
        };
        of_normal.max(apart(*of_position, position))
    };
    let nearest = LEVELS
        .iter()
        .min_by(|one, other| off(one).total_cmp(&off(other)));
    nearest.copied().ok_or_else(String::new)
}

/// Surfaces that an object is among.
fn of_object(
    object: &ObjectConfig,
    length: f64,
    limits: &mut Limits,
) -> Result<&'static str, String> {
    let bent = match *object {
        ObjectConfig::Sphere { radius } => {
            limits.length_within("radius", radius, RADII.map(|one| one * length));
            return Ok("ball");
        }
        ObjectConfig::Dish { radius } | ObjectConfig::Cylinder { radius, .. } => radius.recip(),
        ObjectConfig::Plane {} => 0.0,
        ObjectConfig::Paraboloid { c } => 2.0 * c.abs(),
        ObjectConfig::Saddle { a } => 2.0 * a.abs(),
        ObjectConfig::Ellipsoid { .. }
        | ObjectConfig::Torus { .. }
        | ObjectConfig::HeightField { .. } => {
            return Err("an object that is neither a ball nor near a quadric".to_owned());
        }
    };
    limits.curvature_within(bent, [0.0, MOST_BENT / length]);
    Ok("quadric and waves")
}

/// Distribution of positions' errors, and their standard deviation.
fn of_position(glide: &GlideConfig) -> Result<(&'static str, f64), String> {
    let of_ifd =
        |fraction: Option<f64>| fraction.map(|one| one * glide.motion.inter_finger_distance);
    let (name, size, axis, per_std) = match &glide.noise.position {
        None => return Err("no noise of positions".to_owned()),
        Some(PositionNoise::Gaussian {
            fraction_of_ifd,
            std,
            axis,
        }) => ("Gaussian", std.or(of_ifd(*fraction_of_ifd)), axis, 1.0),
        Some(PositionNoise::Uniform {
            fraction_of_ifd,
            bound,
            axis,
        }) => (
            "uniform",
            bound.or(of_ifd(*fraction_of_ifd)),
            axis,
            f64::sqrt(3.0),
        ),
    };
    if *axis != NoiseAxis::Xyz {
        return Err("errors of heights alone".to_owned());
    }
    Ok((name, size.unwrap_or(0.0) / per_std))
}

/// Whether the estimator is told the noise.
fn of_estimator(glide: &GlideConfig, position: f64, normal: Option<f64>) -> Result<bool, String> {
    let estimator = glide.estimator.clone();
    let GlideEstimatorConfig::Penalised {
        intervals,
        criterion,
        position_std,
        normal_std_deg,
        ..
    } = estimator.with_length_noise(glide.motion.inter_finger_distance)
    else {
        return Err(format!("the method {}", glide.estimator.name()));
    };
    if intervals.is_some() || criterion != CriterionName::default() {
        return Err("a number of intervals or a criterion that is not the default".to_owned());
    }
    let agrees =
        |told: Option<f64>, is: f64| told.is_none_or(|told| (told - is).abs() <= 1e-9 * is);
    if !(agrees(position_std, position) && agrees(normal_std_deg, normal.unwrap_or(0.0))) {
        return Err("noise that is not as the estimator is told".to_owned());
    }
    let is_told = position_std.is_some();
    if normal.is_some() && normal_std_deg.is_some() != is_told {
        return Err("noise of which the estimator is told a part".to_owned());
    }
    Ok(is_told)
}

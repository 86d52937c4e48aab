//! Families of glides with a penalised spline as estimator.

use palpate_study::config::{
    CriterionName, FingertipConfig, GlideConfig, GlideEstimatorConfig, GlideSensorConfig,
    LengthUnit, NoiseAxis, NormalNoise, ObjectConfig, PositionNoise, Reports,
};

use super::{FamilyMatch, Limits, unless};

// Ranges of the random scenes. Lengths are relative to the distance between fingers; half the patch's length is 1.5 of
// these on average.
const HALF: f64 = 1.5;
const FINGERS: [usize; 2] = [3, 5];
const CONTACTS: [f64; 2] = [8.0, 14.0];
/// Half the distance between the outermost fingers, in halves of the patch's length.
const ASPECTS: [f64; 2] = [0.8, 1.25];
const RADII: [f64; 2] = [3.0, 20.0];
/// Largest second derivative of a quadric with one of its waves.
const MAX_CURVATURE: f64 = 0.24 + 0.25;
/// Noise levels: of positions, relative to the distance between fingers, and of normals, degrees.
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
/// Largest ratio of a noise to that of its level.
const MAX_RATIO: f64 = 2.5;

/// Family of a glide.
pub(super) fn family(glide: &GlideConfig, unit: LengthUnit) -> FamilyMatch {
    let mut limits = Limits::new(unit);
    let motion = &glide.motion;
    let half = 0.5 * motion.patch_length;
    let length = half / HALF;
    let fingers = motion.finger_positions.len();
    let other_fingers = format!("{fingers} fingers (random scenes: 3 and 5)");
    unless(FINGERS.contains(&fingers), &other_fingers)?;
    let positions = || motion.finger_positions.iter().copied();
    let spread =
        positions().fold(f64::NEG_INFINITY, f64::max) - positions().fold(f64::INFINITY, f64::min);
    let spreads = ASPECTS.map(|aspect| 2.0 * aspect * half);
    limits.length_within("spread of fingers", spread, spreads);
    let contacts = f64::from(motion.contacts_per_finger);
    limits.within("contacts", contacts, CONTACTS, " per finger");
    let GlideSensorConfig::Ideal { normals, reports } = glide.sensor else {
        return Err("pads, whose errors the estimator is not told".to_owned());
    };
    let is_tip = matches!(glide.probe, FingertipConfig::Sphere { .. });
    let has_contacts = !is_tip || reports == Reports::Contact;
    unless(has_contacts, "lowest points of round tips")?;
    let on = of_object(&glide.object, length, &mut limits)?;
    let (distribution, position) = of_position(glide)?;
    let normal = normals.then(|| {
        let std = glide.noise.normal.as_ref();
        std.map_or(0.0, |NormalNoise::Gaussian { std_deg }| *std_deg)
    });
    let is_stated = of_estimator(glide, position, normal)?;
    let (of_position, of_normal) = level(position / length, normal)?;
    let near = |number: f64| [number / MAX_RATIO, number * MAX_RATIO];
    limits.length_within("noise of positions", position, near(of_position * length));
    if let (Some(std), Some(of_normal)) = (normal, of_normal) {
        limits.within("noise of normals", std, near(of_normal), " deg");
    }
    let normals = of_normal.map_or("no normals".to_owned(), |std| format!("normals {std} deg"));
    let noise = if is_stated { "told" } else { "found" };
    limits.family(format!(
        "{fingers} fingers, {distribution} {} %, {normals}, noise {noise}; {on}",
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

/// Name of the object's surfaces.
fn of_object(
    object: &ObjectConfig,
    length: f64,
    limits: &mut Limits,
) -> Result<&'static str, String> {
    let curvature = match *object {
        ObjectConfig::Sphere { radius } => {
            limits.length_within("radius", radius, RADII.map(|one| one * length));
            return Ok("ball");
        }
        ObjectConfig::Dish { radius } | ObjectConfig::Cylinder { radius, .. } => radius.recip(),
        ObjectConfig::Plane {} => 0.0,
        ObjectConfig::Paraboloid { c } => 2.0 * c.abs(),
        ObjectConfig::Saddle { a } => 2.0 * a.abs(),
        _ => return Err("an object that is neither a ball nor near a quadric".to_owned()),
    };
    limits.curvature_within(curvature, [0.0, MAX_CURVATURE / length]);
    Ok("quadric and waves")
}

/// Distribution of the position errors, and their standard deviation.
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

/// Whether the noise is stated to the estimator.
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
        |stated: Option<f64>, is: f64| stated.is_none_or(|one| (one - is).abs() <= 1e-9 * is);
    if !(agrees(position_std, position) && agrees(normal_std_deg, normal.unwrap_or(0.0))) {
        return Err("noise that is not as the estimator is told".to_owned());
    }
    let is_stated = position_std.is_some();
    if normal.is_some() && normal_std_deg.is_some() != is_stated {
        return Err("noise of which the estimator is told a part".to_owned());
    }
    Ok(is_stated)
}

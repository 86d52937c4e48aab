//! Builds a [`GlideScene`] from its config, and compares the models that can compute the contacts.

use nalgebra::Vector3;
use palpate_ep2::{Contact, RoundTip};
use palpate_geometry::{Shape, ShapeThresholds, Surface};
use palpate_rolling::{Fingertip, GlideError, Glider, InvalidTouch, Model, Touch, TouchModel};
use palpate_sensing::{
    BeyondPads, Channel, Distribution, NormalError, PadOffset, Pads, PositionAxes, PositionError,
    Stream,
};
use palpate_statistics::{BadSetting, Number};

use super::fingertip_sensor::{GlideSensor, SensorKind};
use super::glide_trial::{ContactNoise, FingerTouch, GlideScene, TrueGrid, TruePlace};
use crate::config_conversion::{pad_layout, range_error, sensor_error, shape};
use crate::ladder::{Accuracy, Ladder, Rung};
use crate::principal_curvatures::{PointCurvature, align_axes};
use crate::scene::{Need, joined};
use palpate_estimators::GlideMethod;
use palpate_study::config::{
    FingertipConfig, GlideConfig, GlideModelConfig, GlideMotionConfig, GlideNoiseConfig,
    GlideSensorConfig, ModelConfig, NoiseAxis, NormalNoise, ObjectConfig, PositionNoise,
};
use palpate_study::{FieldError, Warning};

/// Tolerances of Newton's method for the position of a contact, relative to the tip's radius. `palpate check` prints
/// the errors of the contacts for these tolerances.
const TOLERANCES: [f64; 4] = [1e-3, 1e-6, 1e-9, 1e-12];

impl GlideScene {
    /// Builds the scene of a config. `seed` is the seed of its random numbers.
    ///
    /// # Errors
    /// [`FieldError`] with the path of the invalid field.
    pub(crate) fn new(config: &GlideConfig, seed: u64) -> Result<Self, FieldError> {
        let glider = Self::glider(config)?;
        let (_, radius) = tip(config);
        let middle = middle(config, glider.object())?;
        let touches = touches(&glider, middle, &config.motion)?;
        let sensor = sensor(&config.sensor, radius)?;
        let noiseless_readings = noiseless_readings(&sensor, &touches, radius)?;
        let tip = sensor.tip(radius);
        let noise = noise(&config.noise, config.motion.inter_finger_distance)?;
        let method = GlideMethod::of(&config.estimator, Some(config.motion.inter_finger_distance));
        let grid = grid(config, glider.object(), middle)?;
        let models = [Some(need(&glider)), noise.need(), Some(sensor.need())].into_iter();
        let models = models
            .chain([tip.map(|tip| tip_text(&tip, sensor.normals))])
            .chain([Some(method.description())]);
        let warnings = [finger_spacing(&config.motion), beyond(config)].into_iter();
        let warnings = warnings.flatten().map(Need::Warning);
        let needs = models.flatten().map(Need::Model).chain(warnings).collect();
        Ok(Self {
            seed,
            config: config.clone(),
            touches,
            noiseless_readings,
            noise,
            tip,
            method,
            grid,
            needs,
        })
    }

    /// Builds the glider that computes the contacts in the scene of a config.
    ///
    /// # Errors
    /// [`FieldError`] with the path of the invalid field.
    pub fn glider(config: &GlideConfig) -> Result<Glider, FieldError> {
        let model = match config.model {
            GlideModelConfig::Auto { tolerance } => TouchModel::Auto { tolerance },
            GlideModelConfig::ClosedForm {} => TouchModel::ClosedForm,
            GlideModelConfig::Newton { tolerance } => TouchModel::Newton { tolerance },
        };
        let glider = Glider::new(shape(&config.object)?, tip(config).0).map_err(tip_error)?;
        glider.on(model).map_err(|error| match error {
            InvalidTouch::Tip(error) => tip_error(error),
            InvalidTouch::Unsupported { .. } => FieldError::at("scene.model.kind", error),
            InvalidTouch::Tolerance(_) => FieldError::at("scene.model.tolerance", error),
        })
    }

    /// Computes the contacts of all fingers, finger by finger.
    ///
    /// # Errors
    /// [`FieldError`] if the contact of a finger cannot be computed.
    pub fn follow(glider: &Glider, config: &GlideConfig) -> Result<Vec<Touch>, FieldError> {
        let middle = middle(config, glider.object())?;
        let touches = touches(glider, middle, &config.motion)?;
        Ok(touches.into_iter().map(|one| one.touch).collect())
    }

    pub(super) fn measured_ladder(&self) -> Result<Ladder, FieldError> {
        let config = &self.config;
        let glider = Self::glider(config)?;
        let middle = middle(config, glider.object())?;
        let (_, radius) = tip(config);
        let on = |model: TouchModel| -> Result<Vec<FingerTouch>, String> {
            let glider = glider.on(model).map_err(|error| match error {
                InvalidTouch::Unsupported { reason, .. } => reason,
                error => error.to_string(),
            })?;
            touches(&glider, middle, &config.motion).map_err(|error| error.message)
        };
        let closed = on(TouchModel::ClosedForm);
        let finest = on(TouchModel::Newton {
            tolerance: Model::SMALLEST_TOLERANCE,
        });
        // The error of the closed form is its difference from Newton's method with the smallest tolerance. If Newton's
        // method fails, the error of the closed form counts as 0.
        let best = closed.as_ref().or(finest.as_ref());
        let closed_error = match (&closed, &finest) {
            (Ok(closed), Ok(finest)) => Ok(distance(closed, finest) / radius),
            (Ok(_), Err(_)) => Ok(0.0),
            (Err(why), _) => Err(why.clone()),
        };
        let rung = |model: TouchModel, error: Result<f64, String>| Rung {
            name: named(model).0,
            model: ModelConfig::Glide(named(model).1),
            accuracy: Accuracy::from(error),
        };
        let choice = glider.choice();
        let mut tolerances = TOLERANCES.to_vec();
        if let TouchModel::Newton { tolerance } = choice.model {
            tolerances.push(tolerance);
        }
        tolerances.sort_by(|one, other| other.total_cmp(one));
        tolerances.dedup();
        let mut rungs = vec![rung(TouchModel::ClosedForm, closed_error)];
        rungs.extend(tolerances.into_iter().map(|tolerance| {
            let model = TouchModel::Newton { tolerance };
            let error = on(model).and_then(|touches| {
                let best = best.map_err(Clone::clone)?;
                Ok(distance(&touches, best) / radius)
            });
            rung(model, error)
        }));
        let (reason, tolerance) = match config.model {
            GlideModelConfig::Auto { tolerance } => (choice.reason, Some(tolerance)),
            _ => ("named in the config".to_owned(), None),
        };
        let taken = ModelConfig::Glide(named(choice.model).1);
        Ok(Ladder::new(rungs, &taken, reason, tolerance))
    }
}

fn tip(config: &GlideConfig) -> (Fingertip, f64) {
    match config.probe {
        FingertipConfig::Point {} => (Fingertip::Point, 0.0),
        FingertipConfig::Sphere { radius } => (Fingertip::Sphere { radius }, radius),
    }
}

fn need(glider: &Glider) -> String {
    let choice = glider.choice();
    let bound = match (choice.model, choice.error_bound) {
        (TouchModel::Newton { .. }, Some(bound)) => {
            format!(", error at most {bound:.0e} of the tip's radius")
        }
        _ => String::new(),
    };
    format!("contacts by {} ({}{bound})", choice.rung, choice.reason)
}

fn tip_text(tip: &RoundTip, with_normals: bool) -> String {
    let normals = match with_normals {
        true => "the sensed normals",
        false => "the normals of a surface fitted to the tips' centres",
    };
    format!(
        "contacts at a distance of {} from the tips' centres, along {normals}",
        Number(tip.radius)
    )
}

fn tip_error(error: BadSetting) -> FieldError {
    range_error("scene.probe.radius", error.expected, error.value)
}

fn middle(config: &GlideConfig, object: &Shape) -> Result<(f64, f64), FieldError> {
    let middle = config
        .object_contact
        .map_or(object.default_contact(), |[x, y]| (x, y));
    let path = match config.object {
        ObjectConfig::HeightField { .. } if config.object_contact.is_none() => {
            "scene.object.formula"
        }
        _ => "scene.object_contact",
    };
    object
        .contact_at(middle.0, middle.1)
        .map_err(|error| FieldError::at(path, format!("the middle of the patch: {error}")))?;
    Ok(middle)
}

fn touches(
    glider: &Glider,
    (middle_x, middle_y): (f64, f64),
    motion: &GlideMotionConfig,
) -> Result<Vec<FingerTouch>, FieldError> {
    let mut touches = Vec::new();
    for (finger, position) in motion.finger_positions.iter().enumerate() {
        for contact in 0..motion.contacts_per_finger {
            let along = share(contact, motion.contacts_per_finger) * 0.5 * motion.patch_length;
            let touch = glider
                .touch(middle_x + along, middle_y + position)
                .map_err(|error| {
                    let path = match error {
                        GlideError::TwoContacts { .. } => "scene.probe.radius",
                        _ => "scene.motion",
                    };
                    let place = format!("finger {finger}, contact {contact} (counting from 0)");
                    FieldError::at(path, format!("{place}: {error}"))
                })?;
            touches.push(FingerTouch { finger, touch });
        }
    }
    Ok(touches)
}

fn share(index: u32, count: u32) -> f64 {
    if count == 1 {
        0.0
    } else {
        2.0 * f64::from(index) / f64::from(count - 1) - 1.0
    }
}

fn sensor(config: &GlideSensorConfig, radius: f64) -> Result<GlideSensor, FieldError> {
    Ok(match config {
        GlideSensorConfig::Ideal { normals, reports } => GlideSensor {
            kind: SensorKind::Ideal(*reports),
            normals: *normals,
        },
        GlideSensorConfig::Pads {
            pitch,
            layout,
            cap_deg,
            normals,
        } => {
            let pads = Pads::new(
                radius,
                *pitch,
                pad_layout(*layout),
                PadOffset::Centred,
                cap_deg.to_radians(),
            )
            .map_err(|error| sensor_error("scene.sensor", error))?;
            // Centred pads need no random numbers, so any stream is suitable.
            let placement = pads.place(&mut Stream::new(0, 0, Channel::PadOffset));
            GlideSensor {
                kind: SensorKind::Pads { pads, placement },
                normals: *normals,
            }
        }
    })
}

fn noiseless_readings(
    sensor: &GlideSensor,
    touches: &[FingerTouch],
    radius: f64,
) -> Result<Vec<Contact>, FieldError> {
    let beyond_pads = |error: BeyondPads| FieldError::at("scene.sensor.cap_deg", error);
    touches
        .iter()
        .map(|FingerTouch { finger, touch }| {
            let (position, normal) = sensor.read(touch, radius).map_err(beyond_pads)?;
            Ok(Contact::new(*finger, position, normal))
        })
        .collect()
}

fn noise(
    config: &GlideNoiseConfig,
    inter_finger_distance: f64,
) -> Result<ContactNoise, FieldError> {
    let position = config.position.as_ref().map(|position| {
        let (distribution, fraction, size, key, axis) = match *position {
            PositionNoise::Gaussian {
                fraction_of_ifd,
                std,
                axis,
            } => (Distribution::Gaussian, fraction_of_ifd, std, "std", axis),
            PositionNoise::Uniform {
                fraction_of_ifd,
                bound,
                axis,
            } => (Distribution::Uniform, fraction_of_ifd, bound, "bound", axis),
        };
        let (size, key) = match fraction {
            Some(fraction) => (fraction * inter_finger_distance, "fraction_of_ifd"),
            None => (size.unwrap_or_default(), key),
        };
        let axes = match axis {
            NoiseAxis::Xyz => PositionAxes::Xyz,
            NoiseAxis::Z => PositionAxes::Z,
        };
        PositionError::new(distribution, size, axes)
            .map_err(|error| FieldError::at(format!("scene.noise.position.{key}"), error))
    });
    let normal = config.normal.as_ref().map(|normal| {
        let NormalNoise::Gaussian { std_deg, bias_deg } = *normal;
        let bias = bias_deg.unwrap_or(0.0).to_radians();
        NormalError::new(std_deg.to_radians(), bias).map_err(|error| {
            let key = error.setting.replace("_rad", "_deg");
            FieldError::at(format!("scene.noise.normal.{key}"), error)
        })
    });
    Ok(ContactNoise {
        position: position.transpose()?.filter(PositionError::is_random),
        normal: normal.transpose()?,
    })
}

impl ContactNoise {
    fn need(&self) -> Option<String> {
        let position = self.position.map(|error| {
            let distribution = match error.distribution {
                Distribution::Gaussian => "Gaussian",
                Distribution::Uniform => "uniform",
            };
            let axes = match error.axes {
                PositionAxes::Xyz => "x, y and z",
                PositionAxes::Z => "z",
            };
            format!("{distribution} errors of {axes}")
        });
        let normal = self.normal.filter(NormalError::is_random);
        let normal = normal.map(|_| "Gaussian tilts of the normals".to_owned());
        let errors = joined([position, normal], " and ");
        errors.map(|errors| format!("noise: {errors}, drawn per contact"))
    }
}

fn grid(
    glide: &GlideConfig,
    object: &Shape,
    (middle_x, middle_y): (f64, f64),
) -> Result<TrueGrid, FieldError> {
    let config = &glide.evaluate;
    let thresholds = ShapeThresholds::new(config.gaussian_threshold, config.mean_threshold)
        .map_err(|error| FieldError::at("scene.evaluate.gaussian_threshold", error))?;
    let at = |index| share(index, config.grid) * config.half_width;
    let truth = Glider::new(object.clone(), Fingertip::Point).map_err(tip_error)?;
    let grid_error = |error: GlideError| {
        FieldError::at("scene.evaluate.half_width", format!("the grid: {error}"))
    };
    // If the object's curvature is the same everywhere, use its exact value. For example, the Gaussian curvature of a
    // cylinder is then exactly 0, without rounding errors.
    let everywhere = object.constant_curvature();
    let place = |x: f64, y: f64| -> Result<TruePlace, FieldError> {
        let touch = truth
            .touch(middle_x + x, middle_y + y)
            .map_err(grid_error)?;
        let curvature = everywhere.unwrap_or(touch.curvature);
        let (gaussian, mean) = (curvature.gaussian_curvature(), curvature.mean_curvature());
        let principal = || {
            let x = Vector3::x();
            let along = (x - touch.normal * touch.normal.dot(&x)).normalize();
            let (normal, form) = object.curvature_along(&touch.point, &along).ok()?;
            let of_form = PointCurvature::of(&form, None, None);
            let mut principal = PointCurvature::of(&curvature, None, None);
            // The second axis of the curvature form is −y, but angles are measured from x towards y. So the angle has
            // the opposite sign.
            principal.values[3] = -of_form.values[3];
            Some((principal, [along, normal.cross(&along)]))
        };
        Ok(TruePlace {
            point: touch.point,
            gaussian,
            mean,
            class: thresholds.classify(gaussian, mean),
            principal: glide.principal_curvatures.then(principal).flatten(),
        })
    };
    let mut places: Vec<TruePlace> = (0..config.grid)
        .flat_map(|row| (0..config.grid).map(move |column| (row, column)))
        .map(|(row, column)| place(at(row), at(column)))
        .collect::<Result<_, _>>()?;
    let principal = places.iter_mut().filter_map(|one| one.principal.as_mut());
    align_axes(principal.map(|(principal, _)| principal));
    Ok(TrueGrid {
        side: config.grid as usize,
        places,
        thresholds,
    })
}

/// A relative difference up to this number, between the stated and the true distance between fingers, counts as a
/// rounding error of the config.
const SPACING_TOLERANCE: f64 = 1e-6;

fn finger_spacing(motion: &GlideMotionConfig) -> Option<Warning> {
    let stated = motion.inter_finger_distance;
    let mut positions = motion.finger_positions.clone();
    positions.sort_by(f64::total_cmp);
    let gaps = positions.windows(2).map(|pair| pair[1] - pair[0]);
    let is_other = |gap: &f64| (gap - stated).abs() > SPACING_TOLERANCE * stated;
    let spacing = gaps.filter(|gap| gap.is_finite()).find(is_other)?;
    let [shown, found] = [stated, spacing].map(Number::rounded);
    let text = format!(
        "`inter_finger_distance` is {shown}, but fingers are {found} apart; it scales `fraction_of_ifd` and the smoothing of two-pass"
    );
    let numbers = [("inter_finger_distance", stated), ("spacing", spacing)];
    Some(Warning::new("stated-scale", text, numbers))
}

/// Returns a warning if the grid of points at which the curvature is estimated is larger than the area of the contacts.
fn beyond(config: &GlideConfig) -> Option<Warning> {
    let motion = &config.motion;
    let positions = || motion.finger_positions.iter().copied();
    let lowest = positions().fold(f64::INFINITY, f64::min);
    let highest = positions().fold(f64::NEG_INFINITY, f64::max);
    let reach = (0.5 * motion.patch_length).min(-lowest).min(highest);
    let half_width = config.evaluate.half_width;
    (half_width > reach * (1.0 + 1e-9)).then(|| {
        Warning::new(
            "grid-beyond-contacts",
            "the grid extends beyond the contacts, so the fit is extrapolated there",
            [("half_width", half_width), ("reach", reach)],
        )
    })
}

fn distance(touches: &[FingerTouch], others: &[FingerTouch]) -> f64 {
    let pairs = touches.iter().zip(others);
    pairs
        .map(|(one, other)| (one.touch.point - other.touch.point).norm())
        .fold(0.0, f64::max)
}

fn named(model: TouchModel) -> (String, GlideModelConfig) {
    match model {
        TouchModel::Auto { tolerance } => (
            format!("auto, tolerance {tolerance:e}"),
            GlideModelConfig::Auto { tolerance },
        ),
        TouchModel::ClosedForm => ("closed form".to_owned(), GlideModelConfig::ClosedForm {}),
        TouchModel::Newton { tolerance } => (
            format!("Newton's method, tolerance {tolerance:e}"),
            GlideModelConfig::Newton { tolerance },
        ),
    }
}

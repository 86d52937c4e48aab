//! Builds a [`GlideScene`] from its config.

use palpate_ep2::{Contact, RoundTip};
use palpate_geometry::{InvalidShape, Shape, ShapeThresholds, Surface};
use palpate_rolling::{Fingertip, GlideError, Glider, InvalidTouch, TouchModel};
use palpate_sensing::{
    BeyondPads, Channel, Distribution, NormalError, PadOffset, Pads, PositionAxes, PositionError,
    Stream,
};
use palpate_statistics::Number;

use super::scene::{ContactNoise, FingerTouch, GlideScene, TrueGrid, TruePlace};
use super::sensor::{GlideSensor, SensorKind};
use palpate_estimators::GlideFit;

use crate::need::Need;
use crate::plan::{pad_layout, sensor_error, shape};
use palpate_study::FieldError;
use palpate_study::Warning;
use palpate_study::config::{
    EvaluateConfig, FingertipConfig, GlideConfig, GlideModelConfig, GlideMotionConfig,
    GlideNoiseConfig, GlideSensorConfig, NoiseAxis, NormalNoise, ObjectConfig, PositionNoise,
};

impl GlideScene {
    /// Builds the scene of a config; `seed` seeds its random numbers.
    ///
    /// # Errors
    /// [`FieldError`] with the path of the field that makes no scene.
    pub fn new(config: &GlideConfig, seed: u64) -> Result<Self, FieldError> {
        let glider = glider(config)?;
        let (_, radius) = tip(config);
        let middle = middle(config, glider.object())?;
        let touches = touches(&glider, middle, &config.motion)?;
        let sensor = sensor(&config.sensor, radius)?;
        let sensed = sensed(&sensor, &touches, radius)?;
        let tip = sensor.tip(radius);
        let noise = noise(&config.noise, config.motion.inter_finger_distance)?;
        let method = GlideFit::of(&config.estimator, Some(config.motion.inter_finger_distance));
        let grid = grid(&config.evaluate, glider.object(), middle)?;
        let models = [Some(need(&glider)), noise.need(), Some(sensor.need())].into_iter();
        let models = models
            .chain([tip.map(|tip| of_tips(&tip, sensor.normals))])
            .chain([Some(method.description())]);
        let warning = beyond(config).map(Need::from);
        let needs = models.flatten().map(Need::from).chain(warning).collect();
        Ok(Self {
            seed,
            config: config.clone(),
            touches,
            sensed,
            noise,
            tip,
            method,
            grid,
            needs,
        })
    }
}

/// The fingertip and its radius (0 for a point).
pub(super) fn tip(config: &GlideConfig) -> (Fingertip, f64) {
    match config.probe {
        FingertipConfig::Point {} => (Fingertip::Point, 0.0),
        FingertipConfig::Sphere { radius } => (Fingertip::Sphere { radius }, radius),
    }
}

/// Builds the glider that finds the contacts of a config's scene.
pub(super) fn glider(config: &GlideConfig) -> Result<Glider, FieldError> {
    let model = match config.model {
        GlideModelConfig::Auto { tolerance } => TouchModel::Auto { tolerance },
        GlideModelConfig::ClosedForm {} => TouchModel::ClosedForm,
        GlideModelConfig::Newton { tolerance } => TouchModel::Newton { tolerance },
    };
    let glider = Glider::new(shape(&config.object)?, tip(config).0).map_err(of_tip)?;
    glider.on(model).map_err(|error| match error {
        InvalidTouch::Tip(error) => of_tip(error),
        InvalidTouch::Unsupported { .. } => FieldError::at("scene.model.kind", error),
        InvalidTouch::Tolerance { .. } => FieldError::at("scene.model.tolerance", error),
    })
}

/// Line for `palpate check`: how the contacts are computed.
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

/// Line for `palpate check`: how contacts are computed from the tips' centres.
fn of_tips(tip: &RoundTip, with_normals: bool) -> String {
    let normals = match with_normals {
        true => "the sensed normals",
        false => "the normals of a first fit to the tips' centres",
    };
    format!(
        "contacts at a distance of {} from the tips' centres, along {normals}",
        Number(tip.radius)
    )
}

fn of_tip(error: InvalidShape) -> FieldError {
    let message = format!("must be {}, is {}", error.expected, Number(error.value));
    FieldError::at("scene.probe.radius", message)
}

pub(super) fn middle(config: &GlideConfig, object: &Shape) -> Result<(f64, f64), FieldError> {
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

pub(super) fn touches(
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

/// Position of item `index` of `count` equally spaced items from −1 to 1; 0 if there is only one.
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
            // The placement of centred pads draws no random numbers.
            let placement = pads.place(&mut Stream::new(0, 0, Channel::PadOffset));
            GlideSensor {
                kind: SensorKind::Pads { pads, placement },
                normals: *normals,
            }
        }
    })
}

fn sensed(
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
        let (distribution, fraction, (key, length), axis) = match *position {
            PositionNoise::Gaussian {
                fraction_of_ifd,
                std,
                axis,
            } => (Distribution::Gaussian, fraction_of_ifd, ("std", std), axis),
            PositionNoise::Uniform {
                fraction_of_ifd,
                bound,
                axis,
            } => (
                Distribution::Uniform,
                fraction_of_ifd,
                ("bound", bound),
                axis,
            ),
        };
        let of_fingers = fraction.map(|fraction| fraction * inter_finger_distance);
        let size = of_fingers.or(length).unwrap_or_default();
        let key = fraction.map_or(key, |_| "fraction_of_ifd");
        let axes = match axis {
            NoiseAxis::Xyz => PositionAxes::Xyz,
            NoiseAxis::Z => PositionAxes::Z,
        };
        PositionError::new(distribution, size, axes)
            .map_err(|error| FieldError::at(format!("scene.noise.position.{key}"), error))
    });
    let normal = config.normal.as_ref().map(|normal| {
        let NormalNoise::Gaussian { std_deg } = *normal;
        NormalError::new(std_deg.to_radians())
    });
    Ok(ContactNoise {
        position: position.transpose()?.filter(PositionError::is_random),
        normal: normal
            .transpose()
            .map_err(|error| FieldError::at("scene.noise.normal.std_deg", error))?
            .filter(NormalError::is_random),
    })
}

impl ContactNoise {
    fn need(&self) -> Option<String> {
        let position = self.position.map(|error| {
            let distribution = match error.distribution() {
                Distribution::Gaussian => "Gaussian",
                Distribution::Uniform => "uniform",
            };
            let axes = match error.axes() {
                PositionAxes::Xyz => "x, y and z",
                PositionAxes::Z => "z",
            };
            format!("{distribution} errors of {axes}")
        });
        let normal = self
            .normal
            .map(|_| "Gaussian tilts of the normals".to_owned());
        let errors: Vec<String> = position.into_iter().chain(normal).collect();
        (!errors.is_empty()).then(|| format!("noise: {}, drawn per contact", errors.join(" and ")))
    }
}

fn grid(
    config: &EvaluateConfig,
    object: &Shape,
    (middle_x, middle_y): (f64, f64),
) -> Result<TrueGrid, FieldError> {
    let thresholds = ShapeThresholds::new(config.gaussian_threshold, config.mean_threshold)
        .map_err(|error| FieldError::at("scene.evaluate.gaussian_threshold", error))?;
    let at = |index| share(index, config.grid) * config.half_width;
    let truth = Glider::new(object.clone(), Fingertip::Point).map_err(of_tip)?;
    let of_grid = |error: GlideError| {
        FieldError::at("scene.evaluate.half_width", format!("the grid: {error}"))
    };
    // A constant curvature has no rounding errors: K of a cylinder is exactly 0.
    let everywhere = object.constant_curvature();
    let place = |x: f64, y: f64| -> Result<TruePlace, FieldError> {
        let touch = truth.touch(middle_x + x, middle_y + y).map_err(of_grid)?;
        let curvature = everywhere.unwrap_or(touch.curvature);
        let (gaussian, mean) = (curvature.gaussian_curvature(), curvature.mean_curvature());
        Ok(TruePlace {
            point: touch.point,
            gaussian,
            mean,
            class: thresholds.classify(gaussian, mean),
        })
    };
    let places = (0..config.grid)
        .flat_map(|row| (0..config.grid).map(move |column| (row, column)))
        .map(|(row, column)| place(at(row), at(column)))
        .collect::<Result<_, _>>()?;
    Ok(TrueGrid {
        side: config.grid as usize,
        places,
        thresholds,
    })
}

/// Warns if the grid extends beyond the contacts.
fn beyond(config: &GlideConfig) -> Option<Warning> {
    let motion = &config.motion;
    let lowest = motion
        .finger_positions
        .iter()
        .copied()
        .fold(f64::INFINITY, f64::min);
    let highest = motion
        .finger_positions
        .iter()
        .copied()
        .fold(f64::NEG_INFINITY, f64::max);
    let reach = (0.5 * motion.patch_length).min(-lowest).min(highest);
    let half_width = config.evaluate.half_width;
    (half_width > reach * (1.0 + 1e-9)).then(|| {
        Warning::new(
            "grid-beyond-contacts",
            "the grid extends beyond the contacts, where the fit is extrapolated",
            [("half_width", half_width), ("reach", reach)],
        )
    })
}

//! The curvature of a patch from recorded glides.

use std::borrow::Cow;

use nalgebra::{Point3, Vector3};
use palpate_ep2::{
    Contact, Curvature, Ep2Error, Fit, MapPoint, Method, MisfitTest, Patch, Regions, RoundTip,
    Status, Uncertainty, regions,
};
use palpate_geometry::{ShapeClass, ShapeThresholds};
use palpate_statistics::{Misfit, StatedQuantity};

use super::error::{RecordedError, explained};
use super::glide_options::GlideOptions;
use super::glide_recording::GlideRecording;
use super::glide_report::{GlideEstimate, GlideMap, PatchNoise, PatchRegion, Thresholds, tidy};
use super::glide_warnings::{directions, distant, misfit_warnings, normals, spacing, stated_noise};
use super::press_report::Radius;
use super::reading_table::ExtraColumns;
use super::value::{FORMAT_VERSION, Value};
use palpate_estimators::GlideFit;
use palpate_study::config::{LengthUnit, SettingError};
use palpate_study::{Unit, Warning};

/// Estimates the curvature of a patch from recorded contacts.
///
/// # Errors
/// [`RecordedError::Line`] if one contact is at fault; otherwise [`RecordedError::Readings`] if the options contradict the
/// file, or if the contacts do not determine the patch.
pub fn estimate_glide(
    recorded: &GlideRecording,
    options: &GlideOptions,
) -> Result<(GlideEstimate, GlideMap), RecordedError> {
    GlideFitResult::new(Cow::Borrowed(recorded), options)?.estimate()
}

/// Surface fitted to recorded contacts. Its methods compute curvatures, map and estimate only when called.
#[derive(Clone, Debug)]
pub struct GlideFitResult<'r> {
    recorded: Cow<'r, GlideRecording>,
    given: GlideOptions,
    /// `given`, with position noise converted to a length.
    options: GlideOptions,
    unit: LengthUnit,
    /// Contacts computed from the stated points of round tips.
    of_tips: Option<Vec<Contact>>,
    patch: Patch,
    fit: Fit,
    centre: MapPoint,
    limits: ShapeThresholds,
    limits_from: &'static str,
}

impl<'r> GlideFitResult<'r> {
    /// Fits the surface to these contacts.
    ///
    /// # Errors
    /// Errors of [`estimate_glide`], except those for maps that exceed the range of doubles.
    pub fn new(
        recorded: Cow<'r, GlideRecording>,
        given: &GlideOptions,
    ) -> Result<Self, RecordedError> {
        let unit = recorded.source.unit(recorded.unit, given.length_unit)?;
        let refused = |error| refused(&recorded, &error);
        let options = with_length_noise(&recorded, given)?;
        let method = GlideFit::of(&options.estimator, options.inter_finger_distance);
        let outward = Vector3::from(options.outward);
        let contacts = |tip: RoundTip| tip.contacts(&recorded.contacts, &outward, &method);
        let of_tips = options.tip().map(contacts).transpose().map_err(refused)?;
        let contacts = of_tips.as_deref().unwrap_or(&recorded.contacts);
        let patch = Patch::new(contacts, &outward).map_err(refused)?;
        let fit = method.fit(&patch).map_err(refused)?;
        let centre = fit.centre().map_err(refused)?;
        let stated = options.thresholds();
        let stated = stated.map_err(|error| recorded.source.fail(error.to_string()))?;
        let (limits, limits_from) = match stated {
            Some(thresholds) => (thresholds, "given"),
            None => (
                of_size(&fit).ok_or(Ep2Error::OutOfRange).map_err(refused)?,
                "the patch's size: those of the 1996 paper on its patch of 3 x 3, scaled",
            ),
        };
        Ok(Self {
            given: given.clone(),
            recorded,
            options,
            unit,
            of_tips,
            patch,
            fit,
            centre,
            limits,
            limits_from,
        })
    }

    fn contacts(&self) -> &[Contact] {
        self.of_tips.as_deref().unwrap_or(&self.recorded.contacts)
    }

    fn refused(&self, error: &Ep2Error) -> RecordedError {
        refused(&self.recorded, error)
    }

    /// The surface at the contacts.
    fn at_contacts(&self) -> Result<Vec<MapPoint>, RecordedError> {
        let contacts = self.contacts().iter();
        let places: Vec<Point3<f64>> = contacts.map(|contact| contact.position).collect();
        let points = self.fit.points_at(&places);
        points.map_err(|error| self.refused(&error))
    }

    /// Curvature at every place of the map, in the order of [`GlideMap::points`].
    ///
    /// # Errors
    /// [`RecordedError::Readings`] if a curvature exceeds the range of doubles.
    pub fn curvatures(&self) -> Result<Vec<Curvature>, RecordedError> {
        if self.options.map_at_contacts {
            let points = self.at_contacts()?;
            return Ok(points.iter().map(|point| point.curvature).collect());
        }
        let curvatures = self.fit.curvatures(self.options.grid);
        curvatures.map_err(|error| self.refused(&error))
    }

    /// Limits below which curvatures count as zero.
    pub fn thresholds(&self) -> &ShapeThresholds {
        &self.limits
    }

    /// The estimate, and its map.
    ///
    /// # Errors
    /// [`RecordedError::Readings`] if a point of the map exceeds the range of doubles.
    pub fn estimate(&self) -> Result<(GlideEstimate, GlideMap), RecordedError> {
        let Self { options, unit, .. } = self;
        let refused = |error| self.refused(&error);
        let points = self.fit.map(options.grid).map_err(refused)?;
        let regions = regions(options.grid, &points, &self.limits).map_err(refused)?;
        let estimate = self.report(&regions);
        let (points, regions, extras) = match options.map_at_contacts {
            true => (self.at_contacts()?, None, self.recorded.extras.clone()),
            false => (points, Some(regions.of_point), ExtraColumns::default()),
        };
        let map = GlideMap {
            points,
            regions,
            thresholds: self.limits,
            unit: *unit,
            extras,
        };
        Ok((estimate, map))
    }

    /// Warnings about the contacts, with these misfits.
    fn warnings(&self, misfits: &[Misfit], unknown_fit: Option<String>) -> Vec<Warning> {
        let (recorded, patch, unit) = (&self.recorded, &self.patch, self.unit);
        let (source, contacts) = (&recorded.source, self.contacts());
        let directions = directions(contacts);
        let misfits = misfit_warnings(misfits, directions.is_some(), source);
        // Two-pass, which alone has a status, states no uncertainty.
        let is_unknown = self.centre.curvature.uncertainty.is_none() && self.fit.status.is_none();
        let unknown_noise = is_unknown.then(|| {
            let count = patch.samples.len();
            format!("there are no standard deviations: {count} contacts do not determine their noise; state it with setting `position_std`")
        });
        let rows = recorded.contacts.iter().map(|contact| {
            let ([x, y, z], finger) = (contact.position.into(), contact.finger as f64);
            let [normal_x, normal_y, normal_z] = contact.normal.unwrap_or_default().into();
            [finger, x, y, z, normal_x, normal_y, normal_z]
        });
        Warning::of(
            StatedQuantity::Scale.code(),
            spacing(patch, &self.given, unit),
        )
        .into_iter()
        .chain(misfits)
        .chain(Warning::of("unknown-fit", unknown_fit))
        .chain(Warning::of("unknown-noise", unknown_noise))
        .chain(Warning::of(
            "distant-contact",
            distant(contacts, unit, source),
        ))
        .chain(stated_noise(patch, &self.options.estimator, unit))
        .chain(normals(contacts))
        .chain(Warning::of("signs", directions))
        .chain(Warning::of(
            "repeated-rows",
            source.repeated("contact", rows, 0.0),
        ))
        .chain(Warning::of("unnamed-fingers", recorded.note.clone()))
        .collect()
    }

    /// The estimate with these regions.
    fn report(&self, regions: &Regions) -> GlideEstimate {
        let (recorded, options, centre) = (&self.recorded, &self.options, &self.centre);
        let (patch, fit, limits, unit) = (&self.patch, &self.fit, &self.limits, self.unit);
        let value = |value: f64, std: Option<f64>, power: Unit| Value::new(value, std, power, unit);
        let bare = |value: f64, power: Unit| Value::bare(value, power.of(unit));
        let curvature = centre.curvature;
        let stds = curvature.uncertainty;
        let gaussian_std = stds.map(|stds| stds.gaussian_std);
        let mean_std = stds.map(|stds| stds.mean_std);
        let [min_std, max_std] = principal_stds(&curvature);
        let method = GlideFit::of(&options.estimator, options.inter_finger_distance);
        let (tested, unknown) = match method.misfit(patch) {
            Ok(tested) => (tested, None),
            Err(error) => {
                let why = format!("the goodness of fit cannot be computed: {error}");
                (MisfitTest::default(), Some(why))
            }
        };
        let warnings = self.warnings(&tested.misfits, unknown);
        GlideEstimate {
            format_version: FORMAT_VERSION,
            method: options.estimator.name(),
            contacts: recorded.contacts.len(),
            fingers: recorded.fingers,
            with_normals: patch.has_normals(),
            length_unit: unit.as_str(),
            position: tidy(&centre.position.coords),
            normal: tidy(&centre.normal),
            gaussian_curvature: value(curvature.gaussian, gaussian_std, Unit::PerLengthSquared),
            radius: Radius::of_mean(&value(curvature.mean, mean_std, Unit::PerLength), unit),
            mean_curvature: value(curvature.mean, mean_std, Unit::PerLength),
            k_min: value(centre.k_min, min_std, Unit::PerLength),
            k_max: value(centre.k_max, max_std, Unit::PerLength),
            direction_of_min: tidy(&centre.direction_of_min),
            direction_of_max: tidy(&centre.direction_of_max),
            shape_index: centre.shape_index,
            class: curvature.class(limits).name(),
            class_probabilities: curvature.class_probabilities(limits).map(|all| {
                let names = ShapeClass::ALL.map(ShapeClass::name).into_iter();
                names.zip(all).collect()
            }),
            sign_class: curvature.sign_class().name(),
            thresholds: Thresholds {
                gaussian: bare(limits.gaussian(), Unit::PerLengthSquared),
                mean: bare(limits.mean(), Unit::PerLength),
                from: self.limits_from,
            },
            noise: fit.noise.map(|noise| PatchNoise {
                position_std: bare(noise.position_std, Unit::Length),
                normal_std_deg: noise.normal_std_rad.map(f64::to_degrees),
            }),
            status: fit.status.map(Status::name),
            effective_unknowns: fit.effective_unknowns,
            grid: options.grid,
            regions: PatchRegion::all(regions, unit),
            p_value: tested.goodness.map(|goodness| goodness.p_value),
            warnings,
            covariance: stds.map(|stds| {
                let mixed = stds.correlation * stds.gaussian_std * stds.mean_std;
                [
                    [stds.gaussian_std * stds.gaussian_std, mixed],
                    [mixed, stds.mean_std * stds.mean_std],
                ]
            }),
        }
    }
}

/// Options with position noise as a length. A fraction refers to the stated or, without one, the measured finger distance.
fn with_length_noise(
    recorded: &GlideRecording,
    options: &GlideOptions,
) -> Result<GlideOptions, RecordedError> {
    let mut options = options.clone();
    if options.estimator.position_fraction_of_ifd().is_none() {
        return Ok(options);
    }
    let patch = Patch::new(&recorded.contacts, &Vector3::from(options.outward));
    let patch = patch.map_err(|error| refused(recorded, &error))?;
    let found = patch.finger_distance;
    let found = found.map(|distance| distance * patch.frame.scale());
    let Some(distance) = options.inter_finger_distance.or(found) else {
        let message = format!(
            "{ONE_FINGER}: setting `position_fraction_of_ifd` needs setting `inter_finger_distance`"
        );
        return Err(recorded.source.fail(message));
    };
    options.estimator = options.estimator.with_length_noise(distance);
    Ok(options)
}

/// Reason why there is no distance between fingers.
const ONE_FINGER: &str = "all contacts are of one finger, so there is no distance between fingers";

/// The error, with the line of the contact at fault if there is one.
fn refused(recorded: &GlideRecording, error: &Ep2Error) -> RecordedError {
    let contact = match error {
        Ep2Error::NotFinite { contact }
        | Ep2Error::BadWeight { contact, .. }
        | Ep2Error::BadNormal { contact, .. }
        | Ep2Error::MissingNormal { contact }
        | Ep2Error::Folded { contact, .. } => Some(*contact),
        _ => None,
    };
    let message = remedied(error, recorded.fingers);
    let signs = match error {
        Ep2Error::Folded { .. } | Ep2Error::NoSide { .. } => directions(&recorded.contacts),
        _ => None,
    };
    let message = signs.map_or(message.clone(), |signs| format!("{message}; {signs}"));
    let message = explained(message, error.name());
    match contact {
        Some(contact) => recorded.source.fail_at(contact, message),
        None => recorded.source.fail(message),
    }
}

/// Message of the error, with the setting that helps if there is one.
fn remedied(error: &Ep2Error, fingers: usize) -> String {
    match error {
        Ep2Error::BadSetting(bad) if bad.setting == "unit_length" && bad.value == 0.0 => {
            format!("{ONE_FINGER}: two-pass needs setting `inter_finger_distance`")
        }
        Ep2Error::BadSetting(bad) if bad.setting == "unit_length" => {
            SettingError::of_number("inter_finger_distance", bad.value, bad.expected).to_string()
        }
        Ep2Error::Folded { angle_deg, .. } if *angle_deg > 90.0 => {
            format!("{error}: does its normal point inward?")
        }
        Ep2Error::NoSide { .. } => {
            let curve = match fingers {
                1 => "; contacts along one curve do not determine the surface beside it",
                _ => "",
            };
            format!("{error}; give another with setting `outward`{curve}")
        }
        _ => error.to_string(),
    }
}

/// The thresholds of the 1996 paper, 0.005 and 0.03 on a patch of 3 × 3, scaled to this patch by the mean of its sides.
/// `None` if they exceed the range of doubles.
fn of_size(fit: &Fit) -> Option<ShapeThresholds> {
    let [u, v] = fit
        .domain
        .map(|[low, high]| (high - low) * fit.frame.scale());
    let paper_units = 3.0 / (0.5 * u + 0.5 * v);
    ShapeThresholds::new(0.005 * paper_units * paper_units, 0.03 * paper_units).ok()
}

/// Standard deviations of the principal curvatures H ∓ √(H² − K), to first order; `None` if the two cannot be distinguished
/// or if the method states no uncertainty.
fn principal_stds(curvature: &Curvature) -> [Option<f64>; 2] {
    let Some(uncertainty) = curvature.uncertainty else {
        return [None; 2];
    };
    let Uncertainty {
        gaussian_std,
        mean_std,
        correlation,
    } = uncertainty;
    let variance = |by_gaussian: f64, by_mean: f64| {
        let (gaussian, mean) = (by_gaussian * gaussian_std, by_mean * mean_std);
        (gaussian * gaussian + 2.0 * correlation * gaussian * mean + mean * mean).max(0.0)
    };
    let mean = curvature.mean;
    let square = mean * mean - curvature.gaussian;
    if square <= 2.0 * variance(-1.0, 2.0 * mean).sqrt() || square <= 0.0 {
        return [None; 2];
    }
    let half = square.sqrt();
    [-1.0, 1.0].map(|sign| {
        let std = variance(-0.5 * sign / half, 1.0 + sign * mean / half).sqrt();
        std.is_finite().then_some(std)
    })
}

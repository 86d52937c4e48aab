//! Estimates the curvature of a patch from recorded glides.

use std::borrow::Cow;

use nalgebra::Vector3;
use palpate_ep2::{
    Contact, Curvature, EffectiveReadings, Ep2Error, IndependentFit, MapPoint, Method, MisfitTest,
    Outlier, Patch, Regions, RoundTip, ShapeError, ShapeFit, SoundContacts, StrokeCurvature,
    regions, stroke_curvature,
};
use palpate_estimators::{GlideFit, GlideMethod, fit_shape};
use palpate_geometry::{ShapeClass, ShapeThresholds};
use palpate_statistics::{Misfit, StatedQuantity};

use super::error::RecordedError;
use super::glide_options::GlideOptions;
use super::glide_recording::{
    GlideRecording, ONE_FINGER, of_row, refused, shape_refused, stroke_refused,
};
use super::glide_report::{
    GlideEstimate, GlideMap, GlideRadius, PatchNoise, PatchRegion, Thresholds, of_size, tidy,
};
use super::glide_warnings::{
    FoundNoise, directions, distant, extent, misfit_warnings, narrow, normals, spacing,
    stated_noise,
};
use super::log_warnings::{across, assumed_side, correlated, left_out, shape_warnings};
use super::press_report::Radius;
use super::reading_table::ExtraColumns;
use super::shape_report::{LeftOut, ShapeReport, StrokeReport, is_undetermined};
use super::two_groups::two_groups;
use super::value::{FORMAT_VERSION, Value, finite};
use palpate_study::config::LengthUnit;
use palpate_study::{Unit, Warning};

/// Estimates the curvature of a patch from recorded contacts.
///
/// # Errors
/// [`RecordedError::Line`] if a contact is wrong. [`RecordedError::Readings`] if the options contradict the file, or if
/// the contacts do not determine the patch.
pub fn estimate_glide(
    recorded: &GlideRecording,
    options: &GlideOptions,
) -> Result<(GlideEstimate, GlideMap), RecordedError> {
    GlideFitResult::new(Cow::Borrowed(recorded), options)?.estimate()
}

/// Surface fitted to recorded contacts. Curvatures, the map and the estimate are computed only when their methods are
/// called.
#[derive(Clone, Debug)]
pub struct GlideFitResult<'r> {
    recorded: Cow<'r, GlideRecording>,
    given: GlideOptions,
    /// Options that the user gave, with the position noise converted to a length.
    options: GlideOptions,
    unit: LengthUnit,
    used: UsedContacts,
    surface: Surface,
    /// Curvature along the stroke, if all contacts form a single stroke; otherwise `None`.
    stroke: Option<StrokeCurvature>,
    centre: MapPoint,
    /// Thresholds of the Gaussian and the mean curvature, below which a curvature counts as zero.
    pub thresholds: ShapeThresholds,
    limits_from: &'static str,
}

/// The contacts that are fitted, without outliers. If the file states points of round fingertips, the contacts are
/// computed from these points.
#[derive(Clone, Debug)]
struct UsedContacts {
    contacts: Vec<Contact>,
    /// Row of each contact in the recording, counted from 0.
    rows: Vec<usize>,
    outliers: Vec<Outlier>,
    readings: EffectiveReadings,
}

#[derive(Clone, Debug)]
enum Surface {
    Graph(Box<(GlideFit, IndependentFit)>),
    Shape(Box<ShapeFit>),
}

impl<'r> GlideFitResult<'r> {
    /// Fits the surface to the recorded contacts.
    ///
    /// # Errors
    /// The errors of [`estimate_glide`], without the errors of the map, which is computed later.
    pub fn new(
        recorded: Cow<'r, GlideRecording>,
        given: &GlideOptions,
    ) -> Result<Self, RecordedError> {
        let unit = recorded.source.unit(recorded.unit, given.length_unit)?;
        if given.tip_radius.is_none() {
            recorded.check_contacts()?;
        }
        let (all, outward) = (&recorded.contacts, given.outward());
        let shape_refused = |error| shape_refused(&recorded, &error);
        let refused = |error| refused(&recorded, &error);
        let is_side_assumed = !recorded.has_normals() && given.outward.is_none();
        let stroke_of = |contacts: &[Contact]| {
            let stroke = stroke_curvature(contacts, &outward)?;
            Some(match is_side_assumed {
                true => stroke.for_any_side(),
                false => stroke,
            })
        };
        let options = with_length_noise(&recorded, given)?;
        let stated = options.thresholds();
        let stated = stated.map_err(|error| recorded.source.fail(error.to_string()))?;
        let tip = options.tip();
        let method = GlideMethod::of(&options.estimator, options.inter_finger_distance);
        let (used, surface, stroke, centre, sides) = match method {
            GlideMethod::Graph(method) => {
                let SoundContacts {
                    outliers,
                    rows,
                    distinct,
                } = near_surface(all, &outward).map_err(shape_refused)?;
                let sound: Vec<Contact> = rows.iter().map(|&row| all[row]).collect();
                let contacts = |tip: RoundTip| tip.contacts(&sound, &outward, &method);
                let of_tips = tip.map(contacts).transpose().map_err(refused)?;
                let distinct = Some(distinct).filter(|_| of_tips.is_none());
                let contacts = of_tips.unwrap_or(sound);
                let with_noise = |factors| method.clone().with_noise_factors(factors);
                let at_row = |error| of_row(error, &rows);
                let fitted = IndependentFit::new(with_noise, &contacts, distinct, &outward);
                let (mut fitted, single) = match fitted {
                    Ok(fitted) => (fitted, None),
                    Err(error) => {
                        let error = at_row(error);
                        let Some(stroke) = stroke_of(&contacts) else {
                            return Err(refused(error));
                        };
                        let contacts = stroke.with_normals(&contacts, &outward);
                        let fitted = IndependentFit::new(with_noise, &contacts, None, &outward);
                        let refused = |_| stroke_refused(&recorded, &error, &stroke, unit);
                        (fitted.map_err(refused)?, Some(stroke))
                    }
                };
                let is_quadric = matches!(method, GlideFit::Quadric(_));
                fitted
                    .widen_by_bias(&outward, is_quadric)
                    .map_err(refused)?;
                if let Some(stroke) = single.as_ref().filter(|_| !recorded.has_normals()) {
                    fitted.without_normals(stroke);
                }
                let fit = &fitted.fit;
                // If the noise is correlated, `fitted.contacts` are means of consecutive contacts. The means may be too
                // few to recognise a stroke, so also try all contacts.
                let stroke = single
                    .or_else(|| stroke_of(&fitted.contacts))
                    .or_else(|| stroke_of(&contacts));
                let centre = fit.centre().map_err(refused)?;
                let sides = fit
                    .domain
                    .map(|[low, high]| (high - low) * fit.frame.scale());
                let used = UsedContacts {
                    contacts,
                    rows,
                    outliers,
                    readings: fitted.readings,
                };
                let surface = Surface::Graph(Box::new((method, fitted)));
                (used, surface, stroke, centre, sides)
            }
            GlideMethod::Shape(settings) => {
                let fit = fit_shape(&settings, tip.as_ref(), all, &outward);
                let fit = fit.map_err(shape_refused)?;
                let mut left = fit.outliers.iter().map(|one| one.contact).peekable();
                let rows = (0..all.len()).filter(|row| left.next_if_eq(row).is_none());
                let rows: Vec<usize> = rows.collect();
                let contacts: Vec<Contact> = rows.iter().map(|&row| all[row]).collect();
                let centres = tip.map(|tip| tip.centres(&contacts, &outward));
                let contacts = centres.transpose().map_err(refused)?.unwrap_or(contacts);
                let stroke = stroke_of(&contacts);
                // A single stroke determines the surface if its contacts have normals and the shape is stated.
                let is_determined = settings.shape.is_some() && recorded.has_normals();
                let stroke = stroke.filter(|_| !is_determined);
                let tip_radius = tip.map_or(0.0, |tip| tip.radius);
                let of_object = |stroke: StrokeCurvature| {
                    let turns = stroke.value.recip();
                    let error = Ep2Error::TipTooLarge { tip_radius, turns };
                    stroke.without_tip(tip_radius).ok_or(error)
                };
                let stroke = stroke.map(of_object).transpose().map_err(refused)?;
                let centre = fit.point_at(&fit.foot.0);
                let sides = fit.domain(&contacts).map(|[low, high]| high - low);
                let used = UsedContacts {
                    contacts,
                    rows,
                    outliers: fit.outliers.clone(),
                    readings: fit.readings,
                };
                (used, Surface::Shape(Box::new(fit)), stroke, centre, sides)
            }
        };
        let (thresholds, limits_from) = match stated {
            Some(thresholds) => (thresholds, "given"),
            None => (
                of_size(sides)
                    .ok_or(Ep2Error::OutOfRange)
                    .map_err(refused)?,
                "the patch's size: those of the 1996 paper on its patch of 3 x 3, scaled",
            ),
        };
        Ok(Self {
            given: given.clone(),
            recorded,
            options,
            unit,
            used,
            surface,
            stroke,
            centre,
            thresholds,
            limits_from,
        })
    }

    fn refused(&self, error: &Ep2Error) -> RecordedError {
        refused(&self.recorded, error)
    }

    /// Points of the fitted surface: one for each fitted contact if `at_contacts` is true, otherwise one for each grid
    /// point.
    fn points(&self, at_contacts: bool) -> Result<Vec<MapPoint>, RecordedError> {
        let (contacts, side) = (&self.used.contacts, self.options.grid);
        let places = contacts.iter().map(|contact| contact.position);
        let points = match (&self.surface, at_contacts) {
            (Surface::Graph(graph), true) => graph.1.fit.points_at(&places.collect::<Vec<_>>()),
            (Surface::Graph(graph), false) => graph.1.fit.map(side),
            (Surface::Shape(fit), true) => Ok(places.map(|place| fit.point_at(&place)).collect()),
            (Surface::Shape(fit), false) => Ok(fit.map(contacts, side)),
        };
        let mut points = points.map_err(|error| self.refused(&error))?;
        for point in points.iter_mut().filter(|_| self.is_open()) {
            point.curvature.uncertainty = None;
        }
        Ok(points)
    }

    fn is_open(&self) -> bool {
        let is_unresolved = match &self.surface {
            Surface::Graph(_) => false,
            Surface::Shape(fit) => is_undetermined(fit) || fit.is_none_of_these(),
        };
        self.stroke.is_some() || is_unresolved
    }

    /// Curvature at every point of the map, in the order of [`GlideMap::points`].
    ///
    /// # Errors
    /// [`RecordedError::Readings`] if a curvature exceeds the range of doubles.
    pub fn curvatures(&self) -> Result<Vec<Curvature>, RecordedError> {
        match &self.surface {
            Surface::Graph(graph) if !self.options.map_at_contacts && !self.is_open() => {
                let curvatures = graph.1.fit.curvatures(self.options.grid);
                curvatures.map_err(|error| self.refused(&error))
            }
            _ => {
                let points = self.points(self.options.map_at_contacts)?;
                Ok(points.iter().map(|point| point.curvature).collect())
            }
        }
    }

    /// The estimate, and the map of curvatures.
    ///
    /// # Errors
    /// [`RecordedError::Readings`] if a point of the map exceeds the range of doubles.
    pub fn estimate(&self) -> Result<(GlideEstimate, GlideMap), RecordedError> {
        let Self { options, unit, .. } = self;
        let points = self.points(false)?;
        let regions = regions(options.grid, &points, &self.thresholds);
        let regions = regions.map_err(|error| self.refused(&error))?;
        let estimate = self.report(&regions);
        let (points, regions, extras) = match options.map_at_contacts {
            true => {
                let extras = self.recorded.extras.selected(&self.used.rows);
                (self.points(true)?, None, extras)
            }
            false => (points, Some(regions.of_point), ExtraColumns::default()),
        };
        let map = GlideMap {
            points,
            regions,
            thresholds: self.thresholds,
            unit: *unit,
            extras,
        };
        Ok((estimate, map))
    }

    /// Tests the goodness of fit of a fitted graph (height over a plane), and finds misfits. Outliers are identified by
    /// their row number in the recording. The second result is the reason why the test is impossible; `None` if the
    /// test is possible.
    fn misfit(&self) -> (MisfitTest, Option<String>) {
        let Surface::Graph(graph) = &self.surface else {
            return Default::default();
        };
        // For a stroke that was recorded without normals, the fit uses assumed normals, so its goodness of fit cannot
        // be tested.
        if self.stroke.is_some() && !self.recorded.has_normals() {
            return Default::default();
        }
        let (method, fitted) = &**graph;
        let method = method.clone().with_noise_factors(fitted.noise_ratios);
        match method.misfit(&fitted.patch, Some(&fitted.fit)) {
            Ok(mut tested) => {
                // If contacts were averaged, an outlier among the means is not a row of the file. So do not report it.
                if fitted.contacts.len() < self.used.readings.distinct {
                    let is_outlier = |one: &Misfit| matches!(one, Misfit::Outlier { .. });
                    tested.misfits.retain(|one| !is_outlier(one));
                }
                for misfit in &mut tested.misfits {
                    if let Misfit::Outlier { reading, .. } = misfit {
                        *reading = self.used.rows[fitted.rows[*reading]];
                    }
                }
                (tested, None)
            }
            Err(error) => {
                let why = format!("the goodness of fit cannot be computed: {error}");
                (MisfitTest::default(), Some(why))
            }
        }
    }

    /// Warnings about the contacts, including warnings about `misfits`. `unknown_fit` is the reason why the goodness of
    /// fit could not be tested; `None` if it was tested.
    fn warnings(&self, misfits: &[Misfit], unknown_fit: Option<String>) -> Vec<Warning> {
        let (recorded, used, unit) = (&self.recorded, &self.used, self.unit);
        let (source, contacts) = (&recorded.source, &used.contacts);
        let directions = directions(contacts);
        let misfits = misfit_warnings(misfits, directions.is_some(), source);
        let (of_graph, of_shape) = match &self.surface {
            Surface::Graph(graph) => (Some(&graph.1), Vec::new()),
            Surface::Shape(fit) => {
                let is_stroke = self.stroke.is_some();
                (None, shape_warnings(fit, contacts, is_stroke, unit))
            }
        };
        // A missing uncertainty means that the noise is unknown. The exception is the method `two-pass`, which never
        // computes an uncertainty. Its fits are recognised by their status, which the fits of other methods do not
        // have.
        let is_unknown = self.centre.curvature.uncertainty.is_none()
            && of_graph.is_some_and(|graph| graph.fit.status.is_none());
        let unknown_noise = is_unknown.then(|| {
            let count = contacts.len();
            format!("there are no standard deviations: {count} contacts do not determine their noise; state it with setting `position_std`")
        });
        let rows = used.rows.iter().map(|&row| {
            let contact = &recorded.contacts[row];
            let ([x, y, z], finger) = (contact.position.into(), contact.finger as f64);
            let [normal_x, normal_y, normal_z] = contact.normal.unwrap_or_default().into();
            [finger, x, y, z, normal_x, normal_y, normal_z]
        });
        let has_copies = used.readings.distinct < used.rows.len();
        let of_used = has_copies.then(|| source.selected(&used.rows));
        let repeated = of_used.and_then(|source| source.repeated("contact", rows, 0.0));
        let spacing = of_graph.and_then(|graph| spacing(&graph.patch, &self.given, unit));
        let distant = of_graph.and_then(|graph| {
            let row = |contact: usize| source.row(used.rows[graph.rows[contact]]);
            distant(&graph.contacts, unit, &row)
        });
        let mut estimator = self.options.estimator.clone();
        let stated = estimator.noise().map(std::mem::take).unwrap_or_default();
        let stated = [stated.position_std, stated.normal_std_deg];
        let found = || match &self.surface {
            Surface::Graph(graph) => {
                let (_, fitted) = &**graph;
                FoundNoise::of_graph(&fitted.patch, &estimator, fitted.noise_ratios)
            }
            Surface::Shape(fit) => FoundNoise::of_shape(fit, contacts),
        };
        let stated = (stated != [None; 2])
            .then(found)
            .flatten()
            .map(|found| stated_noise(stated, &found, unit));
        let stroke = self.stroke.as_ref();
        let noise = match &self.surface {
            Surface::Graph(graph) => graph.1.fit.noise,
            Surface::Shape(fit) => fit.noise,
        };
        let (fitted, distinct, shape) = match &self.surface {
            // If there are copies, use the fitted contacts, which do not contain them.
            Surface::Graph(graph) => match has_copies {
                true => (&graph.1.contacts, graph.1.contacts.len(), None),
                false => (contacts, contacts.len(), None),
            },
            Surface::Shape(fit) => (contacts, used.readings.distinct, Some(&**fit)),
        };
        let normal = &self.centre.normal;
        let has_side = stroke.is_some() || !self.is_open();
        let side = (has_side && !recorded.has_normals())
            .then(|| assumed_side(shape, stroke, &self.centre.curvature, self.options.outward))
            .flatten();
        let (unused, other_tip) = match self.given.tip_radius {
            None => (recorded.possible_tips(), None),
            Some(stated) => (None, recorded.other_tip_radius(stated)),
        };
        Warning::of(StatedQuantity::Scale.code(), spacing)
            .into_iter()
            .chain(Warning::of(StatedQuantity::Scale.code(), other_tip))
            .chain(Warning::of(
                "units",
                extent(
                    contacts,
                    unit,
                    self.given.tip_radius,
                    &self.centre.curvature,
                ),
            ))
            .chain(Warning::of("units", narrow(contacts, normal)))
            .chain(side)
            .chain(Warning::of("assumed-columns", unused))
            .chain(left_out(&used.outliers, recorded))
            .chain(correlated(&used.readings, recorded.has_normals()))
            .chain(two_groups(fitted, normal, noise, distinct))
            .chain(self.stroke.map(|stroke| across(&stroke, unit)))
            .chain(of_shape)
            .chain(misfits)
            .chain(Warning::of("unknown-fit", unknown_fit))
            .chain(Warning::of("unknown-noise", unknown_noise))
            .chain(Warning::of("distant-contact", distant))
            .chain(stated.unwrap_or_default())
            .chain(normals(contacts))
            .chain(Warning::of("signs", directions))
            .chain(Warning::of("repeated-rows", repeated))
            .chain(Warning::of("unnamed-fingers", recorded.note.clone()))
            .chain(recorded.source.notes.iter().cloned())
            .collect()
    }

    fn report(&self, regions: &Regions) -> GlideEstimate {
        let (recorded, options, centre) = (&self.recorded, &self.options, &self.centre);
        let (limits, unit, is_open) = (&self.thresholds, self.unit, self.is_open());
        let size = match &self.surface {
            Surface::Graph(_) => None,
            Surface::Shape(fit) => fit.curvature.std.map(|std| (std, fit.curvature.interval95)),
        };
        let value = |value: f64, std: Option<f64>, power: Unit| {
            let mut value = Value::new(value, std, power, unit);
            // A shape has a single curvature, whose interval determines all other intervals.
            if let (Some((of_size, ends)), Some(std)) = (size, std.filter(|std| *std > 0.0)) {
                value.interval95 = Some(match power {
                    Unit::PerLengthSquared => squares(ends),
                    _ => ends.map(|end| end.map(|end| end * (std / of_size))),
                });
            }
            match is_open {
                true => Value::open(power, unit),
                false => value,
            }
        };
        let bare = |value: f64, power: Unit| Value::bare(value, power.of(unit));
        let curvature = centre.curvature;
        let stds = curvature.uncertainty.filter(|_| !is_open);
        let gaussian_std = stds.map(|stds| stds.gaussian_std);
        let mean_std = stds.map(|stds| stds.mean_std);
        let principal_stds = match &self.surface {
            Surface::Graph(graph) => graph.1.fit.principal_stds_at(&centre.position),
            Surface::Shape(fit) => fit.principal_stds(),
        };
        let std = |place: usize| {
            principal_stds
                .map(|stds| stds[place])
                .filter(|std| std.is_finite())
        };
        let [min_std, max_std] = [0, 1].map(std);
        let (tested, unknown) = self.misfit();
        let warnings = self.warnings(&tested.misfits, unknown);
        let (noise, status, effective_unknowns, shape) = match &self.surface {
            Surface::Graph(graph) => {
                let fit = &graph.1.fit;
                (fit.noise, fit.status, fit.effective_unknowns, None)
            }
            Surface::Shape(fit) => {
                let report = ShapeReport::new(fit, unit, self.stroke.is_some());
                (fit.noise, None, fit.shape.unknowns() as f64, Some(report))
            }
        };
        let mean_curvature = value(curvature.mean, mean_std, Unit::PerLength);
        let radius = match &shape {
            Some(shape) => GlideRadius::OfShape(shape.radius.clone()),
            None => GlideRadius::OfMean(Radius::of_mean(&mean_curvature, unit)),
        };
        GlideEstimate {
            format_version: FORMAT_VERSION,
            method: (&options.estimator).into(),
            contacts: recorded.contacts.len(),
            fingers: recorded.fingers,
            with_normals: recorded.has_normals(),
            length_unit: unit.as_str(),
            position: tidy(&centre.position.coords),
            normal: tidy(&centre.normal),
            gaussian_curvature: value(curvature.gaussian, gaussian_std, Unit::PerLengthSquared),
            radius,
            mean_curvature,
            k_min: value(centre.k_min, min_std, Unit::PerLength),
            k_max: value(centre.k_max, max_std, Unit::PerLength),
            direction_of_min: tidy(&centre.direction_of_min),
            direction_of_max: tidy(&centre.direction_of_max),
            shape_index: centre.shape_index.filter(|_| !is_open),
            class: (!is_open).then(|| limits.classify(curvature.gaussian, curvature.mean).name()),
            class_probabilities: curvature
                .class_probabilities(limits)
                .filter(|_| !is_open)
                .map(|all| {
                    let names = ShapeClass::ALL.map(ShapeClass::name).into_iter();
                    names.zip(all).collect()
                }),
            sign_class: (!is_open && curvature.gaussian != 0.0)
                .then(|| curvature.sign_class().into()),
            thresholds: Thresholds::new(limits, self.limits_from, unit),
            noise: noise.map(|noise| PatchNoise {
                position_std: bare(noise.position_std, Unit::Length),
                normal_std_deg: noise.normal_std_rad.map(f64::to_degrees),
            }),
            status: status.map(<&str>::from),
            effective_unknowns,
            grid: options.grid,
            regions: match is_open {
                true => Vec::new(),
                false => PatchRegion::all(regions, unit),
            },
            p_value: tested.goodness.map(|goodness| goodness.p_value),
            effective_contacts: self.used.readings.effective(),
            distinct_contacts: self.used.readings.distinct,
            correlated_contacts: self.used.readings.position_correlation,
            left_out: self
                .used
                .outliers
                .iter()
                .map(|one| LeftOut::new(one, &self.recorded.source))
                .collect(),
            stroke: self.stroke.map(|stroke| StrokeReport::new(&stroke, unit)),
            shape,
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

/// Smallest and largest square of the numbers in an interval.
fn squares(ends: [Option<f64>; 2]) -> [Option<f64>; 2] {
    let low = ends[0].unwrap_or(f64::NEG_INFINITY);
    let high = ends[1].unwrap_or(f64::INFINITY);
    let distances = [low.max(-high).max(0.0), high.max(-low)];
    distances.map(|distance| finite(distance * distance))
}

/// The contacts without gross outliers and without contacts that contradict a smooth surface.
fn near_surface(contacts: &[Contact], outward: &Vector3<f64>) -> Result<SoundContacts, ShapeError> {
    SoundContacts::new(contacts)?.without_misfits(contacts, outward)
}

/// The options, with the position noise as a length. If the noise is stated as a fraction, it is multiplied by the
/// stated or, if none is stated, by the measured distance between fingers.
fn with_length_noise(
    recorded: &GlideRecording,
    options: &GlideOptions,
) -> Result<GlideOptions, RecordedError> {
    let mut options = options.clone();
    if let Some(distance) = options.inter_finger_distance {
        options.estimator = options.estimator.with_length_noise(distance);
    }
    let noise = options.estimator.noise();
    if noise.is_none_or(|noise| noise.position_fraction_of_ifd.is_none()) {
        return Ok(options);
    }
    let (all, outward) = (&recorded.contacts, options.outward());
    let sound = match GlideMethod::of(&options.estimator, None) {
        GlideMethod::Graph(_) => near_surface(all, &outward),
        GlideMethod::Shape(_) => SoundContacts::new(all),
    };
    let sound = sound.map_err(|error| shape_refused(recorded, &error))?;
    let contacts: Vec<Contact> = sound.rows.iter().map(|&row| all[row]).collect();
    let patch = Patch::new(&contacts, &outward);
    let patch = patch.map_err(|error| refused(recorded, &of_row(error, &sound.rows)))?;
    let Some(distance) = patch.finger_distance else {
        let message = format!(
            "{ONE_FINGER}: setting `position_fraction_of_ifd` needs setting `inter_finger_distance`"
        );
        return Err(recorded.source.fail(message));
    };
    let distance = distance * patch.frame.scale();
    options.estimator = options.estimator.with_length_noise(distance);
    Ok(options)
}

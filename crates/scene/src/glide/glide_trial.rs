//! A glide that is ready to run, and its trials.

use std::sync::LazyLock;

use nalgebra::{Point3, Vector3};
use palpate_ep2::{
    Contact, Curvature, Ep2Error, Fit, MapPoint, Method, Patch, RoundTip, ShapeError, ShapeFit,
    regions,
};
use palpate_geometry::{CurvatureForm, ShapeClass, ShapeThresholds};
use palpate_rolling::Touch;
use palpate_sensing::{Channel, NormalError, PositionError, Stream};
use palpate_statistics::BadSetting;

use crate::ladder::Ladder;
use crate::principal_curvatures::PointCurvature;
use crate::scene::{Need, Observer, Trials};
use crate::trace::{Trace, TraceError, counted};
use palpate_estimators::{GlideFit, GlideMethod, fit_shape, push_map_point};
use palpate_study::config::{GlideConfig, LengthUnit};
use palpate_study::readings::{COLUMNS, table_columns};
use palpate_study::{Column, FieldError, Quantity, Table, Unit};
use palpate_sweep::Observation;

const GLIDE_QUANTITIES: [Quantity; 3] = [
    Quantity::GAUSSIAN_CURVATURE,
    Quantity::MEAN_CURVATURE,
    Quantity::CLASS,
];

static WITH_PRINCIPAL: LazyLock<Vec<Quantity>> =
    LazyLock::new(|| [&GLIDE_QUANTITIES[..], &Quantity::PRINCIPAL].concat());

/// A glide that is ready to run. It contains the true contacts, the sensor, the noise and the estimator of a grid point
/// of a study.
#[derive(Clone, Debug)]
pub struct GlideScene {
    pub(super) seed: u64,
    pub(super) config: GlideConfig,
    pub(super) touches: Vec<FingerTouch>,
    pub(super) noiseless_readings: Vec<Contact>,
    pub(super) noise: ContactNoise,
    pub(super) tip: Option<RoundTip>,
    pub(super) method: GlideMethod,
    pub(super) grid: TrueGrid,
    pub(super) needs: Vec<Need>,
}

/// The fitted surface: a graph (height over a plane) or a simple shape.
pub(super) enum GlideSurface {
    Graph(Box<Fit>),
    Shape(Box<ShapeFit>),
}

impl GlideSurface {
    fn curvature_at(&self, place: &Point3<f64>) -> Result<Curvature, Ep2Error> {
        match self {
            Self::Graph(fit) => fit.curvature_at(place),
            Self::Shape(fit) => Ok(fit.point_at(place).curvature),
        }
    }

    /// Principal curvatures of the fitted surface at the point nearest to `place`. Angles are measured from `axes[0]`
    /// towards `axes[1]`.
    fn principal_at(
        &self,
        place: &Point3<f64>,
        axes: &[Vector3<f64>; 2],
    ) -> Result<PointCurvature, Ep2Error> {
        let point = self.points_at(std::slice::from_ref(place))?[0];
        let stds = match self {
            Self::Graph(fit) => fit.principal_stds_at(place),
            Self::Shape(fit) => fit.principal_stds(),
        };
        let [x, y] = axes.map(|axis| axis.dot(&point.direction_of_min));
        let mean_std = point.curvature.uncertainty.map(|one| one.mean_std);
        let mut principal = PointCurvature::of(&CurvatureForm::default(), stds, mean_std);
        let mean = point.curvature.mean;
        principal.values = [point.k_min, point.k_max, mean, libm::atan2(y, x)];
        Ok(principal)
    }

    pub(super) fn points_at(&self, places: &[Point3<f64>]) -> Result<Vec<MapPoint>, Ep2Error> {
        match self {
            Self::Graph(fit) => fit.points_at(places),
            Self::Shape(fit) => Ok(places.iter().map(|place| fit.point_at(place)).collect()),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FingerTouch {
    pub(super) finger: usize,
    pub(super) touch: Touch,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct ContactNoise {
    pub(super) position: Option<PositionError>,
    pub(super) normal: Option<NormalError>,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct TrueGrid {
    pub(super) side: usize,
    /// Places at which the curvature is estimated: the grid points over the patch, in an order in which x changes
    /// slowest.
    pub(super) places: Vec<TruePlace>,
    pub(super) thresholds: ShapeThresholds,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TruePlace {
    pub(super) point: nalgebra::Point3<f64>,
    pub(super) gaussian: f64,
    pub(super) mean: f64,
    pub(super) class: ShapeClass,
    /// True principal curvatures at this place, with two tangents of the object: the axis angle is measured from the
    /// first tangent towards the second. `None` if the field `principal_curvatures` of the config is false.
    pub(super) principal: Option<(PointCurvature, [Vector3<f64>; 2])>,
}

impl TruePlace {
    fn value(&self, quantity: Quantity) -> Option<f64> {
        match quantity {
            Quantity::GAUSSIAN_CURVATURE => Some(self.gaussian),
            Quantity::MEAN_CURVATURE => Some(self.mean),
            Quantity::CLASS => Some(1.0),
            _ => {
                let (truth, _) = &self.principal?;
                Some(truth.outcome(truth, quantity)?.truth)
            }
        }
    }
}

impl GlideScene {
    /// Contacts that the sensor reports. The contacts have the noise of trial number `trial`; they have no noise if
    /// `trial` is `None`.
    pub(super) fn readings(&self, trial: Option<u64>) -> Vec<Contact> {
        let mut contacts = self.noiseless_readings.clone();
        let Some(trial) = trial else {
            return contacts;
        };
        if let Some(error) = &self.noise.position {
            let mut stream = Stream::new(self.seed, trial, Channel::Position);
            for contact in &mut contacts {
                contact.position = error.read(&mut stream, &contact.position);
            }
        }
        if let Some(error) = &self.noise.normal {
            let mut stream = Stream::new(self.seed, trial, Channel::Normal);
            for normal in contacts.iter_mut().filter_map(|one| one.normal.as_mut()) {
                *normal = error.read(&mut stream, normal);
            }
        }
        contacts
    }

    /// The contacts that the sensor reports, as the patch to which a graph (height over a plane) is fitted. The
    /// contacts have the noise of trial number `trial`; they have no noise if `trial` is `None`.
    fn patch(&self, method: &GlideFit, trial: Option<u64>) -> Result<Patch, Ep2Error> {
        let readings = self.readings(trial);
        let contacts = match &self.tip {
            Some(tip) => tip.contacts(&readings, &Vector3::z(), method)?,
            None => readings,
        };
        Patch::new(&contacts, &Vector3::z())
    }

    /// Fits the surface of the scene's estimator to the contacts that the sensor reports. The contacts have the noise
    /// of trial number `trial`; they have no noise if `trial` is `None`.
    pub(super) fn fit(&self, trial: Option<u64>) -> Result<GlideSurface, ShapeError> {
        Ok(match &self.method {
            GlideMethod::Graph(method) => {
                let patch = self.patch(method, trial)?;
                GlideSurface::Graph(Box::new(method.fit(&patch)?))
            }
            GlideMethod::Shape(settings) => {
                let readings = self.readings(trial);
                let fit = fit_shape(settings, self.tip.as_ref(), &readings, &Vector3::z())?;
                GlideSurface::Shape(Box::new(fit))
            }
        })
    }

    pub(crate) fn quantities_of(config: &GlideConfig) -> &'static [Quantity] {
        match config.principal_curvatures {
            true => &WITH_PRINCIPAL,
            false => &GLIDE_QUANTITIES,
        }
    }

    fn compare(&self, fit: &GlideSurface, observe: Observer<'_>) -> Result<(), Ep2Error> {
        for place in &self.grid.places {
            let curvature = fit.curvature_at(&place.point)?;
            let uncertainty = curvature.uncertainty;
            let is_right = (self
                .grid
                .thresholds
                .classify(curvature.gaussian, curvature.mean))
                == place.class;
            let outcomes = [
                Observation {
                    std: uncertainty.map(|one| one.gaussian_std),
                    ..Observation::plain(curvature.gaussian, place.gaussian)
                },
                Observation {
                    std: uncertainty.map(|one| one.mean_std),
                    ..Observation::plain(curvature.mean, place.mean)
                },
                Observation::plain(f64::from(u8::from(is_right)), 1.0),
            ];
            for (quantity, outcome) in outcomes.into_iter().enumerate() {
                observe(quantity, outcome);
            }
            if let Some((truth, axes)) = &place.principal {
                let estimate = fit.principal_at(&place.point, axes)?;
                estimate.report(truth, self.quantities(), observe);
            }
        }
        Ok(())
    }
}

impl Trials for GlideScene {
    fn quantities(&self) -> &'static [Quantity] {
        Self::quantities_of(&self.config)
    }

    fn is_random(&self) -> bool {
        self.noise.position.is_some() || self.noise.normal.is_some_and(|error| error.is_random())
    }

    fn estimable(&self) -> Result<(), FieldError> {
        self.fit(None).map(drop).map_err(|error| fit_error(&error))
    }

    fn trial(&self, trial: u64, observe: Observer<'_>) -> Result<(), &'static str> {
        let compared = self
            .fit(Some(trial))
            .and_then(|fit| Ok(self.compare(&fit, observe)?));
        compared.map_err(Into::into)
    }

    fn trial_with_warnings(
        &self,
        trial: u64,
        observe: Observer<'_>,
    ) -> Result<Vec<&'static str>, &'static str> {
        let GlideMethod::Graph(method) = &self.method else {
            return self.trial(trial, observe).map(|()| Vec::new());
        };
        let test = self.patch(method, Some(trial)).and_then(|patch| {
            let fit = Box::new(method.fit(&patch)?);
            let test = method.misfit(&patch, Some(&fit));
            self.compare(&GlideSurface::Graph(fit), observe)?;
            test
        });
        let test = test.map_err(<&str>::from)?;
        Ok(test.misfits.iter().map(|misfit| misfit.code()).collect())
    }

    fn truth(&self, quantity: usize) -> Option<f64> {
        let quantity = *self.quantities().get(quantity)?;
        let mut values = self.grid.places.iter().map(|place| place.value(quantity));
        let first = values.next()??;
        values.all(|value| value == Some(first)).then_some(first)
    }

    fn true_class(&self) -> Option<&'static str> {
        let places = &self.grid.places;
        let count = |class: ShapeClass| places.iter().filter(|place| place.class == class).count();
        let mut classes = ShapeClass::ALL.into_iter();
        let most = classes.find(|class| 2 * count(*class) > places.len());
        most.map(ShapeClass::name)
    }

    fn needs(&self) -> Vec<Need> {
        self.needs.clone()
    }

    fn ladder(&self) -> Result<Option<Ladder>, FieldError> {
        self.measured_ladder().map(Some)
    }

    fn trace(&self, trial: Option<u64>, unit: LengthUnit) -> Result<Trace, TraceError> {
        Ok(self.record(trial, unit))
    }

    fn map(&self, cell: usize, trial: u64, table: &mut Table) -> Result<(), &'static str> {
        self.push_map(cell, trial, table).map_err(Into::into)
    }
}

impl GlideScene {
    /// Records the true contacts and the readings of one glide. The readings have the noise of trial number `trial`;
    /// they have no noise if `trial` is `None`.
    pub(super) fn record(&self, trial: Option<u64>, unit: LengthUnit) -> Trace {
        let tip = Column::in_length(["tip_x", "tip_y", "tip_z"], Unit::Length, unit);
        let mut contacts = Table::new(table_columns(&COLUMNS.glides, unit).into_iter().chain(tip));
        for one in &self.touches {
            let touch = &one.touch;
            let row = touch.point.iter().chain(touch.normal.iter());
            contacts.push(one.finger, row.chain(touch.tip_centre.iter()).copied());
        }
        let fingers = self.touches.last().map_or(0, |last| last.finger + 1);
        let fingers = counted(fingers, "finger");
        Trace {
            what: format!("{} of {fingers}", counted(contacts.rows.len(), "contact")),
            contacts,
            readings: readings_table(&self.readings(trial), unit),
            camera: None,
        }
    }

    /// Adds the map of trial number `trial` to a table. There is one row per grid point, and x changes slowest.
    pub(super) fn push_map(
        &self,
        cell: usize,
        trial: u64,
        table: &mut Table,
    ) -> Result<(), ShapeError> {
        let fit = self.fit(Some(trial))?;
        let world: Vec<_> = self.grid.places.iter().map(|place| place.point).collect();
        let points = fit.points_at(&world)?;
        let regions = regions(self.grid.side, &points, &self.grid.thresholds)?;
        let places = points.iter().zip(&self.grid.places).zip(&regions.of_point);
        for ((point, truth), region) in places {
            push_map_point(
                table,
                Some((cell, truth.class)),
                point,
                Some(*region),
                &self.grid.thresholds,
            );
        }
        Ok(())
    }
}

/// Readings of the contacts, as a table in the format of `palpate estimate glide`, one row per contact.
fn readings_table(contacts: &[Contact], unit: LengthUnit) -> Table {
    let first = contacts.first();
    let columns = match first.and_then(|contact| contact.normal) {
        Some(_) => &COLUMNS.glides[..],
        None => &COLUMNS.glides[..4],
    };
    let mut table = Table::new(table_columns(columns, unit));
    for contact in contacts {
        let normal = contact.normal.iter().flat_map(|normal| normal.iter());
        table.push(
            contact.finger,
            contact.position.iter().chain(normal).copied(),
        );
    }
    table
}

/// Adds the path of a config field to an error. The error occurred when the surface was fitted to noiseless contacts,
/// and the config field is its cause.
fn fit_error(error: &ShapeError) -> FieldError {
    let ShapeError::Contacts(error) = error else {
        return FieldError::at("scene", error);
    };
    let path = match error {
        Ep2Error::BadSetting(BadSetting { setting, .. }) => match *setting {
            "normal_std" => "scene.estimator.normal_std_deg".to_owned(),
            "unit_length" => "scene.motion.inter_finger_distance".to_owned(),
            setting => format!("scene.estimator.{setting}"),
        },
        Ep2Error::TooFewContacts { .. }
        | Ep2Error::Coincident { .. }
        | Ep2Error::Collinear { .. }
        | Ep2Error::Undetermined { .. } => "scene.motion".to_owned(),
        _ => "scene".to_owned(),
    };
    FieldError::at(path, error)
}

//! Fits a plane, a sphere or a cylinder to contacts by robust least squares, and chooses the most probable of these
//! shapes. The contacts may be on all sides of the object.

mod cells;
mod intervals;
mod lack_of_fit;
mod pose;
mod robust_fit;
mod shape_choice;
mod shape_map;
mod shape_report;
mod start;
mod wave_tests;

use nalgebra::{Point3, Vector3};
use palpate_statistics::evenly_spaced;
use strum::{IntoStaticStr, VariantArray};
use thiserror::Error;

use crate::effective_readings::EffectiveReadings;
use crate::error::LARGEST;
use crate::gross_outliers::{Outlier, OutlierReason, SoundContacts, within_share};
use crate::noise::Resolution;
use crate::patch::direction;
use crate::{Contact, Ep2Error, Noise, NoiseEstimate};
use cells::Rounding;
use lack_of_fit::{LackOfFit, lack_of_fit};
use pose::Cloud;
use robust_fit::{RobustFit, Solution, StatedNoise, robust_fit, solve};
use shape_choice::choose;

/// The most probable shape is chosen with at most this number of contacts.
const MAX_COMPARED: usize = 20_000;
const ITERATIONS: usize = 40;

/// Reasons for which no shape can be fitted to contacts.
#[derive(Clone, Debug, Error, IntoStaticStr, PartialEq)]
#[strum(serialize_all = "kebab-case")]
pub enum ShapeError {
    /// The contacts or the settings are invalid, or there are too few contacts.
    #[error(transparent)]
    #[strum(transparent)]
    Contacts(#[from] Ep2Error),
    /// More than a fifth of the contacts are outliers.
    #[error(
        "{} of {contacts} contacts are outliers, more than a fifth: they may be of two objects, or not of this shape",
        outliers.len()
    )]
    TooManyOutliers {
        /// Number of contacts that were passed to the fit.
        contacts: usize,
        /// Indices of the outliers, counted from 0.
        outliers: Vec<usize>,
    },
}

/// A simple shape that can be fitted to contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "kebab-case")]
pub enum Shape {
    /// A plane.
    Plane,
    /// A sphere.
    Sphere,
    /// A circular cylinder.
    Cylinder,
}

impl Shape {
    /// Number of fitted parameters of the shape.
    pub const fn unknowns(self) -> usize {
        match self {
            Self::Plane => 3,
            Self::Sphere => 4,
            Self::Cylinder => 5,
        }
    }
}

/// Estimated curvature or radius with its 95 % interval. An end of the interval is `None` if the interval is not
/// bounded there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SizeEstimate {
    /// The estimated value; `None` if the contacts do not determine it.
    pub value: Option<f64>,
    /// Standard error of the value; `None` if the noise or the value is not determined.
    pub std: Option<f64>,
    /// Lower and upper end of the 95 % interval.
    pub interval95: [Option<f64>; 2],
}

/// Settings of a fit of shapes to contacts. The weights of the contacts are not used.
#[derive(Clone, Copy, Debug)]
pub struct ShapeSettings {
    /// The shape to fit; with `None`, the most probable shape is chosen.
    pub shape: Option<Shape>,
    /// Radius of a round fingertip whose centres are the positions of the contacts; 0 if the positions are on the
    /// object.
    pub tip_radius: f64,
    /// Direction out of the object, for contacts without normals. In two cases, the direction is not used, and the
    /// object is assumed to be convex: if the object was touched all around, or if the direction is nearly
    /// perpendicular to the mean normal of the fitted shape.
    pub outward: Vector3<f64>,
    /// Stated noise of the contacts.
    pub noise: Noise,
}

impl Default for ShapeSettings {
    fn default() -> Self {
        Self {
            shape: None,
            tip_radius: 0.0,
            outward: Vector3::z(),
            noise: Noise::default(),
        }
    }
}

/// A plane, a sphere or a cylinder that was fitted to contacts.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeFit {
    /// The fitted shape.
    pub shape: Shape,
    /// Probabilities of a plane, a sphere, a cylinder and none of these shapes, in this order; `None` if the shape was
    /// stated.
    pub probabilities: Option<[f64; 4]>,
    /// Curvature (1/length) of the object, > 0 if it is convex. For a sphere, it is the curvature in all directions;
    /// for a cylinder, it is the curvature across the axis. It has no interval if neither a plane nor a sphere nor a
    /// cylinder fits the contacts.
    pub curvature: SizeEstimate,
    /// Radius (length) of the object. Its interval has no upper bound if the curvature may be 0.
    pub radius: SizeEstimate,
    /// Centre of a sphere, point of a cylinder's axis that is nearest to the contacts, or point of a plane that is
    /// nearest to the middle of the contacts. `None` if the contacts do not determine the size of the shape.
    pub place: Option<Point3<f64>>,
    /// Standard errors of the coordinates of `place`.
    pub place_std: Option<[f64; 3]>,
    /// A point of the surface in the middle of the contacts, and the outward normal at this point.
    pub foot: (Point3<f64>, Vector3<f64>),
    /// Axis of a cylinder or normal of a plane; `None` for a sphere.
    pub direction: Option<Vector3<f64>>,
    /// Standard error (rad) of `direction`. A direction has two angles; this is the larger of their standard errors.
    pub direction_std_rad: Option<f64>,
    /// Root mean square distance (length) of the contacts from the shape, without outliers.
    pub rms_misfit: f64,
    /// P-value of the fit: the probability that contacts on an object with exactly this shape would fit worse. It is 1 if
    /// the deviations are below 10⁻⁴ of the spread of the contacts, and those of the normals below 10⁻⁴ rad.
    pub p_value: f64,
    /// Noise of the contacts. It is correct only if the object has the fitted shape. `None` if there are too few
    /// contacts.
    pub noise: Option<NoiseEstimate>,
    /// Number of independent readings among the contacts.
    pub readings: EffectiveReadings,
    /// Contacts that the fit did not use.
    pub outliers: Vec<Outlier>,
    /// Whether the shape is assumed to be convex, because neither normals nor the outward direction determine which side
    /// is outside.
    pub is_side_assumed: bool,
}

impl ShapeFit {
    /// Whether the object is probably neither a plane nor a sphere nor a cylinder: the probability of "none of these"
    /// exceeds 0.5.
    pub fn is_none_of_these(&self) -> bool {
        self.probabilities.is_some_and(|[.., none]| none > 0.5)
    }

    /// The fit with the probabilities of the shapes. If none of the shapes fits, all standard errors and intervals are
    /// removed, because they would be valid only for an object of the fitted shape.
    fn with_probabilities(mut self, probabilities: Option<[f64; 4]>) -> Self {
        self.probabilities = probabilities;
        if self.is_none_of_these() {
            for size in [&mut self.curvature, &mut self.radius] {
                (size.std, size.interval95) = (None, [None; 2]);
            }
            (self.place_std, self.direction_std_rad) = (None, None);
        }
        self
    }
}

/// Contacts, with their spread as the unit of length. The other fields convert results back to the original unit.
struct Scaled {
    cloud: Cloud,
    fingers: Vec<usize>,
    centre: Point3<f64>,
    scale: f64,
}

impl Scaled {
    fn new(contacts: &[Contact], resolution: Resolution) -> Result<Self, Ep2Error> {
        let anchor = contacts
            .first()
            .map_or(Point3::origin(), |one| one.position);
        let count = contacts.len() as f64;
        let mean = contacts.iter().map(|one| (one.position - anchor) / count);
        let centre = anchor + mean.sum::<Vector3<f64>>();
        let extent = contacts.iter().map(|one| (one.position - centre).amax());
        let extent = extent.fold(0.0, f64::max);
        if extent <= 1e-12 * centre.coords.amax() {
            let contacts = contacts.len();
            return Err(Ep2Error::Coincident { contacts, extent });
        }
        let squares = contacts
            .iter()
            .map(|one| ((one.position - centre) / extent).norm_squared());
        let scale = extent * (squares.sum::<f64>() / count).sqrt();
        let places = contacts.iter().map(|one| (one.position - centre) / scale);
        let normals = contacts.iter().filter_map(|one| one.normal);
        // A normal is first divided by its largest component, because the square of a large or small number may exceed
        // the range of doubles.
        let normals = normals.map(|normal| (normal / normal.amax()).normalize());
        Ok(Self {
            cloud: Cloud {
                places: places.collect(),
                normals: normals.collect(),
                resolution: resolution.in_unit(scale),
                rounding_variance: 0.0,
            },
            fingers: contacts.iter().map(|one| one.finger).collect(),
            centre,
            scale,
        })
    }

    fn point(&self, place: &Vector3<f64>) -> Point3<f64> {
        self.centre + place * self.scale
    }
}

struct Candidate {
    solution: Solution,
    lack: LackOfFit,
}

impl ShapeSettings {
    /// Fits the stated shape or, if none is stated, the most probable shape.
    ///
    /// # Errors
    /// [`ShapeError`] if a number is invalid, if there are too few contacts, or if more than a fifth of them are
    /// outliers.
    pub fn fit(&self, contacts: &[Contact]) -> Result<ShapeFit, ShapeError> {
        let is_good = (0.0..=LARGEST).contains(&self.tip_radius);
        Ep2Error::unless_good(
            "tip_radius",
            self.tip_radius,
            is_good,
            ">= 0 and at most 1e150",
        )?;
        direction(&self.outward)?;
        self.enough(contacts)?;
        let sound = SoundContacts::new(contacts)?;
        let all = &sound.distinct.contacts;
        self.enough(all)?;
        if self.shape.is_some() || all.len() <= MAX_COMPARED {
            return self.fit_sound(contacts, sound);
        }
        let selection: Vec<Contact> = evenly_spaced(all.len(), MAX_COMPARED)
            .map(|contact| all[contact])
            .collect();
        // If the fit to the selection fails, fit all contacts, so that the error refers to all contacts.
        let Ok(chosen) = self.fit(&selection) else {
            return self.fit_sound(contacts, sound);
        };
        let stated = Self {
            shape: Some(chosen.shape),
            ..*self
        };
        Ok(stated
            .fit_sound(contacts, sound)?
            .with_probabilities(chosen.probabilities))
    }

    /// Fits the stated shape or, if none is stated, the most probable shape to `sound`, the contacts without gross
    /// outliers. `contacts` also contains the gross outliers.
    fn fit_sound(
        &self,
        contacts: &[Contact],
        sound: SoundContacts,
    ) -> Result<ShapeFit, ShapeError> {
        let count = contacts.len();
        let SoundContacts {
            mut outliers,
            rows,
            distinct,
        } = sound;
        // The means of merged contacts are not rounded, so use the contacts before merging.
        let resolution = Resolution::new(rows.iter().map(|&row| &contacts[row]));
        let scaled = Scaled::new(&distinct.contacts, resolution)?;
        let stated = self.stated(scaled.scale)?;
        let cloud = &scaled.cloud;
        let shapes = match &self.shape {
            Some(shape) => std::slice::from_ref(shape),
            None => Shape::VARIANTS,
        };
        let fits = shapes.iter().map(|&shape| robust_fit(shape, cloud));
        let mut fits: Vec<RobustFit> = fits.collect();
        let to_few: Option<Vec<_>> = fits.iter().map(|fit| fit.inliers_of_few(cloud)).collect();
        let most = |inliers: &Vec<bool>| inliers.iter().filter(|one| **one).count();
        if let Some(inliers) = to_few.and_then(|all| all.into_iter().max_by_key(most)) {
            let runs = distinct.run_of_row.iter().zip(&rows);
            let left = runs.filter(|(run, _)| !inliers[**run]).map(|(_, row)| *row);
            return Err(ShapeError::TooManyOutliers {
                contacts: count,
                outliers: left.collect(),
            });
        }
        let by_noise = |one: &&RobustFit, other: &&RobustFit| {
            let [one, other] = [one, other].map(|fit| fit.solution.variances[0]);
            one.total_cmp(&other)
        };
        let best = fits.iter().min_by(by_noise).unwrap_or(&fits[0]);
        let (best, is_used) = (best.solution, best.is_used.clone());
        // If the contacts contradict the stated noise, the fits do not use it. If the stated noise is too large, the
        // intervals are still computed from it, so they become wider.
        let ratios = best.noise_ratios(stated);
        let of_intervals = [0, 1].map(|kind| stated[kind].filter(|_| ratios[kind] <= 1.0));
        let stated = [0, 1].map(|kind| stated[kind].filter(|_| ratios[kind] == 1.0));
        let runs = distinct.run_of_row.iter().zip(&rows);
        let misfits = runs.filter(|(run, _)| !is_used[**run]);
        outliers.extend(misfits.map(|(_, row)| Outlier {
            contact: *row,
            reason: OutlierReason::Misfit,
        }));
        outliers.sort_by_key(|outlier| outlier.contact);
        let outliers = within_share(outliers, count)?;
        let mut used = cloud.selected(&is_used);
        let fingers = scaled.fingers.iter().zip(&is_used);
        let fingers: Vec<usize> = fingers
            .filter_map(|(one, used)| used.then_some(*one))
            .collect();
        let rounding = Rounding::new(&best, &used, &fingers);
        used.rounding_variance = rounding.variance;
        let mut candidates: Vec<Candidate> = fits
            .drain(..)
            .map(|fit| {
                let solution =
                    match fit.is_used == is_used && stated == [None; 2] && rounding.variance == 0.0
                    {
                        true => fit.solution,
                        false => solve(fit.solution.pose, &used, stated, [1.0; 2], ITERATIONS),
                    };
                let lack = lack_of_fit(&solution, &used, &fingers, &rounding);
                let solution = match lack.correlations == [1.0; 2] {
                    true => solution,
                    false => solve(solution.pose, &used, stated, lack.correlations, ITERATIONS),
                };
                Candidate { solution, lack }
            })
            .collect();
        let (chosen, probabilities) = match self.shape {
            Some(_) => (0, None),
            None => choose(&candidates, stated, &used),
        };
        let candidate = &mut candidates[chosen];
        candidate.solution.pose = candidate.solution.within_noise();
        if of_intervals != stated {
            let (pose, correlations) = (candidate.solution.pose, candidate.lack.correlations);
            candidate.solution = solve(pose, &used, of_intervals, correlations, 0);
        }
        let [position_correlation, normal_correlation] = candidate.lack.with_rounding;
        let readings = EffectiveReadings {
            contacts: count - outliers.len(),
            distinct: used.places.len(),
            position_correlation,
            normal_correlation,
        };
        let outward = direction(&self.outward)?.normalize();
        let fit = self.reported(candidate, &scaled, &used, &rounding, outward);
        let fit = ShapeFit {
            readings,
            outliers,
            ..fit.ok_or(Ep2Error::OutOfRange)?
        };
        Ok(fit.with_probabilities(probabilities))
    }

    fn enough(&self, contacts: &[Contact]) -> Result<(), Ep2Error> {
        let has_normals = contacts.first().is_some_and(|one| one.normal.is_some());
        let per_contact = if has_normals { 3 } else { 1 };
        let equations = per_contact * contacts.len();
        let needed = match self.shape {
            Some(Shape::Plane) => 4,
            Some(Shape::Sphere) => 5,
            Some(Shape::Cylinder) | None => 6,
        };
        if contacts.len() < 3 || equations < needed {
            return Err(Ep2Error::TooFewContacts {
                contacts: contacts.len(),
                equations,
                needed,
            });
        }
        Ok(())
    }

    fn stated(&self, scale: f64) -> Result<StatedNoise, Ep2Error> {
        let Noise {
            position_std,
            normal_std_rad,
        } = self.noise;
        for (name, std) in [
            ("position_std", position_std),
            ("normal_std_rad", normal_std_rad),
        ] {
            let value = std.unwrap_or(1.0);
            let is_good = value > 0.0 && value <= LARGEST;
            Ep2Error::unless_good(name, value, is_good, "> 0 and at most 1e150")?;
        }
        Ok([position_std.map(|std| std / scale), normal_std_rad])
    }
}

//! The methods that estimate curvature from glides (EP2), built from their settings.

use palpate_ep2::{
    Contact, Criterion, Ep2Error, Fit, Method, MisfitTest, Noise, Passes, Patch, Penalised,
    Quadric, RoundTip, Shape, ShapeError, ShapeFit, ShapeSettings, TangentNormals, TwoPass,
};

use nalgebra::Vector3;
use palpate_study::config::{CriterionName, GlideEstimatorConfig, NormalsOf, StatedNoise};

/// A method that estimates curvature from glides, with its settings.
#[derive(Clone, Debug)]
pub enum GlideMethod {
    /// A method that fits the surface as a height function over a plane. All contacts must be on one side of the
    /// object, because the fitted surface has only one height at each point of the plane.
    Graph(GlideFit),
    /// A fit of a simple shape. The contacts may be on all sides of the object.
    Shape(ShapeSettings),
}

impl GlideMethod {
    /// Builds the method that a config describes. If the config states the noise as a fraction of the distance between
    /// fingers, the fraction is multiplied by `inter_finger_distance`. The estimator `two-pass` also uses this distance
    /// as its length unit. If this distance is `None`, `two-pass` computes it from the contacts.
    pub fn of(config: &GlideEstimatorConfig, inter_finger_distance: Option<f64>) -> Self {
        let config = match inter_finger_distance {
            Some(distance) => config.clone().with_length_noise(distance),
            None => config.clone(),
        };
        let (shape, stated) = match config {
            GlideEstimatorConfig::Plane(stated) => (Some(Shape::Plane), stated),
            GlideEstimatorConfig::Sphere(stated) => (Some(Shape::Sphere), stated),
            GlideEstimatorConfig::Cylinder(stated) => (Some(Shape::Cylinder), stated),
            GlideEstimatorConfig::Shape(stated) => (None, stated),
            graph => return Self::Graph(GlideFit::of(graph, inter_finger_distance)),
        };
        Self::Shape(ShapeSettings {
            shape,
            noise: noise(stated),
            ..ShapeSettings::default()
        })
    }

    /// Text that describes the method and its settings.
    pub fn description(&self) -> String {
        match self {
            Self::Graph(graph) => graph.description(),
            Self::Shape(settings) => match settings.shape {
                Some(shape) => format!("{} by robust least squares", <&str>::from(shape)),
                None => "the most probable of plane, sphere and cylinder".to_owned(),
            },
        }
    }
}

/// Fits a simple shape to contacts, or to readings of round fingertips.
///
/// # Errors
/// The errors of [`ShapeSettings::fit`] and [`RoundTip::centres`].
pub fn fit_shape(
    settings: &ShapeSettings,
    tip: Option<&RoundTip>,
    readings: &[Contact],
    outward: &Vector3<f64>,
) -> Result<ShapeFit, ShapeError> {
    let settings = ShapeSettings {
        outward: *outward,
        tip_radius: tip.map_or(0.0, |tip| tip.radius),
        ..*settings
    };
    match tip {
        Some(tip) => settings.fit(&tip.centres(readings, outward)?),
        None => settings.fit(readings),
    }
}

fn noise(noise: StatedNoise) -> Noise {
    Noise {
        position_std: noise.position_std,
        normal_std_rad: noise.normal_std_deg.map(f64::to_radians),
    }
}

/// A method that fits the surface as a height function over a plane, with its settings.
#[derive(Clone, Debug)]
pub enum GlideFit {
    /// A penalised spline that is fitted to all contacts.
    Penalised(Penalised),
    /// The two-pass method of Charlebois, Gupta and Payandeh (1996).
    TwoPass(TwoPass),
    /// A single quadric that is fitted to all contacts.
    Quadric(Quadric),
}

impl Method for GlideFit {
    fn fit(&self, patch: &Patch) -> Result<Fit, Ep2Error> {
        self.method().fit(patch)
    }

    fn misfit(&self, patch: &Patch, fit: Option<&Fit>) -> Result<MisfitTest, Ep2Error> {
        self.method().misfit(patch, fit)
    }
}

impl GlideFit {
    fn method(&self) -> &dyn Method {
        match self {
            Self::Penalised(method) => method,
            Self::TwoPass(method) => method,
            Self::Quadric(method) => method,
        }
    }

    /// Whether the method that a config states uses the distance between fingers.
    pub fn uses_finger_distance(config: &GlideEstimatorConfig) -> bool {
        matches!(config, GlideEstimatorConfig::TwoPass { .. })
            || (config.clone().noise())
                .is_some_and(|noise| noise.position_fraction_of_ifd.is_some())
    }

    /// The same method, but its stated standard deviations of positions and of normals are multiplied by the factors
    /// `position` and `normal`.
    #[must_use]
    pub fn with_noise_factors(mut self, [position, normal]: [f64; 2]) -> Self {
        if let Self::Penalised(Penalised { noise, .. }) | Self::Quadric(Quadric { noise }) =
            &mut self
        {
            noise.position_std = noise.position_std.map(|std| std * position);
            noise.normal_std_rad = noise.normal_std_rad.map(|std| std * normal);
        }
        self
    }

    fn of(config: GlideEstimatorConfig, unit_length: Option<f64>) -> Self {
        match config {
            GlideEstimatorConfig::Penalised {
                intervals,
                criterion,
                gamma,
                noise: stated,
            } => Self::Penalised(Penalised {
                intervals: intervals.map(|intervals| intervals as usize),
                criterion: match criterion {
                    CriterionName::RobustGcv => Criterion::RobustGcv { gamma },
                    CriterionName::Gcv => Criterion::Gcv,
                    CriterionName::Reml => Criterion::Reml,
                },
                noise: noise(stated),
            }),
            GlideEstimatorConfig::TwoPass {
                first_degree,
                second_degree,
                weight,
                smoothing,
                second_smoothing,
                tangent_step,
                normals,
                passes,
            } => Self::TwoPass(TwoPass {
                first_degree: first_degree as usize,
                second_degree: second_degree as usize,
                weight,
                smoothing,
                second_smoothing,
                tangent_step,
                normals: match normals {
                    NormalsOf::Measured => TangentNormals::Measured,
                    NormalsOf::FirstFit => TangentNormals::FirstFit,
                },
                unit_length,
                passes: if passes == 1 {
                    Passes::One
                } else {
                    Passes::Two
                },
                ..TwoPass::default()
            }),
            GlideEstimatorConfig::Quadric(stated)
            | GlideEstimatorConfig::Plane(stated)
            | GlideEstimatorConfig::Sphere(stated)
            | GlideEstimatorConfig::Cylinder(stated)
            | GlideEstimatorConfig::Shape(stated) => Self::Quadric(Quadric {
                noise: noise(stated),
            }),
        }
    }

    fn description(&self) -> String {
        match self {
            Self::Penalised(Penalised {
                criterion, noise, ..
            }) => {
                let criterion = match criterion {
                    Criterion::RobustGcv { gamma } => {
                        format!("robust generalised cross validation (gamma {gamma})")
                    }
                    Criterion::Gcv => "generalised cross validation".to_owned(),
                    Criterion::Reml => "restricted maximum likelihood".to_owned(),
                };
                let noise = match (noise.position_std, noise.normal_std_rad) {
                    (None, None) => "noise estimated from the contacts",
                    (Some(_), Some(_)) => "noise as stated",
                    _ => "noise partly stated, partly estimated from the contacts",
                };
                format!("penalised bicubic spline, penalty weight by {criterion}, {noise}")
            }
            Self::TwoPass(TwoPass {
                first_degree,
                second_degree,
                passes,
                ..
            }) => match passes {
                Passes::One => {
                    format!("smoothing spline of degree {first_degree}, first pass alone")
                }
                Passes::Two => format!(
                    "two-pass smoothing splines of degrees {first_degree} and {second_degree}"
                ),
            },
            Self::Quadric(_) => "least-squares quadric".to_owned(),
        }
    }
}

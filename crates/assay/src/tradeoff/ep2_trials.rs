//! The ladder (list of compared settings) of estimates from contact points (EP2). The settings differ in the fit
//! method, the spline's knots and the number of contacts.

use anyhow::Result;
use palpate_scene::Scene;

use super::ladder::{Ladder, RungError};
use super::scene_trials::{Choice, Measure, outcomes, root_mean, scenes};

const CONTACTS: [u32; 4] = [5, 10, 30, 100];
/// Largest number of contacts per finger for the two-pass method, which takes several seconds with more contacts.
const MAX_OF_TWO_PASS: u32 = 30;
const INTERVALS: [u32; 4] = [2, 4, 6, 8];
/// Numbers of contacts per finger for which several numbers of knot intervals are compared. For other numbers of
/// contacts, the estimator uses its default number of intervals.
const CONTACTS_OF_INTERVALS: [u32; 3] = [10, 30, 100];
/// Smoothing factors of the two-pass method that are compared. Both passes use the same factor. The method adds knots
/// until the residuals are below a limit that is proportional to this factor. The default is 1000.
const SMOOTHINGS: [f64; 2] = [300.0, 3000.0];
const GAUSSIAN: usize = 0;
const MEAN: usize = 1;
const TRIALS: u64 = 40;
const TIMED: u32 = 2;

/// Config lines that all scenes share. `$rung` is replaced by the motion and the estimator of a compared setting.
const COMMON: &str = r#"
kind = "glide"
probe = { kind = "point" }
$rung
"#;

const SCENES: [(&str, &str); 3] = [
    (
        "sphere of radius 5, noise 1 % of the finger distance and 0.5°",
        r#"
object = { kind = "sphere", radius = 5.0 }
noise = { position = { kind = "gaussian", fraction_of_ifd = 0.01 }, normal = { kind = "gaussian", std_deg = 0.5 } }
"#,
    ),
    (
        "saddle z = 0.1 (x² − y²); noise: positions 5 %, normals 2°",
        r#"
object = { kind = "saddle", a = 0.1 }
noise = { position = { kind = "gaussian", fraction_of_ifd = 0.05 }, normal = { kind = "gaussian", std_deg = 2.0 } }
"#,
    ),
    (
        "waves z = 0.15 sin 1.5x cos 1.5y; noise: positions 2 %, normals 2°",
        r#"
object = { kind = "height-field", formula = "0.15*sin(1.5*x)*cos(1.5*y)" }
noise = { position = { kind = "gaussian", fraction_of_ifd = 0.02 }, normal = { kind = "gaussian", std_deg = 2.0 } }
"#,
    ),
];

fn rung(estimator: &str, contacts: u32) -> String {
    format!(
        r#"motion = {{ finger_positions = [-1.5, 0.0, 1.5], inter_finger_distance = 1.0, patch_length = 3.0, contacts_per_finger = {contacts} }}
estimator = {estimator}
evaluate = {{ grid = 15, half_width = 1.0, gaussian_threshold = 0.005, mean_threshold = 0.03 }}"#
    )
}

/// The ladder (list of compared settings) of surface fits. The settings differ in the fit method, the spline's knots
/// and the number of contacts.
pub(super) fn fits() -> Ladder {
    let methods = [
        ("quadric", r#"{ kind = "quadric" }"#),
        ("two-pass", r#"{ kind = "two-pass" }"#),
        ("penalised spline", r#"{ kind = "penalised" }"#),
    ];
    let mut choices: Vec<Choice> = Vec::new();
    for (name, estimator) in methods {
        let is_fast = |contacts: &u32| name != "two-pass" || *contacts <= MAX_OF_TWO_PASS;
        choices.extend(CONTACTS.into_iter().filter(is_fast).map(|contacts| {
            let points = 3 * contacts;
            let text = rung(estimator, contacts);
            Choice::new(format!("{name}, {points} contacts"), text).set(f64::from(points))
        }));
    }
    for contacts in CONTACTS_OF_INTERVALS {
        choices.extend(INTERVALS.map(|intervals| {
            let estimator = format!(r#"{{ kind = "penalised", intervals = {intervals} }}"#);
            let name = format!(
                "penalised spline, {intervals}² spline cells, {} contacts",
                3 * contacts
            );
            Choice::new(name, rung(&estimator, contacts)).set(f64::from(intervals))
        }));
    }
    for contacts in [10, MAX_OF_TWO_PASS] {
        choices.extend(SMOOTHINGS.map(|smoothing| {
            let estimator = format!(
                r#"{{ kind = "two-pass", smoothing = {smoothing:e}, second_smoothing = {smoothing:e} }}"#
            );
            let name = format!("two-pass, smoothing = {smoothing}, {} contacts", 3 * contacts);
            Choice::new(name, rung(&estimator, contacts)).set(smoothing)
        }));
    }
    let measure = Measure {
        error: |scene, trials| shape_error(scene, trials),
        trials: TRIALS,
        timed: TIMED,
    };
    Ladder {
        name: "fits",
        title: "Which fit of a surface, and how many contacts?",
        error: "larger rms error of H over the curvedness C and of K over C²; two-pass only up to 90 contacts, because more take seconds",
        evaluation: "one trial: readings, fit, and a map of 15 × 15 points",
        scenes: scenes(COMMON, SCENES, &choices, measure),
    }
}

/// Sums over all points of one trial's curvature map: of the squared errors, and of the squared true values.
#[derive(Default)]
struct Squares {
    gaussian: f64,
    mean: f64,
    /// The sums Σ C² and Σ C⁴ over the points of the map, where C is the true curvedness. It is computed from C² = 2H²
    /// − K, with the mean curvature H and the Gaussian curvature K.
    curvedness: [f64; 2],
}

impl Squares {
    fn add(&mut self, gaussian: [f64; 2], mean: [f64; 2]) {
        let [[k, true_k], [h, true_h]] = [gaussian, mean];
        self.gaussian += (k - true_k).powi(2);
        self.mean += (h - true_h).powi(2);
        let square = 2.0 * true_h * true_h - true_k;
        self.curvedness[0] += square;
        self.curvedness[1] += square * square;
    }

    /// Squares of two relative errors of one trial. The first is the rms error of the mean curvature, divided by the
    /// rms of the true curvedness C. The second is the rms error of the Gaussian curvature, divided by the rms of C².
    fn shares(&self) -> [f64; 2] {
        [
            self.mean / self.curvedness[0],
            self.gaussian / self.curvedness[1],
        ]
    }
}

/// The larger of two relative errors. The first is the rms error of the mean curvature, divided by the rms of the true
/// curvedness C. The second is the rms error of the Gaussian curvature, divided by the rms of C². All trials must have
/// the same true curvatures.
fn larger(trials: &[Squares]) -> Result<RungError> {
    let [mean, gaussian] = [0, 1].map(|which| {
        let shares = trials.iter().map(|squares| squares.shares()[which]);
        root_mean(&shares.collect::<Vec<f64>>())
    });
    let (mean, gaussian) = (mean?, gaussian?);
    Ok(match mean.error > gaussian.error {
        true => mean,
        false => gaussian,
    })
}

fn shape_error(scene: &Scene, trials: u64) -> Result<RungError> {
    let outcomes = outcomes(scene, trials)?;
    let trials = outcomes.iter().map(|trial| {
        let of = |quantity: usize| {
            let of_it = trial.iter().filter(move |(index, _)| *index == quantity);
            of_it.map(|(_, outcome)| [outcome.estimate, outcome.truth])
        };
        let mut squares = Squares::default();
        of(GAUSSIAN)
            .zip(of(MEAN))
            .for_each(|(gaussian, mean)| squares.add(gaussian, mean));
        squares
    });
    larger(&trials.collect::<Vec<Squares>>())
}

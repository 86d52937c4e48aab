//! Makes small studies in memory, and checks their scores, figures and errors.

use palpate_report::{Files, Score, Study, Verdict, figures, score};

pub(crate) const STATISTICS: &str = "truth,trials,failures,mean,std,bias,rms_error,rms_error_std,mean_abs_error,\
    relative_rms_error,relative_mean_abs_error,q05,q50,q95,mean_reported_std,coverage50,coverage80,coverage95";

/// A config with a spherical probe of radius 1 and an object of this `kind`. The text `rest` is inserted before the
/// scene.
pub(crate) fn config(kind: &str, rest: &str) -> String {
    format!(
        "name = \"study\"\ntitle = \"A question?\"\nsource = \"somewhere\"\nseed = 7\ncrate_version = \"0.1.0\"\n{rest}\n\
         [scene]\nkind = \"roll\"\nprobe = {{ kind = \"sphere\", radius = 1.0 }}\nobject = {{ kind = \"{kind}\" }}\n\
         noise = {{ angular_velocity = {{ kind = \"uniform\", fraction = 0.01 }} }}\n\
         motion = {{ rate_rad_per_s = 0.1, duration_s = 1.0 }}\n"
    )
}

/// Builds the text of `cells.csv` with one row per cell, and the text of `failures.csv`.
pub(crate) struct Cells {
    text: String,
    failures: String,
    rows: usize,
}

#[derive(Clone, Copy, Default)]
pub(crate) struct Numbers {
    pub(crate) truth: Option<f64>,
    pub(crate) trials: u64,
    pub(crate) failures: u64,
    pub(crate) mean: Option<f64>,
    pub(crate) std: Option<f64>,
    pub(crate) rms: Option<f64>,
    pub(crate) abs: Option<f64>,
    pub(crate) quantiles: Option<[f64; 3]>,
    pub(crate) coverage: Option<f64>,
    pub(crate) bound: Option<f64>,
}

impl Numbers {
    pub(crate) fn new(truth: f64, error: f64) -> Self {
        Self {
            truth: Some(truth),
            trials: 100,
            mean: Some(truth * (1.0 + error)),
            rms: Some(error),
            abs: Some(error),
            coverage: Some(0.95),
            ..Self::default()
        }
    }
}

impl Cells {
    pub(crate) fn new(axes: &str) -> Self {
        Self {
            text: format!("cell,{axes},quantity,unit,{STATISTICS},std_bound\n"),
            failures: NO_FAILURES.to_owned(),
            rows: 0,
        }
    }

    /// Adds a cell with the quantity `normal_curvature_u`. `place` are the swept values, separated by commas. Failed
    /// trials have the kind `unresolved`.
    pub(crate) fn push(&mut self, place: &str, numbers: Numbers) {
        self.push_of(place, "normal_curvature_u,1/cm", numbers, "unresolved");
    }

    /// Adds a cell with another quantity, given as `quantity,unit`. `failure` is the kind of its failed trials.
    pub(crate) fn push_of(&mut self, place: &str, quantity: &str, of: Numbers, failure: &str) {
        let Numbers {
            trials, failures, ..
        } = of;
        let quantiles = of.quantiles.map_or([None; 3], |all| all.map(Some));
        let truth = |share: f64| Some(share * of.truth?);
        let numbers = [
            of.mean,
            of.std,
            of.mean.zip(of.truth).map(|(mean, truth)| mean - truth),
            of.rms.and_then(truth),
            None,
            of.abs.and_then(truth),
            of.rms,
            of.abs,
            quantiles[0],
            quantiles[1],
            quantiles[2],
            of.rms.and_then(truth),
            None,
            None,
            of.coverage,
            of.bound,
        ];
        let text = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
        let cell = self.rows;
        self.rows += 1;
        self.text += &format!(
            "{cell},{place},{quantity},{},{trials},{failures},{}\n",
            text(of.truth),
            numbers.map(text).join(","),
        );
        if failures > 0 {
            self.failures += &format!("{cell},{failure},{failures},0\n");
        }
    }

    pub(crate) fn text(&self) -> String {
        self.text.clone()
    }

    pub(crate) fn study(&self, config: &str) -> Study {
        study(config, &self.text, &self.failures, &[])
    }

    pub(crate) fn study_with(&self, config: &str, map: &str) -> Study {
        study(config, &self.text, &self.failures, &[("map.csv", map)])
    }
}

pub(crate) const NO_FAILURES: &str = "cell,kind,count,first_trial\n";

pub(crate) fn study(config: &str, cells: &str, failures: &str, others: &[(&str, &str)]) -> Study {
    let files = [
        ("run.toml", config),
        ("cells.csv", cells),
        ("failures.csv", failures),
    ];
    Study::read(Files::in_memory(files.iter().chain(others).copied())).unwrap()
}

/// A value that has exactly one score: a score itself, or a study with only one claim.
pub(crate) trait Scored {
    fn score(&self) -> Score;
}

impl Scored for Score {
    fn score(&self) -> Score {
        self.clone()
    }
}

impl Scored for Study {
    fn score(&self) -> Score {
        let scores = score(std::slice::from_ref(self));
        assert_eq!(scores.len(), 1);
        scores[0].clone()
    }
}

#[track_caller]
fn has_verdict(score: &Score, verdict: Verdict, parts: &[&str]) {
    assert_eq!(score.verdict, verdict, "{score:?}");
    for part in parts {
        let said = score.measured.contains(part) || score.why.contains(part);
        assert!(said, "{part:?} is not in {score:?}");
    }
}

#[track_caller]
pub(crate) fn holds(of: &impl Scored, parts: &[&str]) {
    has_verdict(&of.score(), Verdict::Holds, parts);
}

#[track_caller]
pub(crate) fn differs(of: &impl Scored, parts: &[&str]) {
    has_verdict(&of.score(), Verdict::Differs, parts);
}

#[track_caller]
pub(crate) fn untestable(of: &impl Scored, parts: &[&str]) {
    has_verdict(&of.score(), Verdict::NotTestable, parts);
}

#[track_caller]
pub(crate) fn drawn(study: &Study) -> String {
    figures(study).unwrap().remove(0).svg
}

/// Checks that drawing a study fails, and that the error message contains these texts.
#[track_caller]
pub(crate) fn refused(study: &Study, parts: &[&str]) {
    says(&figures(study).unwrap_err().to_string(), parts);
}

#[track_caller]
pub(crate) fn says(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "{part:?} is not in: {text}");
    }
}

#[track_caller]
pub(crate) fn shows(svg: &str, texts: &[&str]) {
    for text in texts {
        assert!(
            svg.contains(&format!("\n{text}\n")),
            "{text:?} is not shown"
        );
    }
}

pub(crate) fn count(svg: &str, element: &str, colour: &str) -> usize {
    let is_one = |line: &&str| line.starts_with(&format!("<{element} ")) && line.contains(colour);
    svg.lines().filter(is_one).count()
}

pub(crate) fn attribute(element: &str, name: &str) -> f64 {
    let text = element.split(&format!(" {name}=\"")).nth(1).unwrap();
    text.split('"').next().unwrap().parse().unwrap()
}

/// A study that sweeps radii and noises. Its errors are not simulated: they are the values that the theory of
/// Charlebois et al. (1996) predicts. The text `rest` is added to its config.
pub(crate) fn angular_velocity(rest: &str) -> Study {
    let mut cells = Cells::new("scene.object.radius_cm,scene.noise.angular_velocity.fraction");
    for radius in [500.0, 50.0, 5.0, 0.5] {
        for noise in [0.001, 0.01, 0.1] {
            let rms = noise * (1.0 + radius) / 12f64.sqrt();
            let numbers = Numbers {
                abs: Some(0.8 * rms),
                ..Numbers::new(1.0 / radius, rms)
            };
            cells.push(&format!("{radius},{noise}"), numbers);
        }
    }
    cells.study(&config("sphere", rest))
}

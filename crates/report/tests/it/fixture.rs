//! Small studies in memory, and checks of their scores, figures and errors.

use palpate_report::{Files, Score, Study, Verdict, figures, score};

pub(crate) const STATISTICS: &str = "truth,trials,failures,mean,std,bias,rms_error,rms_error_std,mean_abs_error,\
    relative_rms_error,relative_mean_abs_error,q05,q50,q95,mean_reported_std,coverage50,coverage80,coverage95";

/// A config with a spherical probe of radius 1 and an object of `kind`.
pub(crate) fn config(kind: &str, rest: &str) -> String {
    format!(
        "name = \"study\"\ntitle = \"A question?\"\nsource = \"somewhere\"\nseed = 7\ncrate_version = \"0.1.0\"\n{rest}\n\
         [scene]\nkind = \"roll\"\nprobe = {{ kind = \"sphere\", radius = 1.0 }}\nobject = {{ kind = \"{kind}\" }}\n\
         noise = {{ angular_velocity = {{ kind = \"uniform\", fraction = 0.01 }} }}\n\
         motion = {{ rate_rad_per_s = 0.1, duration_s = 1.0 }}\n"
    )
}

/// Builder of a table with one row of `normal_curvature_u` per cell.
pub(crate) struct Cells {
    header: String,
    rows: Vec<String>,
    failures: Vec<String>,
}

/// Numbers of a row, without its swept values.
#[derive(Clone, Copy)]
pub(crate) struct Numbers {
    pub(crate) truth: f64,
    pub(crate) trials: u64,
    pub(crate) failures: u64,
    pub(crate) mean: Option<f64>,
    /// Relative rms error.
    pub(crate) rms: Option<f64>,
    /// Mean relative |error|.
    pub(crate) abs: Option<f64>,
}

impl Numbers {
    pub(crate) fn new(truth: f64, error: f64) -> Self {
        let mean = Some(truth * (1.0 + error));
        Self {
            truth,
            trials: 100,
            failures: 0,
            mean,
            rms: Some(error),
            abs: Some(error),
        }
    }
}

impl Cells {
    pub(crate) fn new(axes: &str) -> Self {
        Self {
            header: format!("cell,{axes},quantity,unit,{STATISTICS}"),
            rows: Vec::new(),
            failures: Vec::new(),
        }
    }

    pub(crate) fn push(&mut self, place: &str, numbers: Numbers) {
        let Numbers {
            truth,
            trials,
            failures,
            mean,
            rms,
            abs,
        } = numbers;
        let cell = self.rows.len();
        let text = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
        let times = |value: Option<f64>| text(value.map(|value| value * truth));
        self.rows.push(format!(
            "{cell},{place},normal_curvature_u,1/cm,{truth},{trials},{failures},{},,{},{},,{},{},{},,,,{},,,0.95",
            text(mean),
            text(mean.map(|mean| mean - truth)),
            times(rms),
            times(abs),
            text(rms),
            text(abs),
            times(rms),
        ));
        if failures > 0 {
            self.failures
                .push(format!("{cell},unresolved,{failures},0"));
        }
    }

    pub(crate) fn text(&self) -> String {
        format!("{}\n{}\n", self.header, self.rows.join("\n"))
    }

    pub(crate) fn study(&self, config: &str) -> Study {
        let failures = format!("{NO_FAILURES}{}\n", self.failures.join("\n"));
        study(config, &self.text(), &failures, &[])
    }
}

pub(crate) const NO_FAILURES: &str = "cell,kind,count,first_trial\n";

/// A study of these three files, and others by name.
pub(crate) fn study(config: &str, cells: &str, failures: &str, others: &[(&str, &str)]) -> Study {
    let files = [
        ("run.toml", config),
        ("cells.csv", cells),
        ("failures.csv", failures),
    ];
    Study::read(Files::in_memory(files.iter().chain(others).copied())).unwrap()
}

/// One claim's score, or the only one of a study.
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
fn judged(score: &Score, verdict: Verdict, parts: &[&str]) {
    assert_eq!(score.verdict, verdict, "{score:?}");
    for part in parts {
        let said = score.measured.contains(part) || score.why.contains(part);
        assert!(said, "{part:?} is not in {score:?}");
    }
}

#[track_caller]
pub(crate) fn holds(of: &impl Scored, parts: &[&str]) {
    judged(&of.score(), Verdict::Holds, parts);
}

#[track_caller]
pub(crate) fn differs(of: &impl Scored, parts: &[&str]) {
    judged(&of.score(), Verdict::Differs, parts);
}

#[track_caller]
pub(crate) fn untestable(of: &impl Scored, parts: &[&str]) {
    judged(&of.score(), Verdict::NotTestable, parts);
}

/// The study's first figure as SVG.
#[track_caller]
pub(crate) fn drawn(study: &Study) -> String {
    figures(study).unwrap().remove(0).svg
}

/// Checks that a study cannot be drawn, and that the error contains these texts.
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

/// Lines of text in a picture.
#[track_caller]
pub(crate) fn shows(svg: &str, texts: &[&str]) {
    for text in texts {
        assert!(
            svg.contains(&format!("\n{text}\n")),
            "{text:?} is not shown"
        );
    }
}

/// Number of elements of a colour.
pub(crate) fn count(svg: &str, element: &str, colour: &str) -> usize {
    let is_one = |line: &&str| line.starts_with(&format!("<{element} ")) && line.contains(colour);
    svg.lines().filter(is_one).count()
}

/// Number in an attribute of an element.
pub(crate) fn attribute(element: &str, name: &str) -> f64 {
    let text = element.split(&format!(" {name}=\"")).nth(1).unwrap();
    text.split('"').next().unwrap().parse().unwrap()
}

/// Study over radii and noises, with the errors that theory predicts. The config also contains `rest`.
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

//! Makes a self-contained HTML page about several studies.

use crate::{Figure, ReportError, Score, Study, Verdict, figures, score};
use crate::{page_sections, phrases, plot};
use minijinja::value::Value;
use minijinja::{Environment, context};
use palpate_study::number::grouped;
use std::collections::{BTreeMap, BTreeSet};

/// Makes the HTML page about some studies. It shows the scorecard and, for each study, its source, number of trials,
/// figures, failures and config. Further sections show the coverage of each estimator's intervals and the glossary of
/// `palpate explain`. If all studies are in the same folder, and this folder contains `tradeoff/` or `peers.csv`, a
/// section shows the measurements in these files. The page contains no scripts and loads no other files.
///
/// ```
/// use palpate_report::{Files, Study, page};
///
/// # let root = tempfile::tempdir()?;
/// # let dir = root.path().join("ball");
/// # std::fs::create_dir(&dir)?;
/// # let config = "name = \"ball\"\ntitle = \"How round is the ball?\"\nclaims = [99]\n";
/// # std::fs::write(dir.join("run.toml"), config)?;
/// # std::fs::write(dir.join("failures.csv"), "cell,kind,count,first_trial\n")?;
/// # let statistics = "truth,trials,failures,mean,std,bias,rms_error,rms_error_std,mean_abs_error,relative_rms_error,\
/// #     relative_mean_abs_error,q05,q50,q95,mean_reported_std,coverage50,coverage80,coverage95";
/// # let row = format!("0,curvature,1/mm,0.2,9,0,0.25{}", ",".repeat(14));
/// # std::fs::write(dir.join("cells.csv"), format!("cell,quantity,unit,{statistics}\n{row}\n"))?;
/// let study = Study::read(Files::in_folder(&dir))?;
/// let html = page(&[study])?;
/// assert!(html.contains("How round is the ball?"));
/// assert!(!html.contains("<script"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ReportError`] if a plot of a study cannot be drawn, as for [`figures()`](crate::figures()), or if a table of
/// measurements is malformed.
pub fn page(studies: &[Study]) -> Result<String, ReportError> {
    let mut environment = Environment::new();
    // The name of the template ends in .html so that the template engine escapes HTML.
    environment.add_template("page.html", include_str!("../templates/page.html"))?;
    for (name, text) in [
        (
            "measurements.html",
            include_str!("../templates/measurements.html"),
        ),
        (
            "calibration.html",
            include_str!("../templates/calibration.html"),
        ),
        ("glossary.html", include_str!("../templates/glossary.html")),
    ] {
        environment.add_template(name, text)?;
    }
    let sections = studies
        .iter()
        .map(section)
        .collect::<Result<Vec<Value>, ReportError>>()?;
    let scored = score(studies);
    let scores: Vec<Value> = scored.iter().map(|score| row(score, studies)).collect();
    let claims: BTreeSet<u32> = scored.iter().map(|score| score.claim).collect();
    let claims = claims.len();
    let counts = counts(&scored);
    let measured = page_sections::folder(studies)
        .map(|folder| page_sections::measurements(&folder))
        .transpose()?;
    let calibration = page_sections::coverage(studies)?;
    let glossary = page_sections::glossary();
    let on_dark = plot::on_dark().into_iter();
    let on_dark: Vec<[String; 2]> = on_dark
        .map(|(white, dark)| [plot::hex(white), plot::hex(dark)])
        .collect();
    let dark = plot::hex(plot::DARK);
    let template = environment.get_template("page.html")?;
    Ok(template.render(context! {
        scores, claims, counts, studies => sections, calibration, measured, glossary, dark, on_dark
    })?)
}

fn counts(scores: &[Score]) -> String {
    let all = [Verdict::Holds, Verdict::Differs, Verdict::NotTestable];
    let counted = all.map(|verdict| {
        let count = scores.iter().filter(|score| score.verdict == verdict);
        (count.count(), verdict)
    });
    let said = counted.iter().filter(|(count, _)| *count > 0);
    let said = said.map(|(count, verdict)| match verdict {
        Verdict::Holds if *count != 1 => format!("{count} hold"),
        Verdict::Differs if *count != 1 => format!("{count} differ"),
        verdict => format!("{count} {verdict}"),
    });
    said.collect::<Vec<_>>().join(", ")
}

fn row(score: &Score, studies: &[Study]) -> Value {
    let place = studies.iter().position(|study| study.name() == score.study);
    let section = place.map_or(0, |at| at + 1);
    let source = place.map_or("", |at| studies[at].source());
    let class = match score.verdict {
        Verdict::Holds => "holds",
        Verdict::Differs => "differs",
        Verdict::NotTestable => "open",
    };
    context! {
        claim => score.claim,
        study => &score.study,
        section,
        source,
        paper_says => &score.paper_says,
        measured => &score.measured,
        why => &score.why,
        verdict => score.verdict.to_string(),
        class,
    }
}

fn section(study: &Study) -> Result<Value, ReportError> {
    let shown = |figure: Figure| {
        let least = least_width(&figure);
        let svg = Value::from_safe_string(figure.svg);
        context! { title => figure.title, svg, least }
    };
    let figures: Vec<Value> = figures(study)?.into_iter().map(shown).collect();
    let mut kinds: BTreeMap<&str, (u64, usize)> = BTreeMap::new();
    for failure in study.failures() {
        let (trials, cells) = kinds.entry(&failure.kind).or_default();
        *trials = trials.saturating_add(failure.count);
        *cells += 1;
    }
    let failures: Vec<Value> = kinds
        .into_iter()
        .map(|(kind, (trials, cells))| context! { kind, word => page_sections::address(kind), trials => grouped(trials), cells => grouped(cells as u64) })
        .collect();
    let setting = |key: &str| {
        study
            .setting(key)
            .map(|value| value.to_string().trim_matches('"').to_owned())
    };
    let table = study.cells();
    let trials = (0..table.rows()).filter_map(|row| table.statistic(row, "trials"));
    Ok(context! {
        name => study.name(),
        title => study.title(),
        source => study.source(),
        cells => grouped(cells(study)),
        sample => phrases::sample(trials, "cell"),
        seed => setting("seed"),
        version => setting("crate_version"),
        figures,
        failures,
        config => study.config_text(),
    })
}

fn cells(study: &Study) -> u64 {
    let table = study.cells();
    let mut cells: Vec<u64> = (0..table.rows()).map(|row| table.cell(row)).collect();
    cells.sort_unstable();
    cells.dedup();
    cells.len() as u64
}

/// Smallest ratio of the displayed width of a figure on the page to its original width. At this ratio, the font size of
/// the figure's text is 11 pixels. On a screen that is too narrow for this scale, the reader scrolls the figure
/// sideways.
const LEAST_SCALE: f64 = 0.61;

pub(crate) fn least_width(figure: &Figure) -> f64 {
    (LEAST_SCALE * figure.width()).ceil()
}

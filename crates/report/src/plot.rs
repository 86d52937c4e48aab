//! Figures: the plots in the `[[plot]]` tables of studies, and figures of other results.

mod answer_figure;
mod bars;
mod captions;
mod chart;
mod class_grid;
mod class_map;
mod class_surface;
mod contact_table;
mod contacts;
mod coverage_plot;
mod default_plot;
mod drawing;
mod heat;
mod label_placement;
mod lettering;
mod lines;
mod pareto;
mod press_trace;
mod profile;
mod reference_lines;
mod scale;
mod selection;
mod series;
mod sheet;
mod space;
mod style;
mod symbol;
mod uncertainty;

use crate::{Files, ReportError, Study};
use palpate_study::config::{PlotConfig, PlotKind};
use selection::Request;

pub use answer_figure::{
    AnswerChart, AnswerFigure, CurveLine, CurvePoint, FieldAxis, MapPanel, Stretch, answer_figure,
};
pub(crate) use captions::swept_values;
pub(crate) use coverage_plot::figure as coverage_figure;
pub use drawing::Figure;
pub use heat::HeatPanel;
pub(crate) use pareto::figures as pareto_figures;
pub use pareto::tradeoff_figures;
pub use press_trace::press_figures;
pub(crate) use style::{DARK, hex, on_dark};

/// Draws every `[[plot]]` of the study, in the order of the config. A study without a `[[plot]]` gets one figure. It
/// shows the relative rms error of the object's curvature over the first swept field. It has one line for each value of
/// the second swept field, and one panel for each value of the third.
///
/// Plots of the kinds `class-map`, `class-surface` and `profile` show `map.csv`; plots of the kind `contacts` show
/// `trace.csv` and `readings.csv`. The bytes of an SVG depend only on the study's tables and `run.toml`.
///
/// # Errors
/// [`ReportError`] if a `[[plot]]` is invalid, names a column that does not exist, or selects several rows for one point.
/// In the last case, the error names the swept fields in which the rows differ. Also an error if a table that the plot
/// needs is missing or invalid.
pub fn figures(study: &Study) -> Result<Vec<Figure>, ReportError> {
    let mut plots = study.plots()?;
    if plots.is_empty() {
        plots.extend(default_plot::plot(study)?);
    }
    let draw = |(at, plot): (usize, &PlotConfig)| {
        let name = plot.name.clone().unwrap_or(format!("plot-{}", at + 1));
        one(study, plot, &name)
    };
    plots.iter().enumerate().map(draw).collect()
}

/// Draws one plot from tables in memory, without reading or writing files. `tables` must contain `cells.csv`. Some kinds
/// of plots also need `map.csv`, or `trace.csv` and `readings.csv`. If `run.toml` is among the tables, the captions use
/// its settings.
///
/// ```
/// use palpate_report::{Files, figure};
/// use palpate_study::config::plots;
///
/// let plot = plots("plot.toml", "[[plot]]\nx = \"scene.object.radius\"\ny = \"mean\"\n")?;
/// let statistics = "truth,trials,failures,mean,std,bias,rms_error,rms_error_std,mean_abs_error,relative_rms_error,\
///     relative_mean_abs_error,q05,q50,q95,mean_reported_std,coverage50,coverage80,coverage95";
/// let row = |radius: f64, mean: f64| format!("0,{radius},curvature,1/mm,0.2,9,0,{mean}{}\n", ",".repeat(14));
/// let header = format!("cell,scene.object.radius_mm,quantity,unit,{statistics}\n");
/// let cells = header + &row(5.0, 0.21) + &row(10.0, 0.11);
///
/// let svg = figure(&plot[0], Files::in_memory([("cells.csv", cells)]))?.svg;
/// assert!(svg.starts_with("<svg"));
/// assert!(svg.contains("object radius (mm)") && svg.contains("mean estimate of curvature (1/mm)"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ReportError`] if the plot names an unknown column or selects several rows for one point, or if a table is missing or
/// malformed.
pub fn figure(plot: &PlotConfig, tables: Files) -> Result<Figure, ReportError> {
    let name = plot.name.as_deref().unwrap_or("plot");
    let others = [
        ("run.toml", "name = \"figure\"\n"),
        ("failures.csv", NO_FAILURES),
    ];
    one(&Study::read(tables.or(others))?, plot, name)
}

const NO_FAILURES: &str = "cell,kind,count,first_trial\n";

fn one(study: &Study, plot: &PlotConfig, name: &str) -> Result<Figure, ReportError> {
    let of = Request { study, plot, name };
    let kind = plot.kind;
    let found = study.setting("scene.kind").and_then(toml::Value::as_str);
    if let (Some(wanted), Some(found)) = (kind.scene(), found)
        && wanted != found
    {
        let kind = <&str>::from(kind);
        return Err(of.bad(format!(
            "kind {kind:?} needs a scene of kind {wanted}, and the scene of this study is a {found}"
        )));
    }
    match kind {
        PlotKind::Lines => lines::figure(of),
        PlotKind::ClassMap => class_map::figure(of),
        PlotKind::ClassSurface => class_surface::figure(of),
        PlotKind::Contacts => contacts::figure(of),
        PlotKind::Profile => profile::figure(of),
    }
}

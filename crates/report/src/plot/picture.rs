//! A picture of any kind, ready to be drawn.

use super::canvas::{Canvas, Drawn};
use super::figure::Figure;
use super::fronts::Fronts;
use super::layout::Layout;
use super::press_trace::Quiver;
use super::spec::Plot;
use super::{class_map, compose, contacts, draw, profile};
use crate::{ReportError, Study};
use plotters::prelude::DrawingBackend;

/// A picture with the place of everything in it.
pub(crate) enum Picture {
    Lines(Box<(Figure, Layout)>),
    /// Figures below each other, at least one.
    Stack(Vec<(Figure, Layout)>),
    ClassMap(class_map::Layout),
    Contacts(contacts::Layout),
    Quiver(Box<Quiver>),
    Fronts(Box<Fronts>),
}

impl Picture {
    /// The picture that `plot` asks for.
    pub(crate) fn of(study: &Study, plot: &Plot) -> Result<Self, ReportError> {
        check_scene(study, plot)?;
        let lines = |figure: Figure| {
            let layout = Layout::of(&figure);
            Self::Lines(Box::new((figure, layout)))
        };
        Ok(match plot {
            Plot::Lines(spec) => lines(compose::figure(study, spec)?),
            Plot::Profile(spec) => lines(profile::figure(study, spec)?),
            Plot::ClassMap(spec) => Self::ClassMap(class_map::layout(study, spec)?),
            Plot::Contacts(heading) => Self::Contacts(contacts::layout(study, heading)?),
        })
    }

    /// File stem.
    pub(crate) fn name(&self) -> &str {
        match self {
            Self::Lines(lines) => &lines.0.name,
            Self::Stack(figures) => figures.first().map_or("", |first| &first.0.name),
            Self::ClassMap(map) => &map.name,
            Self::Contacts(contacts) => &contacts.name,
            Self::Quiver(_) => "quiver",
            Self::Fronts(fronts) => &fronts.name,
        }
    }

    pub(crate) fn title(&self) -> &str {
        match self {
            Self::Lines(lines) => &lines.0.title,
            Self::Stack(figures) => figures.first().map_or("", |first| &first.0.title),
            Self::ClassMap(map) => &map.title_text,
            Self::Contacts(contacts) => &contacts.title_text,
            Self::Quiver(quiver) => &quiver.title,
            Self::Fronts(fronts) => &fronts.title_text,
        }
    }

    /// Its SVG with titles of what has no name beside it.
    pub(crate) fn titled(&self, svg: String) -> String {
        match self {
            Self::Fronts(fronts) => fronts.titled(&svg),
            _ => svg,
        }
    }

    /// Width and height in pixels.
    pub(crate) fn size(&self) -> (f64, f64) {
        match self {
            Self::Lines(lines) => lines.1.size,
            Self::Stack(figures) => figures.last().map_or((1.0, 1.0), |last| last.1.size),
            Self::ClassMap(map) => map.size,
            Self::Contacts(contacts) => contacts.size,
            Self::Quiver(quiver) => quiver.size,
            Self::Fronts(fronts) => fronts.size,
        }
    }

    pub(crate) fn draw<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Drawn {
        match self {
            Self::Lines(lines) => {
                canvas.fill(draw::WHITE)?;
                draw::draw(&lines.0, &lines.1, canvas)
            }
            Self::Stack(figures) => {
                canvas.fill(draw::WHITE)?;
                let mut all = figures.iter();
                all.try_for_each(|(figure, layout)| draw::draw(figure, layout, canvas))
            }
            Self::ClassMap(map) => class_map::draw(map, canvas),
            Self::Contacts(picture) => contacts::draw(picture, canvas),
            Self::Quiver(quiver) => quiver.draw(canvas),
            Self::Fronts(fronts) => fronts.draw(canvas),
        }
    }
}

/// A plot is not drawn from the map or the trace of another kind of scene.
fn check_scene(study: &Study, plot: &Plot) -> Result<(), ReportError> {
    let found = study.setting("scene.kind").and_then(toml::Value::as_str);
    match (plot.needs(), found) {
        (Some((kind, wanted)), Some(found)) if wanted != found => Err(ReportError::BadPlot {
            path: study.run_toml(),
            plot: plot.name().to_owned(),
            problem: format!(
                "kind {kind:?} is drawn from a {wanted}, and the scene of this study is a {found}"
            ),
        }),
        _ => Ok(()),
    }
}

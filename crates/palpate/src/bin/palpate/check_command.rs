//! Implements the command `palpate check`.

use std::fmt::Write;
use std::time::Instant;

use palpate::config::ModelConfig;
use palpate::{Accuracy, Check, Coverage, Ladder, Rungs, load};

use crate::answer_commands::note_ignored_fields;
use crate::budget::runner;
use crate::cli::CheckArgs;
use crate::duration::{roughly, short, two_digits};
use crate::failure::Failure;
use crate::{output, progress};

/// Largest number of groups that are printed one by one; the other groups are only counted. The cells of a group need
/// the same models.
const MAX_GROUPS: usize = 50;

pub(crate) fn check(args: &CheckArgs) -> Result<(), Failure> {
    let start = Instant::now();
    let study = load(&args.config).map_err(Failure::usage)?;
    note_ignored_fields(&study, std::iter::empty());
    let runner = runner(None)?;
    let check = progress::counting("cells", |progress| {
        palpate::check(&study, &runner, &|| start.elapsed(), progress)
    })
    .map_err(Failure::of_sweep)?;
    output::print(&text(&study.config.name, &check))
}

/// The text that `palpate check` prints. If only a sample of the cells was checked, the text states how the sample was
/// chosen.
fn text(name: &str, check: &Check) -> String {
    let mut text = String::new();
    let (mut not_set_up, mut at_most) = (String::new(), "");
    if check.set_up < check.cells {
        not_set_up = format!("; {} were set up, to save time", check.set_up);
        at_most = "at most ";
    }
    let _ = writeln!(text, "study   {name}");
    let _ = writeln!(
        text,
        "cells   {}; {} of them run a single trial{not_set_up}",
        check.cells, check.single
    );
    if check.checked < check.cells {
        let _ = writeln!(
            text,
            "sample  each swept value is checked against the limits of its field; all fields together are checked in {} cells:\n        cells with each value of an axis, cells with both ends of every two axes, and cells spread evenly;\n        {} of these cells were set up, as many as one second allows. `run` checks every other cell before its trials",
            check.checked, check.set_up
        );
    }
    let _ = writeln!(text, "trials  {at_most}{}", check.trials);
    let _ = writeln!(text, "models");
    let of = match check.set_up < check.cells {
        true => format!("{} cells set up", check.set_up),
        false => format!("{} cells", check.cells),
    };
    for group in check.groups.iter().take(MAX_GROUPS) {
        let _ = writeln!(text, "  {} of {of}", group.cells);
        let needless = (!group.needless.is_empty())
            .then(|| format!("needs no {}", group.needless.join(", no ")));
        let lines = group.needs.iter().chain(&needless);
        for line in lines.cloned().chain(rungs(&group.rungs)) {
            let _ = writeln!(text, "    {line}");
        }
    }
    if check.groups.len() > MAX_GROUPS {
        let more = &check.groups[MAX_GROUPS..];
        let cells: usize = more.iter().map(|group| group.cells).sum();
        let _ = writeln!(text, "  {cells} others in {} more groups", more.len());
    }
    let _ = writeln!(text, "intervals of 95 %");
    for (cells, others, worst) in grouped(&check.intervals) {
        let _ = writeln!(text, "  {cells} of {of}");
        for line in intervals(worst).into_iter().flatten() {
            let _ = writeln!(text, "    {line}");
        }
        let which = match worst {
            Coverage::NotMeasured(_) => "one",
            _ => "the worst",
        };
        if others > 0 {
            let all = others + 1;
            let _ = writeln!(text, "    this is {which} of {all} similar results");
        }
    }
    let _ = write!(
        text,
        "time    about {} on {} threads, planning included",
        roughly(check.seconds),
        check.threads
    );
    text
}

/// Groups coverages by kind: measured, outside the measured scenes, or not measured. `all` contains each coverage with
/// its number of cells. Returns for each kind: the number of its cells, the number of its coverages minus one, and its
/// coverage with the worst single scene.
fn grouped(all: &[(usize, Coverage)]) -> Vec<(usize, usize, &Coverage)> {
    let lowest = |one: &Coverage| match one {
        Coverage::Measured(family) | Coverage::Outside(family, _) => family.lowest,
        Coverage::NotMeasured(_) => 0.0,
    };
    let mut groups: Vec<(usize, usize, &Coverage)> = Vec::new();
    for (cells, one) in all {
        let is_like =
            |other: &Coverage| std::mem::discriminant(other) == std::mem::discriminant(one);
        match groups.iter_mut().find(|group| is_like(group.2)) {
            None => groups.push((*cells, 0, one)),
            Some((sum, others, worst)) => {
                (*sum, *others) = (*sum + cells, *others + 1);
                *worst = if lowest(one) < lowest(worst) {
                    one
                } else {
                    *worst
                };
            }
        }
    }
    groups
}

/// Returns two texts about a coverage. The first states the measured coverage, or the reason why it was not measured.
/// The second states the coverage in the most similar random scenes. It exists only if a number of the scene is outside
/// the ranges of the random scenes.
fn intervals(coverage: &Coverage) -> [Option<String>; 2] {
    match coverage {
        Coverage::Measured(family) => [Some(format!("tested: {family}")), None],
        Coverage::Outside(family, outside) => [
            Some(format!("not tested: random scenes have no {outside}")),
            Some(format!("most similar: {family}")),
        ],
        Coverage::NotMeasured(why) => [Some(format!("not tested: {why}")), None],
    }
}

fn rungs(rungs: &Rungs) -> Vec<String> {
    match rungs {
        Rungs::None => Vec::new(),
        Rungs::NotMeasured => vec!["models, cheapest first: not measured, to save time".to_owned()],
        Rungs::AsIn(cell) => vec![format!("models, cheapest first: as in cell {cell}")],
        Rungs::Measured {
            cell,
            ladder,
            times,
        } => {
            let errors = errors_of(ladder);
            let first = format!("models, cheapest first, in cell {cell}; errors: {errors}");
            let chosen = |tolerance| format!("chosen for a tolerance of {tolerance:e}: ");
            let chosen = ladder.tolerance.map_or_else(String::new, chosen);
            let reason = format!("  {chosen}{}", ladder.reason);
            let rungs = rung_lines(ladder, times);
            [first, reason].into_iter().chain(rungs).collect()
        }
    }
}

/// Text that explains the errors in the list of models: the quantity that has the error, and the length by which the
/// error is divided.
fn errors_of(ladder: &Ladder) -> &'static str {
    match ladder.taken().model {
        ModelConfig::Roll(_) => {
            "positions of the contacts at the end, relative to the first contact's length scale"
        }
        ModelConfig::Glide(_) => "positions of the contacts, relative to the tip's radius",
        ModelConfig::Press(_) => "displacements of the markers, relative to the largest",
    }
}

/// One line of text per model in `times`: its error, its computing time, and the ratio of this time to the computing
/// time of the chosen model.
fn rung_lines(ladder: &Ladder, times: &[(usize, Option<f64>)]) -> impl Iterator<Item = String> {
    let name = |place: usize| ladder.rungs[place].name.as_str();
    let widths = times.iter().map(|(place, _)| name(*place).chars().count());
    let width = widths.max().unwrap_or(0);
    let taken = times.iter().find(|(place, _)| *place == ladder.taken);
    let of_taken = taken.and_then(|(_, time)| *time);
    times.iter().map(move |&(place, time)| {
        let is_taken = place == ladder.taken;
        let mark = if is_taken { '>' } else { ' ' };
        let time = time.map_or_else(String::new, |time| {
            let model = &ladder.rungs[place].model;
            time_in_words(time, of_taken.filter(|_| !is_taken), model)
        });
        let text = match &ladder.rungs[place].accuracy {
            Accuracy::Impossible(why) => format!("cannot: {why}"),
            Accuracy::Error(_) if ladder.reference == Some(place) => {
                format!("reference for the errors{time}")
            }
            Accuracy::Error(error) => format!("error {error:.1e}{time}"),
        };
        format!("  {mark} {:width$}  {text}", name(place))
    })
}

/// A computing time (s) of a model as text. If `other` is given, the text also contains the time divided by `other`.
fn time_in_words(time: f64, other: Option<f64>, model: &ModelConfig) -> String {
    let seconds = short(time);
    let ratio = other.map_or_else(String::new, |other| {
        format!(" ({} x)", two_digits(time / other))
    });
    match model {
        ModelConfig::Roll(_) => format!(", {seconds} per trial{ratio}"),
        _ => format!(", {seconds} once for all trials{ratio}"),
    }
}

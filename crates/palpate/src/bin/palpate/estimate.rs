//! Implements the command `palpate estimate`.

mod summary;

use std::io::IsTerminal;
use std::path::Path;

use anyhow::anyhow;
use palpate_recorded::{
    Form, GlideOptions, GlideRecording, LoadCurve, LoadOptions, PictureOptions, PressOptions,
    PressRecording, RecordedFile, RollOptions, RollRecording, estimate_force, estimate_glide,
    estimate_press, estimate_roll,
};
use palpate_study::config::{self, FieldError, LengthUnit, Study, StudyConfig};
use palpate_study::readings::{columns_of, of_key};
use serde::Serialize;
use serde_json::{Map, Value as Json};

use crate::cli::{
    EstimateForceArgs, EstimateGlideArgs, EstimatePressArgs, EstimateRollArgs, FormArgs, LikeArgs,
};
use crate::failure::{Failure, with_flags};
use crate::output::{self, Guard, OutputFile};
use summary::summary;

pub(crate) fn table(path: &Path, form: Form) -> Result<RecordedFile, Failure> {
    let file = match path == Path::new("-") {
        true => RecordedFile::read_stream("standard input", std::io::stdin().lock()),
        false => RecordedFile::read(path),
    };
    let mut file = file.map_err(Failure::work)?;
    file.form = form;
    Ok(file)
}

/// Format of a table, as the arguments state it. The study of `--like` supplies the column names that are not stated.
pub(crate) fn form(args: &FormArgs, like: Option<&Like>) -> Form {
    let mut form = args.form();
    let Some(like) = like else {
        return form;
    };
    let columns = columns_of(like.config.scene.kind());
    for (key, name) in &like.config.columns {
        let column = of_key(key, &columns);
        let mut keys = form.columns.keys();
        if !keys.any(|key| of_key(key, &columns) == column) {
            form.columns.insert(key.clone(), name.clone());
        }
    }
    form
}

/// Text of an estimate for standard output: a few lines on a terminal, otherwise (or with `--json`) JSON.
pub(crate) fn shown(estimate: &impl Serialize, json: bool) -> Result<String, Failure> {
    if json || !std::io::stdout().is_terminal() {
        return output::json(estimate);
    }
    let estimate = serde_json::to_value(estimate).map_err(Failure::work)?;
    Ok(summary(&estimate))
}

/// Prints the warnings of an estimate to the stream stderr.
pub(crate) fn warn(estimate: &impl Serialize) -> Result<(), Failure> {
    let json = serde_json::to_value(estimate).map_err(Failure::work)?;
    let warnings = json["warnings"].as_array().into_iter().flatten();
    for warning in warnings.filter_map(|warning| warning["text"].as_str()) {
        output::print_note(format_args!("warning: {}", with_flags(warning)));
    }
    Ok(())
}

/// The study that `--like` names. It supplies every setting that no flag states.
pub(crate) struct Like {
    study: Study,
    cell: usize,
    pub(crate) config: StudyConfig,
}

impl Like {
    pub(crate) fn of(args: &LikeArgs) -> Result<Option<Self>, Failure> {
        let Some(file) = &args.like else {
            return Ok(None);
        };
        let study = config::load(file).map_err(Failure::usage)?;
        let Ok(cell) = study.cell(args.cell) else {
            return Err(Failure::no_cell(args.cell, &study));
        };
        Ok(Some(Self {
            study,
            cell: args.cell,
            config: cell.config,
        }))
    }

    /// Options that the study states for an estimate, with lengths in `unit`. If the unit of the readings is unknown
    /// (`None`), lengths keep the unit of the study.
    pub(crate) fn options<T>(
        &self,
        unit: Option<LengthUnit>,
        options: fn(&StudyConfig, LengthUnit) -> Result<T, FieldError>,
    ) -> Result<T, Failure> {
        let unit = unit.unwrap_or(self.config.length_unit);
        options(&self.config, unit)
            .map_err(|error| Failure::usage(self.study.error_at(self.cell, error)))
    }
}

pub(crate) fn roll(args: &EstimateRollArgs) -> Result<(), Failure> {
    let like = Like::of(&args.like)?;
    let form = Form {
        rotation_frame: args.rotation_frame,
        ..form(&args.form, like.as_ref())
    };
    let file = table(&args.readings, form)?;
    let readings = RollRecording::try_from(file).map_err(Failure::work)?;
    let unit = readings.unit.or(args.form.length_unit);
    let base = like.map(|like| like.options(unit, palpate::roll_options));
    let given = args.rolls.and(&args.estimator);
    let options = RollOptions::with_settings(base.transpose()?, &given, args.form.length_unit);
    let options = options.map_err(Failure::usage)?;
    let estimate = estimate_roll(readings, &options).map_err(Failure::work)?;
    warn(&estimate)?;
    output::print(&shown(&estimate, args.json)?)
}

pub(crate) fn glide(args: &EstimateGlideArgs) -> Result<(), Failure> {
    let map_file = map_file(args)?;
    let like = Like::of(&args.like)?;
    let file = table(&args.readings, form(&args.form, like.as_ref()))?;
    let readings = GlideRecording::try_from(file).map_err(Failure::work)?;
    let options = glide_options(args, like, &readings)?;
    let (estimate, map) = estimate_glide(&readings, &options).map_err(Failure::work)?;
    warn(&estimate)?;
    let json = shown(&estimate, args.json)?;
    let Some(map_file) = map_file else {
        return output::print(&json);
    };
    map_file.write(map.to_csv().as_bytes())?;
    map_file.print(&json)
}

fn glide_options(
    args: &EstimateGlideArgs,
    like: Option<Like>,
    readings: &GlideRecording,
) -> Result<GlideOptions, Failure> {
    let unit = readings.unit.or(args.form.length_unit);
    let base = like.map(|like| like.options(unit, GlideOptions::from_study));
    let options = GlideOptions::with_settings(
        base.transpose()?,
        &args.glides.and(&args.estimator),
        args.form.length_unit,
        readings.has_normals(),
    );
    Ok(GlideOptions {
        map_at_contacts: args.at_contacts,
        ..options.map_err(Failure::usage)?
    })
}

/// Output file of the map, if `--map` names one. Rejects a file in a directory that does not exist.
fn map_file(args: &EstimateGlideArgs) -> Result<Option<OutputFile>, Failure> {
    let Some(path) = &args.map else {
        return Ok(None);
    };
    let inputs = [&args.readings].into_iter().chain(&args.like.like);
    let file = OutputFile::new("--map", path, Guard::new(inputs, args.force))?;
    match path.parent() {
        Some(dir) if dir != Path::new("") && !dir.is_dir() => {
            let (path, dir) = (path.display(), dir.display());
            Err(Failure::Work(anyhow!("--map {path}: no directory {dir}")))
        }
        _ => Ok(Some(file)),
    }
}

pub(crate) fn press(args: &EstimatePressArgs) -> Result<(), Failure> {
    let like = Like::of(&args.sensor.like)?;
    let file = table(&args.readings, form(&args.form, like.as_ref()))?;
    let readings = PressRecording::try_from(file).map_err(Failure::work)?;
    let unit = readings.unit.or(args.form.length_unit);
    let mut given = args.sensor.presses.and(&args.sensor.estimator);
    given.insert("radial_scale".to_owned(), args.radial_scale.into());
    let mut options = press_options(&given, like.as_ref(), unit, readings.has_tangential())?;
    options.length_unit = args.form.length_unit.or(options.length_unit);
    let estimate = estimate_press(&readings, &options).map_err(Failure::work)?;
    warn(&estimate)?;
    output::print(&shown(&estimate, args.json)?)
}

/// Options of the estimate of a press, from flags and from the study of `--like`. Lengths are in the readings' unit.
pub(crate) fn press_options(
    given: &Map<String, Json>,
    like: Option<&Like>,
    unit: Option<LengthUnit>,
    has_tangential: bool,
) -> Result<PressOptions, Failure> {
    let base = like.map(|like| like.options(unit, palpate::press_options));
    let options = PressOptions::with_settings(base.transpose()?, given, None, has_tangential);
    options.map_err(Failure::usage)
}

/// Options of the fit of a press to camera frames, from flags and from the study of `--like`. Lengths are in `unit`.
pub(crate) fn picture_options(
    given: &Map<String, Json>,
    like: Option<&Like>,
    unit: Option<LengthUnit>,
) -> Result<PictureOptions, Failure> {
    let base = like.map(|like| like.options(unit, PictureOptions::from_study));
    PictureOptions::with_settings(base.transpose()?, given).map_err(Failure::usage)
}

pub(crate) fn force(args: &EstimateForceArgs) -> Result<(), Failure> {
    let options = LoadOptions {
        modulus_kpa: args.modulus_kpa,
        modulus_std_kpa: args.modulus_std_kpa,
        poisson: args.poisson,
        sensor_radius: args.sensor_radius,
        force_std_n: args.force_std_n,
        length_unit: args.form.length_unit,
    };
    options.check().map_err(Failure::usage)?;
    let file = table(&args.readings, form(&args.form, None))?;
    let curve = LoadCurve::try_from(file).map_err(Failure::work)?;
    let estimate = estimate_force(&curve, &options).map_err(Failure::work)?;
    warn(&estimate)?;
    output::print(&output::json(&estimate)?)
}

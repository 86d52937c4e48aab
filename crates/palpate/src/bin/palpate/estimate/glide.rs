//! Implements the command `palpate estimate glide`.

use std::path::Path;

use anyhow::anyhow;
use palpate_recorded::{GlideOptions, GlideRecording, estimate_glide, parse_glide};

use super::like::Like;
use super::table::{form, shown, table, warn};
use crate::cli::EstimateGlideArgs;
use crate::failure::Failure;
use crate::output::{self, Guard, OutputFile};

pub(crate) fn glide(args: &EstimateGlideArgs) -> Result<(), Failure> {
    let map_file = map_file(args)?;
    let like = Like::of(&args.like)?;
    let file = table(&args.readings, form(&args.form, like.as_ref()))?;
    let readings = parse_glide(file).map_err(Failure::work)?;
    let options = options(args, like, &readings)?;
    let (estimate, map) = estimate_glide(&readings, &options).map_err(Failure::work)?;
    warn(&estimate)?;
    let json = shown(&estimate, args.json)?;
    let Some(map_file) = map_file else {
        return output::print(&json);
    };
    map_file.write(map.to_csv().as_bytes())?;
    map_file.print(&json)
}

fn options(
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

//! Tables of readings: files, or standard input.

use std::path::Path;

use palpate_recorded::{Form, RecordedFile};
use palpate_study::readings::{columns_of, of_key};

use super::like::Like;
use crate::cli::FormArgs;
use crate::failure::Failure;

/// Table in a form; `-` is standard input.
pub(crate) fn table(path: &Path, form: Form) -> Result<RecordedFile, Failure> {
    let file = match path == Path::new("-") {
        true => RecordedFile::read_stream("standard input", std::io::stdin().lock()),
        false => RecordedFile::read(path),
    };
    file.map(|file| file.written(form)).map_err(Failure::work)
}

/// Form that the arguments tell, with the names of columns of a study for those that they do not.
pub(crate) fn form(args: &FormArgs, like: Option<&Like>) -> Form {
    let mut form = args.form();
    let Some(like) = like else {
        return form;
    };
    let columns = columns_of(like.config.scene.kind());
    for (key, name) in &like.config.columns {
        let column = of_key(key, &columns);
        let mut told = form.columns.keys();
        if !told.any(|told| of_key(told, &columns) == column) {
            form.columns.insert(key.clone(), name.clone());
        }
    }
    form
}

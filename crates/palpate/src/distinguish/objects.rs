//! Cells of a study whose objects differ and nothing else.

use palpate_study::config::Study;

use super::error::DistinguishError;

/// Swept fields that make objects, the others, and the cells that share the latter.
pub(crate) struct Layout {
    /// Columns of the fields that make objects.
    pub(crate) objects: Vec<String>,
    /// Columns of the others.
    pub(crate) others: Vec<String>,
    pub(crate) groups: Vec<(Vec<String>, Members)>,
}

/// Cells, and the values that make their objects.
type Members = Vec<(usize, Vec<String>)>;

/// Groups of cells whose objects differ and nothing else, in the order of the study; each with at least two.
pub(crate) fn grouped(study: &Study) -> Result<Layout, DistinguishError> {
    let is_object = |path: &String| path == "scene.object" || path.starts_with("scene.object.");
    let parted = |of_object: bool, texts: &[String]| -> Vec<String> {
        let pairs = study.paths.iter().zip(texts);
        let kept = pairs.filter(|(path, _)| is_object(path) == of_object);
        kept.map(|(_, text)| text.clone()).collect()
    };
    let mut groups: Vec<(Vec<String>, Members)> = Vec::new();
    for cell in 0..study.cell_count() {
        let coordinates = study.cell(cell)?.coordinates;
        let (settings, label) = (parted(false, &coordinates), parted(true, &coordinates));
        match groups.iter_mut().find(|(known, _)| *known == settings) {
            Some((_, members)) => members.push((cell, label)),
            None => groups.push((settings, vec![(cell, label)])),
        }
    }
    groups.retain(|(_, members)| members.len() > 1);
    match study.paths.iter().any(is_object) && !groups.is_empty() {
        true => Ok(Layout {
            objects: parted(true, &study.columns),
            others: parted(false, &study.columns),
            groups,
        }),
        false => Err(DistinguishError::NoObjects),
    }
}

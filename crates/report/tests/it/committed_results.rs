//! Tests that the tables in `results/` produce exactly the committed figures, scores and page.

use palpate_report::{
    Figure, Files, Study, claims_table, figures, page, press_figures, score, tradeoff_figures,
};
use std::fs::{read_dir, read_to_string};
use std::path::{Path, PathBuf};

fn results() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../results")
}

fn studies() -> Vec<PathBuf> {
    let folders = read_dir(results())
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut folders: Vec<PathBuf> = folders
        .filter(|path| path.join("run.toml").exists())
        .collect();
    folders.sort();
    folders
}

#[track_caller]
fn drawn(folder: &Path, figures: Vec<Figure>) -> usize {
    for figure in &figures {
        let path = folder.join(&figure.name).with_extension("svg");
        assert!(
            read_to_string(&path).unwrap() == figure.svg,
            "{}",
            path.display()
        );
    }
    figures.len()
}

#[test]
fn figures_are_the_committed_ones() {
    let mut count = 0;
    for folder in studies() {
        count += drawn(
            &folder,
            figures(&Study::read(Files::in_folder(&folder)).unwrap()).unwrap(),
        );
        if folder.join("quiver.svg").exists() {
            count += drawn(&folder, press_figures(&Files::in_folder(&folder)).unwrap());
        }
    }
    let folder = results().join("tradeoff");
    let fronts = tradeoff_figures(&Files::in_folder(&folder)).unwrap();
    assert!(count + drawn(&folder, fronts) > 70);
}

#[test]
fn scores_are_the_committed_ones() {
    let studies = studies();
    assert!(studies.len() > 28);
    for folder in studies {
        let scores =
            claims_table(&score(&[Study::read(Files::in_folder(&folder)).unwrap()])).to_csv();
        let committed = read_to_string(folder.join("claims.csv")).unwrap_or_default();
        assert!(
            scores == committed,
            "{}\n{scores}\n{committed}",
            folder.display()
        );
    }
}

#[test]
fn the_page_is_the_committed_one() {
    let studies: Vec<Study> = studies()
        .iter()
        .map(|folder| Study::read(Files::in_folder(folder)).unwrap())
        .collect();
    let committed = read_to_string(results().join("index.html")).unwrap();
    assert!(page(&studies).unwrap() == committed);
}

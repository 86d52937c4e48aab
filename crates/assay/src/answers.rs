//! Whether answers keep their word: sides of `palpate design` against references of 100 times the trials, and probabilities
//! of `palpate distinguish` against pairs of fresh trials.

mod designs;
mod pairs;
mod scenes;
mod score;

pub use score::{Options, Score};

use anyhow::{Result, ensure};

/// Asks all, and gives the scores; `say` is told each as it is known.
///
/// # Errors
/// A scene that cannot be asked.
pub fn scores(options: Options<'_>, say: impl Fn(&Score)) -> Result<Vec<Score>> {
    let mut scores = Vec::new();
    let mut push = |score: Score| {
        say(&score);
        scores.push(score);
    };
    for scene in scenes::DESIGNS {
        if scene.name.contains(options.only) {
            push(designs::score(scene, options.seeds)?);
        }
    }
    for scene in scenes::PAIRS {
        if scene.name.contains(options.only) {
            push(pairs::score(scene, options)?);
        }
    }
    Ok(scores)
}

/// Fails where fewer are right than must be: 183 of 200 designs and 16 of 20 of each scene; 19 of 20 probabilities.
///
/// An answer is right with 95 %: of 200 at least 183 are so with 98.8 %, of 20 at least 16 with 99.7 %.
///
/// # Errors
/// Too few are right.
pub fn check(scores: &[Score]) -> Result<()> {
    let of = |command: &str| {
        let scores = scores.iter().filter(|score| score.command == command);
        scores.fold((0, 0), |(cases, right), score| {
            (cases + score.cases, right + score.right)
        })
    };
    let ((cases, right), (pairs, held)) = (of(designs::COMMAND), of(pairs::COMMAND));
    ensure!(
        200 * right >= 183 * cases,
        "design: {right} of {cases} answers are right"
    );
    ensure!(
        20 * held >= 19 * pairs,
        "distinguish: {held} of {pairs} probabilities are within their intervals"
    );
    for score in scores
        .iter()
        .filter(|score| score.command == designs::COMMAND)
    {
        let Score {
            scene,
            cases,
            right,
            ..
        } = score;
        ensure!(20 * right >= 16 * cases, "{scene}: {right} of {cases}");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_few_right_answers_are_an_error() {
        let score = |command, right| Score {
            command,
            scene: "a",
            cases: 20,
            right,
        };
        let of = |design, distinguish| {
            check(&[score("design", design), score("distinguish", distinguish)])
        };
        assert!(of(19, 19).is_ok());
        for (design, distinguish) in [(18, 20), (20, 18)] {
            assert!(of(design, distinguish).is_err());
        }
        let mut many = vec![score("design", 20); 9];
        many.push(score("design", 15));
        assert!(check(&many).is_err());
        assert_eq!(
            crate::intervals::table(&many[..1]).unwrap(),
            "command,scene,cases,right\ndesign,a,20,20\n"
        );
    }
}

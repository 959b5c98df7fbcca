//! The names of a convention's folds, from `datasets/folds.toml`.

use std::fs;

use anyhow::{Context, Result, ensure};

use crate::data::Convention;
use crate::workspace::Workspace;

const FILE: &str = "datasets/folds.toml";

/// In the file's order.
pub(crate) fn fold_names(workspace: &Workspace, convention: Convention) -> Result<Vec<String>> {
    let text = fs::read_to_string(workspace.path(FILE))
        .with_context(|| format!("{FILE} cannot be read"))?;
    parse(&text, convention).with_context(|| format!("in {FILE}"))
}

fn parse(text: &str, convention: Convention) -> Result<Vec<String>> {
    let table: toml::Table = text.parse().context("not well formed")?;
    let folds = table
        .get(convention.name())
        .and_then(|entry| entry.get("folds")?.as_array())
        .with_context(|| format!("[{convention}] has no list `folds`"))?;
    let names: Vec<String> = folds
        .iter()
        .filter_map(|fold| fold.get("name")?.as_str().map(str::to_owned))
        .collect();
    ensure!(!names.is_empty(), "[{convention}] has no fold with a name");
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_convention_has_five_folds() {
        let workspace = Workspace::find().unwrap();
        for convention in Convention::RECORDED {
            let names = fold_names(&workspace, convention).unwrap();
            assert_eq!(
                names,
                ["eth", "hotel", "univ", "zara1", "zara2"],
                "{convention}"
            );
        }
        assert_eq!(
            fold_names(&workspace, Convention::Simulated).unwrap().len(),
            5
        );
    }

    #[test]
    fn a_convention_without_folds_is_an_error() {
        let message = parse("[star]\nfolds = []", Convention::Star)
            .unwrap_err()
            .to_string();
        assert!(message.contains("star"), "{message}");
        assert!(parse("", Convention::Star).is_err());
    }
}

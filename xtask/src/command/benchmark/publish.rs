//! Copies a report into the documentation, with what made it, and its headline tables into the README.

use std::fs;
use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result};

use super::readme;
use crate::benchmark::{Plan, RecipeName, Settings, human};
use crate::whole_file;
use crate::workspace::Workspace;

/// The page whose tables the README shows too.
const HEADLINE: &str = "docs/benchmark.md";
const README: &str = "README.md";

/// Where results are shown: every data convention, recipe and profile has a page of its own, and the headline is the one whose
/// name says nothing of them.
fn file(settings: &Settings) -> String {
    let named = |name: &str, usual: &str| {
        if name == usual {
            String::new()
        } else {
            format!("-{name}")
        }
    };
    format!(
        "docs/benchmark{}{}{}.md",
        named(&settings.convention, "star"),
        settings.recipe.name.suffix(),
        named(&settings.profile, "paper")
    )
}

/// Writes the results of the plan, which `commit` measured, into the page of its profile, and into the README where they are those of all
/// `folds`.
pub(super) fn publish(
    workspace: &Workspace,
    (plan, folds): (&Plan, &[String]),
    (out, commit): (&Path, &str),
    took: Duration,
) -> Result<()> {
    let report = fs::read_to_string(out.join("report.md")).context("the report cannot be read")?;
    let now = workspace.now();
    let text = page(&report, plan, commit, &now, took);
    let file = file(&plan.settings);
    let mut pages = vec![(file.as_str(), text)];
    if file == HEADLINE && is_whole(plan, folds) {
        let old = fs::read_to_string(workspace.path(README))
            .with_context(|| format!("{README} cannot be read"))?;
        let made_by = made_by(plan, commit, &now, took);
        let new = readme::with_results(&old, &report, &plan.settings.protocols, &made_by)?;
        pages.push((README, new));
    }
    for (file, text) in pages {
        whole_file::write(&workspace.path(file), text.as_bytes())?;
        println!("published: {file}");
    }
    Ok(())
}

/// Whether the README may show it: the whole method, alone or beside another network, on all folds and windows, under the protocols that do not look ahead.
fn is_whole(plan: &Plan, folds: &[String]) -> bool {
    let settings = &plan.settings;
    let full = |fold: &String| {
        let mut tasks = plan.tasks.iter();
        tasks.any(|task| task.fold == *fold && task.variant == "full")
    };
    settings.protocols == ["fair", "single"]
        && settings.train_walkers.is_none()
        && settings.test_walkers.is_none()
        && folds.iter().all(full)
        && plan
            .tasks
            .iter()
            .all(|task| ["full", "perceptron"].contains(&task.variant.as_str()))
}

/// What made the tables of the README, in words.
fn made_by(plan: &Plan, commit: &str, time: &str, took: Duration) -> String {
    let settings = &plan.settings;
    format!(
        "`{}` made these tables: recipe `{}`, {} epochs, the last one; seeds {}; data convention `{}`, window rule \
         `published`, {} test windows; device {}; commit {commit}, {time}, in {}. All of it: [{HEADLINE}]({HEADLINE}).",
        command(plan, &seeds(plan)),
        settings.recipe.name,
        settings.epochs,
        seeds(plan).join(", "),
        settings.convention,
        match settings.test_walkers {
            None => "all".to_owned(),
            Some(walkers) => format!("{walkers} walkers of the"),
        },
        settings.device,
        human(took),
    )
}

/// The seeds of the tasks, each once, in order.
fn seeds(plan: &Plan) -> Vec<String> {
    let mut seeds: Vec<u64> = plan.tasks.iter().map(|task| task.seed).collect();
    seeds.sort_unstable();
    seeds.dedup();
    seeds.iter().map(u64::to_string).collect()
}

/// The report with its origin below the title.
fn page(report: &str, plan: &Plan, commit: &str, time: &str, took: Duration) -> String {
    // The report opens with its data convention, then comes its title: the origin goes below both.
    let end_of_title = report
        .lines()
        .scan(0, |end, line| {
            *end += line.len() + 1;
            Some((*end, line))
        })
        .find(|(_, line)| line.starts_with("# "))
        .map_or(0, |(end, _)| end.min(report.len()));
    let (title, body) = report.split_at(end_of_title);
    let settings = &plan.settings;
    let or = |walkers: Option<u32>, otherwise: &str| {
        walkers.map_or(otherwise.to_owned(), |walkers| walkers.to_string())
    };
    let of_the_recipe = "the recipe's";
    let optimiser = match &settings.recipe.optimiser {
        Some(optimiser) => format!(
            "{} / {} ({})",
            optimiser.batch_walkers, optimiser.learning_rate, optimiser.schedule
        ),
        None => of_the_recipe.to_owned(),
    };
    let seeds = seeds(plan);
    format!(
        "{}\n\n\
         <!-- Generated. Do not edit: run the command below. -->\n\
         | made by | |\n|---|---|\n\
         | command | `{}` |\n\
         | data convention | {} |\n\
         | seeds | {} |\n\
         | recipe | {} |\n\
         | epochs | {} |\n\
         | walkers trained on in an epoch / scored | {} / {} |\n\
         | walkers a batch / largest step of Adam | {optimiser} |\n\
         | device | {} |\n\
         | commit | {commit} |\n\
         | time | {time}, took {} |\n\n{}\n",
        title.trim(),
        command(plan, &seeds),
        settings.convention,
        seeds.join(", "),
        settings.recipe.name,
        settings.epochs,
        or(
            settings.train_walkers,
            match settings.recipe.name {
                RecipeName::Recommended => of_the_recipe,
                RecipeName::Published => "all",
            }
        ),
        or(settings.test_walkers, "all"),
        settings.device,
        human(took),
        body.trim()
    )
}

/// A command line that does the same on another machine: no folder of this one is in it.
fn command(plan: &Plan, seeds: &[String]) -> String {
    let settings = &plan.settings;
    let unique = |pick: fn(&crate::benchmark::Task) -> &String| {
        let mut names: Vec<&str> = plan.tasks.iter().map(|task| pick(task).as_str()).collect();
        names.sort_unstable();
        names.dedup();
        names.join(",")
    };
    let mut words = vec![
        "cargo xtask benchmark".to_owned(),
        format!("--profile {}", settings.profile),
        format!("--convention {}", settings.convention),
        format!("--folds {}", unique(|task| &task.fold)),
        format!("--variants {}", unique(|task| &task.variant)),
        format!("--protocol {}", settings.protocols.join(",")),
        format!("--seeds {}", seeds.join(",")),
        format!("--epochs {}", settings.epochs),
        format!("--device {}", settings.device),
        format!("--cargo-profile {}", settings.cargo_profile),
    ];
    let walkers = [
        ("train", settings.train_walkers),
        ("test", settings.test_walkers),
    ];
    words.extend(walkers.into_iter().filter_map(|(which, walkers)| {
        walkers.map(|walkers| format!("--{which}-walkers {walkers}"))
    }));
    words.push("--publish".to_owned());
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::benchmark::{PUBLISHED, RECOMMENDED};

    fn settings() -> Settings {
        Settings {
            profile: "quick".to_owned(),
            convention: "star".to_owned(),
            data: Some("/secret/folder".into()),
            device: "cpu".to_owned(),
            cargo_profile: "release".to_owned(),
            epochs: 4,
            train_walkers: Some(800),
            proposal_steps: None,
            test_walkers: None,
            protocols: vec!["fair".to_owned(), "single".to_owned()],
            recipe: RECOMMENDED,
        }
    }

    #[test]
    fn a_convention_a_recipe_and_a_profile_have_a_page_of_their_own() {
        for (convention, recipe, profile, expected) in [
            ("star", RECOMMENDED, "paper", HEADLINE),
            ("star", RECOMMENDED, "quick", "docs/benchmark-quick.md"),
            ("star", PUBLISHED, "paper", "docs/benchmark-published.md"),
            (
                "star",
                PUBLISHED,
                "quick",
                "docs/benchmark-published-quick.md",
            ),
            (
                "social-gan",
                RECOMMENDED,
                "paper",
                "docs/benchmark-social-gan.md",
            ),
            (
                "simulated",
                PUBLISHED,
                "smoke",
                "docs/benchmark-simulated-published-smoke.md",
            ),
        ] {
            let settings = Settings {
                convention: convention.to_owned(),
                profile: profile.to_owned(),
                recipe,
                ..settings()
            };
            assert_eq!(file(&settings), expected);
        }
    }

    /// The README shows the headline, and no part of it.
    #[test]
    fn a_part_of_the_benchmark_does_not_reach_the_readme() {
        let names =
            |names: &[&str]| -> Vec<String> { names.iter().map(|&name| name.to_owned()).collect() };
        let folds = names(&["eth", "hotel"]);
        let whole = |settings: Settings, some: &[&str], variants: &[&str]| {
            let plan = Plan::new(settings, &names(some), &names(variants), &[0]).unwrap();
            is_whole(&plan, &folds)
        };
        let all = || Settings {
            train_walkers: None,
            ..settings()
        };
        assert!(whole(all(), &["eth", "hotel"], &["full"]));
        assert!(whole(all(), &["eth", "hotel"], &["full", "perceptron"]));
        assert!(!whole(all(), &["eth", "hotel"], &["perceptron"]));
        assert!(!whole(all(), &["eth"], &["full"]));
        assert!(!whole(all(), &["eth", "hotel"], &["full", "star"]));
        assert!(!whole(settings(), &["eth", "hotel"], &["full"]));
        let cut = Settings {
            test_walkers: Some(50),
            ..all()
        };
        assert!(!whole(cut, &["eth", "hotel"], &["full"]));
    }

    fn made(settings: Settings) -> String {
        let names = |names: &[&str]| {
            names
                .iter()
                .map(|&name| name.to_owned())
                .collect::<Vec<_>>()
        };
        let folds = names(&["hotel", "eth"]);
        let plan = Plan::new(settings, &folds, &names(&["full"]), &[2, 1]).unwrap();
        let took = Duration::from_secs(61);
        let report = "# Title\n\n| a | table |\n";
        page(report, &plan, "0123456789ab", "2024", took)
    }

    fn check(text: &str, pieces: &[&str]) {
        for piece in pieces {
            assert!(text.contains(piece), "{piece} is not in {text}");
        }
        assert!(!text.contains("secret"));
    }

    #[test]
    fn the_page_says_what_made_it_and_names_no_folder() {
        let text = made(settings());
        assert!(text.starts_with("# Title\n"), "{text}");
        assert!(text.ends_with("\n| a | table |\n"), "{text}");
        check(
            &text,
            &[
                "`cargo xtask benchmark --profile quick --convention star --folds eth,hotel --variants \
                 full --protocol fair,single --seeds 1,2 --epochs 4 --device cpu --cargo-profile release --train-walkers 800 \
                 --publish`",
                "| commit | 0123456789ab |",
                "| recipe | recommended |",
                "| walkers trained on in an epoch / scored | 800 / all |",
                "| walkers a batch / largest step of Adam | the recipe's |",
                "| time | 2024, took 1 min 1 s |",
            ],
        );
    }

    #[test]
    fn the_page_says_what_a_recipe_was_changed_to() {
        let text = made(Settings {
            recipe: PUBLISHED,
            train_walkers: None,
            test_walkers: Some(50),
            ..settings()
        });
        // The paper's epochs are of all walkers.
        check(
            &text,
            &[
                "| recipe | published |",
                "| walkers trained on in an epoch / scored | all / 50 |",
                "| walkers a batch / largest step of Adam | 256 / 0.0015 (constant) |",
            ],
        );
    }

    #[test]
    fn the_page_leaves_to_the_recipe_what_is_its_own() {
        let text = made(Settings {
            train_walkers: None,
            ..settings()
        });
        let row = "| walkers trained on in an epoch / scored | the recipe's / all |";
        check(&text, &[row, "--cargo-profile release --publish`"]);
    }
}

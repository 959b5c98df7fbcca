//! Copies a report into the documentation, with what made it.

use std::fs;
use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result};

use crate::benchmark::{Plan, human};
use crate::whole_file;
use crate::workspace::Workspace;

/// Where the results of a profile in a data convention are shown: every pair has a page of its own.
fn file(profile: &str, convention: &str) -> String {
    let named = |name: &str, usual: &str| {
        if name == usual {
            String::new()
        } else {
            format!("-{name}")
        }
    };
    format!(
        "docs/benchmark{}{}.md",
        named(convention, "star"),
        named(profile, "quick")
    )
}

/// Writes the results of the plan into the page of its profile.
pub(super) fn publish(
    workspace: &Workspace,
    plan: &Plan,
    out: &Path,
    took: Duration,
) -> Result<()> {
    let report = fs::read_to_string(out.join("report.md")).context("the report cannot be read")?;
    let text = page(&report, plan, &workspace.commit(), &workspace.now(), took);
    let file = file(&plan.settings.profile, &plan.settings.convention);
    whole_file::write(&workspace.path(&file), text.as_bytes())?;
    println!("published: {file}");
    Ok(())
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
    let limit =
        |walkers: Option<u32>| walkers.map_or("all".to_owned(), |walkers| walkers.to_string());
    let mut seeds: Vec<u64> = plan.tasks.iter().map(|task| task.seed).collect();
    seeds.sort_unstable();
    seeds.dedup();
    let seeds: Vec<String> = seeds.iter().map(u64::to_string).collect();
    format!(
        "{}\n\n\
         <!-- Generated. Do not edit: run the command below. -->\n\
         | made by | |\n|---|---|\n\
         | command | `{}` |\n\
         | data convention | {} |\n\
         | seeds | {} |\n\
         | epochs | {} |\n\
         | walkers trained on in an epoch / scored | {} / {} |\n\
         | walkers a batch / largest step of Adam | {} / {} ({}) |\n\
         | device | {} |\n\
         | commit | {commit} |\n\
         | time | {time}, took {} |\n\n{}\n",
        title.trim(),
        command(plan, &seeds),
        settings.convention,
        seeds.join(", "),
        settings.epochs,
        limit(settings.train_walkers),
        limit(settings.test_walkers),
        settings.recipe.batch_walkers,
        settings.recipe.learning_rate,
        settings.recipe.schedule,
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
    use crate::benchmark::Settings;

    #[test]
    fn a_profile_and_a_convention_have_a_page_of_their_own() {
        assert_eq!(file("quick", "star"), "docs/benchmark.md");
        assert_eq!(file("evening", "star"), "docs/benchmark-evening.md");
        assert_eq!(file("quick", "social-gan"), "docs/benchmark-social-gan.md");
    }

    #[test]
    fn the_page_says_what_made_it_and_names_no_folder() {
        let settings = Settings {
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
            recipe: crate::benchmark::PUBLISHED,
        };
        let names = |names: &[&str]| {
            names
                .iter()
                .map(|&name| name.to_owned())
                .collect::<Vec<_>>()
        };
        let plan = Plan::new(
            settings,
            &names(&["hotel", "eth"]),
            &names(&["full"]),
            &[2, 1],
        )
        .unwrap();
        let took = Duration::from_secs(61);
        let text = page(
            "# Title\n\n| a | table |\n",
            &plan,
            "0123456789ab",
            "2024",
            took,
        );
        assert!(text.starts_with("# Title\n"), "{text}");
        assert!(text.ends_with("\n| a | table |\n"), "{text}");
        for piece in [
            "`cargo xtask benchmark --profile quick --convention star --folds eth,hotel --variants \
             full --protocol fair,single --seeds 1,2 --epochs 4 --device cpu --cargo-profile release --train-walkers 800 \
             --publish`",
            "| commit | 0123456789ab |",
            "| walkers trained on in an epoch / scored | 800 / all |",
            "| time | 2024, took 1 min 1 s |",
        ] {
            assert!(text.contains(piece), "{piece} is not in {text}");
        }
        assert!(!text.contains("secret"));
    }
}

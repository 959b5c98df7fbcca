//! Copies a report into the documentation, with what made it, and its headline tables into the README.

use super::super::recipe::Recipe;
use super::method::Method;
use super::plan::{Plan, Settings};
use super::profile::Profile;
use super::readme;
use crate::telling::human;
use anyhow::Context as _;
use ddl::Protocol;
use ddl::data::{Convention, write_whole};
use std::fs;
use std::path::Path;
use std::time::Duration;
use time::OffsetDateTime;

const HEADLINE: &str = "docs/benchmark.md";
const README: &str = "README.md";
/// Those of the headline: nothing is chosen with the truth.
const HEADLINE_PROTOCOLS: [Protocol; 4] = [
    Protocol::Fair,
    Protocol::Single,
    Protocol::Online,
    Protocol::OnlineSingle,
];

pub(super) struct Making<'a> {
    pub(super) commit: &'a str,
    pub(super) took: Duration,
    pub(super) at: OffsetDateTime,
}

/// Writes a report into the page of its plan in the `checkout`, and into the README there where the plan is of all folds and windows.
pub(super) fn publish(
    checkout: &Path,
    plan: &Plan,
    report: &str,
    making: &Making<'_>,
) -> anyhow::Result<Vec<String>> {
    let file = file(&plan.settings);
    let mut pages = vec![(file.clone(), page(report, plan, making))];
    if file == HEADLINE && is_whole(plan) {
        let old = fs::read_to_string(checkout.join(README))
            .with_context(|| format!("cannot read {README}"))?;
        let protocols = &plan.settings.protocols;
        let new = readme::with_results(&old, report, protocols, &made_by(plan, making))?;
        pages.push((README.to_owned(), new));
    }
    for (file, text) in &pages {
        write_whole(&checkout.join(file), text.as_bytes())
            .with_context(|| format!("cannot write {file}"))?;
    }
    Ok(pages.into_iter().map(|(file, _)| file).collect())
}

/// What the names of pages and folders say of a recipe: nothing of the recommended one.
pub(super) const fn suffix(recipe: Recipe) -> &'static str {
    match recipe {
        Recipe::Recommended => "",
        Recipe::Published => "-published",
    }
}

/// Where results are shown: every data convention, recipe and profile has a page of its own, and the headline is the one whose
/// name says nothing of them.
fn file(settings: &Settings) -> String {
    let convention = match settings.convention {
        Convention::Star => String::new(),
        other => format!("-{other}"),
    };
    let profile = match settings.profile {
        Profile::Paper => String::new(),
        other => format!("-{other}"),
    };
    let recipe = suffix(settings.recipe.name);
    format!("docs/benchmark{convention}{recipe}{profile}.md")
}

/// Whether the README may show it: the whole method, alone or beside another network, on all folds and windows, under the protocols that do not
/// look ahead.
fn is_whole(plan: &Plan) -> bool {
    let settings = &plan.settings;
    let full = |fold: &str| {
        let mut tasks = plan.tasks.iter();
        tasks.any(|task| task.fold == fold && task.variant == Method::FULL)
    };
    settings.protocols == HEADLINE_PROTOCOLS
        && settings.train_pedestrians.is_none()
        && settings.test_pedestrians.is_none()
        && settings.convention.fold_names().all(full)
        && plan
            .tasks
            .iter()
            .all(|task| [Method::FULL, Method::PERCEPTRON].contains(&task.variant))
}

fn time(making: &Making<'_>) -> String {
    let at = making.at;
    format!("{} {:02}:{:02} UTC", at.date(), at.hour(), at.minute())
}

fn made_by(plan: &Plan, making: &Making<'_>) -> String {
    let settings = &plan.settings;
    format!(
        "`{}` made these tables: recipe `{}`, {} epochs, the last one; seeds {}; data convention `{}`, window rule \
         `published`, {} test windows; device {}; commit {}, {}, in {}. All of it: [{HEADLINE}]({HEADLINE}).",
        command(plan),
        settings.recipe.name,
        settings.epochs,
        seeds(plan).join(", "),
        settings.convention,
        match settings.test_pedestrians {
            None => "all".to_owned(),
            Some(pedestrians) => format!("{pedestrians} pedestrians of the"),
        },
        settings.device,
        making.commit,
        time(making),
        human(making.took),
    )
}

fn seeds(plan: &Plan) -> Vec<String> {
    let mut seeds: Vec<u64> = plan.tasks.iter().map(|task| task.seed).collect();
    seeds.sort_unstable();
    seeds.dedup();
    seeds.iter().map(u64::to_string).collect()
}

fn page(report: &str, plan: &Plan, making: &Making<'_>) -> String {
    // The report opens with its data convention, then comes its title: the origin goes below both.
    let before: usize = report
        .split_inclusive('\n')
        .take_while(|line| !line.starts_with("# "))
        .map(str::len)
        .sum();
    let rest = &report[before..];
    let (title, body) = report.split_at(before + rest.find('\n').unwrap_or(0));
    let settings = &plan.settings;
    let of_the_recipe = "the recipe's";
    let or = |pedestrians: Option<usize>, otherwise: &str| {
        pedestrians.map_or(otherwise.to_owned(), |pedestrians| pedestrians.to_string())
    };
    let trained_on = match settings.recipe.name {
        Recipe::Recommended => or(settings.train_pedestrians, of_the_recipe),
        Recipe::Published => or(settings.train_pedestrians, "all"),
    };
    let optimiser = settings.recipe.optimiser.as_ref();
    let optimiser = optimiser.map_or(of_the_recipe.to_owned(), |of| {
        let (batch, step, schedule) = (of.batch_pedestrians, of.learning_rate, of.schedule);
        format!("{batch} / {step} ({schedule})")
    });
    let rows = [
        ("command", format!("`{}`", command(plan))),
        ("data convention", settings.convention.to_string()),
        ("seeds", seeds(plan).join(", ")),
        ("recipe", settings.recipe.name.to_string()),
        ("epochs", settings.epochs.to_string()),
        (
            "pedestrians trained on in an epoch / scored",
            format!("{trained_on} / {}", or(settings.test_pedestrians, "all")),
        ),
        ("pedestrians a batch / largest step of Adam", optimiser),
        ("device", settings.device.to_string()),
        ("commit", making.commit.to_owned()),
        (
            "time",
            format!("{}, took {}", time(making), human(making.took)),
        ),
    ];
    let rows = rows.map(|(name, value)| format!("| {name} | {value} |\n"));
    format!(
        "{}\n\n<!-- Generated. Do not edit: run the command below. -->\n| made by | |\n|---|---|\n{}\n{}\n",
        title.trim(),
        rows.concat(),
        body.trim()
    )
}

/// A command line that does the same on another machine: no folder of this one is in it.
fn command(plan: &Plan) -> String {
    let settings = &plan.settings;
    let unique = |mut names: Vec<&str>| {
        names.sort_unstable();
        names.dedup();
        names.join(",")
    };
    let folds = plan.tasks.iter().map(|task| task.fold.as_str()).collect();
    let methods = plan.tasks.iter().map(|task| task.variant.name()).collect();
    let protocols = settings.protocols.iter().map(ToString::to_string);
    let pedestrians = [
        ("train", settings.train_pedestrians),
        ("test", settings.test_pedestrians),
    ]
    .map(|(which, pedestrians)| {
        pedestrians.map_or(String::new(), |pedestrians| {
            format!(" --{which}-pedestrians {pedestrians}")
        })
    });
    format!(
        "cargo xtask benchmark --profile {} --convention {} --folds {} --variants {} --protocol {} --seeds {} --epochs {} --device {} \
         --cargo-profile {}{} --publish",
        settings.profile,
        settings.convention,
        unique(folds),
        unique(methods),
        protocols.collect::<Vec<_>>().join(","),
        seeds(plan).join(","),
        settings.epochs,
        settings.device,
        settings.cargo_profile,
        pedestrians.concat()
    )
}

#[cfg(test)]
mod tests {
    use super::super::fixture::{plan, settings};
    use super::*;

    #[test]
    fn a_convention_a_recipe_and_a_profile_have_a_page_of_their_own() {
        for (convention, recipe, profile, expected) in [
            (Convention::Star, Recipe::Recommended, Profile::Paper, ""),
            (
                Convention::Star,
                Recipe::Published,
                Profile::Quick,
                "-published-quick",
            ),
            (
                Convention::SocialGan,
                Recipe::Recommended,
                Profile::Paper,
                "-social-gan",
            ),
        ] {
            let settings = Settings {
                profile,
                convention,
                ..settings(recipe)
            };
            assert_eq!(file(&settings), format!("docs/benchmark{expected}.md"));
        }
    }

    #[test]
    fn a_part_of_the_benchmark_does_not_reach_the_readme() {
        let all = || Settings {
            train_pedestrians: None,
            test_pedestrians: None,
            ..settings(Recipe::Recommended)
        };
        let folds: Vec<&str> = Convention::Star.fold_names().collect();
        let whole = |settings, folds: &[&str], methods: &[Method]| {
            is_whole(&plan(settings, folds, methods, &[0]).unwrap())
        };
        let (full, perceptron) = (Method::FULL, Method::PERCEPTRON);
        assert!(whole(all(), &folds, &[full]));
        assert!(whole(all(), &folds, &[full, perceptron]));
        assert!(!whole(all(), &folds, &[perceptron]));
        assert!(!whole(all(), &folds[1..], &[full]));
        assert!(!whole(all(), &folds, &[full, Method::ALL[3]]));
        let changes: [fn(&mut Settings); 3] = [
            |settings| settings.train_pedestrians = Some(800),
            |settings| settings.test_pedestrians = Some(50),
            |settings| settings.protocols.truncate(1),
        ];
        for change in changes {
            let mut settings = all();
            change(&mut settings);
            assert!(!whole(settings, &folds, &[full]));
        }
    }

    const REPORT: &str = "convention\n\n# Title\n\n| a | table |\n";

    fn making() -> Making<'static> {
        Making {
            commit: "0123456789ab",
            took: Duration::from_secs(61),
            at: OffsetDateTime::UNIX_EPOCH,
        }
    }

    #[test]
    fn the_page_says_what_made_it_and_names_no_folder() {
        let pedestrians = "| pedestrians trained on in an epoch / scored |";
        for (recipe, train_pedestrians, test_pedestrians, pieces) in [
            (
                Recipe::Recommended,
                Some(800),
                None,
                [
                    "`cargo xtask benchmark --profile quick --convention star --folds eth,hotel --variants full --protocol \
                     fair,single,online,online-single --seeds 1,2 --epochs 4 --device cpu --cargo-profile release --train-pedestrians 800 --publish`",
                    "| time | 1970-01-01 00:00 UTC, took 1 min 1 s |",
                    "| recipe | recommended |",
                    &format!("{pedestrians} 800 / all |"),
                ],
            ),
            (
                Recipe::Recommended,
                None,
                None,
                [
                    "--cargo-profile release --publish`",
                    &format!("{pedestrians} the recipe's / all |"),
                    "| pedestrians a batch / largest step of Adam | the recipe's |",
                    "| seeds | 1, 2 |",
                ],
            ),
            (
                // The paper's epochs are of all pedestrians.
                Recipe::Published,
                None,
                Some(50),
                [
                    &format!("{pedestrians} all / 50 |"),
                    "| pedestrians a batch / largest step of Adam | 256 / 0.0015 (constant) |",
                    "--protocol published,fair,single",
                    "--test-pedestrians 50 --publish`",
                ],
            ),
        ] {
            let settings = Settings {
                proposal_steps: None,
                train_pedestrians,
                test_pedestrians,
                ..settings(recipe)
            };
            let plan = plan(settings, &["hotel", "eth"], &[Method::FULL], &[2, 1]).unwrap();
            let text = page(REPORT, &plan, &making());
            assert!(
                text.starts_with("convention\n\n# Title\n\n<!-- Gen"),
                "{text}"
            );
            assert!(text.ends_with("\n\n| a | table |\n") && !text.contains("recordings"));
            for piece in pieces {
                assert!(text.contains(piece), "{piece} is not in {text}");
            }
        }
    }

    #[test]
    fn the_headline_reaches_the_page_and_the_readme() {
        let checkout = tempfile::tempdir().unwrap();
        fs::create_dir(checkout.path().join("docs")).unwrap();
        let marks = "<!-- Results: generated by `cargo xtask benchmark --publish`. -->\n<!-- End of the results. -->\n";
        fs::write(checkout.path().join(README), marks).unwrap();
        let report = "# Title\n\n## Protocol `fair`, x\n\n| f |\n\n## Protocol `single`, x\n\n| s |\n\n## Protocol `online`, x\n\n\
             | o |\n\n## Protocol `online-single`, x\n\n| os |\n";
        let folds: Vec<&str> = Convention::Star.fold_names().collect();
        let publish = |folds: &[&str]| {
            let headline = Settings {
                profile: Profile::Paper,
                train_pedestrians: None,
                ..settings(Recipe::Recommended)
            };
            let plan = plan(headline, folds, &[Method::FULL], &[0]).unwrap();
            publish(checkout.path(), &plan, report, &making()).unwrap()
        };
        assert_eq!(publish(&folds[..1]), [HEADLINE]);
        assert_eq!(publish(&folds), [HEADLINE, README]);
        let readme = fs::read_to_string(checkout.path().join(README)).unwrap();
        assert!(
            readme.contains("| s |")
                && readme.contains("| o |")
                && readme.contains("in 1 min 1 s. All of it")
        );
        let page = fs::read_to_string(checkout.path().join(HEADLINE)).unwrap();
        assert!(page.contains("| commit | 0123456789ab |"), "{page}");
    }
}

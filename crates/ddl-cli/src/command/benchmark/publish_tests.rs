use super::super::fixture::{plan, settings};
use super::super::method::Method;
use super::super::plan::Settings;
use super::super::profile::Profile;
use super::*;
use ddl::Protocol;
use ddl::eval::{Conditions, ResultRow, Scores};

const WHOLE_FOLDS: [&str; 5] = ["eth", "hotel", "univ", "zara1", "zara2"];

fn making() -> Making {
    Making {
        commits: vec!["0123456789ab".to_owned()],
        tasks: 4,
        took: Duration::from_secs(61),
        processors: vec!["Abacus 9".to_owned()],
        at: OffsetDateTime::UNIX_EPOCH,
    }
}

fn whole(convention: Convention) -> Settings {
    Settings {
        profile: Profile::Paper,
        convention,
        train_pedestrians: None,
        ..settings(Recipe::Recommended)
    }
}

/// Results of a trained model and of a baseline on five folds.
fn report(convention: Convention, min_ade: f64) -> Report {
    let row = |fold: &str, forecaster: &str, epochs| ResultRow {
        conditions: Conditions {
            epochs,
            ..Conditions::new(convention, convention.headline_rule(), Protocol::Fair, fold, forecaster)
        },
        scores: Scores {
            min_ade,
            min_fde: 2.0 * min_ade,
            ..Scores::default()
        },
        blocks: Vec::new(),
    };
    let rows = WHOLE_FOLDS.iter().flat_map(|fold| {
        [
            row(fold, "DDL", Some(20)),
            row(fold, "constant velocity (last step)", None),
        ]
    });
    Report::new("Results", rows).unwrap()
}

/// A checkout with this project's pages.
fn checkout() -> tempfile::TempDir {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let copy = tempfile::tempdir().unwrap();
    fs::create_dir(copy.path().join("docs")).unwrap();
    fs::copy(root.join(PAGE), copy.path().join(PAGE)).unwrap();
    copy
}

fn published(checkout: &Path, settings: Settings, folds: &[&str], min_ade: f64) {
    let report = report(settings.convention, min_ade);
    let plan = plan(settings, folds, &[Method::FULL], &[2, 1]).unwrap();
    check(checkout, &plan).unwrap();
    publish(checkout, &plan, &report, &making()).unwrap();
}

#[test]
fn the_page_of_the_project_is_short() {
    let page = fs::metadata(checkout().path().join(PAGE)).unwrap();
    assert!(page.len() <= 10_000, "{} bytes", page.len());
}

#[test]
fn a_section_replaces_that_of_its_convention_and_keeps_the_other() {
    let checkout = checkout();
    let publish = |convention, min_ade| {
        published(checkout.path(), whole(convention), &WHOLE_FOLDS, min_ade);
        read(checkout.path(), PAGE).unwrap()
    };
    publish(Convention::Star, 0.125);
    let page = publish(Convention::SocialGan, 0.375);
    for section in ["star", "social-gan"] {
        let command = format!("benchmark --profile paper --convention {section} ");
        assert_eq!(page.matches(&command).count(), 1, "{page}");
    }
    for errors in ["0.125/0.250", "0.375/0.750"] {
        // Five folds and their mean, for the model and the baseline.
        assert_eq!(page.matches(errors).count(), 12, "{page}");
    }
    assert_eq!(publish(Convention::SocialGan, 0.375), page);
    let again = publish(Convention::Star, 0.25);
    assert!(!again.contains("0.125/0.250") && again.contains("0.375/0.750"));
    assert_eq!(publish(Convention::Star, 0.125), page);
}

#[test]
fn a_section_says_what_made_it_and_names_no_folder_of_this_machine() {
    for (train_pedestrians, test_pedestrians, pieces) in [
        (
            Some(800),
            None,
            [
                "--cargo-profile release --train-pedestrians 800 --publish\n",
                "all test windows.\n",
            ],
        ),
        (
            None,
            Some(50),
            [
                "--cargo-profile release --test-pedestrians 50 --publish\n",
                "50 pedestrians of the test windows.\n",
            ],
        ),
    ] {
        let settings = Settings {
            train_pedestrians,
            test_pedestrians,
            ..settings(Recipe::Recommended)
        };
        let checkout = checkout();
        published(checkout.path(), settings, &["hotel", "eth"], 0.5);
        let page = read(checkout.path(), PAGE).unwrap();
        assert!(!page.contains("/recordings"));
        for piece in pieces.into_iter().chain([
            "cargo xtask benchmark --profile quick --convention star --folds eth,hotel \\\n  \
             --variants full --protocol fair,single,online,online-single \\\n  \
             --seeds 1,2 --epochs 4 --device cpu --cargo-profile release",
            "Commit 0123456789ab, seeds 1, 2, recipe `recommended`, 4 epochs; published 1970-01-01 00:00 UTC.\n\
             4 tasks took 1 min 1 s in sum on Abacus 9, device cpu.\nWindow rule `published`",
            "`runs/star-quick`",
        ]) {
            assert!(page.contains(piece), "{piece} is not in {page}");
        }
    }
}

#[test]
fn what_cannot_be_published_is_refused_before_the_work() {
    for (settings, words) in [
        (whole(Convention::Simulated), "no section for results in simulated"),
        (settings(Recipe::Published), "leave out --publish"),
    ] {
        let plan = plan(settings, &["one"], &[Method::FULL], &[1]).unwrap();
        let error = format!("{:#}", check(checkout().path(), &plan).unwrap_err());
        assert!(error.contains(words), "{error}");
    }
}

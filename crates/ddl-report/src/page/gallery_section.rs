//! The gallery: the picked cases as figures with captions.

use std::fmt::Write as _;

use super::figure::case_figure;
use crate::{
    Moment,
    document::{escape, inline},
    figure::drawing::Drawing,
    gallery::{Pick, Show},
};

/// Cases in the order of [`Show::ALL`], with the place of their moment.
fn cases(moments: &[Moment]) -> Vec<(usize, &Moment, &Pick)> {
    let mut cases: Vec<(usize, &Moment, &Pick)> = moments
        .iter()
        .enumerate()
        .flat_map(|(at, moment)| moment.picks.iter().map(move |pick| (at, moment, pick)))
        .collect();
    cases.sort_by_key(|(_, _, pick)| pick.show);
    cases
}

/// What a case shows, in a sentence.
fn meaning(show: Show) -> &'static str {
    match show {
        Show::Convergence => "A walker who reaches the goal of the representative hypothesis.",
        Show::Group => "People who walk together.",
        Show::SlowingDown => {
            "A walker who slows down; where the forecast does too, its arrows grow shorter."
        }
        Show::KeepingDistance => "People who pass each other and keep their distance.",
        Show::Turning => "A walker who turns.",
    }
}

pub(super) fn html(moments: &[Moment]) -> String {
    let cases = cases(moments);
    if cases.is_empty() {
        return "<p class=\"nothing\">No cases were picked for this page.</p>\n".to_owned();
    }
    let mut html = "<div class=\"cases\">\n".to_owned();
    for (at, moment, pick) in cases {
        let figure = case_figure(moment, pick, false).inline("case");
        let pedestrian = pick.pedestrians.first().copied().unwrap_or(0);
        let who: Vec<String> = pick
            .pedestrians
            .iter()
            .map(|&i| escape(&moment.pedestrians[i].pedestrian.to_string()))
            .collect();
        let fold = if moment.fold == moment.recording {
            String::new()
        } else {
            format!(" (fold <code>{}</code>)", escape(&moment.fold))
        };
        let plural = if who.len() == 1 { "walker" } else { "walkers" };
        let _ = write!(
            html,
            "<figure>\n{figure}\n<figcaption>\n<h3>{}</h3>\n<p>{} {} of recording <code>{}</code>{}, \
             frame {}; forecast by {}.</p>\n<p class=\"rule\">Why this one: {}.</p>\n<button type=\"button\" \
             data-moment=\"{at}\" data-walker=\"{pedestrian}\">Play this moment</button>\n</figcaption>\n</figure>\n",
            capitalised(&pick.show.to_string()),
            meaning(pick.show),
            capitalised(&format!("{plural} {}", who.join(", "))),
            escape(&moment.recording),
            fold,
            moment.frame,
            escape(&moment.forecaster),
            inline(pick.rule.trim_end_matches('.')),
        );
    }
    html + "</div>\n"
}

pub(super) fn figures(moments: &[Moment]) -> Vec<(String, Drawing)> {
    cases(moments)
        .into_iter()
        .map(|(_, moment, pick)| {
            let name = format!("case {} {} {}", pick.show, moment.recording, moment.frame);
            (name, case_figure(moment, pick, true))
        })
        .collect()
}

fn capitalised(words: &str) -> String {
    let mut characters = words.chars();
    characters.next().map_or(String::new(), |first| {
        first.to_uppercase().chain(characters).collect()
    })
}

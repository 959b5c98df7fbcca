//! The HTML page of a report.

use super::{
    error::PageError,
    gallery_section, headline,
    headline_chart::{Shape, headline_chart},
    moment_data::{self, Truth},
    player::{PLAYER_SCRIPTS, THEME_BUTTON, head, player},
    standing,
    template::{fill, json_in_script},
    training_section,
};
use crate::{
    ForecastSnapshot, Report, TrainingCurve,
    document::{ContentsEntry, escape, identifier, inline, unused},
    figure::drawing::Drawing,
};

const TEMPLATE: &str = include_str!("page.html");
/// Scripts of the rest of this page, run after those of the player.
const REPORT_SCRIPTS: [&str; 2] = [include_str!("script/curves.js"), include_str!("script/report_file.js")];

/// Content of a page: the report, moments and training curves.
#[derive(Debug, Clone, Copy)]
pub struct Page<'a> {
    /// The results.
    pub report: &'a Report,
    /// Moments for the player; those with [picks](ForecastSnapshot::picks) are also shown in the gallery.
    pub moments: &'a [ForecastSnapshot],
    /// Training curves.
    pub curves: &'a [TrainingCurve],
}

impl<'a> Page<'a> {
    /// A page with only the report, without moments and training curves.
    pub fn new(report: &'a Report) -> Self {
        let (moments, curves) = (&[], &[]);
        Self {
            report,
            moments,
            curves,
        }
    }

    /// The HTML text of the page.
    ///
    /// # Errors
    /// A moment is incomplete, or the epochs of a curve do not ascend; the error names it.
    pub fn to_html(&self) -> Result<String, PageError> {
        self.check()?;
        let document = self.report.document();
        let (tables, contents) = document.sections();
        let contents: Vec<String> = contents.iter().map(item).collect();
        let report = json_in_script(&self.report.to_json()?);
        let moments = json_in_script(&moment_data::to_json(self.moments)?);
        let curves = json_in_script(&serde_json::to_string(self.curves)?);
        let scripts = [PLAYER_SCRIPTS.join("\n"), REPORT_SCRIPTS.join("\n")].join("\n");
        Ok(fill(
            TEMPLATE,
            &[
                ("head", &head(&document.title)),
                ("theme-button", THEME_BUTTON),
                ("title", &escape(&document.title)),
                ("lead", &inline(&document.lead)),
                ("headline", &headline::headline(self.report)),
                ("player", &player(self.moments)),
                ("gallery", &gallery_section::html(self.moments)),
                ("training", &training_section::html(self.curves)),
                ("contents", &contents.concat()),
                ("tables", &tables),
                ("report-json", &report),
                ("moments-json", &moments),
                ("curves-json", &curves),
                ("scripts", &scripts),
            ],
        ))
    }

    /// Every figure as a separate SVG file on white: its name and its content.
    ///
    /// # Errors
    /// As [`to_html`](Self::to_html).
    pub fn figures(&self) -> Result<Vec<(String, String)>, PageError> {
        self.check()?;
        let mut figures: Vec<(String, Drawing)> = Vec::new();
        if let Some(standing) = standing::standing(self.report) {
            figures.push(("comparison".to_owned(), headline_chart(&standing, Shape::Wide)));
        }
        figures.extend(gallery_section::figures(self.moments));
        figures.extend(training_section::figures(self.curves));
        let mut used: Vec<String> = Vec::new();
        let figures = figures
            .into_iter()
            .map(|(name, drawing)| (name, drawing.to_file("")))
            .chain(self.report.watching_figures());
        let named = |(name, text): (String, String)| (format!("{}.svg", unused(identifier(&name), &mut used)), text);
        Ok(figures.map(named).collect())
    }

    fn check(&self) -> Result<(), PageError> {
        moment_data::check(self.moments, Truth::Whole)?;
        training_section::check(self.curves)
    }
}

fn item(entry: &ContentsEntry) -> String {
    let class = if entry.warned { " class=\"warned\"" } else { "" };
    format!("<li{class}><a href=\"#{}\">{}</a></li>\n", entry.id, entry.heading)
}

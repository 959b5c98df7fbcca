//! The HTML page of a report.

use crate::document::{ContentsEntry, inline};
use crate::error::ReportError;
use crate::page::headline_chart::{ChartShape, headline_chart};
use crate::page::player::{PLAYER_SCRIPTS, bar, document, player, scripts};
use crate::page::{headline, moment_check, moment_data, standing};
use crate::report::Report;
use crate::snapshot::ForecastSnapshot;
use ddl_core::HORIZON;
use maud::{Markup, html};

/// The script of the rest of this page, run after those of the player.
const REPORT_SCRIPT: &str = include_str!("script/report_file.js");

/// Content of a page: the report and moments.
#[derive(Debug, Clone, Copy)]
pub struct Page<'a> {
    /// The results.
    pub report: &'a Report,
    /// Moments for the player.
    pub moments: &'a [ForecastSnapshot],
}

impl<'a> Page<'a> {
    /// A page with only the report, without moments.
    pub fn new(report: &'a Report) -> Self {
        Self { report, moments: &[] }
    }

    /// The HTML text of the page.
    ///
    /// # Errors
    /// A moment is incomplete; the error names it.
    pub fn to_html(&self) -> Result<String, ReportError> {
        self.check()?;
        let moments = moment_data::to_json(self.moments)?;
        let report = self.report.to_json()?;
        let data: [(&str, &str); 2] = [("report-json", &report), ("moments-json", &moments)];
        let links = [("results", "Results"), ("player", "Player"), ("tables", "Tables")];
        let body = html! {
            body {
                a.skip href="#results" { "To the results" }
                (bar(&links))
                main { (self.content()) }
                footer {
                    p {
                        "The numbers of this page come from the " code { "report.json" }
                        " that is embedded in it, bit for bit. "
                        button type="button" id="save-report" { "Save report.json" }
                    }
                }
                (scripts(&data, &[&PLAYER_SCRIPTS[..], &[REPORT_SCRIPT]].concat()))
            }
        };
        Ok(document(self.report.title(), &body).into_string())
    }

    fn content(&self) -> Markup {
        let results = self.report.document();
        let (tables, contents) = results.sections();
        html! {
            header id="results" {
                p.kicker { "Pedestrian trajectory forecasting" }
                h1 { (results.title) }
                p.lead { (inline(&results.lead)) }
            }
            section.headline aria-label="The best result and its comparison" { (headline::headline(self.report)) }
            (player(self.moments))
            section #tables {
                h2 { "All tables" }
                ol.contents {
                    @for ContentsEntry { id, heading, class } in &contents {
                        li class=[class] { a href={ "#" (id) } { (heading) } }
                    }
                }
            }
            div.tables { (tables) }
        }
    }

    /// The comparison with published results as SVG on white, if there is one.
    ///
    /// # Errors
    /// As [`to_html`](Self::to_html).
    pub fn comparison(&self) -> Result<Option<String>, ReportError> {
        self.check()?;
        let standing = standing::standing(self.report);
        Ok(standing.map(|standing| headline_chart(&standing, ChartShape::Wide).to_file("")))
    }

    fn check(&self) -> Result<(), ReportError> {
        moment_check::check(self.moments, HORIZON)
    }
}

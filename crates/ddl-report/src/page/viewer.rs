//! A page with only the player, for forecasts without a known future.

use crate::error::ReportError;
use crate::page::player::{PLAYER_SCRIPTS, bar, document, player, scripts};
use crate::page::{moment_check, moment_data};
use crate::snapshot::ForecastSnapshot;
use maud::html;

/// Content of a page that plays forecasts of own tracks: one file, which needs no network and no other file.
#[derive(Debug, Clone, Copy)]
pub struct Viewer<'a> {
    /// The title.
    pub title: &'a str,
    /// A description of one or two sentences.
    pub lead: &'a str,
    /// Paragraphs below the player.
    pub notes: &'a [String],
    /// The moments to play.
    pub moments: &'a [ForecastSnapshot],
}

impl Viewer<'_> {
    /// The HTML text of the page.
    ///
    /// # Errors
    /// A moment is incomplete; the error names it.
    pub fn to_html(&self) -> Result<String, ReportError> {
        moment_check::check(self.moments, 0)?;
        let moments = moment_data::to_json(self.moments)?;
        let body = html! {
            body.viewer data-first="busiest" {
                a.skip href="#player" { "To the player" }
                (bar(&[("player", "Player"), ("notes", "Notes")]))
                main {
                    header {
                        p.kicker { "Forecasts of pedestrians" }
                        h1 { (self.title) }
                        p.lead { (self.lead) }
                    }
                    (player(self.moments))
                    section #notes aria-label="Notes" {
                        @for note in self.notes { p { (note) } }
                    }
                }
                (scripts(&[("moments-json", &moments)], &PLAYER_SCRIPTS))
            }
        };
        Ok(document(self.title, &body).into_string())
    }
}

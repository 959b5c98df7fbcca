//! A page with only the player, for forecasts without a known future.

use super::{
    error::PageError,
    moment_data::{self, Truth},
    player::{PLAYER_SCRIPTS, THEME_BUTTON, head, player},
    template::{fill, json_in_script},
};
use crate::{ForecastSnapshot, document::escape};

const TEMPLATE: &str = include_str!("viewer.html");

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
    pub fn to_html(&self) -> Result<String, PageError> {
        moment_data::check(self.moments, Truth::AsSeen)?;
        let moments = json_in_script(&moment_data::to_json(self.moments)?);
        let notes: Vec<String> = self
            .notes
            .iter()
            .map(|note| format!("<p>{}</p>\n", escape(note)))
            .collect();
        Ok(fill(
            TEMPLATE,
            &[
                ("head", &head(self.title)),
                ("theme-button", THEME_BUTTON),
                ("title", &escape(self.title)),
                ("lead", &escape(self.lead)),
                ("player", &player(self.moments)),
                ("notes", &notes.concat()),
                ("moments-json", &moments),
                ("scripts", &PLAYER_SCRIPTS.join("\n")),
            ],
        ))
    }
}

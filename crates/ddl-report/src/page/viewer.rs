//! The player alone, on a page of its own: for forecasts that there is nothing to measure with.

use super::{
    error::PageError,
    moment_data::{self, Truth},
    player::{PLAYER_SCRIPTS, THEME_BUTTON, head, player},
    template::{fill, json_in_script},
};
use crate::{Moment, document::escape};

const TEMPLATE: &str = include_str!("viewer.html");

/// A page that plays forecasts of somebody's own tracks: one file that needs nothing else, no network, no other file.
#[derive(Debug, Clone, Copy)]
pub struct Viewer<'a> {
    /// The title.
    pub title: &'a str,
    /// What it shows, in a sentence or two.
    pub lead: &'a str,
    /// What is to be known besides, below the player: a paragraph a note.
    pub notes: &'a [String],
    /// The moments that it plays.
    pub moments: &'a [Moment],
}

impl Viewer<'_> {
    /// The page, to be written into a file and opened in a browser.
    ///
    /// # Errors
    /// A moment is not whole; the message names it.
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

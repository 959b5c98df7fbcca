//! `ddl forecast`: forecasts of a file of tracks or of live tracks.

mod arguments;
mod frames;
mod json_lines;
mod kept_memory;
mod left_out;
mod live;
mod moment;
mod table;

pub(crate) use arguments::ForecastCommand;

use crate::output::{file_of, write_output};
use crate::telling::tell;
use anyhow::bail;
use moment::{SceneWindows, StreamState};
use std::io::IsTerminal as _;

/// Number of lines above which a terminal gets a note.
const LOOKED_THROUGH: usize = 100;
/// Bytes above which the output counts as large.
const LARGE: usize = 50 << 20;

impl ForecastCommand {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        self.machine.prepare_for_little()?;
        let mut levels = self.region.iter().enumerate();
        if let Some((_, twice)) = levels.find(|(i, level)| self.region[..*i].contains(level)) {
            bail!("--region names {twice} twice; name each probability once");
        }
        if self.memory.is_some() && !self.tracks.are_live() {
            bail!("--memory is for live tracks from standard input: `tracker | ddl forecast - --memory FILE`");
        }
        if self.latest && !self.tracks.are_live() {
            bail!(
                "--latest is for tracks as they come; write them to standard input: `trackers | ddl forecast - \
                 --latest`"
            );
        }
        if self.tracks.are_live() {
            return live::run(&self);
        }
        let model = self.model()?;
        let observed = self.tracks.observed(model.config())?;
        let windows = SceneWindows {
            windows: &observed.windows,
            scenes: &[],
        };
        let text = self.text(&model, windows, observed.clock, &mut StreamState::default())?;
        write_output(self.output.as_deref(), &text)?;
        self.warn_of_flood(&text);
        observed.tell_what_was_estimated();
        Ok(())
    }

    /// Notes how to reduce large output: thousands of lines on a terminal, or a large file.
    fn warn_of_flood(&self, text: &str) {
        let on_terminal = file_of(self.output.as_deref()).is_none() && std::io::stdout().is_terminal();
        if on_terminal && text.lines().nth(LOOKED_THROUGH).is_some() {
            let lines = text.lines().count();
            tell(format_args!(
                "note: {lines} lines; --output FILE writes them to a file, --last and --one reduce them, `ddl view` \
                 shows them"
            ));
        } else if text.len() > LARGE {
            tell(format_args!(
                "note: {} MiB, because all pedestrians are forecast from every frame; --last and --one reduce the \
                 output",
                text.len() >> 20
            ));
        }
    }
}

//! `ddl forecast`: forecasts of a file of tracks or of live tracks.

mod arguments;
mod first_rows;
mod frames;
mod json_lines;
mod kept_memory;
mod left_out;
mod live;
mod moment;
mod table;
mod told_once;

pub(crate) use arguments::ForecastCommand;

use crate::interrupt::Interrupt;
use crate::output::{file_of, write_parts};
use crate::telling::tell;
use anyhow::bail;
use ddl::DdlError;
use ddl::data::Window;
use moment::{SceneWindows, StreamState};
use std::io::IsTerminal as _;

/// Number of lines above which a terminal gets a note.
const LOOKED_THROUGH: usize = 100;
/// About so many pedestrians are forecast and written at once: their forecasts take some 30 MB as text.
const AT_ONCE: usize = 1024;
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
        let mut state = StreamState::default();
        let (mut lines, mut bytes) = (0, 0);
        let interrupt = Interrupt::catch()?;
        let parts = parts_of(&observed.windows).map(|windows| {
            // No unfinished file is left.
            if interrupt.flow().is_break() {
                bail!(DdlError::Interrupted);
            }
            let windows = SceneWindows { windows, scenes: &[] };
            let text = self.text(&model, windows, observed.clock, &mut state)?;
            bytes += text.len();
            lines += text.lines().count();
            Ok(text)
        });
        write_parts(self.output.as_deref(), parts)?;
        state.unfamiliar.warn("");
        self.warn_of_flood(lines, bytes);
        observed.tell_what_was_estimated();
        Ok(())
    }

    /// Notes how to reduce large output: thousands of lines on a terminal, or a large file.
    fn warn_of_flood(&self, lines: usize, bytes: usize) {
        let on_terminal = file_of(self.output.as_deref()).is_none() && std::io::stdout().is_terminal();
        if on_terminal && lines > LOOKED_THROUGH {
            tell(format_args!(
                "note: {lines} lines; --output FILE writes them to a file, --last and --one reduce them, `ddl view` \
                 shows them"
            ));
        } else if bytes > LARGE {
            tell(format_args!(
                "note: {} MiB, because all pedestrians are forecast from every frame; --last and --one reduce the \
                 output",
                bytes >> 20
            ));
        }
    }
}

/// The windows in parts of about so many pedestrians as are forecast at once.
fn parts_of(windows: &[Window]) -> impl Iterator<Item = &[Window]> {
    let mut rest = windows;
    std::iter::from_fn(move || {
        let mut pedestrians = 0;
        let few = rest.iter().take_while(|window| {
            pedestrians += window.len();
            pedestrians <= AT_ONCE
        });
        let (part, others) = rest.split_at_checked(few.count().max(1))?;
        rest = others;
        Some(part)
    })
}

//! `ddl windows`: the observed test windows for another program.

use crate::command::RecordingsAt;
use crate::command::test_windows::{NO_WINDOW, TestWindows};
use crate::output::write_output;
use crate::paths::OutputFile;
use anyhow::ensure;
use clap::Args;
use ddl::eval::external;

/// Write the observed test windows, for another program to forecast
///
/// Writes JSON lines, one object for each pedestrian of each window of a fold: recording, `observed_until` (the last
/// observed raw frame), pedestrian, and the 8 observed positions in metres, 0.4 s apart. They hold no future positions.
/// `ddl evaluate --forecasts` scores the other program's forecasts.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  ddl windows --convention star --fold zara1 --output windows.jsonl")]
pub(crate) struct WindowsCommand {
    #[command(flatten)]
    windows: TestWindows,
    #[command(flatten)]
    recordings: RecordingsAt,
    /// File to write [default: standard output]
    #[arg(long, short, value_hint = clap::ValueHint::AnyPath)]
    output: Option<OutputFile>,
}

impl WindowsCommand {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        let (_, windows) = self.windows.windows(&self.recordings)?;
        ensure!(!windows.is_empty(), NO_WINDOW);
        let mut text = Vec::new();
        external::write_windows(&windows, &mut text)?;
        write_output(self.output.as_deref(), std::str::from_utf8(&text)?)
    }
}

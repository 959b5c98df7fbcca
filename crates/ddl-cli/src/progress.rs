//! Progress as a bar on a terminal, as a line at intervals elsewhere, or as JSON lines for programs.

use crate::telling::tell;
use clap::ValueEnum;
use indicatif::{ProgressBar, ProgressStyle};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::cell::Cell;
use std::io::{IsTerminal as _, Write as _};
use std::time::{Duration, Instant};

/// Interval of the lines in a log; shorter work prints none.
const LINE_EVERY: Duration = Duration::from_secs(30);

/// How progress is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ProgressMode {
    /// A bar if standard error is a terminal, otherwise a line there every 30 s.
    Auto,
    /// One JSON object per line on standard output.
    Json,
    /// Nothing.
    None,
}

#[derive(Debug)]
pub(crate) struct Progress {
    stage: &'static str,
    mode: ProgressMode,
    bar: ProgressBar,
    /// The time of the last line, where there is no bar.
    last_line: Cell<Instant>,
}

#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct ProgressLine<'a> {
    pub(crate) stage: Cow<'a, str>,
    pub(crate) done: u64,
    pub(crate) total: u64,
    pub(crate) message: Cow<'a, str>,
}

impl Progress {
    pub(crate) fn new(stage: &'static str, mode: ProgressMode) -> Self {
        let visible = mode == ProgressMode::Auto && std::io::stderr().is_terminal();
        let bar = if visible { ProgressBar::new(0) } else { ProgressBar::hidden() };
        let style = ProgressStyle::with_template("{prefix:>9} [{bar:32}] {pos}/{len} {elapsed} (left {eta}) {msg}");
        // the template is a valid constant, so the default is never used
        let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
        bar.set_style(style.progress_chars("=> "));
        bar.set_prefix(stage);
        Self { stage, mode, bar, last_line: Cell::new(Instant::now()) }
    }

    pub(crate) fn tell(&self, done: u64, total: u64, message: &str) {
        self.bar.set_length(total);
        self.bar.set_position(done);
        self.bar.set_message(message.to_owned());
        let line_is_due =
            self.mode == ProgressMode::Auto && self.bar.is_hidden() && self.last_line.get().elapsed() >= LINE_EVERY;
        if line_is_due {
            self.last_line.set(Instant::now());
            tell(format_args!("{}: {done} of {total} {message}", self.stage));
        }
        if self.mode == ProgressMode::Json {
            let (stage, message) = (self.stage.into(), message.into());
            let line = serde_json::to_string(&ProgressLine { stage, done, total, message });
            if let Ok(line) = line {
                // a closed output must not stop the work
                let _ = writeln!(std::io::stdout(), "{line}");
            }
        }
    }

    /// Prints a line above the bar.
    pub(crate) fn say(&self, line: &str) {
        if self.bar.is_hidden() {
            tell(format_args!("{line}"));
        } else {
            self.bar.println(line);
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

//! Progress for people (a bar on the terminal) or for programs (a JSON object a line).

use clap::ValueEnum;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;
use std::io::{IsTerminal as _, Write as _};

/// How progress is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ProgressMode {
    /// A bar when standard error is a terminal, nothing otherwise.
    Auto,
    /// One JSON object a line on standard output.
    Json,
    /// Nothing.
    None,
}

/// Tells how far a stage has come.
#[derive(Debug)]
pub(crate) struct Progress {
    stage: &'static str,
    mode: ProgressMode,
    bar: ProgressBar,
}

#[derive(Serialize)]
struct Line<'a> {
    stage: &'a str,
    done: u64,
    total: u64,
    message: &'a str,
}

impl Progress {
    pub(crate) fn new(stage: &'static str, mode: ProgressMode) -> Self {
        let visible = mode == ProgressMode::Auto && std::io::stderr().is_terminal();
        let bar = if visible {
            ProgressBar::new(0)
        } else {
            ProgressBar::hidden()
        };
        let style = ProgressStyle::with_template(
            "{prefix:>9} [{bar:32}] {pos}/{len} {elapsed} (left {eta}) {msg}",
        );
        // the template is a constant, so the default style is never needed
        bar.set_style(
            style
                .unwrap_or_else(|_| ProgressStyle::default_bar())
                .progress_chars("=> "),
        );
        bar.set_prefix(stage);
        Self { stage, mode, bar }
    }

    pub(crate) fn tell(&self, done: u64, total: u64, message: &str) {
        self.bar.set_length(total);
        self.bar.set_position(done);
        self.bar.set_message(message.to_owned());
        if self.mode == ProgressMode::Json
            && let Ok(line) = serde_json::to_string(&Line {
                stage: self.stage,
                done,
                total,
                message,
            })
        {
            // a reader that went away must not stop the work
            let _ = writeln!(std::io::stdout(), "{line}");
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

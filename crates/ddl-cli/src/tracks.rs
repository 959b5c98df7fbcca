use crate::clock::{Clock, FrameNumber};
use crate::recordings;
use crate::telling::tell;
use crate::units::{InSteps, Units};
use anyhow::bail;
use clap::Args;
use ddl::RunConfig;
use ddl::data::{Completion, Doubt, MadeUp, OBSERVED, Observation, Recording, Window};
use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};

/// Which tracks to read, and what their numbers mean. A command that needs them requires `file`.
#[derive(Debug, Args)]
pub(crate) struct Tracks {
    /// csv with the header frame,pedestrian,x,y: metres, rows of a pedestrian 0.4 s apart unless --fps or --dt says otherwise
    ///
    /// Or TrajNet++ ndjson, ETH obsmat.txt or the files of a data convention, told by extension and first lines. `ddl forecast -` reads a tracker's lines as
    /// they come.
    #[arg(value_name = "TRACKS")]
    file: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) units: Units,
    /// Only who was seen at each of the last 8 steps
    ///
    /// Otherwise who was seen at 2 of them or more is forecast too: holes of up to 2 steps are filled on a straight line, and what begins late is
    /// padded at the mean velocity seen. The columns `padded` and `filled` count such positions.
    #[arg(long, requires = "file")]
    whole: bool,
    /// Only the last frame that can be forecast from, instead of every one
    #[arg(long, requires = "file")]
    last: bool,
}

fn frames(count: FrameNumber) -> String {
    match count {
        FrameNumber::Whole(1) => "1 frame".to_owned(),
        count => format!("{count} frames"),
    }
}

#[derive(Debug)]
pub(crate) struct Observed {
    pub(crate) recording: Recording,
    pub(crate) windows: Vec<Window>,
    pub(crate) clock: Clock,
    /// What looks wrong with them: wrong units or a wrong rate give forecasts that look confident and mean nothing.
    pub(crate) doubt: Option<Doubt>,
    whole: bool,
}

impl Tracks {
    pub(crate) fn are_live(&self) -> bool {
        self.file().as_os_str() == "-"
    }

    pub(crate) fn file(&self) -> &Path {
        self.file.as_deref().unwrap_or(Path::new(""))
    }

    pub(crate) fn are_named(&self) -> bool {
        self.file.is_some()
    }

    pub(crate) fn completion(&self) -> Completion {
        if self.whole {
            Completion::NONE
        } else {
            Completion::USUAL
        }
    }

    pub(crate) fn live_units(&self, run: &RunConfig) -> anyhow::Result<Units> {
        if self.last {
            bail!(
                "--last has no meaning for tracks that have no end yet: every frame of standard input is forecast from as it comes"
            );
        }
        Ok(self.units.or_those_of(run))
    }

    /// Windows of 8 observed steps, one a frame that has anybody to forecast, for a run.
    pub(crate) fn observed(&self, run: &RunConfig) -> anyhow::Result<Observed> {
        let InSteps {
            recording,
            clock,
            guessed,
            notes,
        } = self.units.or_those_of(run).read(self.file())?;
        for note in notes {
            tell(format_args!("note: {note}"));
        }
        let mut windows = recording.completed_windows(self.completion());
        if windows.is_empty() {
            bail!(
                "{}: nobody was seen {} (a step of 0.4 s is taken to be {}); give --fps where frame numbers are not 0.4 s apart, or --frame-step",
                self.file().display(),
                if self.whole {
                    "at 8 steps in a row, 3.2 s"
                } else {
                    "at two steps in a row"
                },
                frames(clock.number(recording.frame_step()))
            );
        }
        // Who looks at a terminal may be trying the tracks for the first time; scripts are left in peace.
        if guessed && std::io::stderr().is_terminal() {
            tell(format_args!(
                "note: a step of 0.4 s is taken to be {}, the most common difference of two rows; give --fps, --dt or --frame-step to read them differently",
                frames(clock.number(recording.frame_step()))
            ));
        }
        let doubt = recording
            .speed_doubt()
            .filter(|doubt| !matches!(doubt, Doubt::NoSteps { .. }))
            .map(|doubt| clock.of_doubt(doubt));
        if let Some(doubt) = &doubt {
            recordings::warn_of(doubt);
        }
        if self.last {
            windows.drain(..windows.len() - 1);
        }
        Ok(Observed {
            recording,
            windows,
            clock,
            doubt,
            whole: self.whole,
        })
    }
}

impl Observed {
    /// Says so where observations were not whole: a forecast from two positions looks like any other.
    pub(crate) fn tell_what_is_made_up(&self) {
        let windows = self.windows.iter();
        let all: Vec<MadeUp> = windows
            .flat_map(|window| (0..window.len()).map(|i| window.made_up(i)))
            .collect();
        let late = all.iter().filter(|made_up| made_up.padded > 0).count();
        let holes = all.iter().filter(|made_up| made_up.filled > 0).count();
        if late + holes > 0 {
            tell(format_args!(
                "note: of {} forecasts {late} are of people seen for less than {OBSERVED} steps, and {holes} over holes that were filled (columns \
                 padded and filled); --whole leaves them out",
                all.len()
            ));
        }
        if !self.whole {
            self.tell_who_is_missing();
        }
    }

    fn tell_who_is_missing(&self) {
        let Some(window) = self.windows.last() else {
            return;
        };
        let last = window.frames()[OBSERVED - 1];
        let there = |seen: &&Observation| seen.frame == last;
        let present = self.recording.observations().iter().filter(there).count();
        let missing = present.saturating_sub(window.len());
        if missing > 0 {
            let frame = self.clock.number(last);
            tell(format_args!(
                "note: {missing} of the {present} people at frame {frame} were seen at too few of the last {OBSERVED} steps and are not forecast"
            ));
        }
    }
}

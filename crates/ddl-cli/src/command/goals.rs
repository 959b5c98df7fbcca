//! `ddl goals`.

use crate::tracks::{Tracks, write_output};
use anyhow::Context as _;
use clap::Args;
use ddl::{Ddl, DeviceChoice};
use serde::Serialize;
use std::path::PathBuf;

/// Estimate where the people of your own tracks are going, as csv
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  ddl goals --model runs/eth tracks.csv")]
pub(crate) struct Goals {
    /// Directory of a trained run, which holds the expert library
    #[arg(long)]
    model: PathBuf,
    #[command(flatten)]
    tracks: Tracks,
    /// File to write [default: standard output]
    #[arg(long, short)]
    output: Option<PathBuf>,
}

#[derive(Serialize)]
struct Row {
    observed_until: i64,
    pedestrian: i64,
    goal: usize,
    weight: f64,
    x: f64,
    y: f64,
}

impl Goals {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        let windows = self.tracks.windows()?;
        let model = Ddl::load(&self.model, DeviceChoice::Cpu)?;
        let mut writer = csv::Writer::from_writer(Vec::new());
        for window in &windows {
            let last = window.frames()[ddl::data::OBSERVED - 1];
            for (pedestrian, set) in window.pedestrians().iter().zip(model.goals(window)?) {
                for (goal, (position, weight)) in set.goals().iter().zip(set.weights()).enumerate()
                {
                    writer.serialize(Row {
                        observed_until: last,
                        pedestrian: pedestrian.0,
                        goal,
                        weight: *weight,
                        x: position[0],
                        y: position[1],
                    })?;
                }
            }
        }
        let bytes = writer.into_inner().context("cannot finish the csv")?;
        write_output(self.output.as_deref(), &String::from_utf8(bytes)?)
    }
}

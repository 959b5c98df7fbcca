//! `ddl occupancy`: where somebody will be.

use crate::command::forecast::{AnsweringCommand, StreamOptions, StreamState, answer};
use crate::paths::OutputPlace;
use anyhow::{Context as _, bail};
use clap::{Args, ValueEnum};
use ddl::data::write_atomically;
use ddl::scene::{Area, Occupancy};
use ddl::{Moment, Note, file_stem};
use serde_json::Value;

/// Compute grids of the probability that somebody is there
///
/// From the joint futures of every moment, or with --last of the last one. Only pedestrians who are forecast count.
#[derive(Debug, Args)]
#[command(mut_arg("every", |every| every.long("moments-every")))]
#[command(after_help = "Examples:\n  \
        ddl occupancy tracks.csv --last --folder grids --format pgm\n  \
        ddl occupancy tracks.csv --last --cell 0.05 --every 0.1 --area=-5,-5,5,5 --folder grids\n  \
        tracker | ddl occupancy - --fps 10 --every 0.4 | planner")]
pub(crate) struct OccupancyCommand {
    #[command(flatten)]
    stream: StreamOptions,
    /// Side of a cell, metres; its number is of the middle of the cell, so cells should not be larger than a pedestrian
    #[arg(long, default_value_t = 0.1, allow_negative_numbers = true)]
    cell: f64,
    /// Time between two grids, seconds; the first is of the moment itself, the last of at most 4.8 s after it
    #[arg(id = "grids", long = "every", value_name = "SECONDS", default_value_t = 0.4, allow_negative_numbers = true)]
    every: f64,
    /// The area: lowest x and y, largest x and y, metres [default: all paths of the moment, and 1 m around them,
    /// without people too far away for 25 million cells]
    #[arg(long, value_name = "X,Y,X,Y", value_parser = corners, allow_hyphen_values = true)]
    area: Option<[f64; 4]>,
    /// Radius of a pedestrian, metres
    #[arg(long, default_value_t = Occupancy::BODY, allow_negative_numbers = true)]
    radius: f64,
    /// Folder for the files of npy and pgm, created if missing
    #[arg(long, value_name = "FOLDER", value_hint = clap::ValueHint::AnyPath)]
    folder: Option<OutputPlace>,
    /// Format: jsonl (one message of the layout of `nav_msgs/OccupancyGrid` for each time), npy (one array of times,
    /// rows and columns for each moment) or pgm (one image for each time), both with a yaml of origin and resolution
    /// [default: jsonl; with --folder npy]
    #[arg(long, value_enum)]
    format: Option<GridFormat>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum GridFormat {
    Jsonl,
    Npy,
    Pgm,
}

fn corners(text: &str) -> anyhow::Result<[f64; 4]> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse()).collect();
    let corners = numbers.ok().and_then(|numbers| numbers.try_into().ok());
    corners.context("an area is four numbers, such as -5,-5,5,5: lowest x and y, largest x and y (metres)")
}

/// Metres around the paths in an area of their own.
const MARGIN: f64 = 1.0;

impl OccupancyCommand {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        Occupancy::every(self.every)?;
        match (&self.folder, self.format()) {
            (None, GridFormat::Npy | GridFormat::Pgm) => {
                bail!("npy and pgm are files: name their folder with --folder")
            }
            (Some(_), GridFormat::Jsonl) => bail!("jsonl goes to --output or to standard output: leave out --folder"),
            (Some(_), _) if self.stream.output.is_some() => {
                bail!("npy and pgm are written into --folder: leave out --output")
            }
            (Some(folder), _) => {
                std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
            }
            (None, GridFormat::Jsonl) => {}
        }
        answer(&self, StreamState::default())
    }

    fn format(&self) -> GridFormat {
        let default = if self.folder.is_some() { GridFormat::Npy } else { GridFormat::Jsonl };
        self.format.unwrap_or(default)
    }

    fn area_of(&self, moment: &Moment<'_>, times: usize, state: &mut StreamState) -> anyhow::Result<Area> {
        if let Some([x0, y0, x1, y1]) = self.area {
            return Ok(Area::new([x0, y0], [x1, y1], self.cell)?);
        }
        let (area, left_out) = moment.answer.futures()?.area(MARGIN, self.cell, times)?;
        state.tell_notes_once(Note::outside_area(&left_out, moment.window), moment);
        Ok(area)
    }

    /// Writes the grids of one moment to files, whose names begin with `stem`.
    fn write(
        &self,
        stem: &str,
        area: &Area,
        grids: impl Iterator<Item = Occupancy>,
        times: usize,
    ) -> anyhow::Result<()> {
        let folder = self.folder.as_deref().unwrap_or(std::path::Path::new(""));
        let put = |name: String, bytes: &[u8]| {
            let path = folder.join(name);
            write_atomically(&path, bytes).with_context(|| format!("cannot write {}", path.display()))
        };
        if self.format() == GridFormat::Npy {
            let mut bytes = area.npy_head(times);
            let (mut head, mut at) = (String::new(), Vec::new());
            for grid in grids {
                bytes.extend(grid.npy_values());
                head = grid.yaml(&format!("{stem}.npy"));
                at.push(grid.time);
            }
            put(format!("{stem}.yaml"), format!("{head}times: {at:?}\n").as_bytes())?;
            return put(format!("{stem}.npy"), &bytes);
        }
        for grid in grids {
            let image = format!("{stem}_{:.2}s.pgm", grid.time);
            put(image.replace(".pgm", ".yaml"), grid.yaml(&image).as_bytes())?;
            put(image, &grid.pgm())?;
        }
        Ok(())
    }
}

impl AnsweringCommand for OccupancyCommand {
    fn stream(&self) -> &StreamOptions {
        &self.stream
    }

    /// The grids of one moment can fill a large part of the memory.
    fn at_once(&self) -> usize {
        1
    }

    fn text(&self, moments: &[Moment<'_>], state: &mut StreamState) -> anyhow::Result<String> {
        state.is_first_text();
        let times = Occupancy::every(self.every)?;
        let mut text = String::new();
        for moment in moments {
            let futures = moment.answer.futures()?;
            let area = self.area_of(moment, times.len(), state)?;
            area.ensure_kept(times.len())?;
            let grids = futures.occupancy(&area, &times, self.radius)?;
            let moment_number = moment.observed_until().rounded();
            if self.folder.is_some() {
                let scene = moment.scene.map_or_else(String::new, |scene| file_stem(scene) + "_");
                self.write(&format!("{scene}{moment_number}"), &area, grids, times.len())?;
                continue;
            }
            for grid in grids {
                let mut message = grid.message(state.frame_id.as_deref().unwrap_or("map"));
                if let Value::Object(fields) = &mut message {
                    fields.insert("observed_until".to_owned(), serde_json::to_value(moment_number)?);
                    if let Some(scene) = moment.scene {
                        fields.insert("scene".to_owned(), serde_json::to_value(scene)?);
                    }
                }
                text += &serde_json::to_string(&message)?;
                text.push('\n');
            }
        }
        Ok(text)
    }
}

//! Options by the names of the program's, and their ranges.

use crate::exchange::Failure;
use ddl::data::{ColumnChoice, Homography};
use ddl::{Request, TrackUnits, WindowOptions};
use serde::Deserialize;

/// `Options` of `types.d.ts`.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase", deny_unknown_fields)]
#[expect(clippy::struct_excessive_bools, reason = "switches of the user")]
pub(crate) struct BrowserOptions {
    fps: Option<f64>,
    dt: Option<f64>,
    frame_step: Option<i64>,
    homography: Option<String>,
    columns: Option<String>,
    keep: Option<String>,
    unit: Option<String>,
    whole: bool,
    max_age: Option<f64>,
    every: Option<f64>,
    last: bool,
    joint: bool,
    region: Vec<f64>,
    pub(crate) memory: bool,
    pub(crate) moments: Option<usize>,
}

impl BrowserOptions {
    pub(crate) fn units(&self) -> Result<TrackUnits, Failure> {
        let given = [self.fps.is_some(), self.dt.is_some(), self.frame_step.is_some()];
        if given.iter().filter(|is_given| **is_given).count() > 1 {
            return Err("give one of fps, dt and frameStep".into());
        }
        let homography = self.homography.as_deref().map(str::parse::<Homography>).transpose();
        Ok(TrackUnits {
            fps: self.fps,
            dt: self.dt,
            frame_step: self.frame_step,
            homography: homography.map_err(|error| format!("homography: {error}"))?,
        })
    }

    pub(crate) fn choice(&self) -> Result<ColumnChoice, Failure> {
        let given = [&self.columns, &self.keep, &self.unit].map(Option::as_deref);
        Ok(ColumnChoice::given(given, self.homography.is_some())?)
    }

    pub(crate) fn windows(&self) -> WindowOptions {
        WindowOptions { whole: self.whole, max_age: self.max_age, every: self.every, last: self.last }
    }

    /// What is asked of the model.
    pub(crate) fn request(&self) -> Result<Request, Failure> {
        let request = if self.joint { Request::joint() } else { Request::default() };
        Ok(if self.regions()?.is_empty() { request } else { request.with_adaptive_regions() })
    }

    /// Probabilities of regions.
    pub(crate) fn regions(&self) -> Result<&[f64], Failure> {
        let [low, high] = ddl::region_table().range();
        if self.region.iter().all(|level| (low..=high).contains(level)) {
            return Ok(&self.region);
        }
        Err(format!("the probability of a region must be from {low} to {high}").into())
    }
}

//! The node: the loop from a message with tracks to its forecast.

use crate::graph::{self, DEPTH_OF_TRANSFORMS, Inputs, Outputs, publish, take};
use crate::health::Health;
use crate::options::NodeArguments;
use crate::place::WatchedPlace;
use crate::tell;
use crate::transforms::{Transforms, moved};
use anyhow::Context as _;
use ddl::data::{TIME_STEP, Window, is_vehicle};
use ddl::scene::{Area, Occupancy};
use ddl::{Answer, Note};
use ddl_ros::msg::{Forecasts, Header};
use ddl_ros::{ForecastMessages, Observed, Tracks, occupancy_grid};
use ros2_client::{Gid, MessageInfo, ROSTime, SystemTime};
use std::iter::from_fn;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Metres around the paths in grids without a given area.
const MARGIN: f64 = 1.0;
/// Runs until it is interrupted.
pub(crate) fn run<T: Tracks + 'static>(options: &NodeArguments) -> anyhow::Result<()> {
    let stopped = Arc::new(AtomicBool::new(false));
    let of_handler = Arc::clone(&stopped);
    ctrlc::set_handler(move || of_handler.store(true, Ordering::Relaxed))?;
    let mut forecasting = Forecasting {
        options,
        place: WatchedPlace::open(options)?,
        transforms: Transforms::new(&options.frame, options.transform, options.transform_age),
        fixed_area: options.fixed_area()?,
        last_area: None,
        health: Health::default(),
        last: None,
        arrived: None,
    };
    let mut node = graph::open(options).context("the node cannot be opened")?;
    let outputs = Outputs::open(&mut node, options)?;
    let mut inputs = Inputs::<T>::open(&mut node, options)?;
    tell(&format!(
        "{} ({}) to {}, in frame {}, domain {}",
        options.topic(&options.topic),
        options.r#type,
        options.topic("~/forecasts"),
        options.frame,
        options.domain
    ));
    for name in options.strange_topics() {
        tell(&format!("note: {name} is no topic of the node, so it is not remapped"));
    }
    while !stopped.load(Ordering::Relaxed) {
        inputs.wait()?;
        // No more than waited: who sends without end must not keep the node from forecasts, reports and its end.
        for (subscription, is_static) in [(&inputs.resting, true), (&inputs.moving, false)] {
            for message in from_fn(|| take(subscription)).take(DEPTH_OF_TRANSFORMS) {
                let added = message.and_then(|(message, _)| forecasting.transforms.add(message, is_static));
                added.unwrap_or_else(|error| forecasting.health.fault(&error));
            }
        }
        for message in from_fn(|| take(&inputs.tracks)).take(options.depth.into()) {
            forecasting.health.note_message();
            let observed = message.and_then(|(message, info)| forecasting.observe(message, &info));
            observed.unwrap_or_else(|error| forecasting.health.dropped(&error));
        }
        forecasting.answer(&outputs).unwrap_or_else(|error| forecasting.health.dropped(&error));
        if let Some(report) = forecasting.health.report(&options.name) {
            publish(&outputs.diagnostics, report).unwrap_or_else(|error| forecasting.health.fault(&error));
        }
    }
    forecasting.place.close()
}

struct Forecasting<'a> {
    options: &'a NodeArguments,
    place: WatchedPlace,
    transforms: Transforms,
    /// The area of all grids; without it, that of the last ones.
    fixed_area: Option<Area>,
    last_area: Option<Area>,
    health: Health,
    /// The publisher and number of the last message with tracks.
    last: Option<(Gid, i64)>,
    arrived: Option<ROSTime>,
}

impl Forecasting<'_> {
    fn observe<T: Tracks>(&mut self, message: T, info: &MessageInfo) -> anyhow::Result<()> {
        let (publisher, number) = (info.publisher_gid(), info.sequence_number());
        if let Some((last_publisher, last)) = self.last.replace((publisher, number))
            && last_publisher == publisher
        {
            self.health.lost += (number - last - 1).max(0) as u64;
        }
        let mut observed = message.observed()?;
        observed.keep("no pedestrian by its class", |seen| match &self.options.class {
            Some(class) => seen.class == *class,
            None => !is_vehicle(&seen.class),
        });
        self.move_into_fixed_frame(&mut observed)?;
        for (reason, count) in &observed.left_out {
            self.health.left_out += count;
            self.health.warn(&format!("rows are left out: {reason}"));
        }
        self.place.observe(&observed, &mut self.health)?;
        self.arrived = info.received_timestamp();
        Ok(())
    }

    fn answer(&mut self, outputs: &Outputs) -> anyhow::Result<()> {
        match self.place.forecast()? {
            Some((header, Some((window, answer)))) => self.publish(&window, &answer, &header, outputs)?,
            Some((header, None)) => self.publish_nobody(header, outputs)?,
            None => {}
        }
        self.health.skipped = self.place.skipped();
        self.place.save(&mut self.health);
        Ok(())
    }

    fn move_into_fixed_frame(&mut self, observed: &mut Observed) -> anyhow::Result<()> {
        if self.options.transform.is_some() || observed.header.frame_id != self.options.frame {
            let (transform, is_held) = self.transforms.to_fixed(&observed.header)?;
            self.health.held += u64::from(is_held);
            for seen in &mut observed.pedestrians {
                seen.position = moved(&transform, seen.position);
            }
            observed.keep_finite();
            observed.header.frame_id.clone_from(&self.options.frame);
        }
        Ok(())
    }

    fn publish(&mut self, window: &Window, answer: &Answer, header: &Header, outputs: &Outputs) -> anyhow::Result<()> {
        let moment = ForecastMessages { window, forecast: answer.forecast(), header, joint: answer.is_joint() };
        publish(&outputs.forecasts, moment.forecasts())?;
        if let Some(arrived) = self.arrived {
            let latency = SystemTime::now().to_nanos() - arrived.to_nanos();
            self.health.answered(latency as f64 / 1e6);
        }
        publish(&outputs.markers, moment.markers())?;
        for path in moment.likeliest_paths() {
            publish(&outputs.paths, path)?;
        }
        if outputs.grids.is_empty() {
            return Ok(());
        }
        let futures = answer.futures()?;
        let (area, left_out) = match self.fixed_area {
            Some(area) => (area, Vec::new()),
            None => futures.area(MARGIN, self.options.cell, self.options.grids.len())?,
        };
        self.last_area = Some(area);
        if let Some(note) = Note::outside_area(&left_out, window) {
            self.health.warn(&note.to_string());
        }
        let grids = futures.occupancy(&area, &self.options.grids, Occupancy::BODY)?;
        for (grid, output) in grids.zip(&outputs.grids) {
            publish(output, occupancy_grid(&grid, header))?;
        }
        Ok(())
    }

    /// That nobody is there must be known too, or a costmap keeps those who left.
    fn publish_nobody(&mut self, header: Header, outputs: &Outputs) -> anyhow::Result<()> {
        if let Some(area) = self.fixed_area.or(self.last_area) {
            let [width, height] = area.size();
            for (&time, output) in self.options.grids.iter().zip(&outputs.grids) {
                let probabilities = vec![0.0; width * height];
                let empty = Occupancy { area, time, probabilities };
                publish(output, occupancy_grid(&empty, &header))?;
            }
        }
        let joint = self.options.joint;
        let empty = Forecasts { header, time_step: TIME_STEP, joint, pedestrians: Vec::new() };
        publish(&outputs.forecasts, empty)
    }
}

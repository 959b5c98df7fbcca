//! The node: its subscriptions, its publishers, and the loop from a message with tracks to its forecast.

use crate::health::Health;
use crate::options::Options;
use crate::place::Place;
use crate::tell;
use crate::transforms::{Transforms, moved};
use anyhow::{Context as _, anyhow};
use ddl::Forecast;
use ddl::data::Window;
use ddl::scene::{Area, Futures, Occupancy};
use ddl_ros::msg::{DiagnosticArray, Forecasts, Header, MarkerArray, OccupancyGrid, Path, TfMessage};
use ddl_ros::{Message, Moment, Observed, Tracks, occupancy_grid};
use ros2_client::dds::rustdds::{DomainParticipantBuilder, Topic, mio1};
use ros2_client::qos::{Durability, History, WhenFull};
use ros2_client::{
    Context, Gid, MessageInfo, MessageTypeName, Name, Node, NodeName, NodeOptions, Publisher, QosProfile, ROSTime,
    Subscription, SystemTime,
};
use std::io::ErrorKind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Longest time without a look at the clock.
const WAIT: Duration = Duration::from_millis(200);
/// Metres around the paths in grids without a given area.
const MARGIN: f64 = 1.0;
/// Messages kept for a subscriber that is late; paths, one for each pedestrian, are many.
const DEPTH: usize = 10;
const DEPTH_OF_PATHS: usize = 1000;
const DEPTH_OF_TRANSFORMS: usize = 100;

/// Runs until it is interrupted.
pub(crate) fn run<T: Tracks + 'static>(options: &Options) -> anyhow::Result<()> {
    let stopped = Arc::new(AtomicBool::new(false));
    let of_handler = Arc::clone(&stopped);
    ctrlc::set_handler(move || of_handler.store(true, Ordering::Relaxed))?;
    let mut forecasting = Forecasting {
        options,
        place: Place::open(options)?,
        transforms: Transforms::new(&options.frame, options.transform, options.transform_age),
        fixed_area: options.fixed_area()?,
        last_area: None,
        health: Health::default(),
        last: None,
        arrived: None,
    };
    let mut node = open(options).context("the node cannot be opened")?;
    let outputs = Outputs::open(&mut node, options)?;
    let qos = QosProfile::subscription_default().history(History::KeepLast {
        depth: options.depth.into(),
    });
    let qos = if options.reliable {
        qos.reliability_reliable(WhenFull::Fail)
    } else {
        qos
    };
    let mut tracks = subscribe::<T>(&mut node, &options.topic, &qos)?;
    let qos = reliable(DEPTH_OF_TRANSFORMS);
    let mut moving = subscribe::<TfMessage>(&mut node, "/tf", &qos)?;
    let mut resting = subscribe::<TfMessage>(&mut node, "/tf_static", &qos.durability(Durability::TransientLocal))?;
    let mut poll = mio1::Poll::new()?;
    let sources: [&mut dyn mio1::event::Source; 3] = [&mut tracks, &mut moving, &mut resting];
    for (index, source) in sources.into_iter().enumerate() {
        poll.registry()
            .register(source, mio1::Token(index), mio1::Interest::READABLE)?;
    }
    tell(&format!(
        "{} ({}) to /{}/forecasts, in frame {}, domain {}",
        options.topic, options.r#type, options.name, options.frame, options.domain
    ));
    let mut events = mio1::Events::with_capacity(8);
    while !stopped.load(Ordering::Relaxed) {
        match poll.poll(&mut events, Some(WAIT)) {
            Err(error) if error.kind() != ErrorKind::Interrupted => return Err(error.into()),
            _ => {}
        }
        for (subscription, is_static) in [(&resting, true), (&moving, false)] {
            while let Some(message) = take(subscription) {
                let added = message.and_then(|(message, _)| forecasting.transforms.add(message, is_static));
                added.unwrap_or_else(|error| forecasting.health.fault(&error));
            }
        }
        while let Some(message) = take(&tracks) {
            forecasting.health.hear();
            let observed = message.and_then(|(message, info)| forecasting.observe(message, &info));
            observed.unwrap_or_else(|error| forecasting.health.dropped(&error));
        }
        forecasting
            .answer(&outputs)
            .unwrap_or_else(|error| forecasting.health.dropped(&error));
        if let Some(report) = forecasting.health.report(&options.name) {
            publish(&outputs.diagnostics, report).unwrap_or_else(|error| forecasting.health.fault(&error));
        }
    }
    forecasting.place.close()
}

/// The next message that has arrived.
fn take<M: Message + 'static>(from: &Subscription<M>) -> Option<anyhow::Result<(M, MessageInfo)>> {
    let malformed = |error| anyhow!("a message {} is malformed: {error}", M::TYPE);
    from.take().map_err(malformed).transpose()
}

struct Forecasting<'a> {
    options: &'a Options,
    place: Place,
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
        self.health.occluded += observed.occluded as u64;
        if let Some(class) = &self.options.class {
            observed.pedestrians.retain(|seen| seen.class == *class);
        }
        self.to_fixed(&mut observed)?;
        self.health.doubtful += self.place.observe(&observed)? as u64;
        self.arrived = info.received_timestamp();
        Ok(())
    }

    fn answer(&mut self, outputs: &Outputs) -> anyhow::Result<()> {
        if let Some(answer) = self.place.forecast()? {
            match &answer.forecast {
                Some((window, forecast)) => self.publish(window, forecast, &answer.header, outputs)?,
                None => self.publish_nobody(answer.header, outputs)?,
            }
        }
        self.health.skipped = self.place.skipped();
        self.place.save()
    }

    fn to_fixed(&self, observed: &mut Observed) -> anyhow::Result<()> {
        if self.options.transform.is_some() || observed.header.frame_id != self.options.frame {
            let transform = self.transforms.to_fixed(&observed.header)?;
            for seen in &mut observed.pedestrians {
                seen.position = moved(&transform, seen.position);
            }
            observed.header.frame_id.clone_from(&self.options.frame);
        }
        Ok(())
    }

    fn publish(
        &mut self,
        window: &Window,
        forecast: &Forecast,
        header: &Header,
        outputs: &Outputs,
    ) -> anyhow::Result<()> {
        let moment = Moment {
            window,
            forecast,
            header,
            joint: self.options.joint,
        };
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
        let futures = Futures::new(window, forecast.clone())?;
        let around = || futures.area(MARGIN, self.options.cell);
        let area = *self.last_area.insert(self.fixed_area.map_or_else(around, Ok)?);
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
                let empty = Occupancy {
                    area,
                    time,
                    probabilities,
                };
                publish(output, occupancy_grid(&empty, &header))?;
            }
        }
        let joint = self.options.joint;
        publish(
            &outputs.forecasts,
            Forecasts {
                header,
                joint,
                ..Forecasts::default()
            },
        )
    }
}

struct Outputs {
    forecasts: Publisher<Forecasts>,
    paths: Publisher<Path>,
    markers: Publisher<MarkerArray>,
    /// One for each time.
    grids: Vec<Publisher<OccupancyGrid>>,
    diagnostics: Publisher<DiagnosticArray>,
}

impl Outputs {
    fn open(node: &mut Node, options: &Options) -> anyhow::Result<Self> {
        let own = |name: &str| format!("/{}/{name}", options.name);
        let mut grids = Vec::new();
        for time in &options.grids {
            // 0.8 s ahead: t0_8.
            let name = format!("occupancy/t{time}").replace('.', "_");
            grids.push(advertise(node, &own(&name), DEPTH)?);
        }
        Ok(Self {
            forecasts: advertise(node, &own("forecasts"), DEPTH)?,
            paths: advertise(node, &own("paths"), DEPTH_OF_PATHS)?,
            markers: advertise(node, &own("markers"), DEPTH)?,
            grids,
            diagnostics: advertise(node, "/diagnostics", DEPTH)?,
        })
    }
}

fn open(options: &Options) -> anyhow::Result<Node> {
    let mut participant = DomainParticipantBuilder::new(options.domain);
    if !options.interface.is_empty() {
        participant = participant.with_only_networks(options.interface.iter().copied());
    }
    let context = Context::from_domain_participant(participant.build()?)?;
    let name = NodeName::new("/", &options.name)?;
    Ok(context.new_node(name, NodeOptions::new())?)
}

fn reliable(depth: usize) -> QosProfile {
    // A subscriber that hangs must not hold up the others.
    QosProfile::publisher_default()
        .reliability_reliable(WhenFull::Fail)
        .history(History::KeepLast { depth })
}

fn topic<M: Message>(node: &Node, name: &str, qos: &QosProfile) -> anyhow::Result<Topic> {
    let (space, base) = name.rsplit_once('/').unwrap_or(("", name));
    let (package, kind) = M::TYPE.split_once("/msg/").context(M::TYPE)?;
    let kind = MessageTypeName::new(package, kind);
    let space = format!("/{}", space.trim_start_matches('/'));
    let dds_name = Name::new(&space, base).with_context(|| format!("{name} is no name of a topic"))?;
    node.create_topic(&dds_name, kind, qos).with_context(|| name.to_owned())
}

fn subscribe<M: Message + 'static>(node: &mut Node, name: &str, qos: &QosProfile) -> anyhow::Result<Subscription<M>> {
    let topic = topic::<M>(node, name, qos)?;
    node.create_subscription(&topic, None).with_context(|| name.to_owned())
}

fn advertise<M: Message>(node: &mut Node, name: &str, depth: usize) -> anyhow::Result<Publisher<M>> {
    let topic = topic::<M>(node, name, &reliable(depth))?;
    node.create_publisher(&topic, None).with_context(|| name.to_owned())
}

fn publish<M: Message>(to: &Publisher<M>, message: M) -> anyhow::Result<()> {
    let sent = to.publish(message);
    sent.map_err(|error| anyhow!("a message {} was not sent: {error}", M::TYPE))
}

//! The node in the graph of ROS 2: its subscriptions and publishers.

use crate::options::NodeArguments;
use anyhow::{Context as _, anyhow};
use ddl_ros::Message;
use ddl_ros::msg::{DiagnosticArray, Forecasts, MarkerArray, OccupancyGrid, Path, TfMessage};
use ros2_client::dds::rustdds::{DomainParticipantBuilder, Topic, mio1};
use ros2_client::qos::{Durability, History, WhenFull};
use ros2_client::{
    Context, MessageInfo, MessageTypeName, Name, Node, NodeName, NodeOptions, Publisher, QosProfile, Subscription,
};
use std::io::ErrorKind;
use std::time::Duration;

/// Longest time without a look at the clock.
const WAIT: Duration = Duration::from_millis(200);
/// Messages kept for a subscriber that is late; paths, one for each pedestrian, are many.
const DEPTH: usize = 10;
const DEPTH_OF_PATHS: usize = 1000;
pub(crate) const DEPTH_OF_TRANSFORMS: usize = 100;

pub(crate) struct Inputs<T> {
    pub(crate) tracks: Subscription<T>,
    /// `/tf` and `/tf_static`.
    pub(crate) moving: Subscription<TfMessage>,
    pub(crate) resting: Subscription<TfMessage>,
    poll: mio1::Poll,
    events: mio1::Events,
}

impl<T: Message + 'static> Inputs<T> {
    pub(crate) fn open(node: &mut Node, options: &NodeArguments) -> anyhow::Result<Self> {
        let depth = options.depth.into();
        let mut qos = QosProfile::subscription_default().history(History::KeepLast { depth });
        if options.reliable {
            qos = qos.reliability_reliable(WhenFull::Fail);
        }
        let of_transforms = reliable(DEPTH_OF_TRANSFORMS);
        let latched = of_transforms.clone().durability(Durability::TransientLocal);
        let mut inputs = Self {
            tracks: subscribe(node, &options.topic(&options.topic), &qos)?,
            moving: subscribe(node, &options.topic("/tf"), &of_transforms)?,
            resting: subscribe(node, &options.topic("/tf_static"), &latched)?,
            poll: mio1::Poll::new()?,
            events: mio1::Events::with_capacity(8),
        };
        let sources: [&mut dyn mio1::event::Source; 3] = [&mut inputs.tracks, &mut inputs.moving, &mut inputs.resting];
        for (index, source) in sources.into_iter().enumerate() {
            let (token, interest) = (mio1::Token(index), mio1::Interest::READABLE);
            inputs.poll.registry().register(source, token, interest)?;
        }
        Ok(inputs)
    }

    /// Waits for a message, for a moment.
    pub(crate) fn wait(&mut self) -> anyhow::Result<()> {
        match self.poll.poll(&mut self.events, Some(WAIT)) {
            Err(error) if error.kind() != ErrorKind::Interrupted => Err(error.into()),
            _ => Ok(()),
        }
    }
}

/// The next message that has arrived.
pub(crate) fn take<M: Message + 'static>(from: &Subscription<M>) -> Option<anyhow::Result<(M, MessageInfo)>> {
    from.take().map_err(|error| anyhow!("a message {} is malformed: {error}", M::TYPE)).transpose()
}

pub(crate) struct Outputs {
    pub(crate) forecasts: Publisher<Forecasts>,
    pub(crate) paths: Publisher<Path>,
    pub(crate) markers: Publisher<MarkerArray>,
    /// One for each time.
    pub(crate) grids: Vec<Publisher<OccupancyGrid>>,
    pub(crate) diagnostics: Publisher<DiagnosticArray>,
}

impl Outputs {
    pub(crate) fn open(node: &mut Node, options: &NodeArguments) -> anyhow::Result<Self> {
        let own = |name: &str| options.topic(&format!("~/{name}"));
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
            diagnostics: advertise(node, &options.topic("/diagnostics"), DEPTH)?,
        })
    }
}

pub(crate) fn open(options: &NodeArguments) -> anyhow::Result<Node> {
    let mut participant = DomainParticipantBuilder::new(options.domain);
    if !options.interface.is_empty() {
        participant = participant.with_only_networks(options.interface.iter().copied());
    }
    let context = Context::from_domain_participant(participant.build()?)?;
    Ok(context.new_node(NodeName::new(&options.namespace, &options.name)?, NodeOptions::new())?)
}

fn reliable(depth: usize) -> QosProfile {
    // A subscriber that hangs must not hold up the others.
    QosProfile::publisher_default().reliability_reliable(WhenFull::Fail).history(History::KeepLast { depth })
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

pub(crate) fn publish<M: Message>(to: &Publisher<M>, message: M) -> anyhow::Result<()> {
    let sent = to.publish(message);
    sent.map_err(|error| anyhow!("a message {} was not sent: {error}", M::TYPE))
}

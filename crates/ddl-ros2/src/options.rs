//! The options, which are the parameters of the node.

use anyhow::Context as _;
use clap::Parser;
use clap::builder::PossibleValuesParser;
use ddl::data::{HORIZON, LiveTracks, TIME_STEP};
use ddl::scene::Area;
use ddl_ros::Message as _;
use ddl_ros::msg::{Detection3DArray, People, TrackedPersons};
use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use std::net::IpAddr;
use std::path::PathBuf;

/// Forecast pedestrians in ROS 2: subscribe to tracks, publish where they will be in the next 4.8 s
#[derive(Debug, Parser)]
#[command(name = "ddl-ros2", version, allow_negative_numbers = true)]
#[command(after_help = "Options are also parameters of ROS: --ros-args -p transform_age:=0.5 --params-file FILE")]
pub(crate) struct NodeArguments {
    /// Topic of the tracks; without / at its start it is in the namespace
    #[arg(long, default_value = "/tracks")]
    pub(crate) topic: String,
    /// Type of its messages
    #[arg(long, default_value = Detection3DArray::TYPE)]
    #[arg(value_parser = PossibleValuesParser::new([Detection3DArray::TYPE, People::TYPE, TrackedPersons::TYPE]))]
    pub(crate) r#type: String,
    /// Only detections whose likeliest class this is, such as person [default: all but vehicles]
    #[arg(long)]
    pub(crate) class: Option<String>,
    /// Name of the node; its topics begin with it
    #[arg(long, default_value = "ddl")]
    pub(crate) name: String,
    /// Namespace of the node
    #[arg(long, value_name = "/SPACE", default_value = "/", value_parser = space)]
    pub(crate) namespace: String,
    /// Other name for a topic of the node, such as /tf:=/robot/tf; may be repeated
    #[arg(long, value_name = "TOPIC:=TOPIC", value_delimiter = ',', value_parser = pair)]
    pub(crate) remap: Vec<(String, String)>,
    /// Frame that does not move, in which forecasts are made
    #[arg(long, default_value = "map")]
    pub(crate) frame: String,
    /// Place of the frame of the tracks in the fixed frame, instead of /tf: metres and radians
    #[arg(long, value_name = "X,Y,Z,YAW,PITCH,ROLL", value_parser = transform)]
    pub(crate) transform: Option<Isometry3<f64>>,
    /// Oldest transform of /tf that is used where none is newer than the tracks, seconds
    #[arg(long, value_name = "SECONDS", default_value_t = 0.2, value_parser = short)]
    pub(crate) transform_age: f64,
    /// Model: the directory of a run, or a packed file [default: the built-in one]
    #[arg(long)]
    pub(crate) model: Option<PathBuf>,
    /// Forecast joint futures of all pedestrians
    #[arg(long)]
    pub(crate) joint: bool,
    /// Also publish grids of the probability that somebody is there, this many seconds ahead: 0.8,1.6
    #[arg(long, value_name = "SECONDS,...", value_delimiter = ',', requires = "joint", value_parser = ahead)]
    pub(crate) grids: Vec<f64>,
    /// Side of a cell of the grids, metres
    #[arg(long, default_value_t = 0.1, value_parser = positive)]
    pub(crate) cell: f64,
    /// Lowest x and y, largest x and y of the grids, metres [default: all paths, and 1 m around them]
    #[arg(long, value_name = "X,Y,X,Y", value_parser = corners, requires = "grids")]
    pub(crate) area: Option<[f64; 4]>,
    /// Most forecasts a second [default: one for each message]
    #[arg(long, value_name = "HZ", value_parser = positive)]
    pub(crate) rate: Option<f64>,
    /// File of the paths that this place has seen, for a fixed sensor; created if missing
    #[arg(long, value_name = "FILE")]
    pub(crate) memory: Option<PathBuf>,
    /// Oldest last row of a pedestrian that is still forecast, seconds
    #[arg(long, value_name = "SECONDS", value_parser = short)]
    pub(crate) max_age: Option<f64>,
    /// Ask the tracker to send lost messages again; one that is best effort is then not heard
    #[arg(long)]
    pub(crate) reliable: bool,
    /// Most messages that wait
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) depth: u16,
    /// DDS domain
    #[arg(long, env = "ROS_DOMAIN_ID", default_value_t = 0, value_parser = clap::value_parser!(u16).range(..=232))]
    pub(crate) domain: u16,
    /// Address of the network interface to be found on [default: all]
    #[arg(long, value_name = "IP", value_delimiter = ',')]
    pub(crate) interface: Vec<IpAddr>,
    /// Threads that compute [default: as many as processor cores]
    #[arg(long)]
    pub(crate) threads: Option<usize>,
}

impl NodeArguments {
    /// The full name of a topic of the node, as it is remapped.
    pub(crate) fn topic(&self, name: &str) -> String {
        let name = self.full(name);
        self.remap.iter().find(|(from, _)| self.full(from) == name).map_or(name, |(_, to)| self.full(to))
    }

    /// `~` stands for the node, and other names without / at their start are in the namespace.
    fn full(&self, name: &str) -> String {
        let space = self.namespace.trim_end_matches('/');
        match name.strip_prefix("~/") {
            Some(own) => format!("{space}/{}/{own}", self.name),
            None if name.starts_with('/') => name.to_owned(),
            None => format!("{space}/{name}"),
        }
    }

    /// Names that are to be remapped, and are no topics of the node.
    pub(crate) fn strange_topics(&self) -> impl Iterator<Item = &str> {
        let own = ["/tf", "/tf_static", "/diagnostics", "~/forecasts", "~/paths", "~/markers"];
        let known = own.into_iter().chain([self.topic.as_str()]).map(|name| self.full(name));
        let grids = self.full("~/occupancy/");
        let known: Vec<String> = known.collect();
        let names = self.remap.iter().map(|(from, _)| from.as_str());
        names.filter(move |name| !known.contains(&self.full(name)) && !self.full(name).starts_with(&grids))
    }

    /// The area of the grids, if it is given.
    pub(crate) fn fixed_area(&self) -> anyhow::Result<Option<Area>> {
        Ok(self.area.map(|[x, y, to_x, to_y]| Area::new([x, y], [to_x, to_y], self.cell)).transpose()?)
    }
}

fn numbers<const N: usize>(text: &str) -> anyhow::Result<[f64; N]> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse()).collect();
    let numbers = numbers.ok().filter(|numbers| numbers.iter().all(|number: &f64| number.is_finite()));
    let numbers = numbers.and_then(|numbers| numbers.try_into().ok());
    numbers.with_context(|| format!("give {N} numbers with commas between them"))
}

fn space(text: &str) -> anyhow::Result<String> {
    text.strip_prefix('/').map(|_| text.to_owned()).context("begin it with /")
}

/// `NAME:=VALUE`, as ROS writes it.
pub(crate) fn pair(rule: &str) -> anyhow::Result<(String, String)> {
    let pair = rule.split_once(":=").map(|(name, value)| (name.to_owned(), value.to_owned()));
    pair.with_context(|| format!("{rule}: give NAME:=VALUE"))
}

fn corners(text: &str) -> anyhow::Result<[f64; 4]> {
    numbers(text)
}

fn transform(text: &str) -> anyhow::Result<Isometry3<f64>> {
    let [x, y, z, yaw, pitch, roll] = numbers(text)?;
    let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    Ok(Isometry3::from_parts(Translation3::new(x, y, z), rotation))
}

fn ahead(text: &str) -> anyhow::Result<f64> {
    let [number] = numbers(text)?;
    let last = HORIZON as f64 * TIME_STEP;
    (0.0..=last).contains(&number).then_some(number).with_context(|| format!("give seconds from 0 to {last:.1}"))
}

/// A time no longer than tracks are carried on.
fn short(text: &str) -> anyhow::Result<f64> {
    let [number] = numbers(text)?;
    let longest = LiveTracks::LONGEST_GAP;
    (0.0..=longest).contains(&number).then_some(number).with_context(|| format!("give seconds from 0 to {longest}"))
}

fn positive(text: &str) -> anyhow::Result<f64> {
    let [number] = numbers(text)?;
    (number > 0.0).then_some(number).context("give a number above 0")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn topics_areas_and_transforms_are_read_as_ros_writes_them() {
        let line = "node --namespace=/hall/ --name=crowd --topic=seen --remap=seen:=/people,~/paths:=ways,x:=y --joint \
                    --grids=4.8 --area=-1,2,3.5,4 --cell=0.5 --transform=1,2,3,0.7,0.4,-0.2";
        let options = NodeArguments::parse_from(line.split_whitespace());
        let topics = ["seen", "~/markers", "~/paths", "/tf"].map(|name| options.topic(name));
        assert_eq!(topics.join(" "), "/people /hall/crowd/markers /hall/ways /tf");
        assert_eq!(options.strange_topics().collect::<Vec<_>>(), ["x"]);
        let area = options.fixed_area().unwrap().unwrap();
        assert_eq!((area.origin(), area.size()), ([-1.0, 2.0], [9, 4]));
        let moved = crate::transforms::moved(&options.transform.unwrap(), [1.5, -0.75].into());
        // Rz(0.7) Ry(0.4) Rx(-0.2) of it, and (1, 2).
        assert!((moved.x - 2.574_610_9).hypot(moved.y - 2.365_228_6) < 1e-6);
    }
}

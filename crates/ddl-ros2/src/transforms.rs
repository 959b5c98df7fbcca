//! Where frames are in the fixed frame: the transforms of `/tf` and `/tf_static`, or one that is given.

use anyhow::{Context as _, bail, ensure};
use ddl_ros::msg::{Header, Point, TfMessage};
use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion};
use std::collections::{BTreeMap, VecDeque};

/// Microseconds for which transforms are kept.
const KEPT: i64 = 10_000_000;

/// The transforms known so far.
#[derive(Debug)]
pub(crate) struct Transforms {
    fixed_frame: String,
    given: Option<Isometry3<f64>>,
    /// Microseconds that a transform holds on.
    holds: i64,
    /// Each frame in its parent.
    frames: BTreeMap<String, Link>,
}

#[derive(Debug)]
struct Link {
    parent: String,
    is_static: bool,
    /// In order of time (microseconds).
    poses: VecDeque<(i64, Isometry3<f64>)>,
}

impl Transforms {
    pub(crate) fn new(fixed_frame: &str, given: Option<Isometry3<f64>>, holds: f64) -> Self {
        Self {
            fixed_frame: name(fixed_frame).to_owned(),
            given,
            holds: (1e6 * holds) as i64,
            frames: BTreeMap::new(),
        }
    }

    /// Adds all transforms of a message but those that are none.
    pub(crate) fn add(&mut self, message: TfMessage, is_static: bool) -> anyhow::Result<()> {
        let mut added = Ok(());
        for stamped in message.transforms {
            let (frame, parent) = (name(&stamped.child_frame_id), name(&stamped.header.frame_id));
            let (to, turned) = (stamped.transform.translation, stamped.transform.rotation);
            let turned = Quaternion::new(turned.w, turned.x, turned.y, turned.z);
            let Some(turned) = UnitQuaternion::try_new(turned, 1e-6).filter(|_| (to.x + to.y + to.z).is_finite())
            else {
                added = Err(anyhow::anyhow!("the transform from {frame} to {parent} is not one"));
                continue;
            };
            let pose = Isometry3::from_parts(Translation3::new(to.x, to.y, to.z), turned);
            let link = self.frames.entry(frame.to_owned()).or_insert_with(|| Link {
                parent: String::new(),
                is_static,
                poses: VecDeque::new(),
            });
            let stamp = stamped.header.stamp.microseconds();
            let restarted = link.poses.back().is_some_and(|(last, _)| stamp < last - KEPT);
            if is_static || restarted || link.parent != parent {
                link.poses.clear();
            }
            (link.parent, link.is_static) = (parent.to_owned(), is_static);
            let place = link.poses.partition_point(|(other, _)| *other <= stamp);
            link.poses.insert(place, (stamp, pose));
            let newest = link.poses.back().map_or(stamp, |(last, _)| *last);
            link.poses.retain(|(other, _)| newest - other <= KEPT);
        }
        added
    }

    /// The transform from the frame of a header to the fixed frame at its moment.
    pub(crate) fn to_fixed(&self, header: &Header) -> anyhow::Result<Isometry3<f64>> {
        let (from, to) = (name(&header.frame_id), self.fixed_frame.as_str());
        if let Some(given) = self.given {
            return Ok(given);
        }
        ensure!(
            !from.is_empty(),
            "the tracks name no frame: set header.frame_id, or give --transform"
        );
        let time = header.stamp.microseconds();
        for (ancestor, up) in self.upwards(from, time) {
            if let Some((_, other)) = self.upwards(to, time).find(|(frame, _)| *frame == ancestor) {
                let found = || format!("the transform from {from} to {to}");
                return Ok(other.with_context(found)?.inverse() * up.with_context(found)?);
            }
        }
        bail!(
            "no transform from {from} to {to} is known: publish it on /tf or /tf_static, or give --transform, or name \
             another --frame"
        )
    }

    /// The frame and its ancestors, with the transform from the frame to each.
    fn upwards<'a>(
        &'a self,
        frame: &'a str,
        time: i64,
    ) -> impl Iterator<Item = (&'a str, anyhow::Result<Isometry3<f64>>)> {
        let mut next = Some((frame, Ok(Isometry3::identity())));
        let step = move || {
            let (frame, up): (&str, anyhow::Result<_>) = next.take()?;
            let link = self.frames.get(frame);
            next = link.map(|link| {
                let up = up.as_ref().map_err(|error| anyhow::anyhow!("{error}"));
                (
                    link.parent.as_str(),
                    up.and_then(|up| Ok(link.at(time, self.holds)? * up)),
                )
            });
            Some((frame, up))
        };
        // A frame that is its own ancestor has no end.
        std::iter::from_fn(step).take(self.frames.len() + 1)
    }
}

impl Link {
    fn at(&self, time: i64, holds: i64) -> anyhow::Result<Isometry3<f64>> {
        let after = self.poses.partition_point(|(stamp, _)| *stamp <= time);
        let next = self.poses.get(after);
        let Some((stamp, pose)) = after.checked_sub(1).and_then(|last| self.poses.get(last)) else {
            let (first, pose) = next.context("is empty")?;
            ensure!(self.is_static, "begins {} s after the tracks", seconds(first - time));
            return Ok(*pose);
        };
        if self.is_static {
            return Ok(*pose);
        }
        let Some((next, next_pose)) = next else {
            let age = time - stamp;
            ensure!(
                age <= holds,
                "is {} s old; --transform-age allows {} s",
                seconds(age),
                seconds(holds)
            );
            return Ok(*pose);
        };
        let share = (time - stamp) as f64 / (next - stamp) as f64;
        Ok(pose.try_lerp_slerp(next_pose, share, 1e-9).unwrap_or(*pose))
    }
}

/// A place in the frame that a transform leads to.
pub(crate) fn moved(transform: &Isometry3<f64>, place: Point) -> Point {
    let Point3 { coords } = transform * Point3::new(place.x, place.y, place.z);
    Point {
        x: coords.x,
        y: coords.y,
        z: coords.z,
    }
}

/// Frames of ROS 1 begin with a slash.
fn name(frame: &str) -> &str {
    frame.trim_start_matches('/')
}

fn seconds(microseconds: i64) -> f64 {
    microseconds as f64 / 1e6
}

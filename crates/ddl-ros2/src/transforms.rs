//! Where frames are in the fixed frame: the transforms of `/tf` and `/tf_static`, or one that is given.

use anyhow::{anyhow, bail, ensure};
use ddl::data::LiveTracks;
use ddl_ros::msg::{Header, Point, TfMessage};
use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion};
use std::collections::{BTreeMap, VecDeque};

/// Microseconds for which transforms are kept, and after which time that goes back begins anew, as for tracks.
const KEPT: i64 = 10_000_000;
const BACK: i64 = (1e6 * LiveTracks::LONGEST_GAP) as i64;

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

/// A transform, and whether it is older than its moment.
type Found = (Isometry3<f64>, bool);

#[derive(Debug)]
struct Link {
    parent: String,
    is_static: bool,
    /// In order of time (microseconds).
    poses: VecDeque<(i64, Isometry3<f64>)>,
}

impl Transforms {
    pub(crate) fn new(fixed_frame: &str, given: Option<Isometry3<f64>>, holds: f64) -> Self {
        Self { fixed_frame: name(fixed_frame).to_owned(), given, holds: (1e6 * holds) as i64, frames: BTreeMap::new() }
    }

    /// Adds all transforms of a message but those that are none.
    pub(crate) fn add(&mut self, message: TfMessage, is_static: bool) -> anyhow::Result<()> {
        let mut added = Ok(());
        for stamped in message.transforms {
            let (frame, parent) = (name(&stamped.child_frame_id), name(&stamped.header.frame_id));
            let (to, turned) = (stamped.transform.translation, stamped.transform.rotation);
            let turned = Quaternion::new(turned.w, turned.x, turned.y, turned.z);
            let Some(turned) =
                UnitQuaternion::try_new(turned, 1e-6).filter(|turned| (to.x + to.y + to.z + turned.norm()).is_finite())
            else {
                added = Err(anyhow!("the transform from {frame} to {parent} is not one"));
                continue;
            };
            let pose = Isometry3::from_parts(Translation3::new(to.x, to.y, to.z), turned);
            let stamp = stamped.header.stamp.microseconds();
            let last = self.frames.get(frame).and_then(|link| link.poses.back());
            if !is_static && last.is_some_and(|(last, _)| stamp < last - BACK) {
                self.frames.retain(|_, link| link.is_static);
            }
            let link = self.frames.entry(frame.to_owned()).or_insert_with(|| Link {
                parent: String::new(),
                is_static,
                poses: VecDeque::new(),
            });
            if is_static || link.parent != parent {
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
    pub(crate) fn to_fixed(&self, header: &Header) -> anyhow::Result<Found> {
        let (from, to) = (name(&header.frame_id), self.fixed_frame.as_str());
        if let Some(given) = self.given {
            return Ok((given, false));
        }
        ensure!(!from.is_empty(), "the tracks name no frame: set header.frame_id, or give --transform");
        let time = header.stamp.microseconds();
        let others = self.upwards(to, time);
        for (ancestor, up) in self.upwards(from, time) {
            if let Some((_, other)) = others.iter().find(|(frame, _)| *frame == ancestor) {
                let (other, up) = (other.clone()?, up?);
                return Ok((other.0.inverse() * up.0, other.1 || up.1));
            }
        }
        bail!(
            "no transform from {from} to {to} is known: publish it on /tf or /tf_static, or give --transform, or name \
             another --frame"
        )
    }

    /// The frame and its ancestors, with the transform from the frame to each.
    fn upwards<'a>(&'a self, frame: &'a str, time: i64) -> Vec<(&'a str, Result<Found, NoTransform>)> {
        let mut chain = vec![(frame, Ok((Isometry3::identity(), false)))];
        // A frame that is its own ancestor has no end.
        while chain.len() <= self.frames.len()
            && let Some((frame, up)) = chain.last()
            && let Some(link) = self.frames.get(*frame)
        {
            let of_link = |fault| NoTransform { from: (*frame).to_owned(), to: link.parent.clone(), fault };
            let up = up.clone().and_then(|(up, was_held)| {
                let (pose, is_held) = link.at(time, self.holds).map_err(of_link)?;
                Ok((pose * up, was_held || is_held))
            });
            chain.push((&link.parent, up));
        }
        chain
    }
}

/// Why a transform cannot be used.
#[derive(Debug, Clone, thiserror::Error)]
#[error("the transform from {from} to {to} {fault}")]
struct NoTransform {
    from: String,
    to: String,
    fault: LinkFault,
}

/// What is wrong with it; times are microseconds.
#[derive(Debug, Clone, Copy, thiserror::Error)]
enum LinkFault {
    #[error("begins after the tracks")]
    BeginsLater,
    #[error("is {} s old; --transform-age allows {} s", *.age as f64 / 1e6, *.holds as f64 / 1e6)]
    Old { age: i64, holds: i64 },
}

impl Link {
    fn at(&self, time: i64, holds: i64) -> Result<Found, LinkFault> {
        let after = self.poses.partition_point(|(stamp, _)| self.is_static || *stamp <= time);
        let Some((stamp, pose)) = after.checked_sub(1).and_then(|last| self.poses.get(last)) else {
            return Err(LinkFault::BeginsLater);
        };
        let Some((next, next_pose)) = self.poses.get(after) else {
            let age = time - stamp;
            if self.is_static || age <= holds {
                return Ok((*pose, !self.is_static && age > 0));
            }
            return Err(LinkFault::Old { age, holds });
        };
        let share = (time - stamp) as f64 / (next - stamp) as f64;
        Ok((pose.try_lerp_slerp(next_pose, share, 1e-9).unwrap_or(*pose), false))
    }
}

/// Where a place is on the ground of the frame that a transform leads to. Its height counts if the transform tilts.
pub(crate) fn moved(transform: &Isometry3<f64>, Point { x, y, z }: Point) -> Point {
    let is_level = transform.rotation.i == 0.0 && transform.rotation.j == 0.0;
    let moved = transform * Point3::new(x, y, if is_level { 0.0 } else { z });
    [moved.x, moved.y].into()
}

/// Frames of ROS 1 begin with a slash.
fn name(frame: &str) -> &str {
    frame.trim_start_matches('/')
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    #[test]
    fn places_are_where_matrices_put_them() {
        // The messages of `reference/transforms.py`, whether they rest, and what is asked then.
        type Asked = Vec<(Header, Point, Value)>;
        let text = include_str!("../tests/reference/transforms.json");
        for (messages, asked) in serde_json::from_str::<Vec<(Vec<(bool, TfMessage)>, Asked)>>(text).unwrap() {
            let mut transforms = Transforms::new("/map", None, 0.3);
            for (is_static, message) in messages {
                transforms.add(message, is_static).unwrap();
            }
            for (header, place, expected) in asked {
                match transforms.to_fixed(&header) {
                    Ok((transform, is_held)) => {
                        let place = moved(&transform, place);
                        let [x, y] = [0, 1].map(|axis| expected[axis].as_f64().unwrap());
                        assert!((place.x - x).hypot(place.y - y) < 1e-9, "{header:?}: {place:?}, not {expected}");
                        assert_eq!((is_held, place.z), (expected[2] == true, 0.0));
                    }
                    Err(error) => assert!(error.to_string().contains(expected.as_str().unwrap()), "{error}"),
                }
            }
        }
        let (x, y, z) = (1.5, -0.5, f64::NAN);
        assert_eq!(moved(&Isometry3::identity(), Point { x, y, z }), [x, y].into());
    }
}

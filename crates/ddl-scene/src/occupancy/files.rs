//! Grids in the formats of others: maps of ROS, messages of ROS, arrays of numpy.

use super::{Area, Occupancy};
use serde_json::{Value, json};

impl Occupancy {
    /// An image in the format PGM (P5), the row of the highest y first. A pixel is 255 (1 - p), rounded, at most 254,
    /// so that map servers read it back: occupied is black.
    pub fn pgm(&self) -> Vec<u8> {
        let [width, height] = self.area.size();
        let mut bytes = format!("P5\n{width} {height}\n255\n").into_bytes();
        let rows = self.probabilities.chunks_exact(width).rev();
        bytes.extend(rows.flatten().map(|p| (255.0 * (1.0 - p)).round().clamp(0.0, 254.0) as u8));
        bytes
    }

    /// The description (YAML) with which a map server loads the image in this file.
    pub fn yaml(&self, image: &str) -> String {
        let Area { origin: [x, y], cell, .. } = self.area;
        let image = Value::from(image);
        format!(
            "image: {image}\nresolution: {cell:?}\norigin: [{x:?}, {y:?}, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n\
             free_thresh: 0.196\n"
        )
    }

    /// An object with the fields of the message `nav_msgs/OccupancyGrid`, in this coordinate frame: `data` in percent,
    /// rounded. The stamp is the time in seconds after the moment.
    pub fn message(&self, frame_id: &str) -> Value {
        let [width, height] = self.area.size();
        let [x, y] = self.area.origin();
        let percent: Vec<i8> = self.probabilities.iter().map(|p| (100.0 * p).round() as i8).collect();
        let origin = json!({
            "position": {"x": x, "y": y, "z": 0.0},
            "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
        });
        json!({
            "header": {"stamp": self.time, "frame_id": frame_id},
            "info": {"resolution": self.area.cell(), "width": width, "height": height, "origin": origin},
            "data": percent,
        })
    }

    /// The probabilities as they follow each other in a file of numpy.
    pub fn npy_values(&self) -> Vec<u8> {
        self.probabilities.iter().flat_map(|p| p.to_le_bytes()).collect()
    }
}

impl Area {
    /// The head of a file of numpy (version 1.0) with an array `[times][height][width]` of `f32`; the
    /// [values](Occupancy::npy_values) of each time follow it.
    pub fn npy_head(&self, times: usize) -> Vec<u8> {
        let [width, height] = self.size();
        let shape = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({times}, {height}, {width}), }}");
        // Ten bytes come before the text; the whole head is a multiple of 64 bytes.
        let length = (10 + shape.len() + 1).next_multiple_of(64) - 10;
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((length as u16).to_le_bytes());
        bytes.extend(format!("{shape:<width$}\n", width = length - 1).into_bytes());
        bytes
    }
}

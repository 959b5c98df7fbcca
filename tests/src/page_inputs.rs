//! The files used on the pages of the documentation, made from simulated pedestrians.

use crate::own_tracks::{self, FRAME_STEP, Row, csv};
use std::path::Path;

/// The sample recording of the repository.
const SAMPLE: &str = include_str!("../../datasets/sample.csv");

/// Writes every file that a page may use: `tracks.csv`, which is the sample recording, and the same as `tracks.ndjson`,
/// at 25 frames a second (`camera.csv`), in pixels with `H.txt`, with gaps, under other names; `walk.csv`; the folder
/// `recordings`.
pub fn write(folder: &Path) {
    let tracks = sample();
    let file = |name: &str, text: &str| {
        std::fs::write(folder.join(name), text).expect("a file of a page can be written");
    };
    file("tracks.csv", SAMPLE);
    file("tracks.ndjson", &own_tracks::ndjson(&tracks));
    file("camera.csv", &csv(&filmed(&tracks, 10)));
    let to_pixels = |&(f, p, x, y): &Row| (f, p, (x + 5.0) / 0.02, (12.0 - y) / 0.02);
    let pixels: Vec<Row> = tracks.iter().map(to_pixels).collect();
    file("pixels.csv", &csv(&pixels));
    file("H.txt", "0.02 0 -5\n0 -0.02 12\n0 0 1\n");
    // Every fifth frame sees every other pedestrian.
    let seen = |&&(f, p, _, _): &&Row| f % 5 != 2 || p % 2 == 0;
    let holes: Vec<Row> = tracks.iter().filter(seen).copied().collect();
    file("holes.csv", &csv(&holes));
    file(
        "named.csv",
        "time,id,x,y\n0,1,0.00,2.00\n1,1,0.52,2.01\n2,1,1.03,2.03\n",
    );
    file(
        "walk.csv",
        "frame,pedestrian,x,y\n0,1,0.00,2.00\n0,2,8.00,2.50\n1,1,0.52,2.01\n1,2,7.41,2.49\n2,1,1.03,2.03\n\
         2,2,6.83,2.51\n\
         3,1,1.55,2.02\n3,2,6.25,2.52\n",
    );
    std::fs::create_dir(folder.join("recordings")).expect("a folder of a page can be made");
    for (name, scene) in [("hall", "plaza"), ("lobby", "crossing"), ("street", "corridor")] {
        let text = csv(&rows(scene, 200));
        file(&format!("recordings/{name}.csv"), &text);
    }
}

/// The first steps of a simulated scene, to the centimetre.
fn rows(scene: &str, steps: i64) -> Vec<Row> {
    let cut = own_tracks::of_scene(scene, 0..steps * FRAME_STEP);
    let centimetres = |metres: f64| (metres * 100.0).round() / 100.0;
    let row = |(f, p, x, y)| (f / FRAME_STEP, p, centimetres(x), centimetres(y));
    cut.into_iter().map(row).collect()
}

/// The rows of the sample recording.
fn sample() -> Vec<Row> {
    let row = |line: &str| {
        let fields: Vec<&str> = line.split(',').collect();
        let [frame, pedestrian, x, y] = fields[..] else {
            return None;
        };
        Some((
            frame.parse().ok()?,
            pedestrian.parse().ok()?,
            x.parse().ok()?,
            y.parse().ok()?,
        ))
    };
    let rows = SAMPLE.lines().skip(1).map(row);
    rows.collect::<Option<_>>()
        .expect("every row of the sample has four numbers")
}

/// The output of the program `tracker` of the pages: the first ten steps of the sample at 10 frames per second, 4 per
/// step.
pub fn tracker() -> String {
    let mut first = sample();
    first.retain(|row| row.0 < 10);
    csv(&filmed(&first, 4))
}

/// The output of the program `cameras` of the pages: the same tracks from two cameras, alternating line by line.
pub fn cameras() -> String {
    let tracks = tracker();
    let mut lines = tracks.lines();
    let header = lines.next().unwrap_or_default();
    let both = lines.map(|line| format!("hall,{line}\nyard,{line}\n"));
    format!("scene,{header}\n{}", both.collect::<String>())
}

/// The same tracks from a faster camera with `frames` frames per step.
fn filmed(tracks: &[Row], frames: i64) -> Vec<Row> {
    let mut all = Vec::new();
    for &(frame, id, x, y) in tracks {
        let next = tracks.iter().find(|row| (row.0, row.1) == (frame + 1, id));
        let &(_, _, to_x, to_y) = next.unwrap_or(&(frame, id, x, y));
        let shares = if next.is_some() { 0..frames } else { 0..1 };
        all.extend(shares.map(|i| {
            let share = i as f64 / frames as f64;
            (frames * frame + i, id, x + share * (to_x - x), y + share * (to_y - y))
        }));
    }
    all.sort_by_key(|row| (row.0, row.1));
    all
}

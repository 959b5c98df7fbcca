//! The files that the pages of the documentation speak of, made of simulated pedestrians.

use crate::own_tracks::{self, FRAME_STEP, Row, csv};
use std::path::Path;

/// Writes every file that a page may use: `tracks.csv` and the same as `tracks.ndjson`, at 25 frames a second
/// (`camera.csv`), in pixels with `H.txt`, with holes, under other names; `walk.csv`; the folder `recordings`.
pub fn write(folder: &Path) {
    let tracks = rows("plaza", 40, 70);
    let file = |name: &str, text: &str| {
        std::fs::write(folder.join(name), text).expect("a file of a page can be written");
    };
    file("tracks.csv", &csv(&tracks));
    file("tracks.ndjson", &own_tracks::ndjson(&tracks));
    file("camera.csv", &csv(&filmed(&tracks, 10)));
    let to_pixels = |&(f, p, x, y): &Row| (f, p, (x + 5.0) / 0.02, (12.0 - y) / 0.02);
    let pixels: Vec<Row> = tracks.iter().map(to_pixels).collect();
    file("pixels.csv", &csv(&pixels));
    file("H.txt", "0.02 0 -5\n0 -0.02 12\n0 0 1\n");
    // Every fifth frame sees every other person.
    let seen = |&&(f, p, _, _): &&Row| f % 5 != 2 || p % 2 == 0;
    let holes: Vec<Row> = tracks.iter().filter(seen).copied().collect();
    file("holes.csv", &csv(&holes));
    file(
        "named.csv",
        "time,id,x,y\n0,1,0.00,2.00\n1,1,0.52,2.01\n2,1,1.03,2.03\n",
    );
    file(
        "walk.csv",
        "frame,pedestrian,x,y\n0,1,0.00,2.00\n0,2,8.00,2.50\n1,1,0.52,2.01\n1,2,7.41,2.49\n2,1,1.03,2.03\n2,2,6.83,2.51\n\
         3,1,1.55,2.02\n3,2,6.25,2.52\n",
    );
    std::fs::create_dir(folder.join("recordings")).expect("a folder of a page can be made");
    for (name, scene) in [
        ("hall", "plaza"),
        ("lobby", "crossing"),
        ("street", "corridor"),
    ] {
        let text = csv(&rows(scene, 0, 200));
        file(&format!("recordings/{name}.csv"), &text);
    }
}

/// Steps `from` to `until` of a simulated scene, numbered from 0, to the centimetre.
fn rows(scene: &str, from: i64, until: i64) -> Vec<Row> {
    let cut = own_tracks::of_scene(scene, from * FRAME_STEP..until * FRAME_STEP);
    let centimetres = |metres: f64| (metres * 100.0).round() / 100.0;
    let row = |(f, p, x, y)| (f / FRAME_STEP - from, p, centimetres(x), centimetres(y));
    cut.into_iter().map(row).collect()
}

/// What the program `tracker` of the pages writes: 10 frames a second, 4 a step.
pub fn tracker() -> String {
    csv(&filmed(&rows("plaza", 40, 50), 4))
}

/// What the program `cameras` of the pages writes: the same of two cameras, line by line in turn.
pub fn cameras() -> String {
    let tracks = tracker();
    let mut lines = tracks.lines();
    let header = lines.next().unwrap_or_default();
    let both = lines.map(|line| format!("hall,{line}\nyard,{line}\n"));
    format!("scene,{header}\n{}", both.collect::<String>())
}

/// The same as a camera sees it that is faster: so many frames a step.
fn filmed(tracks: &[Row], frames: i64) -> Vec<Row> {
    let mut all = Vec::new();
    for &(frame, who, x, y) in tracks {
        let next = tracks.iter().find(|row| (row.0, row.1) == (frame + 1, who));
        let &(_, _, to_x, to_y) = next.unwrap_or(&(frame, who, x, y));
        let shares = if next.is_some() { 0..frames } else { 0..1 };
        all.extend(shares.map(|i| {
            let share = i as f64 / frames as f64;
            (
                frames * frame + i,
                who,
                x + share * (to_x - x),
                y + share * (to_y - y),
            )
        }));
    }
    all.sort_by_key(|row| (row.0, row.1));
    all
}

//! The files that the pages of the documentation speak of, made of simulated walkers.

use ddl_data::{Dataset, Observation};
use std::fmt::Write as _;
use std::path::Path;

/// Seed of the crowds: that of the program.
const SEED: u64 = 1;

/// One row of a table: frame, pedestrian, x, y.
type Row = (i64, i64, f64, f64);

/// Writes every file that a page may use: `tracks.csv` and the same as `tracks.ndjson`, at 25 frames a second
/// (`camera.csv`), in pixels with `H.txt`, with holes, under other names; `walk.csv`; the folder `recordings`.
///
/// # Panics
/// If they cannot be written.
pub fn write(folder: &Path) {
    let tracks = rows("plaza", 40, 70);
    let file = |name: &str, text: &str| {
        std::fs::write(folder.join(name), text).expect("a file of a page can be written");
    };
    file("tracks.csv", &csv("frame,pedestrian,x,y", &tracks));
    let lines = tracks.iter().map(|(f, p, x, y)| {
        format!("{{\"track\": {{\"f\": {f}, \"p\": {p}, \"x\": {x}, \"y\": {y}}}}}\n")
    });
    file("tracks.ndjson", &lines.collect::<String>());
    file(
        "camera.csv",
        &csv("frame,pedestrian,x,y", &filmed(&tracks, 10)),
    );
    let to_pixels = |&(f, p, x, y): &Row| (f, p, (x + 5.0) / 0.02, (12.0 - y) / 0.02);
    let pixels: Vec<Row> = tracks.iter().map(to_pixels).collect();
    file("pixels.csv", &csv("frame,pedestrian,x,y", &pixels));
    file("H.txt", "0.02 0 -5\n0 -0.02 12\n0 0 1\n");
    // Every fifth frame sees every other person.
    let seen = |&&(f, p, _, _): &&Row| f % 5 != 2 || p % 2 == 0;
    let holes: Vec<Row> = tracks.iter().filter(seen).copied().collect();
    file("holes.csv", &csv("frame,pedestrian,x,y", &holes));
    file(
        "named.csv",
        "time,id,x,y\n0,1,0.00,2.00\n1,1,0.52,2.01\n2,1,1.03,2.03\n",
    );
    let walk = [
        (0, 1, "0.00", "2.00"),
        (0, 2, "8.00", "2.50"),
        (1, 1, "0.52", "2.01"),
        (1, 2, "7.41", "2.49"),
        (2, 1, "1.03", "2.03"),
        (2, 2, "6.83", "2.51"),
        (3, 1, "1.55", "2.02"),
        (3, 2, "6.25", "2.52"),
    ];
    let walk = walk.map(|(f, p, x, y)| format!("{f},{p},{x},{y}\n"));
    file(
        "walk.csv",
        &format!("frame,pedestrian,x,y\n{}", walk.concat()),
    );
    std::fs::create_dir(folder.join("recordings")).expect("a folder of a page can be made");
    for (name, scene) in [
        ("hall", "plaza"),
        ("lobby", "crossing"),
        ("street", "corridor"),
    ] {
        let text = csv("frame,pedestrian,x,y", &rows(scene, 0, 200));
        file(&format!("recordings/{name}.csv"), &text);
    }
}

/// Steps `from` to `until` of a simulated scene, numbered from 0, to the centimetre.
fn rows(scene: &str, from: i64, until: i64) -> Vec<Row> {
    let dataset = Dataset::simulated(SEED);
    let recording = dataset
        .recording(scene)
        .expect("the simulated scene exists");
    let step = recording.frame_step();
    let cut = recording
        .frames()
        .iter()
        .filter(|&&frame| (from..until).contains(&(frame / step)));
    let centimetres = |metres: f64| (metres * 100.0).round() / 100.0;
    cut.flat_map(|&frame| {
        let row = move |seen: &Observation| {
            let [x, y] = seen.position.map(centimetres);
            (frame / step - from, seen.pedestrian.0, x, y)
        };
        recording.at(frame).iter().map(row)
    })
    .collect()
}

/// What the program `tracker` of the pages writes: 10 frames a second, 4 a step.
#[must_use]
pub fn tracker() -> String {
    csv("frame,pedestrian,x,y", &filmed(&rows("plaza", 40, 50), 4))
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

fn csv(header: &str, rows: &[Row]) -> String {
    let mut text = format!("{header}\n");
    for (frame, who, x, y) in rows {
        let _ = writeln!(text, "{frame},{who},{x},{y}"); // writing to a string cannot fail
    }
    text
}

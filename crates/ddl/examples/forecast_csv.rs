//! Forecasts the pedestrians of a csv file: positions in 4.8 s, goals, weights and certificates.
//!
//! ```text
//! cargo run --release -p ddl-forecast --example forecast_csv
//! cargo run --release -p ddl-forecast --example forecast_csv -- tracks.csv
//! ```
//! The table has the columns `frame`, `pedestrian`, `x` and `y`: metres, a row every 0.4 s. Without an argument, the
//! example makes a small one: two pedestrians who meet on a pavement, and a third who appears later. It forecasts the
//! last moment of the table with the default built-in model. For each pedestrian it prints the three most likely goals
//! with their weights, the representative position of all 20 hypotheses, and whether the certificates hold.
#![expect(clippy::print_stdout, reason = "the output of the example")]

use std::error::Error;
use std::fmt::Write as _;

use ddl::data::{Completeness, Format, HORIZON, parse_recording};
use ddl::{BuiltinModel, Ddl, DeviceChoice};

fn pavement() -> String {
    let mut table = "frame,pedestrian,x,y\n".to_owned();
    for t in 0..10 {
        let s = f64::from(t);
        let _ = writeln!(table, "{t},1,{:.3},0.0", 0.5 * s); // writing to a string cannot fail
        let _ = writeln!(table, "{t},2,{:.3},{:.3}", 9.0 - 0.45 * s, 0.8 + 0.04 * s);
        if t >= 6 {
            let _ = writeln!(table, "{t},3,{:.3},{:.3}", 4.0 + 0.1 * s, -3.0 + 0.3 * s);
        }
    }
    table
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (name, table) = match arguments.as_slice() {
        [] => ("pavement", pavement().into_bytes()),
        [file] => {
            let read = std::fs::read(file);
            (&**file, read.map_err(|error| format!("{file}: {error}"))?)
        }
        _ => return Err("usage: forecast_csv [TRACKS.csv]".into()),
    };
    let recording = parse_recording(&table, name, Format::Table)?;
    // Pedestrians with short or incomplete observations are forecast as well.
    let windows = recording
        .observe(recording.live_tracks().with_completeness(Completeness::Partial))
        .windows;
    let window = windows.last().ok_or("no pedestrian was observed twice")?;

    ddl::prepare(DeviceChoice::Cpu, Some(1))?; // one thread is enough
    let model = Ddl::builtin(BuiltinModel::default(), DeviceChoice::Cpu)?;
    let certified = model.forecast_certified(std::slice::from_ref(window))?.remove(0);
    let forecast = &certified.forecast;

    println!(
        "{name}, frame {}: {} pedestrians, {} hypotheses each",
        window.frames()[7],
        window.len(),
        forecast.hypotheses()
    );
    for (i, pedestrian) in window.pedestrians().iter().enumerate() {
        let ([x, y], seen) = (window.observed(i)[7], 8 - window.quality(i).unseen);
        println!("pedestrian {pedestrian}, now at ({x:.2}, {y:.2}) m, tracked for {seen} of 8 time steps");
        // Hypotheses are in the order of their weights, the largest first.
        for k in 0..3.min(forecast.hypotheses()) {
            let [x, y] = forecast.goal(i, k).ok_or("a model without goals")?;
            let certificate = certified.certificate(i, k);
            let verdict = match certificate.verify() {
                Ok(()) => "closer at every step".to_owned(),
                Err(violation) => violation.to_string(),
            };
            println!(
                "  goal ({x:>6.2}, {y:>5.2}) m, weight {:.2}: {:.2} m left in 4.8 s; {verdict}",
                forecast.weight(i, k),
                certificate.final_potential()
            );
        }
        let [x, y] = forecast.hypothesis(i, forecast.representative(i))[HORIZON - 1];
        println!("  representative position in 4.8 s: ({x:.2}, {y:.2}) m");
    }
    match certified.first_violation() {
        None => println!("all {} certificates hold", certified.certificates.len()),
        Some((i, k, violation)) => println!("hypothesis {k} of pedestrian {i}: {violation}"),
    }
    Ok(())
}

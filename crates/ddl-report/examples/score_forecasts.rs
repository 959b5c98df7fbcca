//! Scores forecasts of another program, without libtorch. First what it is to forecast, then what it forecast:
//!
//! ```text
//! cargo run -p ddl-report --example score_forecasts
//! cargo run -p ddl-report --example score_forecasts -- windows star zara1 windows.jsonl
//! cargo run -p ddl-report --example score_forecasts -- score star zara1 forecasts.jsonl
//! ```
//!
//! Without arguments everything is done at once on a simulated crowd, and no file is needed: the windows are written as they are handed
//! out, a stand-in for the other program reads these lines and writes three forecasts a pedestrian, and these are read back and scored beside the
//! baselines. Windows are those of the convention's headline tables; `docs/your-model.md` in the repository describes the files.

use std::error::Error;
use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::Path;

use ddl_data::{Convention, Dataset, Fold, HORIZON, OBSERVED, Position, Window, locate};
use ddl_eval::external::{self, Coverage, ExternalFormat, Matched};
use ddl_eval::{Conditions, Protocol, ResultRow, baseline};
use ddl_report::Report;
use serde_json::{Value, json};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments.as_slice() {
        [] => demonstrate(),
        ["windows", convention, fold, path] => {
            let windows = windows(convention.parse()?, fold)?;
            external::write_windows(&windows, BufWriter::new(File::create(path)?))?;
            Ok(())
        }
        ["score", convention, fold, path] => {
            let (convention, path) = (convention.parse()?, Path::new(path));
            let format = ExternalFormat::of_file(path);
            let windows = windows(convention, fold)?;
            let matched = external::read(path, format, &windows, Coverage::Whole)?;
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            let rows = measure(convention, fold, &name, &matched)?;
            let report = Report::new(format!("{name} on {fold}"), rows)?;
            writeln!(std::io::stdout().lock(), "{}", report.to_markdown())?;
            Ok(())
        }
        _ => Err("usage: score_forecasts [windows|score CONVENTION FOLD FILE]".into()),
    }
}

fn windows(convention: Convention, fold: &str) -> Result<Vec<Window>, Box<dyn Error>> {
    let dataset = match convention {
        Convention::Simulated => Dataset::simulated(1),
        real => Dataset::load(real, &locate(real, None)?)?,
    };
    let fold: Fold<'_> = dataset.fold(fold)?;
    Ok(fold.test_windows(convention.headline_rule()))
}

/// The scores of what was read, beside those of the baselines.
fn measure(
    convention: Convention,
    fold: &str,
    name: &str,
    matched: &Matched,
) -> Result<Vec<ResultRow>, Box<dyn Error>> {
    let mut rows = Vec::new();
    for protocol in [Protocol::Fair, Protocol::Single] {
        let rule = convention.headline_rule();
        let conditions = Conditions::new(convention, rule, protocol, fold, name);
        rows.extend(external::measure(
            &conditions,
            matched,
            baseline::NOISE_SEED,
        )?);
    }
    Ok(rows)
}

/// Both halves, with the other program's work between them, in memory.
fn demonstrate() -> Result<(), Box<dyn Error>> {
    let windows = windows(Convention::Simulated, "plaza")?;
    let mut handed_out = Vec::new();
    external::write_windows(&windows, &mut handed_out)?;
    let mut forecasts = String::new();
    for line in std::str::from_utf8(&handed_out)?.lines() {
        let forecast = another_program(&serde_json::from_str(line)?)?;
        forecasts += &forecast.to_string();
        forecasts.push('\n');
    }
    let matched = external::read_from(
        forecasts.as_bytes(),
        "forecasts.jsonl",
        ExternalFormat::JsonLines,
        &windows,
        Coverage::Whole,
    )?;
    let three = "slower, as fast, faster";
    let rows = measure(Convention::Simulated, "plaza", three, &matched)?;

    let mut out = std::io::stdout().lock();
    writeln!(
        out,
        "{} walkers of the simulated plaza, metres: the best of the hypotheses, and their weighted mean",
        matched.pedestrians()
    )?;
    for protocol in [Protocol::Fair, Protocol::Single] {
        writeln!(
            out,
            "protocol `{protocol}`                              minADE  minFDE  expected ADE  missed by 2 m"
        )?;
        for row in rows
            .iter()
            .filter(|row| row.conditions.protocol == protocol)
        {
            let scores = &row.scores;
            writeln!(
                out,
                "  {:<43} {:>7.3} {:>7.3} {:>13.3} {:>12.1} %",
                row.conditions.forecaster,
                scores.min_ade,
                scores.min_fde,
                scores.expected_ade.unwrap_or(f64::NAN),
                100.0 * scores.miss_rate_2m.unwrap_or(f64::NAN)
            )?;
        }
    }
    Ok(())
}

/// Goes straight on at 60, 100 or 120 % of the mean velocity seen: three hypotheses with weights.
fn another_program(pedestrian: &Value) -> Result<Value, Box<dyn Error>> {
    let observed: Vec<Position> = serde_json::from_value(pedestrian["observed"].clone())?;
    let (first, last) = (observed[0], observed[OBSERVED - 1]);
    let ahead = |pace: f64, step: usize| {
        let steps = pace * step as f64 / (OBSERVED - 1) as f64;
        [0, 1].map(|axis| last[axis] + steps * (last[axis] - first[axis]))
    };
    let hypotheses: Vec<Value> = [(0.6, 0.2), (1.0, 0.6), (1.2, 0.2)]
        .into_iter()
        .map(|(pace, weight)| {
            let positions: Vec<Position> = (1..=HORIZON).map(|step| ahead(pace, step)).collect();
            json!({ "weight": weight, "positions": positions })
        })
        .collect();
    Ok(json!({
        "recording": pedestrian["recording"],
        "observed_until": pedestrian["observed_until"],
        "pedestrian": pedestrian["pedestrian"],
        "hypotheses": hypotheses,
    }))
}

//! Scores forecasts of another program, without libtorch. First what it is to forecast, then what it forecast:
//!
//! ```text
//! score_forecasts windows star zara1 windows.jsonl
//! score_forecasts score star zara1 forecasts.jsonl
//! ```
//!
//! Windows are those of the convention's headline tables; `docs/your-model.md` describes the files.

use std::error::Error;
use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::Path;

use ddl_data::{Convention, Dataset, locate};
use ddl_eval::foreign::{self, Coverage, ForeignFormat};
use ddl_eval::{Conditions, Protocol, Report, baseline};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [what, convention, fold, path] = arguments.as_slice() else {
        return Err("usage: score_forecasts windows|score CONVENTION FOLD FILE".into());
    };
    let (convention, path): (Convention, &Path) = (convention.parse()?, path.as_ref());
    let dataset = match convention {
        Convention::Simulated => Dataset::simulated(1),
        real => Dataset::load(real, &locate(real, None)?)?,
    };
    let rule = convention.headline_rule();
    let windows = dataset.fold(fold)?.test_windows(rule);
    if what == "windows" {
        foreign::write_windows(&windows, BufWriter::new(File::create(path)?))?;
        return Ok(());
    }
    let format = ForeignFormat::of_file(path);
    let matched = foreign::read(path, format, &windows, Coverage::Whole)?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let mut rows = Vec::new();
    for protocol in [Protocol::Fair, Protocol::Single] {
        let conditions = Conditions::new(convention, rule, protocol, fold, &*name);
        rows.extend(foreign::measure(
            &conditions,
            &matched,
            baseline::NOISE_SEED,
        )?);
    }
    let report = Report::new(format!("{name} on {fold}"), rows)?;
    writeln!(std::io::stdout().lock(), "{}", report.to_markdown())?;
    Ok(())
}

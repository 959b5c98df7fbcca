//! Results: `report.json` and `moments.json`.

use std::sync::OnceLock;

use ddl_report::{ForecastSnapshot, Report, page::Page};

/// Reads bytes as `report.json` and creates a page. A report that was read is written and read back unchanged.
pub fn read(bytes: &[u8]) {
    let Ok(report) = Report::from_json(&String::from_utf8_lossy(bytes)) else {
        return;
    };
    let text = report.to_json().expect("valid data can be written");
    let again = Report::from_json(&text).unwrap_or_else(|error| panic!("a written report is refused: {error}\n{text}"));
    assert_eq!(again, report);
    let document = report.document();
    let _ = (document.to_markdown(), document.to_latex());
    let page = Page::new(&report);
    assert!(page.figures().is_ok() && page.to_html().is_ok());
}

/// Reads bytes as `moments.json` and draws them.
pub fn read_moments(bytes: &[u8]) {
    static EMPTY: OnceLock<Report> = OnceLock::new();
    let Ok(moments) = serde_json::from_slice::<Vec<ForecastSnapshot>>(bytes) else {
        return;
    };
    let text = serde_json::to_string(&moments).expect("valid data can be written");
    let again: Vec<ForecastSnapshot> = serde_json::from_str(&text).expect("written moments can be read");
    assert_eq!(again, moments);
    let empty = EMPTY.get_or_init(|| Report::new("none", []).expect("no rows, no conflict"));
    let moments = &moments;
    let page = Page {
        moments,
        ..Page::new(empty)
    };
    // Incomplete moments are refused, by both functions alike.
    assert_eq!(page.figures().is_ok(), page.to_html().is_ok());
}

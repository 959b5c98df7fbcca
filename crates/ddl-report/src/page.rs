//! The report as one HTML page, which needs no network and no other file.
//! Its numbers come from the `report.json` that is embedded in it; tables are those of
//! [`Report::to_markdown`](crate::Report::to_markdown).

mod headline;
mod headline_chart;
mod moment_check;
mod moment_data;
mod player;
mod report_page;
mod standing;
mod viewer;

pub use report_page::Page;
pub use viewer::Viewer;

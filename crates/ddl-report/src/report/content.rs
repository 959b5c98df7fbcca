//! The parts of a report and their order.

use crate::document::{Document, Part};
use crate::report::group::{ResultGroup, groups};
use crate::report::{ablation, across_protocols, deployable, metrics, published, section};
use ddl_data::Convention;
use ddl_eval::{Protocol, ResultRow};

/// What the columns of every group mean, by table.
const LEGENDS: &str = include_str!("how_to_read.txt");

pub(super) fn document(title: &str, rows: &[ResultRow]) -> Document {
    let groups = groups(rows);
    let mut parts: Vec<Part> = groups.iter().flat_map(section::parts).collect();
    if !groups.is_empty() {
        parts.push(Part::heading("How to read the tables"));
        let scenes = groups.iter().any(|group| group.protocol == Protocol::Joint);
        let legends = LEGENDS.trim_end().split("\n\n").chain(scenes.then_some(metrics::JOINT_LEGEND));
        parts.push(Part::List(legends.map(|legend| legend.replace('\n', " ")).collect()));
    }
    parts.extend(deployable::parts(&groups));
    parts.extend(across_protocols::parts(&groups));
    parts.extend(ablation::parts(&groups));
    parts.extend(published::parts(rows));
    Document { lead: first_line(&groups), title: title.to_owned(), parts }
}

fn first_line(groups: &[ResultGroup<'_>]) -> String {
    let mut conventions: Vec<Convention> = groups.iter().map(|group| group.convention).collect();
    conventions.dedup();
    let described = conventions.into_iter().map(|one| format!("`{one}` ({})", describe_convention(one)));
    let described: Vec<String> = described.collect();
    match described.as_slice() {
        [] => "Data convention: none, this report holds no results.".to_owned(),
        [one] => format!("Data convention: {one}."),
        several => format!(
            "Data conventions: {}. Numbers of different conventions are not comparable and are in separate tables.",
            several.join("; ")
        ),
    }
}

fn describe_convention(convention: Convention) -> &'static str {
    match convention {
        Convention::Star => "ETH/UCY as in SR-LSTM, STAR and DDL: ETH every 6 frames",
        Convention::SocialGan => "ETH/UCY as in Social-GAN: ETH every 10 frames",
        Convention::Simulated => "simulated crowds, NOT real recordings: comparable with no published number",
        Convention::Own => "own recordings, comparable with no published number",
    }
}

//! Two windows and files of forecasts for them.

use std::fmt::Write as _;

use ddl_core::{Forecast, HORIZON, PedestrianId, Position, Window};
use ddl_data::{Convention, WindowRule};
use ddl_eval::external::{self, Coverage, ExternalError, ExternalFormat, Matched};
use ddl_eval::{Conditions, Protocol};

/// Two windows of the recording `yard`, observed until 70 and until 80: pedestrians 3 and 5, then 5.
pub(crate) fn windows() -> Vec<Window> {
    let walk = |y: f64| (0..20).map(|t| [0.5 * f64::from(t), y]).collect::<Vec<_>>();
    let ids = |ids: &[i64]| ids.iter().map(|&id| PedestrianId(id)).collect();
    vec![
        Window::new("yard", 0, 10, ids(&[3, 5]), vec![walk(0.0), walk(2.0)]).unwrap(),
        Window::new("yard", 10, 10, ids(&[5]), vec![walk(2.5)]).unwrap(),
    ]
}

pub(crate) fn still(x: f64, y: f64) -> Vec<Position> {
    vec![[x, y]; HORIZON]
}

pub(crate) fn line(observed_until: i64, pedestrian: i64, hypotheses: &str) -> String {
    format!("{{\"observed_until\":{observed_until},\"pedestrian\":{pedestrian},\"hypotheses\":[{hypotheses}]}}\n")
}

pub(crate) fn hypothesis(x: f64) -> String {
    format!("{{\"positions\":{:?}}}", still(x, 0.0))
}

/// All three pedestrians with one hypothesis each, at x = 1, 2 and 3.
pub(crate) fn whole_file() -> String {
    line(70, 3, &hypothesis(1.0)) + &line(70, 5, &hypothesis(2.0)) + &line(80, 5, &hypothesis(3.0))
}

pub(crate) fn read(text: &str, format: ExternalFormat, coverage: Coverage) -> Result<Matched, ExternalError> {
    external::read_from(text.as_bytes(), "f", format, &windows(), coverage)
}

pub(crate) fn matched_of(windows: &[Window], text: &str, coverage: Coverage) -> Result<Matched, ExternalError> {
    external::read_from(text.as_bytes(), "f", ExternalFormat::JsonLines, windows, coverage)
}

pub(crate) fn conditions(protocol: Protocol) -> Conditions {
    let (convention, rule) = (Convention::Star, WindowRule::Complete);
    Conditions::new(convention, rule, protocol, "yard", "mine")
}

pub(crate) fn complaint(text: &str, format: ExternalFormat) -> String {
    read(text, format, Coverage::Whole).unwrap_err().to_string()
}

pub(crate) fn expected() -> Vec<Forecast> {
    let one = |position: &[f64]| {
        let positions = position.iter().flat_map(|&x| still(x, 0.0)).collect();
        Forecast::with_equal_weights(position.len(), 1, positions).unwrap()
    };
    vec![one(&[1.0, 2.0]), one(&[3.0])]
}

pub(crate) fn rows(recording: &str, until: i64, pedestrian: i64, hypothesis: i64, weight: f64, x: f64) -> String {
    (1..=12).fold(String::new(), |mut text, t| {
        let frame = until + 10 * t;
        writeln!(text, "{recording},{until},{pedestrian},{hypothesis},{weight},{frame},{x},0,ok").unwrap();
        text
    })
}

pub(crate) const HEADER: &str = "recording,observed_until,pedestrian,hypothesis,weight,frame,x,y,certified\n";

pub(crate) fn table() -> String {
    HEADER.to_owned()
        + &rows("yard", 70, 3, 0, 1.0, 1.0)
        + &rows("yard", 70, 5, 0, 1.0, 2.0)
        + &rows("yard", 80, 5, 0, 1.0, 3.0)
}

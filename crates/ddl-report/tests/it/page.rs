//! The content and the errors of the report page. `tests/page/check_page.py` tests it in a browser.

use ddl_core::{Forecast, PedestrianId, Position, Window};
use ddl_data::{Convention, WindowRule};
use ddl_eval::{Conditions, Protocol, ResultRow, baseline};
use ddl_report::{
    ForecastSnapshot, Report,
    page::{Page, Viewer},
};
use proptest::prelude::*;
use serde_json::{Value, json};

/// Pedestrians side by side, each with a fan of hypotheses, rounded like a recording.
fn window_and_forecast(pedestrians: usize, hypotheses: usize, goals: bool) -> (Window, Forecast) {
    let track = |i: usize| -> Vec<Position> {
        (0..20).map(|t| [0.437 * f64::from(t), 1.3 * i as f64 + 0.05 * f64::from(t * t % 7)]).collect()
    };
    let tracks: Vec<_> = (0..pedestrians).map(track).collect();
    let ids = (1..).map(PedestrianId).take(pedestrians).collect();
    let mut positions = Vec::new();
    let mut ends = Vec::new();
    for track in &tracks {
        for k in 0..hypotheses {
            let [x, y] = track[7];
            let slope = 0.1 * (k as f64 - hypotheses as f64 / 2.0);
            let path = (1..=12).map(|t| [x + 0.41 * f64::from(t), y + slope * f64::from(t)]);
            positions.extend(path);
            ends.push([x + 5.0, y + 12.5 * slope]);
        }
    }
    let weights = vec![1.0 / hypotheses as f64; pedestrians * hypotheses];
    let forecast = Forecast::new(pedestrians, hypotheses, positions, weights, goals.then_some(ends));
    (Window::new("scene", 0, 10, ids, tracks).unwrap(), forecast.unwrap())
}

fn moment(pedestrians: usize, hypotheses: usize, goals: bool) -> ForecastSnapshot {
    let (window, forecast) = window_and_forecast(pedestrians, hypotheses, goals);
    ForecastSnapshot::new("fold", "stand-in", &window, &forecast).unwrap()
}

fn report() -> Report {
    let (window, _) = window_and_forecast(3, 1, false);
    let row = |protocol| {
        let conditions = Conditions::new(Convention::Star, WindowRule::Published, protocol, "eth", "");
        baseline::measure(&conditions, std::slice::from_ref(&window)).unwrap()
    };
    Report::new("A & B", Protocol::ALL.into_iter().flat_map(row)).unwrap()
}

fn with_moments(moments: &[ForecastSnapshot]) -> String {
    let report = report();
    let page = Page { moments, ..Page::new(&report) };
    page.to_html().unwrap()
}

fn embedded<'a>(html: &'a str, id: &str) -> &'a str {
    let (_, rest) = html.split_once(&format!("id=\"{id}\">")).unwrap();
    rest.split_once("</script>").unwrap().0
}

#[test]
fn the_report_is_embedded_bit_for_bit_and_its_tables_are_there() {
    let report = report();
    let html = Page::new(&report).to_html().unwrap();
    assert_eq!(embedded(&html, "report-json"), report.to_json().unwrap());
    assert!(html.contains("<title>A &amp; B</title>"));
    let tables = report.to_markdown().matches("\n|--").count();
    assert_eq!(html.matches("<table>").count(), tables);
    // Every entry of the contents is a link to a section, and sections that use the future are marked.
    for link in html.split("<a href=\"#").skip(1) {
        let (id, _) = link.split_once('"').unwrap();
        assert_eq!(html.matches(&format!("id=\"{id}\"")).count(), 1, "{id}");
    }
    assert!(
        html.contains("<section id=\"protocol-published-window-rule-published-convention-star\" class=\"warned\">")
    );
    assert!(html.contains("<section id=\"protocol-fair-window-rule-published-convention-star\">"));
    // What is not there is said.
    assert!(html.contains("<section id=\"player\" class=\"empty\">") && html.contains("No moments were recorded"));
}

#[test]
fn the_head_takes_fair_results_and_the_published_ones_bring_their_warning() {
    let every_protocol = report();
    let head = |report: &Report| {
        let html = Page::new(report).to_html().unwrap();
        let (_, rest) = html.split_once("<section class=\"headline\"").unwrap();
        rest.split_once("id=\"player\"").unwrap().0.to_owned()
    };
    let fair = head(&every_protocol);
    assert!(fair.contains("protocol <code>fair</code>") && !fair.contains("class=\"warning\""));
    assert!(!fair.contains("TRUE end"));
    let published = every_protocol.rows().iter().filter(|row| row.conditions.protocol == Protocol::Published);
    let published = head(&Report::new("Published", published.cloned()).unwrap());
    assert!(published.contains("protocol <code>published</code>") && published.contains("class=\"warning\""));
    assert!(head(&Report::new("Nothing", []).unwrap()).contains("This report holds no results."));
}

#[test]
fn the_head_is_about_the_model_as_it_is() {
    let (window, forecast) = window_and_forecast(1, 1, false);
    let windows = std::slice::from_ref(&window);
    let right: Vec<Position> = window.future(0).to_vec();
    let right = Forecast::new(1, 1, right, vec![1.0], None).unwrap();
    let row = |name: &str, forecast: &Forecast| {
        let single = Protocol::Single;
        let conditions = Conditions {
            seed: Some(0),
            epochs: Some(40),
            selection: Some("last epoch".to_owned()),
            ..Conditions::new(Convention::Star, WindowRule::Published, single, "eth", name)
        };
        ResultRow::score(conditions, windows, std::slice::from_ref(forecast)).unwrap()
    };
    let rows = [row("DDL with hindsight", &right), row("DDL", &forecast), row("another", &forecast)];
    let html = Page::new(&Report::new("Heads", rows).unwrap()).to_html().unwrap();
    let (_, verdict) = html.split_once("class=\"verdict\">").unwrap();
    assert!(verdict.starts_with("<strong>DDL</strong>"));
}

#[test]
fn a_page_loads_nothing() {
    let html = with_moments(&[moment(2, 3, true)]);
    for loading in [" src=", "@import", "url(", "fetch(", "XMLHttpRequest", "<iframe"] {
        assert!(!html.contains(loading), "{loading}");
    }
    let namespace = "http://www.w3.org/2000/svg";
    let policy = "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; ";
    assert_eq!(html.matches(policy).count(), 1);
    assert_eq!(html.matches("http").count(), html.matches(namespace).count() + 1);
}

#[test]
fn names_cannot_become_markup() {
    let hostile = "</script><script>alert(1)</script><!-- x < y \u{2028}\u{2029}";
    let mut bad = moment(2, 2, true);
    bad.recording = hostile.to_owned();
    bad.forecaster = hostile.to_owned();
    let report = report();
    let page = Page { report: &report, moments: &[bad] };
    let html = page.to_html().unwrap();
    for end in ["<script>alert", "</script><script>a", "<!-- x"] {
        assert!(!html.contains(end), "{end}");
    }
    let embedded = embedded(&html, "moments-json");
    assert!(!embedded.contains(['\u{2028}', '\u{2029}']) && embedded.contains("x < y"));
    let moments: Value = serde_json::from_str(embedded).unwrap();
    assert_eq!(moments[0]["recording"], hostile);
    assert!(!page.comparison().unwrap().unwrap().contains("<script"));
}

#[test]
fn the_comparison_is_a_file_of_its_own() {
    let report = report();
    let page = Page { report: &report, moments: &[moment(3, 20, true), moment(1, 1, false)] };
    let svg = page.comparison().unwrap().unwrap();
    assert!(svg.starts_with("<?xml") && svg.contains("<title>"));
    assert!(!svg.contains("NaN") && !svg.contains("inf") && !svg.contains("var("));
}

type Fault = (fn(&mut ForecastSnapshot), &'static str);

#[test]
fn what_is_not_whole_is_refused_by_name() {
    let report = report();
    let cases: [Fault; 6] = [
        (|m| m.pedestrians[1].truth.truncate(11), "pedestrian 1 has 11 positions in `truth`, not 12"),
        (
            |m| m.pedestrians[0].hypotheses[1].positions[3][0] = f64::NAN,
            "pedestrian 0 has the coordinate NaN m in `hypotheses`; coordinates must be within",
        ),
        (
            |m| m.pedestrians[0].hypotheses[1].goal = Some([0.0, 1e9]),
            "pedestrian 0 has the coordinate 1000000000 m in `goal`; coordinates must be within",
        ),
        (
            |m| m.pedestrians[0].hypotheses[1].weight = -0.5,
            "hypothesis 1 of pedestrian 0 has the weight -0.5, which is not between 0 and 1",
        ),
        (|m| m.pedestrians.clear(), "no pedestrian"),
        (|m| m.pedestrians[1].hypotheses.clear(), "a pedestrian has no hypothesis"),
    ];
    for (change, expected) in cases {
        let mut bad = moment(2, 2, true);
        change(&mut bad);
        let page = Page { moments: &[moment(1, 1, false), bad], ..Page::new(&report) };
        let words = page.to_html().unwrap_err().to_string();
        let expected = format!("moment 1 (recording `scene`, frame 70): {expected}");
        assert!(words.starts_with(&expected), "{words}");
        assert_eq!(page.comparison().unwrap_err().to_string(), words);
    }
}

#[test]
fn forty_crowded_moments_stay_below_six_megabytes() {
    let moments = vec![moment(25, 20, true); 40];
    let html = with_moments(&moments);
    assert!(html.len() < 6_000_000, "{} bytes", html.len());
}

fn walked(mut place: [i64; 2], steps: &Value) -> (Vec<Position>, [i64; 2]) {
    let steps: Vec<i64> = steps.as_array().unwrap().iter().map(|n| n.as_i64().unwrap()).collect();
    let mut path = Vec::new();
    for step in steps.chunks_exact(2) {
        place = [place[0] + step[0], place[1] + step[1]];
        path.push(place.map(|mm| mm as f64 / 1000.0));
    }
    (path, place)
}

proptest! {
    #[test]
    fn positions_survive_their_compact_form(
        places in prop::collection::vec([-1_000_000_000_i64..=1_000_000_000, -50_000..=50_000], 32)
    ) {
        let metres: Vec<Position> = places.iter().map(|p| p.map(|mm| mm as f64 / 1000.0)).collect();
        let mut moment = moment(1, 1, true);
        let pedestrian = &mut moment.pedestrians[0];
        pedestrian.observed = metres[..8].to_vec();
        pedestrian.truth = metres[8..20].to_vec();
        pedestrian.hypotheses[0].positions = metres[20..].to_vec();
        let html = with_moments(&[moment]);
        let data: Value = serde_json::from_str(embedded(&html, "moments-json")).unwrap();
        let data = &data[0]["pedestrians"][0];
        let (observed, last) = walked([0, 0], &data["observed"]);
        prop_assert_eq!(&observed[..], &metres[..8]);
        prop_assert_eq!(&walked(last, &data["truth"]).0[..], &metres[8..20]);
        prop_assert_eq!(&walked(last, &data["paths"][0]).0[..], &metres[20..]);
    }
}

#[test]
fn a_viewer_plays_what_is_not_over_yet() {
    let mut under_way = moment(2, 2, true);
    under_way.pedestrians[1].truth.truncate(3);
    under_way.pedestrians[0].truth.clear();
    let view = |moment: &ForecastSnapshot| {
        let viewer = Viewer {
            title: "yard <1>",
            lead: "two & two",
            notes: &["made by x < y".to_owned()],
            moments: std::slice::from_ref(moment),
        };
        viewer.to_html()
    };
    let html = view(&under_way).unwrap();
    for words in [
        "<title>yard &lt;1&gt;</title>",
        "two &amp; two",
        "<p>made by x &lt; y</p>",
        "<section id=\"player\" class=\"ready\">",
    ] {
        assert!(html.contains(words), "{words}");
    }
    assert!(!html.contains("report-json"));
    let data = embedded(&html, "moments-json");
    assert!(!data.contains("joint") && !data.contains("groups"));

    under_way.joint = true;
    under_way.groups = vec![vec![0, 1]];
    let html = view(&under_way).unwrap();
    let data: Value = serde_json::from_str(embedded(&html, "moments-json")).unwrap();
    assert_eq!([&data[0]["joint"], &data[0]["groups"]], [&json!(true), &json!([[0, 1]])]);
    under_way.groups = vec![vec![0, 2]];
    assert!(view(&under_way).is_err());
    under_way.groups.clear();
    under_way.pedestrians[1].hypotheses.pop();
    assert!(view(&under_way).is_err());

    let thirteen = vec![[0.0; 2]; 13];
    under_way.joint = false;
    under_way.pedestrians[1].truth = thirteen;
    assert!(view(&under_way).is_err());
}

//! The report as one HTML page that needs nothing else: no network, no other file.
//!
//! It has the comparison, a player of recorded moments, a gallery of cases, training curves and every table of the
//! report. The numbers come from the `report.json` that is embedded in it; tables are those of [`Report::document`].

mod embed;
mod error;
mod figure;
mod gallery_section;
mod headline;
mod moment_data;
mod standing;
mod template;
mod training_section;
mod viewer;

pub use error::{MomentProblem, PageError};
pub use viewer::Viewer;

use crate::{
    Moment, Report, TrainingCurve,
    document::{ContentsEntry, escape, inline},
};
use figure::{Drawing, Shape};
use moment_data::Truth;

const TEMPLATE: &str = include_str!("page.html");
/// Of every page, up to its body.
const HEAD: &str = include_str!("head.html");
/// Light, dark, or as the system has it.
const THEME_BUTTON: &str = include_str!("theme_button.html");
const PLAYER: &str = include_str!("player.html");
const STYLE: &str = include_str!("style.css");
/// Of the player. Run in this order, inside one function.
const PLAYER_SCRIPTS: [&str; 12] = [
    include_str!("script/theme.js"),
    include_str!("script/print.js"),
    include_str!("script/moments.js"),
    include_str!("script/metrics.js"),
    include_str!("script/palette.js"),
    include_str!("script/view.js"),
    include_str!("script/scene.js"),
    include_str!("script/phi_chart.js"),
    include_str!("script/hypothesis_list.js"),
    include_str!("script/clock.js"),
    include_str!("script/player.js"),
    include_str!("script/keys.js"),
];
/// Of the rest of the page, after them.
const REPORT_SCRIPTS: [&str; 2] = [
    include_str!("script/curves.js"),
    include_str!("script/report_file.js"),
];

/// A page of results under way: the report, and what to show besides.
///
/// # Examples
/// ```
/// use ddl_data::{PedestrianId, Window};
/// use ddl_eval::{Forecaster, Moment, Report, baseline::ConstantVelocity, page::Page};
/// let walk = (0..20).map(|t| [0.4 * f64::from(t), 0.0]).collect();
/// let window = Window::new("corridor", 0, 10, vec![PedestrianId(7)], vec![walk])?;
/// let forecast = ConstantVelocity::last_step().forecast(&window)?;
/// let moment = Moment::new("corridor", "constant velocity", &window, &forecast)?;
///
/// let report = Report::new("Nothing measured yet", [])?;
/// let html = Page::new(&report).moments(vec![moment]).to_html()?;
/// assert!(html.starts_with("<!doctype html>"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Page<'a> {
    report: &'a Report,
    moments: Vec<Moment>,
    curves: Vec<TrainingCurve>,
}

impl<'a> Page<'a> {
    /// A page of the report alone.
    #[must_use]
    pub fn new(report: &'a Report) -> Self {
        Self {
            report,
            moments: Vec::new(),
            curves: Vec::new(),
        }
    }

    /// Moments for the player; those with [picks](Moment::picks) are also shown in the gallery.
    #[must_use]
    pub fn moments(mut self, moments: Vec<Moment>) -> Self {
        self.moments = moments;
        self
    }

    /// Training curves.
    #[must_use]
    pub fn curves(mut self, curves: Vec<TrainingCurve>) -> Self {
        self.curves = curves;
        self
    }

    /// The page, to be written into a file and opened in a browser.
    ///
    /// # Errors
    /// A moment is not whole, or the epochs of a curve do not ascend; the message names it.
    pub fn to_html(&self) -> Result<String, PageError> {
        self.check()?;
        let document = self.report.document();
        let contents: Vec<String> = document.contents().iter().map(item).collect();
        let report = embed::json_in_script(&self.report.to_json()?);
        let moments = embed::json_in_script(&moment_data::to_json(&self.moments)?);
        let curves = embed::json_in_script(&serde_json::to_string(&self.curves)?);
        let scripts = [PLAYER_SCRIPTS.join("\n"), REPORT_SCRIPTS.join("\n")].join("\n");
        Ok(template::fill(
            TEMPLATE,
            &[
                ("head", &head(&document.title)),
                ("theme-button", THEME_BUTTON),
                ("title", &escape(&document.title)),
                ("lead", &inline(&document.lead)),
                ("headline", &headline::headline(self.report)),
                ("player", &player(&self.moments)),
                ("gallery", &gallery_section::html(&self.moments)),
                ("training", &training_section::html(&self.curves)),
                ("contents", &contents.concat()),
                ("tables", &document.sections_html()),
                ("report-json", &report),
                ("moments-json", &moments),
                ("curves-json", &curves),
                ("scripts", &scripts),
            ],
        ))
    }

    /// Every figure as an SVG file: its name and its content. They stand alone on white.
    ///
    /// # Errors
    /// As [`to_html`](Self::to_html).
    pub fn figures(&self) -> Result<Vec<(String, String)>, PageError> {
        self.check()?;
        let mut figures: Vec<(String, Drawing)> = Vec::new();
        if let Some(standing) = standing::standing(self.report) {
            figures.push((
                "comparison".to_owned(),
                figure::headline_chart(&standing, Shape::Wide),
            ));
        }
        figures.extend(gallery_section::figures(&self.moments));
        figures.extend(training_section::figures(&self.curves));
        let mut used: Vec<String> = Vec::new();
        let named = |(name, drawing): (String, Drawing)| {
            let name = file_name(&name);
            let before = used.iter().filter(|known| **known == name).count();
            used.push(name.clone());
            let number = if before == 0 {
                String::new()
            } else {
                format!("-{}", before + 1)
            };
            (format!("{name}{number}.svg"), drawing.to_file())
        };
        Ok(figures.into_iter().map(named).collect())
    }

    fn check(&self) -> Result<(), PageError> {
        moment_data::check(&self.moments, Truth::Whole)?;
        training_section::check(&self.curves)
    }
}

/// The head of a page under this title.
fn head(title: &str) -> String {
    let slots = [
        ("title", &*escape(title)),
        ("style", STYLE),
        ("figure-style", figure::STYLE),
    ];
    template::fill(HEAD, &slots)
}

/// The player, which shows the embedded moments.
fn player(moments: &[Moment]) -> String {
    let state = if moments.is_empty() { "empty" } else { "ready" };
    template::fill(PLAYER, &[("player-state", state)])
}

/// A line of the list of tables.
fn item(entry: &ContentsEntry) -> String {
    let class = if entry.warned {
        " class=\"warned\""
    } else {
        ""
    };
    format!(
        "<li{class}><a href=\"#{}\">{}</a></li>\n",
        entry.id, entry.heading
    )
}

/// Small letters, digits and dashes, which every file system takes.
fn file_name(words: &str) -> String {
    let words = words
        .split(|c: char| !c.is_ascii_alphanumeric())
        .filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("-").to_ascii_lowercase()
}

//! The chart at the head of the page: the errors of every forecaster on every fold, as dots.

use crate::figure::cut::cut;
use crate::figure::drawing::Drawing;
use crate::figure::scale::Scale;
use crate::page::standing::{Standing, StandingLine};

/// Largest number of lines of the chart; the tables contain all lines.
pub(crate) const MOST_LINES: usize = 10;
const LINE: f64 = 26.0;

/// Space for the number after the dots, px.
const NUMBER: f64 = 46.0;
/// Least distance of two ticks, px.
const TICKS_APART: f64 = 26.0;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ChartShape {
    Wide,
    Narrow,
}

/// One column for each fold; in it each line has a full dot at minADE and a hollow one at minFDE, m.
pub(crate) fn headline_chart(standing: &Standing, shape: ChartShape) -> Drawing {
    let lines = &standing.lines[..standing.lines.len().min(MOST_LINES)];
    let chart = Chart {
        lines,
        subject: standing.subject().map(|line| line.label.as_str()),
        values: lines.iter().flat_map(columns).flatten().flatten().collect(),
        errors: standing.shared.protocol.errors(),
    };
    let mut names: Vec<String> = standing.folds.clone();
    if standing.folds.len() > 1 {
        names.push("mean".to_owned());
    }
    let [ade, fde] = standing.shared.protocol.errors();
    let title = format!(
        "{ade} and {fde} in metres of {} forecasters on {}; convention {}, window rule {}, protocol {}",
        lines.len(),
        standing.folds.join(", "),
        standing.shared.convention,
        standing.shared.window_rule,
        standing.shared.protocol
    );
    match shape {
        ChartShape::Wide => wide(&chart, &names, &title),
        ChartShape::Narrow => narrow(&chart, &names, &title),
    }
}

struct Chart<'a> {
    lines: &'a [StandingLine],
    subject: Option<&'a str>,
    values: Vec<f64>,
    errors: [&'static str; 2],
}

impl Chart<'_> {
    fn is_subject(&self, line: &StandingLine) -> bool {
        self.subject == Some(&line.label)
    }

    fn key(&self, drawing: &mut Drawing, [x, y]: [f64; 2]) {
        let [ade, fde] = self.errors;
        let axis = if Scale::of(&self.values, [0.0, 1.0]).logarithmic {
            format!("{fde}, metres, logarithmic; less is better")
        } else {
            format!("{fde}, metres; less is better")
        };
        drawing.circle("ade", [x + 5.0, y - 4.0], 4.4);
        drawing.text("small", [x + 16.0, y], format!("{ade} (printed)"));
        drawing.circle("fde", [x + 127.0, y - 4.0], 3.6);
        drawing.text("small", [x + 137.0, y], &axis);
    }
}

/// The folds, then their mean if there are several.
fn columns(line: &StandingLine) -> Vec<Option<[f64; 2]>> {
    let several = line.folds.len() > 1;
    line.folds.iter().copied().chain(several.then_some(line.mean)).collect()
}

fn wide(chart: &Chart<'_>, names: &[String], title: &str) -> Drawing {
    let lines = chart.lines;
    let (width, left, gap, top) = (1080.0, 312.0, 20.0, 34.0);
    let column = (width - left - gap * names.len() as f64) / names.len() as f64;
    let bottom = top + LINE * lines.len() as f64;
    let mut drawing = Drawing::new(width, bottom + 44.0, title);
    for (row, line) in lines.iter().enumerate() {
        let y = top + LINE * (row as f64 + 0.5);
        let class = format!("small {}", name_class(chart.is_subject(line)));
        drawing.text(&class, [0.0, y + 4.0], cut(&line.label, 12.0, 296.0));
        let guesses = format!("K = {}", line.hypotheses);
        drawing.text("small end", [left, y + 4.0], guesses);
    }
    for (fold, name) in names.iter().enumerate() {
        let x = left + gap + (column + gap) * fold as f64;
        let scale = Scale::of(&chart.values, [x, x + column - NUMBER]);
        drawing.text("title", [x, 16.0], name);
        axis(&mut drawing, &scale, [top, bottom]);
        for (row, line) in lines.iter().enumerate() {
            let y = top + LINE * (row as f64 + 0.5);
            dumbbell(&mut drawing, &scale, columns(line)[fold], chart.is_subject(line), y);
        }
    }
    chart.key(&mut drawing, [left + gap, bottom + 38.0]);
    drawing
}

fn narrow(chart: &Chart<'_>, names: &[String], title: &str) -> Drawing {
    let lines = chart.lines;
    let (width, line_height) = (358.0, 38.0);
    let block = 56.0 + line_height * lines.len() as f64;
    let mut drawing = Drawing::new(width, 28.0 + block * names.len() as f64, title);
    chart.key(&mut drawing, [0.0, 12.0]);
    // The mean comes first, because the folds may only be visible after scrolling.
    for (place, name) in names.iter().cycle().skip(names.len() - 1).take(names.len()).enumerate() {
        let fold = (place + names.len() - 1) % names.len();
        let top = 28.0 + block * place as f64;
        let scale = Scale::of(&chart.values, [6.0, width - NUMBER]);
        drawing.text("title", [0.0, top + 14.0], name);
        axis(&mut drawing, &scale, [top + 24.0, top + block - 30.0]);
        for (row, line) in lines.iter().enumerate() {
            let y = top + 26.0 + line_height * (row as f64 + 0.5);
            drawing.text(
                &format!("small halo {}", name_class(chart.is_subject(line))),
                [0.0, y - 4.0],
                format!("{}, K = {}", cut(&line.label, 12.0, 296.0), line.hypotheses),
            );
            dumbbell(&mut drawing, &scale, columns(line)[fold], chart.is_subject(line), y + 8.0);
        }
    }
    drawing
}

fn name_class(subject: bool) -> &'static str {
    if subject { "subject" } else { "name" }
}

fn axis(drawing: &mut Drawing, scale: &Scale, [top, bottom]: [f64; 2]) {
    let mut last = f64::NEG_INFINITY;
    for (tick, (value, label)) in scale.ticks().into_iter().enumerate() {
        let x = scale.at(value);
        if x - last < TICKS_APART {
            continue;
        }
        last = x;
        drawing.line(if tick == 0 { "axis" } else { "grid" }, [x, top], [x, bottom]);
        drawing.text("small middle", [x, bottom + 14.0], label);
    }
}

fn dumbbell(drawing: &mut Drawing, scale: &Scale, pair: Option<[f64; 2]>, subject: bool, y: f64) {
    let Some([ade, fde]) = pair else {
        let x = scale.at(0.0) + 4.0;
        drawing.text("small", [x, y + 4.0], "not measured");
        return;
    };
    let first = if subject { " first" } else { "" };
    let [a, b] = [scale.at(ade), scale.at(fde)];
    drawing.line(&format!("stem{first}"), [a, y], [b, y]);
    drawing.circle(&format!("fde{first}"), [b, y], 3.6);
    drawing.circle(&format!("ade{first}"), [a, y], 4.4);
    let class = if subject { "small halo subject" } else { "small halo" };
    drawing.text(class, [b + 9.0, y + 4.0], format!("{ade:.3}"));
}

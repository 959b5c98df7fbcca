//! The few shapes that a picture is made of, on top of the SVG back end.
//!
//! The back end rounds to whole pixels, so pictures are drawn large and shown smaller.

use plotters::{
    coord::Shift,
    element::DashedPathElement,
    prelude::{
        Circle, DrawingArea, IntoDrawingArea, PathElement, Polygon, RGBAColor, RGBColor, Rectangle,
        SVGBackend, ShapeStyle, Text,
    },
    style::{
        Color, FontTransform, IntoFont, TextStyle,
        text_anchor::{HPos, Pos, VPos},
    },
};

use super::error::FigureError;

/// A place on the canvas: pixels from the left, pixels from the top.
pub(super) type Pixel = (i32, i32);

/// Dark grey.
pub(super) const OBSERVED: RGBColor = RGBColor(51, 51, 51);
/// Blue of Okabe and Ito.
pub(super) const TRUTH: RGBColor = RGBColor(0, 114, 178);
/// Vermilion of Okabe and Ito.
pub(super) const FORECAST: RGBColor = RGBColor(213, 94, 0);
/// Bluish green of Okabe and Ito.
pub(super) const GOAL: RGBColor = RGBColor(0, 158, 115);
/// Orange of Okabe and Ito.
pub(super) const EXPERT: RGBColor = RGBColor(230, 159, 0);
/// Under a shape that must stand out.
pub(super) const PAPER: RGBColor = RGBColor(255, 255, 255);
/// Lines of the grid.
pub(super) const GRID: RGBColor = RGBColor(228, 228, 228);
/// Frame and numbers.
pub(super) const INK: RGBColor = RGBColor(68, 68, 68);

/// How a text sits at its place.
#[derive(Debug, Clone, Copy)]
pub(super) enum Place {
    /// Begins there, centred in height.
    RightOf,
    /// Ends there, centred in height.
    LeftOf,
    /// Centred below it.
    Below,
    /// Centred there, read from bottom to top.
    Upwards,
}

/// A white sheet.
pub(super) struct Canvas<'a>(DrawingArea<SVGBackend<'a>, Shift>);

impl<'a> Canvas<'a> {
    pub(super) fn new(svg: &'a mut String, size: (u32, u32)) -> Result<Self, FigureError> {
        let area = SVGBackend::with_string(svg, size).into_drawing_area();
        area.fill(&PAPER).map_err(failed)?;
        Ok(Self(area))
    }

    pub(super) fn line(
        &self,
        path: &[Pixel],
        colour: impl Into<RGBAColor>,
        width: u32,
    ) -> Result<(), FigureError> {
        self.0
            .draw(&PathElement::new(path.to_vec(), stroke(colour, width)))
            .map_err(failed)
    }

    pub(super) fn dashes(
        &self,
        path: &[Pixel],
        colour: impl Into<RGBAColor>,
        width: u32,
    ) -> Result<(), FigureError> {
        let style = stroke(colour, width);
        self.0
            .draw(&DashedPathElement::new(path.to_vec(), 14, 9, style))
            .map_err(failed)
    }

    pub(super) fn dot(
        &self,
        at: Pixel,
        colour: impl Into<RGBAColor>,
        radius: i32,
    ) -> Result<(), FigureError> {
        self.0
            .draw(&Circle::new(at, radius, colour.into().filled()))
            .map_err(failed)
    }

    pub(super) fn ring(
        &self,
        at: Pixel,
        colour: impl Into<RGBAColor>,
        radius: i32,
        width: u32,
    ) -> Result<(), FigureError> {
        self.0
            .draw(&Circle::new(at, radius, stroke(colour, width)))
            .map_err(failed)
    }

    /// A five-pointed star with a white rim, so that it stands out on lines of its colour.
    pub(super) fn star(
        &self,
        at: Pixel,
        colour: impl Into<RGBAColor>,
        radius: i32,
    ) -> Result<(), FigureError> {
        let corners = |radius: f64| -> Vec<Pixel> {
            let corner = |c: i32| {
                let r = if c % 2 == 0 { radius } else { 0.45 * radius };
                let (sin, cos) = (f64::from(c) * std::f64::consts::PI / 5.0).sin_cos();
                (
                    at.0 + (r * sin).round() as i32,
                    at.1 - (r * cos).round() as i32,
                )
            };
            (0..10).map(corner).collect()
        };
        let radius = f64::from(radius);
        let rim = Polygon::new(corners(radius + 4.0), PAPER.filled());
        self.0.draw(&rim).map_err(failed)?;
        self.0
            .draw(&Polygon::new(corners(radius), colour.into().filled()))
            .map_err(failed)
    }

    pub(super) fn frame(&self, corners: [Pixel; 2]) -> Result<(), FigureError> {
        self.0
            .draw(&Rectangle::new(corners, stroke(INK, 2)))
            .map_err(failed)
    }

    pub(super) fn text(
        &self,
        text: &str,
        at: Pixel,
        size: i32,
        place: Place,
    ) -> Result<(), FigureError> {
        let (h, v) = match place {
            Place::RightOf => (HPos::Left, VPos::Center),
            Place::LeftOf => (HPos::Right, VPos::Center),
            Place::Below => (HPos::Center, VPos::Top),
            Place::Upwards => (HPos::Center, VPos::Center),
        };
        let font = ("sans-serif", size).into_font();
        let font = match place {
            Place::Upwards => font.transform(FontTransform::Rotate270),
            _ => font,
        };
        let style = TextStyle::from(font).color(&INK).pos(Pos::new(h, v));
        // XML has no control characters, and titles come from users.
        let text = text.replace(char::is_control, " ");
        self.0.draw(&Text::new(text, at, style)).map_err(failed)
    }

    pub(super) fn finish(self) -> Result<(), FigureError> {
        self.0.present().map_err(failed)
    }
}

/// Width of a text in pixels, about: fonts differ, and the reader's is not known.
pub(super) fn text_width(text: &str, size: i32) -> i32 {
    // The back end writes sizes divided by 1.24; letters of a wide sans-serif are
    // about 0.53 of that wide.
    let width = text.chars().count() as f64 * f64::from(size) * 0.53 / 1.24;
    width.ceil() as i32
}

fn stroke(colour: impl Into<RGBAColor>, width: u32) -> ShapeStyle {
    ShapeStyle {
        color: colour.into(),
        filled: false,
        stroke_width: width,
    }
}

fn failed(error: impl std::fmt::Display) -> FigureError {
    FigureError::Drawing(error.to_string())
}

//! How large a plot is, and where its lettering goes.

/// Sizes of one kind of plot, pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    /// Neither side of the plot is smaller: across, up.
    pub(super) smallest: (f64, f64),
    /// The plot fills at most this much: across, up.
    pub(super) largest: (f64, f64),
    /// Space around the plot.
    pub(super) left: i32,
    pub(super) top: i32,
    pub(super) right: i32,
    pub(super) bottom: i32,
    /// Margin around the points within the plot, share of the span.
    pub(super) margin: f64,
    /// Size of the numbers at the axes.
    pub(super) numbers: i32,
    /// Steps on the longer side, about.
    pub(super) steps: f64,
}

/// One scene; the legend stands on the right.
pub(super) const SCENE: Layout = Layout {
    smallest: (620.0, 460.0),
    largest: (1240.0, 960.0),
    left: 120,
    top: 84,
    right: 440,
    bottom: 110,
    margin: 0.05,
    numbers: 26,
    steps: 10.0,
};

/// One of several plots of the same size; two lines of title and one of text stand above it.
pub(super) const PANEL: Layout = Layout {
    smallest: (520.0, 520.0),
    largest: (520.0, 520.0),
    left: 76,
    top: 124,
    right: 24,
    bottom: 64,
    margin: 0.1,
    numbers: 27,
    steps: 7.0,
};

//! Forecasts as messages.

use crate::msg::{
    Color, Duration, Forecasts, Header, Hypothesis, MapMetaData, Marker, MarkerArray, OccupancyGrid, Path,
    PedestrianForecast, Point, Pose, PoseStamped,
};
use ddl_core::{Forecast, HORIZON, OBSERVED, Position, TIME_STEP, Window};
use ddl_scene::Occupancy;

/// `visualization_msgs/Marker`: pairs of points, and points.
const LINE_LIST: i32 = 5;
const POINTS: i32 = 8;
/// Width of a line and size of a point in pictures (m).
const LINE: f64 = 0.05;
const POINT: f64 = 0.12;
/// Where no newer picture comes, this one goes.
const LIFETIME: Duration = Duration { sec: 1, nanosec: 0 };

/// The forecast of one moment.
#[derive(Debug, Clone, Copy)]
pub struct ForecastMessages<'a> {
    /// The pedestrians, with their observed positions.
    pub window: &'a Window,
    /// Their forecast.
    pub forecast: &'a Forecast,
    /// The moment, and the frame of all positions.
    pub header: &'a Header,
    /// Whether hypothesis k of all pedestrians is one future of the scene.
    pub joint: bool,
}

impl ForecastMessages<'_> {
    /// Everything: all hypotheses of all pedestrians.
    pub fn forecasts(&self) -> Forecasts {
        Forecasts {
            header: self.header.clone(),
            time_step: TIME_STEP,
            joint: self.joint,
            pedestrians: (0..self.window.len()).map(|i| self.pedestrian(i)).collect(),
        }
    }

    fn pedestrian(&self, i: usize) -> PedestrianForecast {
        let Self { window, forecast, .. } = self;
        let hypotheses = (0..forecast.hypotheses()).map(|k| {
            let path = forecast.hypothesis(i, k);
            Hypothesis {
                weight: forecast.weight(i, k),
                certified: forecast.certified(i, k).unwrap_or(false),
                goal: forecast.goal(i, k).unwrap_or([f64::NAN; 2]).into(),
                x: path.iter().map(|[x, _]| *x).collect(),
                y: path.iter().map(|[_, y]| *y).collect(),
            }
        });
        PedestrianForecast {
            id: window.name(i).to_string(),
            position: self.present(i).into(),
            age: window.quality(i).age,
            familiarity: forecast.familiarity(i).unwrap_or(f64::NAN),
            scales: (0..HORIZON).map_while(|t| forecast.scale(i, t)).collect(),
            hypotheses: hypotheses.collect(),
        }
    }

    /// The likeliest path of each pedestrian, from its present position on; each pose has its time.
    pub fn likeliest_paths(&self) -> Vec<Path> {
        let paths = (0..self.window.len()).map(|i| {
            let poses = self.likeliest(i).enumerate().map(|(step, position)| PoseStamped {
                header: Header { stamp: self.header.stamp.after(TIME_STEP * step as f64), ..self.header.clone() },
                pose: pose(position),
            });
            Path { header: self.header.clone(), poses: poses.collect() }
        });
        paths.collect()
    }

    /// A picture: the likeliest path of each pedestrian as a line, and where its hypotheses end as points, the more
    /// opaque the more probable. It has two markers, which the next picture replaces.
    pub fn markers(&self) -> MarkerArray {
        let [mut lines, mut ends] =
            [("likeliest", LINE_LIST, LINE), ("ends", POINTS, POINT)].map(|(ns, r#type, size)| Marker {
                header: self.header.clone(),
                ns: ns.to_owned(),
                r#type,
                scale: [size; 2].into(),
                color: blue(1.0),
                lifetime: LIFETIME,
                ..Marker::default()
            });
        for i in 0..self.window.len() {
            let path: Vec<Position> = self.likeliest(i).collect();
            lines.points.extend(path.windows(2).flatten().copied().map(Point::from));
            let most = self.forecast.weight(i, self.forecast.most_likely(i));
            for k in 0..self.forecast.hypotheses() {
                ends.points.push(self.forecast.hypothesis(i, k)[HORIZON - 1].into());
                ends.colors.push(blue((self.forecast.weight(i, k) / most) as f32));
            }
        }
        MarkerArray { markers: vec![lines, ends] }
    }

    fn present(&self, i: usize) -> Position {
        self.window.observed(i)[OBSERVED - 1]
    }

    fn likeliest(&self, i: usize) -> impl Iterator<Item = Position> {
        let path = self.forecast.hypothesis(i, self.forecast.most_likely(i));
        std::iter::once(self.present(i)).chain(path.iter().copied())
    }
}

/// The grid in percent, rounded; its stamp is the time that it is of.
///
/// `header`: of the moment of the forecast.
pub fn occupancy_grid(grid: &Occupancy, header: &Header) -> OccupancyGrid {
    let [width, height] = grid.area.size();
    OccupancyGrid {
        header: Header { stamp: header.stamp.after(grid.time), ..header.clone() },
        info: MapMetaData {
            map_load_time: header.stamp,
            resolution: grid.area.cell() as f32,
            width: width as u32,
            height: height as u32,
            origin: pose(grid.area.origin()),
        },
        data: grid.probabilities.iter().map(|p| (100.0 * p).round() as i8).collect(),
    }
}

fn pose(position: Position) -> Pose {
    Pose { position: position.into(), ..Pose::default() }
}

/// As hypotheses are in all pictures.
fn blue(a: f32) -> Color {
    let [r, g, b] = [0.11, 0.37, 0.76];
    Color { r, g, b, a }
}

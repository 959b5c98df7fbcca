//! Layouts of the five scenes: walls, pillars, entries and destinations.

use ddl_core::Position;

use crate::simulate::obstacle::{Pillar, Segment};
use crate::simulate::vector::left;

#[derive(Debug, Clone, Copy)]
pub(super) enum RouteLeg {
    Pass(Segment),
    /// Walk to a place on a line and stand there for a while.
    Stand(Segment),
}

/// Entry, gates to pass, and relative frequency of a route.
#[derive(Debug, Clone)]
pub(super) struct Route {
    pub(super) origin: Segment,
    pub(super) legs: Vec<RouteLeg>,
    pub(super) weight: f64,
}

impl Route {
    fn new(weight: f64, origin: Segment, gates: &[Segment]) -> Self {
        Self { origin, legs: gates.iter().copied().map(RouteLeg::Pass).collect(), weight }
    }

    /// The same route with a stop at a random place between two points before leg `index`.
    fn standing(mut self, weight: f64, index: usize, [a, b]: [Position; 2]) -> Self {
        self.legs.insert(index, RouteLeg::Stand(Segment::new(a, b)));
        self.weight = weight;
        self
    }
}

#[derive(Debug, Clone)]
pub(super) struct SceneLayout {
    pub(super) walls: Vec<Segment>,
    pub(super) pillars: Vec<Pillar>,
    pub(super) routes: Vec<Route>,
    /// Mean time between two arrivals of a pedestrian or group (s).
    pub(super) arrival_interval: f64,
}

type MakeLayout = fn() -> SceneLayout;

/// The scenes with their names, which are those of their recordings and folds.
pub(super) const SCENES: [(&str, MakeLayout); 5] = [
    ("corridor", corridor),
    ("crossing", crossing),
    ("plaza", plaza),
    ("bottleneck", bottleneck),
    ("doorway", doorway),
];

/// A walled way of 26 m x 6 m with two pillars, used in both directions; some pedestrians stop at the wall.
fn corridor() -> SceneLayout {
    let west = Segment::new([0.0, 0.0], [0.0, 6.0]);
    let east = Segment::new([26.0, 0.0], [26.0, 6.0]);
    let eastward = Route::new(1.0, west, &[east]);
    let westward = Route::new(1.0, east, &[west]);
    SceneLayout {
        walls: vec![Segment::new([-1.0, 0.0], [27.0, 0.0]), Segment::new([-1.0, 6.0], [27.0, 6.0])],
        pillars: vec![Pillar::new([9.0, 3.0], 0.3), Pillar::new([17.0, 3.0], 0.3)],
        routes: vec![
            eastward.clone(),
            westward.clone(),
            eastward.standing(0.12, 0, [[5.0, 5.4], [21.0, 5.4]]),
            westward.standing(0.12, 0, [[5.0, 0.6], [21.0, 0.6]]),
        ],
        arrival_interval: 3.0,
    }
}

/// Two ways of 6 m width that cross at right angles; pedestrians go straight on or turn.
fn crossing() -> SceneLayout {
    const HALF: f64 = 3.0;
    const END: f64 = 12.0;
    // Arms in the order east, north, west, south: each is the previous one turned by 90 degrees.
    let turn = |point: Position, quarters: usize| (0..quarters).fold(point, |p, _| left(p));
    let gate = |distance: f64, quarters: usize| {
        Segment::new(turn([distance, -HALF], quarters), turn([distance, HALF], quarters))
    };
    let mut walls = Vec::new();
    let mut routes = Vec::new();
    for from in 0..4 {
        let corner = turn([HALF, HALF], from);
        walls.push(Segment::new(corner, turn([END + 1.0, HALF], from)));
        walls.push(Segment::new(corner, turn([HALF, END + 1.0], from)));
        for (quarters, weight) in [(1, 0.2), (2, 1.0), (3, 0.2)] {
            let to = (from + quarters) % 4;
            let legs = [gate(HALF, from), gate(HALF, to), gate(END, to)];
            routes.push(Route::new(weight, gate(END, from), &legs));
        }
        let place = [turn([HALF - 0.7, HALF + 2.0], from), turn([HALF - 0.7, END - 2.0], from)];
        let to = (from + 1) % 4;
        let legs = [gate(HALF, from), gate(HALF, to), gate(END, to)];
        routes.push(Route::new(0.0, gate(END, from), &legs).standing(0.08, 2, place));
    }
    SceneLayout { walls, pillars: Vec::new(), routes, arrival_interval: 3.0 }
}

/// An open square of 22 m x 18 m with a fountain and trees; pedestrians cross it or meet and talk.
fn plaza() -> SceneLayout {
    let gates = [
        Segment::new([0.0, 3.0], [0.0, 8.0]),
        Segment::new([0.0, 11.0], [0.0, 16.0]),
        Segment::new([5.0, 18.0], [12.0, 18.0]),
        Segment::new([22.0, 10.0], [22.0, 16.0]),
        Segment::new([22.0, 2.0], [22.0, 7.0]),
        Segment::new([8.0, 0.0], [15.0, 0.0]),
    ];
    let places = [
        [[4.0, 5.0], [8.0, 5.0]],
        [[17.0, 11.5], [17.0, 15.0]],
        [[15.0, 4.0], [18.0, 5.5]],
        [[5.0, 13.5], [9.0, 13.5]],
    ];
    let mut routes = Vec::new();
    for (from, &origin) in gates.iter().enumerate() {
        for (to, &goal) in gates.iter().enumerate() {
            if from == to {
                continue;
            }
            let route = Route::new(1.0, origin, &[goal]);
            routes.push(route.clone().standing(0.15, 0, places[(from + 2 * to) % places.len()]));
            routes.push(route);
        }
    }
    SceneLayout {
        walls: vec![Segment::new([0.0, 8.5], [0.0, 10.5]), Segment::new([16.0, 18.0], [21.0, 18.0])],
        pillars: vec![
            Pillar::new([11.0, 9.0], 1.6),
            Pillar::new([5.0, 9.5], 0.35),
            Pillar::new([16.0, 9.0], 0.35),
            Pillar::new([13.0, 14.5], 0.35),
        ],
        routes,
        arrival_interval: 2.2,
    }
}

/// A room of 10 m width that narrows to a passage of 2.4 m; most pedestrians enter the passage.
fn bottleneck() -> SceneLayout {
    let room = Segment::new([0.0, -5.0], [0.0, 5.0]);
    let mouth = Segment::new([11.0, -1.2], [11.0, 1.2]);
    let end = Segment::new([14.0, -1.2], [14.0, 1.2]);
    let street = Segment::new([23.0, -4.0], [23.0, 4.0]);
    let inward = Route::new(0.75, room, &[mouth, end, street]);
    let outward = Route::new(0.2, street, &[end, mouth, room]);
    let mut walls = Vec::new();
    for side in [-1.0, 1.0] {
        let corners = [[-1.0, 5.0], [7.5, 5.0], [11.0, 1.2], [14.0, 1.2], [15.0, 4.5], [24.0, 4.5]];
        let mirrored = corners.map(|[x, y]| [x, side * y]);
        walls.extend(mirrored.windows(2).map(|pair| Segment::new(pair[0], pair[1])));
    }
    SceneLayout {
        walls,
        pillars: vec![Pillar::new([5.0, 1.5], 0.3)],
        routes: vec![
            inward.clone().standing(0.05, 0, [[2.0, -3.9], [6.5, -3.9]]),
            inward,
            outward.clone().standing(0.03, 0, [[17.0, 3.4], [21.5, 3.4]]),
            outward,
        ],
        arrival_interval: 2.8,
    }
}

/// Two halls of 18 m width, one behind the other, joined by two doors of 1.8 m; pedestrians wait at the side.
fn doorway() -> SceneLayout {
    let south = Segment::new([1.0, 0.0], [17.0, 0.0]);
    let north = Segment::new([1.0, 20.0], [17.0, 20.0]);
    let doors = [4.5, 13.0].map(|x: f64| Segment::new([x - 0.9, 10.0], [x + 0.9, 10.0]));
    let mut routes = Vec::new();
    for door in doors {
        let northward = Route::new(1.0, south, &[door, north]);
        let southward = Route::new(1.0, north, &[door, south]);
        let wall = |y: f64| [[6.5, y], [11.0, y]];
        routes.push(northward.clone().standing(0.08, 0, wall(9.0)));
        routes.push(southward.clone().standing(0.08, 0, wall(11.0)));
        routes.push(northward);
        routes.push(southward);
    }
    SceneLayout {
        walls: vec![
            Segment::new([0.0, -1.0], [0.0, 21.0]),
            Segment::new([18.0, -1.0], [18.0, 21.0]),
            Segment::new([0.0, 10.0], doors[0].a),
            Segment::new(doors[0].b, doors[1].a),
            Segment::new(doors[1].b, [18.0, 10.0]),
        ],
        pillars: vec![Pillar::new([9.0, 5.0], 0.35), Pillar::new([9.0, 15.0], 0.35)],
        routes,
        arrival_interval: 2.6,
    }
}

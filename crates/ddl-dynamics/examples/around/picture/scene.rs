//! Walkers who have one goal, and something in their way.

use ddl_dynamics::{
    Attractor, AvoidingFlow, Ball, Chain, CholeskyMetric, DiffeomorphicFlow, DynamicsError, Flow,
    NaturalGradientFlow, PUBLISHED_SIGMA, StableEuler, rollout,
};
use nalgebra::Vector2;

use super::walk::Walk;

/// Seconds of a step, those of the published program.
pub(crate) const TIME_STEP: f64 = 0.4;
/// Seconds of a step of the walkers who are drawn as lines.
const SHORT_STEP: f64 = 0.05;
/// Seconds after which the last one has arrived by far.
const LONGEST: f64 = 60.0;

/// Out to the end of a wall, around it, and back on its other side, to a goal 1 m away (metres).
pub(crate) const SHOWN: [[f64; 2]; 4] = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [0.0, 1.0]];
/// Lower left and upper right corner of the wall, which goes on to the left (metres).
pub(crate) const WALL: [[f64; 2]; 2] = [[-4.0, 0.4], [2.5, 0.6]];
/// Layers of the chain that straightens the path shown.
const LAYERS: usize = 150;

/// Centre and radius of each pillar (metres).
pub(crate) const PILLARS: [([f64; 2], f64); 6] = [
    ([1.5, 0.55], 0.35),
    ([2.7, -0.55], 0.4),
    ([3.6, 0.75], 0.35),
    ([4.3, -0.25], 0.3),
    ([1.2, -1.05], 0.25),
    ([5.0, 0.9], 0.25),
];
/// From this near on, an approach to a pillar is slowed (metres).
pub(crate) const MARGIN: f64 = 0.5;

/// A flow, and the walks that it makes.
pub(crate) struct Scene<F> {
    pub(crate) flow: F,
    /// The walker who is followed in steps of 0.4 s.
    pub(crate) walk: Walk,
    /// Walkers from elsewhere, in short steps.
    pub(crate) others: Vec<Walk>,
}

pub(crate) type WallFlow = DiffeomorphicFlow<f64, 2, Chain<f64, 2>, CholeskyMetric<f64, 2>>;
pub(crate) type PillarFlow = AvoidingFlow<f64, 2, CholeskyMetric<f64, 2>, [Ball<f64, 2>; 6]>;

/// Walkers who follow the path shown, at 1 m/s on it.
pub(crate) fn behind_a_wall() -> Result<Scene<WallFlow>, DynamicsError> {
    let shown = SHOWN.map(Vector2::from);
    let psi = Chain::straightening(&shown, LAYERS)?.chain;
    let flow = DiffeomorphicFlow::in_chart(shown[3], psi, CholeskyMetric::identity())?;
    let others = [
        [-0.5, -0.5],
        [1.8, -1.0],
        [3.3, -1.0],
        [4.1, -0.4],
        [1.1, 1.8],
        [-0.7, 1.7],
    ];
    Scene::new(flow, SHOWN[0], &others)
}

/// Walkers who would go straight to their goal at 1.2 m/s, were it not for the pillars.
pub(crate) fn among_pillars() -> Result<Scene<PillarFlow>, DynamicsError> {
    let mut pillars = [Ball::new(Vector2::zeros(), 1.0)?; 6];
    for (pillar, (centre, radius)) in pillars.iter_mut().zip(PILLARS) {
        *pillar = Ball::new(Vector2::from(centre), radius)?;
    }
    let metric = CholeskyMetric::planar(1.1, 0.0, 1.1, PUBLISHED_SIGMA)?;
    let straight = NaturalGradientFlow::new(Attractor::new(Vector2::new(6.0, 0.0))?, metric);
    let flow = AvoidingFlow::new(straight, pillars, MARGIN)?;
    let others = [
        [0.0, 1.3],
        [0.0, -0.4],
        [0.2, -1.4],
        [2.0, 1.5],
        [3.4, -1.5],
        [6.2, 1.5],
    ];
    Scene::new(flow, [0.0, 0.6], &others)
}

impl<F: Flow<f64, 2>> Scene<F> {
    fn new(flow: F, start: [f64; 2], others: &[[f64; 2]]) -> Result<Self, DynamicsError> {
        let walk = |start: [f64; 2], time_step: f64| {
            let steps = (LONGEST / time_step) as usize;
            let path = rollout(&flow, &StableEuler, start.into(), time_step, steps)?;
            Ok(Walk::until_arrival(&flow, path))
        };
        let followed = walk(start, TIME_STEP)?;
        let others = others.iter().map(|start| walk(*start, SHORT_STEP));
        let others = others.collect::<Result<_, DynamicsError>>()?;
        Ok(Self {
            walk: followed,
            others,
            flow,
        })
    }
}

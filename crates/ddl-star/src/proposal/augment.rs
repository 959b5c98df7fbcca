//! Augmentations that keep a scene plausible. The windows of a fold overlap: without random changes, the network would
//! memorise single pedestrians.

use crate::proposal::data::{RememberedViews, Views};
use ddl_network::ProposalTraining;
use tch::{Kind, Tensor};

/// Standard deviation of the noise on each position of a neighbour (metres).
const NEIGHBOUR_NOISE: f64 = 0.02;

/// Augments a batch with numbers from libtorch's generator. Shapes: `views` `[M, B, ..]`, `future` `[M, B, 12, 2]`; the
/// result has the same shapes.
pub(crate) fn augment(views: &Views, future: &Tensor, training: &ProposalTraining) -> (Views, Tensor) {
    let size = future.size();
    let per_pedestrian = [size[0], size[1]];
    let options = (future.kind(), future.device());
    let uniform = || Tensor::rand(per_pedestrian, options) * 2.0 - 1.0;
    let scale = (uniform() * training.scale).exp();
    // `sign` would have a third value, 0.
    let mirror = uniform().ge(0.0).to_kind(options.0) * 2.0 - 1.0;
    let angle = Tensor::randn(per_pedestrian, options) * training.turn;
    let (cos, sin) = (&scale * angle.cos(), &scale * angle.sin());
    // Row vectors: p' = p [[cos, sin], [-m sin, m cos]], a reflection in the x axis, then a rotation.
    let matrix = Tensor::stack(
        &[
            Tensor::stack(&[cos.shallow_clone(), sin.shallow_clone()], -1),
            Tensor::stack(&[-(&mirror * &sin), &mirror * &cos], -1),
        ],
        -2,
    );
    let noise = |tensor: &Tensor, deviation: f64| tensor.randn_like() * deviation;
    let neighbours = views.neighbours.matmul(&matrix.unsqueeze(2));
    let whole_track = neighbours.narrow(3, 0, 1);
    let neighbours = &neighbours + noise(&whole_track, training.neighbour_jitter) + noise(&neighbours, NEIGHBOUR_NOISE);
    let seeing = Tensor::rand(per_pedestrian, options)
        .ge(training.blindness)
        .to_kind(Kind::Float)
        .to_kind(options.0)
        .unsqueeze(-1);
    let transformed = views.own.matmul(&matrix);
    let inexactness = Tensor::rand([size[0], size[1], 1, 1], options) * training.jitter;
    let own_tracks = &transformed + transformed.randn_like() * inexactness;
    let augmented = Views {
        own: own_tracks,
        neighbours,
        present: &views.present * seeing,
        remembered: remembering(&views.remembered, &matrix, training),
    };
    (augmented, future.matmul(&matrix))
}

/// The memory transformed by `matrix`, with each track shifted by some centimetres, and dropped in part for some
/// pedestrians. Shapes: `matrix` `[M, B, 2, 2]`.
fn remembering(remembered: &RememberedViews, matrix: &Tensor, training: &ProposalTraining) -> RememberedViews {
    let (memory, size) = (&training.memory, remembered.present.size());
    let options = (matrix.kind(), matrix.device());
    let uniform = |others: i64| Tensor::rand([size[0], size[1], others], options);
    let tracks = remembered.tracks.matmul(&matrix.unsqueeze(2));
    let whole_track = tracks.narrow(3, 0, 1);
    let whole = uniform(1).ge(memory.partial).to_kind(options.0);
    let drawn = uniform(size[2]).lt_tensor(&uniform(1)).to_kind(options.0);
    RememberedViews {
        tracks: &tracks + whole_track.randn_like() * memory.jitter,
        distances: remembered.distances.shallow_clone(),
        present: &remembered.present * drawn.maximum(&whole),
    }
}

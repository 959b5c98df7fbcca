//! The loss: several of the nearest endpoints share it at first, only the nearest at the end (relaxed winner takes
//! all).

use crate::proposal::network::Proposals;
use ddl_core::HORIZON;
use ddl_network::proposal::WAYPOINTS;
use tch::{Kind, Tensor};

#[derive(Debug, Clone, Copy)]
pub(crate) struct LossWeights {
    /// Number of nearest endpoints that share the loss; a fraction weights the last of them.
    pub(crate) relaxed: f64,
    pub(crate) waypoints: f64,
    pub(crate) probability: f64,
}

/// Mean over pedestrians of the (relaxed) distance of the nearest proposal, plus the cross-entropy of its probability.
/// It is summed over members, which are trained independently. Shapes: `future` `[M, B, 12, 2]` -> the loss to
/// minimise, and its distance part as the mean over members (metres), both scalar.
pub(crate) fn winner_takes_all(proposals: &Proposals, future: &Tensor, weights: LossWeights) -> (Tensor, Tensor) {
    let end = future.select(2, HORIZON as i64 - 1).unsqueeze(2);
    let length = |offset: Tensor| {
        let squared = offset.square();
        (squared.sum_dim_intlist([-1i64].as_slice(), false, None::<Kind>) + 1e-6).sqrt()
    };
    let off_the_end = length(&proposals.ends - end);
    let distance = if weights.waypoints > 0.0 {
        let steps: Vec<i64> = WAYPOINTS.iter().map(|share| (share * HORIZON as f64) as i64 - 1).collect();
        let index = Tensor::from_slice(&steps).to_device(future.device());
        let on_the_way = future.index_select(2, &index).unsqueeze(2);
        let off = length(&proposals.waypoints - on_the_way);
        off_the_end + off.mean_dim([-1i64].as_slice(), false, None::<Kind>) * weights.waypoints
    } else {
        off_the_end
    };
    let (sorted, order) = distance.sort(-1, false);
    let ends = distance.size()[2];
    let share: Vec<f64> = (0..ends).map(|rank| (weights.relaxed - rank as f64).clamp(0.0, 1.0)).collect();
    let total: f64 = share.iter().sum();
    let share = Tensor::from_slice(&share).to_kind(distance.kind()).to_device(distance.device()) / total;
    let members = distance.size()[0] as f64;
    let nearest = (sorted * share).sum_dim_intlist([-1i64].as_slice(), false, None::<Kind>).mean(None::<Kind>);
    let winner = order.narrow(-1, 0, 1);
    let surprise = -proposals.logits.log_softmax(-1, None::<Kind>).gather(-1, &winner, false).mean(None::<Kind>);
    ((&nearest + surprise * weights.probability) * members, nearest)
}

#[cfg(test)]
mod tests {
    use super::{LossWeights, winner_takes_all};
    use crate::proposal::network::Proposals;
    use tch::{Device, Kind, Tensor};

    #[test]
    fn only_the_nearest_count_and_their_number_shrinks() {
        // One member, one pedestrian that ends at (5, 0); ends at distances 1, 3 and 2.
        let future = Tensor::zeros([1, 1, 12, 2], (Kind::Double, Device::Cpu));
        future.select(2, 11).copy_(&Tensor::from_slice(&[5.0, 0.0]));
        let proposals = Proposals {
            ends: Tensor::from_slice(&[6.0, 0.0, 5.0, 3.0, 3.0, 0.0]).reshape([1, 1, 3, 2]),
            waypoints: Tensor::zeros([1, 1, 3, 3, 2], (Kind::Double, Device::Cpu)),
            logits: Tensor::from_slice(&[0.0, 0.0, 0.0]).reshape([1, 1, 3]),
        };
        let both = |relaxed: f64, probability: f64| {
            let waypoints = 0.0;
            let weights = LossWeights { relaxed, waypoints, probability };
            winner_takes_all(&proposals, &future, weights)
        };
        let loss = |relaxed: f64| both(relaxed, 0.0).0.double_value(&[]);
        assert!((loss(1.0) - 1.0).abs() < 1e-6);
        assert!((loss(2.0) - 1.5).abs() < 1e-6);
        assert!((loss(2.5) - (1.0 + 2.0 + 0.5 * 3.0) / 2.5).abs() < 1e-6);
        assert!((loss(9.0) - 2.0).abs() < 1e-6);
        let (total, distance) = both(1.0, 1.0);
        let surprise = (&total - &distance).double_value(&[]);
        assert!((surprise - 3.0_f64.ln()).abs() < 1e-9);
    }
}

//! Numbers of weights.

use ddl_network::{
    BackboneKind, ForecastWindows as _, MotionNetwork, ProposalConfig, ProposalNetwork, ProposeEndpoints as _,
    StarConfig, Variant,
};

fn check(least: u64, count: usize) {
    let range = least..=20 * least + 1000;
    assert!(range.contains(&(count as u64)), "{least}, {count}");
}

#[test]
fn weights_are_as_many_as_published_and_at_least_the_lower_bound() {
    let published = StarConfig::published(Variant::Full);
    let network = MotionNetwork::new(published.clone(), 1).unwrap();
    assert_eq!(network.copy_weights().unwrap().numbers().len(), 827_443);
    for [model_width, heads, feed_forward_width, layers] in
        [[32, 8, 128, 2], [4, 1, 1, 1], [16, 4, 512, 5], [64, 16, 1, 1]]
    {
        for backbone in BackboneKind::ALL {
            let config = StarConfig {
                backbone,
                model_width,
                heads,
                feed_forward_width,
                spatial_layers: layers as usize,
                ..published.clone()
            };
            let weights = MotionNetwork::new(config.clone(), 1).unwrap().copy_weights();
            check(config.min_weight_count(), weights.unwrap().numbers().len());
        }
    }
    for [members, ends, width, layers, neighbour_width] in
        [[4, 20, 192, 2, 64], [1, 1, 1, 1, 4], [2, 3, 8, 5, 32], [1, 64, 2, 1, 4]]
    {
        let config = ProposalConfig {
            members,
            ends,
            width,
            layers: layers as usize,
            neighbour_width,
            ..ProposalConfig::default()
        };
        let count = ProposalNetwork::new(config.clone(), 1).unwrap().copy_weights().unwrap().numbers().len();
        assert_eq!(config.parameter_count(), count);
        check(config.min_weight_count(), count);
    }
}

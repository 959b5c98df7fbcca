//! How many numbers networks have.

use ddl_network::{
    BackboneKind, MotionNetwork, ProposalConfig, ProposalNetwork, StarConfig, Variant,
};

/// The network has more numbers than the least that its configuration names, but not many times more.
fn check(least: u64, count: usize) {
    let count = count as u64;
    assert!(
        least <= count && count <= 20 * least + 1000,
        "{least}, {count}"
    );
}

#[test]
fn the_published_network() {
    let network = MotionNetwork::new(StarConfig::published(Variant::Full), 1).unwrap();
    assert_eq!(network.weights().count(), 827_443);
}

#[test]
fn forecasting_networks() {
    for (model_width, heads, feed_forward_width, spatial_layers) in [
        (32, 8, 128, 2),
        (1, 1, 1, 1),
        (16, 4, 512, 5),
        (64, 2, 1, 1),
    ] {
        for backbone in BackboneKind::ALL {
            let config = StarConfig {
                backbone,
                model_width,
                heads,
                feed_forward_width,
                spatial_layers,
                ..StarConfig::published(Variant::Full)
            };
            let network = MotionNetwork::new(config.clone(), 1).unwrap();
            check(config.least_numbers(), network.weights().count());
        }
    }
}

#[test]
fn proposal_networks() {
    for (members, ends, width, layers, neighbour_width) in [
        (4, 20, 192, 2, 64),
        (1, 1, 1, 1, 4),
        (2, 3, 8, 5, 32),
        (1, 64, 2, 1, 4),
    ] {
        let config = ProposalConfig {
            members,
            ends,
            width,
            layers,
            neighbour_width,
            ..ProposalConfig::default()
        };
        let network = ProposalNetwork::new(config.clone(), 1).unwrap();
        let count = network.weights().count();
        assert_eq!(config.parameter_count(), count);
        check(config.least_numbers(), count);
    }
}

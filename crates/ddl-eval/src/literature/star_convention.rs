//! What others reached on the same files.

use ddl_data::Convention::Star;

use super::{LiteratureRow, folds, pair};

/// The best published systems measured in the `star` convention: minADE20/minFDE20.
pub const STAR_CONVENTION: [LiteratureRow; 5] = [
    LiteratureRow {
        method: "V2-Net",
        source: "Wong et al., ECCV 2022",
        convention: Some(Star),
        remark: "univ: tests on students001 alone and trains on students003",
        folds: folds([
            (0.239, 0.376),
            (0.108, 0.164),
            (0.210, 0.353),
            (0.194, 0.310),
            (0.150, 0.248),
        ]),
        mean: pair((0.180, 0.290)),
    },
    LiteratureRow {
        method: "E-V2-Net",
        source: "Wong et al., 2025, as quoted by Socialality (2026)",
        convention: Some(Star),
        remark: "",
        folds: folds([
            (0.25, 0.38),
            (0.11, 0.16),
            (0.23, 0.42),
            (0.19, 0.30),
            (0.13, 0.24),
        ]),
        mean: pair((0.18, 0.30)),
    },
    LiteratureRow {
        method: "SocialCircle",
        source: "Wong et al., CVPR 2024, as quoted by Socialality (2026)",
        convention: Some(Star),
        remark: "",
        folds: folds([
            (0.25, 0.38),
            (0.12, 0.14),
            (0.23, 0.42),
            (0.18, 0.29),
            (0.13, 0.22),
        ]),
        mean: pair((0.18, 0.29)),
    },
    LiteratureRow {
        method: "Resonance",
        source: "Wong et al., ICCV 2025, as quoted by Socialality (2026)",
        convention: Some(Star),
        remark: "",
        folds: folds([
            (0.23, 0.35),
            (0.10, 0.15),
            (0.24, 0.41),
            (0.17, 0.29),
            (0.13, 0.22),
        ]),
        mean: pair((0.17, 0.28)),
    },
    LiteratureRow {
        method: "Socialality",
        source: "its own paper, 2026",
        convention: Some(Star),
        remark: "",
        folds: folds([
            (0.23, 0.37),
            (0.10, 0.16),
            (0.24, 0.43),
            (0.17, 0.29),
            (0.13, 0.22),
        ]),
        mean: pair((0.17, 0.29)),
    },
];

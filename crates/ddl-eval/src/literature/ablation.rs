//! Table II of the DDL paper.

use super::{AblationRow, folds, pair};

/// Table II of the DDL paper: `star` convention, protocol `published`.
pub const ABLATION: [AblationRow; 4] = [
    AblationRow {
        variant: "star",
        goal_shift: false,
        dynamics: false,
        folds: folds([
            (0.36, 0.65),
            (0.17, 0.36),
            (0.31, 0.62),
            (0.26, 0.55),
            (0.22, 0.46),
        ]),
        mean: pair((0.26, 0.53)),
    },
    AblationRow {
        variant: "no-goal-shift",
        goal_shift: false,
        dynamics: true,
        folds: folds([
            (0.27, 0.52),
            (0.15, 0.35),
            (0.33, 0.59),
            (0.17, 0.31),
            (0.14, 0.25),
        ]),
        mean: pair((0.21, 0.40)),
    },
    AblationRow {
        variant: "no-dynamics",
        goal_shift: true,
        dynamics: false,
        folds: folds([
            (0.46, 0.89),
            (0.17, 0.35),
            (0.31, 0.64),
            (0.17, 0.40),
            (0.15, 0.28),
        ]),
        mean: pair((0.25, 0.51)),
    },
    AblationRow {
        variant: "full",
        goal_shift: true,
        dynamics: true,
        folds: folds([
            (0.26, 0.50),
            (0.15, 0.35),
            (0.29, 0.58),
            (0.16, 0.29),
            (0.13, 0.23),
        ]),
        mean: pair((0.20, 0.39)),
    },
];

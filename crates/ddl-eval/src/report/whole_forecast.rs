//! Columns of the table on the forecast as a whole: all hypotheses with their weights, not the best one.

use super::further::Column;

pub(super) const LEGEND: &str = "The forecast as a whole, mean over the folds named. ADE@minFDE: ADE of \
    the hypothesis of least FDE; expected: errors of all hypotheses, weighted; likely: errors of the \
    hypothesis of greatest weight; missed 1 m, 2 m: every hypothesis ends farther off; runs into: \
    forecasts, those that protocol `single` would take, that overlap the TRUE future of another (Col-II; discs of radius 0.2 m); KDE NLL: negative \
    log-likelihood of the truth under a Gaussian kernel density of the weighted hypotheses, clipped at 20 \
    nats; AMD: Mahalanobis distance of the truth in deviations of the hypotheses; AMV: largest \
    eigenvalue of their mean covariance; APD, FPD: mean distance between two hypotheses, over the path and \
    of the ends. Distributions need several hypotheses, and depend on how many there are.";

pub(super) const COLUMNS: [Column; 13] = [
    ("ADE@minFDE m", 3, |s| s.ade_at_min_fde),
    ("expected ADE m", 3, |s| s.expected_ade),
    ("expected FDE m", 3, |s| s.expected_fde),
    ("likely ADE m", 3, |s| s.most_likely_ade),
    ("likely FDE m", 3, |s| s.most_likely_fde),
    ("missed 1 m %", 1, |s| {
        s.miss_rate_1m.map(|rate| 100.0 * rate)
    }),
    ("missed 2 m %", 1, |s| {
        s.miss_rate_2m.map(|rate| 100.0 * rate)
    }),
    ("runs into %", 1, |s| {
        s.true_neighbour_collision_rate.map(|rate| 100.0 * rate)
    }),
    ("KDE NLL nats", 3, |s| s.kde_nll),
    ("AMD", 3, |s| s.amd),
    ("AMV m²", 3, |s| s.amv),
    ("APD m", 3, |s| s.diversity),
    ("FPD m", 3, |s| s.end_diversity),
];

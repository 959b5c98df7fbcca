# Prints the numbers of the tests in src/significance: quantiles over resampled blocks and exact p-values. numpy 2.
import numpy as np

random = np.random.default_rng(1)


def folds(error, other):
    # Two folds of 10 and 14 blocks with 1 to 7 pedestrians each: their pedestrians and sums of differences.
    for fold, blocks in enumerate((10, 14)):
        b = np.arange(blocks)
        n = 1 + 3 * b % 7
        yield n, n * (error(b, fold) - other(b, fold))


first = lambda b, fold: 0.1 * (5 * b % 11) + 0.2 * fold
second = lambda b, fold: 0.07 * (3 * b % 13) + 0.1 * fold
nothing = lambda b, fold: 0 * b
for what, other in (("mean", nothing), ("difference", second)):
    means, drawn = [], []
    for n, sums in folds(first, other):
        means.append(sums.sum() / n.sum())
        chosen = random.integers(0, len(n), size=(400_000, len(n)))
        drawn.append(sums[chosen].sum(axis=1) / n[chosen].sum(axis=1))
    low, high = np.percentile(np.mean(drawn, axis=0), [2.5, 97.5])
    print(what, repr(float(np.mean(means))), round(low, 4), round(high, 4))
# All 2^24 patterns of signs.
flipped = []
for n, sums in folds(first, second):
    signs = 1 - 2 * ((np.arange(2 ** len(n))[:, None] >> np.arange(len(n))) & 1)
    flipped.append(signs @ sums / n.sum())
observed = abs(flipped[0][0] + flipped[1][0])
count = sum((abs(one + flipped[1]) >= observed * (1 - 1e-12)).sum() for one in flipped[0])
print("p", count / 2**24)

# Writes high_precision.json: soft-DTW values and gradients in 60 decimal digits (mpmath 1.3), rounded once to f64.
# Nothing is shared with the crate: the sum over paths is formed directly, on numbers of unlimited exponent.
import json

from mpmath import exp, log, mp, mpf

mp.dps = 60


def sequence(steps, dimension, seed, spread, offset):
    # Multiples of 1/64, exact in f64.
    return [
        [
            offset + ((37 * i * i + 11 * seed * i + 29 * k + 13 * seed) % 101 - 50) * spread / 64
            for k in range(dimension)
        ]
        for i in range(steps)
    ]


def soft_dtw(x, y, gamma):
    n, m, gamma = len(x), len(y), mpf(gamma)
    squared = lambda i, j: sum((mpf(a) - mpf(b)) ** 2 for a, b in zip(x[i], y[j]))
    cells = [(i, j) for i in range(n) for j in range(m)]
    k = {c: exp(-squared(*c) / gamma) for c in cells}
    before, after = {}, {}
    for i, j in cells:
        ways = [before[c] for c in ((i - 1, j - 1), (i - 1, j), (i, j - 1)) if c in before]
        before[i, j] = k[i, j] * (sum(ways) if (i, j) != (0, 0) else 1)
    for i, j in reversed(cells):
        ways = [after[c] * k[c] for c in ((i + 1, j + 1), (i + 1, j), (i, j + 1)) if c in after]
        after[i, j] = sum(ways) if (i, j) != (n - 1, m - 1) else mpf(1)
    total = before[n - 1, m - 1]
    gradient = [[mpf(0)] * len(x[0]) for _ in x]
    for i, j in cells:
        expected = before[i, j] * after[i, j] / total
        for d, (a, b) in enumerate(zip(x[i], y[j])):
            gradient[i][d] += expected * 2 * (mpf(a) - mpf(b))
    return -gamma * log(total), gradient


# steps of x, steps of y, dimension, spread, offset of x, gamma
CASES = [
    (1, 1, 1, 1, 0, 1.0),
    (2, 2, 1, 1, 0, 1.0),
    (4, 4, 2, 1, 0, 1.0),
    (5, 3, 2, 1, 0, 0.1),
    (7, 7, 2, 2, 0, 1.0),
    (8, 8, 2, 1, 0, 1.0),
    (8, 8, 2, 1, 0, 0.01),
    (8, 8, 2, 1, 1000, 0.001),
    (8, 8, 2, 1, 0, 1e6),
    (9, 13, 3, 1, 0, 1.0),
    (13, 9, 3, 1, 0, 1.0),
    (21, 10, 1, 4, 0, 0.3),
    (33, 34, 3, 8, 0, 0.05),
    (40, 40, 2, 64, 0, 0.01),
    (3, 150, 2, 1, 0, 1.0),
    (140, 145, 2, 1, 0, 0.2),
    (260, 260, 1, 4, 0, 1.0),
    (300, 300, 1, 1, 0, 100.0),
]
out = []
for n, m, dimension, spread, offset, gamma in CASES:
    x, y = sequence(n, dimension, 1, spread, offset), sequence(m, dimension, 2, spread, 0)
    value, gradient = soft_dtw(x, y, gamma)
    self_value = lambda s: soft_dtw(s, s, gamma)[0] if len(s) <= 50 else None
    normalised = value - (self_value(x) + self_value(y)) / 2 if max(n, m) <= 50 else None
    shown = gradient if n <= 10 else gradient[:2] + gradient[-2:]
    out.append(
        dict(
            n=n,
            m=m,
            dimension=dimension,
            spread=spread,
            offset=offset,
            gamma=gamma,
            value=float(value),
            normalised=None if normalised is None else float(normalised),
            gradient=[[float(g) for g in step] for step in shown],
        )
    )
    print(n, m, float(value), flush=True)
with open("high_precision.json", "w") as file:
    file.write('{"cases": [\n' + ",\n".join(json.dumps(case) for case in out) + "\n]}\n")

"""Checks the slider of joint futures and the conflicts that a page names."""

import math

CONFLICT = 0.4  # m
PARTS = 200  # of a step
FAR = 2.0  # m; nobody comes from there into a conflict and back within a step


def closest(a, b):
    """The smallest distance of two paths along straight segments, in m, sampled."""
    best = math.inf
    for (p, q), (r, s) in zip(zip(a, b), zip(a[1:], b[1:])):
        if min(math.dist(p, q), math.dist(r, s)) > FAR:
            continue
        for part in range(PARTS + 1):
            share = part / PARTS
            gap = [(1 - share) * (y - x) + share * (w - v) for x, y, v, w in zip(p, q, r, s)]
            best = min(best, math.hypot(*gap))
    return best


def conflicts(moment, k):
    """The names and the smallest distance of each pair that comes too close in future k."""
    tracks = [(w["pedestrian"], [w["observed"][-1], *w["hypotheses"][k]["positions"]]) for w in moment["pedestrians"]]
    pairs = [(one, other) for at, one in enumerate(tracks) for other in tracks[at + 1 :]]
    gaps = [(f"{one[0]} and {other[0]}", closest(one[1], other[1])) for one, other in pairs]
    return [(names, gap) for names, gap in gaps if gap < CONFLICT]


def check_words(opened, moment, k):
    count, weight = len(moment["pedestrians"][0]["hypotheses"]), moment["pedestrians"][0]["hypotheses"][k]["weight"]
    words = opened.text("#future-words")
    assert words.startswith(f"future {k + 1} of {count} (weight "), words
    assert weight < 0.01 or abs(float(words.split("weight ")[1].split(" ")[0]) - 100 * weight) < 0.51, words
    assert opened.text("#certificate-words").startswith(f"Future {k + 1}: ")
    assert opened.page.locator(f"#hypotheses tr[data-index='{k}']").get_attribute("aria-selected") == "true"


def check_conflicts(opened, moment, k):
    expected, said = conflicts(moment, k), opened.text("#conflict-words").replace("\u00a0", " ")
    named = said.count("(")
    assert (said == "nobody") == (not expected), (said, expected)
    for names, gap in expected:
        assert len(expected) > 3 or (names in said and f"({gap:.2f} m)" in said), (said, names, gap)
    return named


def check_futures(opened, moments):
    page = opened.page
    chosen = int(page.input_value("#choose-moment"))
    moment = moments[chosen]
    weights = [h["weight"] for h in moment["pedestrians"][0]["hypotheses"]]
    first, count = weights.index(max(weights)), len(weights)
    page.focus(".stage")
    page.keyboard.press("End")
    check_words(opened, moment, first)
    one = opened.picture()

    # The keys go around, and each future has its own picture. The choice of a pedestrian keeps the future.
    page.keyboard.press("d")
    check_words(opened, moment, (first - 1) % count)
    page.keyboard.press("f")
    assert opened.picture() == one
    page.keyboard.press("f")
    check_words(opened, moment, (first + 1) % count)
    assert opened.picture() != one
    page.keyboard.press("ArrowDown")
    check_words(opened, moment, (first + 1) % count)

    # All futures, by the switch and by its key.
    before = opened.picture()
    page.check("#show-futures")
    everything = opened.picture()
    assert everything != before
    page.focus(".stage")
    page.keyboard.press("h")
    assert not page.is_checked("#show-futures") and opened.picture() == before

    named = 0
    for at, moment in enumerate(moments):
        page.select_option("#choose-moment", str(at))
        for k in range(count):
            page.locator("#future").fill(str(k + 1))
            check_words(opened, moment, k)
            named += check_conflicts(opened, moment, k)
    return named

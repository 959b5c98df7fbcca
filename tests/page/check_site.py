"""Opens every page of the guide in a browser: no network request, no error or warning, no horizontal overflow.

    check_site.py FOLDER --browser /path/to/chromium --screenshots FOLDER

FOLDER is the output of `cargo xtask docs`. Pages are opened from the file system, light and dark, wide and narrow;
screenshots of some are kept.
"""

import argparse
import pathlib

from playwright.sync_api import sync_playwright

SIZES = {"wide": {"width": 1280, "height": 900}, "narrow": {"width": 390, "height": 844}}
KEPT = ["index.html"] + [
    f"guide/{page}.html" for page in ("index", "start", "python", "benchmark", "extending", "troubleshooting")
]


def visit(browser, path, size, scheme):
    context = browser.new_context(viewport=SIZES[size], color_scheme=scheme)
    page = context.new_page()
    faults = []
    page.on(
        "console", lambda message: message.type in ("error", "warning") and faults.append(f"console: {message.text}")
    )
    page.on("pageerror", lambda error: faults.append(f"page error: {error}"))
    page.on(
        "request",
        lambda request: request.url.startswith(("file:", "data:")) or faults.append(f"request: {request.url}"),
    )
    page.goto(path.as_uri())
    # Wide tables and code scroll; the page itself must not.
    spare = page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth")
    if spare > 0:
        faults.append(f"{spare} px of horizontal overflow")
    broken = page.evaluate(
        "[...document.images].filter((image) => image.complete && !image.naturalWidth).map((image) => image.src)"
    )
    faults.extend(f"missing picture: {source}" for source in broken)
    return context, page, [f"{path.name}, {size}, {scheme}: {fault}" for fault in faults]


def ratio(page, selector):
    """Contrast of the first matching element's text with its background (WCAG 2)."""
    return page.evaluate(
        """(selector) => {
            const element = document.querySelector(selector);
            const numbers = (colour) => colour.match(/[\\d.]+/g).map(Number);
            let behind = element;
            while (behind && (numbers(getComputedStyle(behind).backgroundColor)[3] ?? 1) === 0)
                behind = behind.parentElement;
            const light = (colour) => {
                const linear = (c) => (c /= 255) <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
                const [r, g, b] = numbers(colour).slice(0, 3).map(linear);
                return 0.2126 * r + 0.7152 * g + 0.0722 * b;
            };
            const background = getComputedStyle(behind ?? document.documentElement).backgroundColor;
            const pair = [getComputedStyle(element).color, background].map(light);
            return (Math.max(...pair) + 0.05) / (Math.min(...pair) + 0.05);
        }""",
        selector,
    )


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--browser", required=True)
    parser.add_argument("--screenshots", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    site = arguments.folder.resolve()
    pages = [site / "index.html", *sorted((site / "guide").glob("*.html"))]
    pages = [page for page in pages if page.name != "toc.html"]
    arguments.screenshots.mkdir(parents=True, exist_ok=True)
    faults, visits = [], 0
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=arguments.browser, args=["--no-sandbox"])
        for path in pages:
            name = path.relative_to(site).as_posix()
            for size, scheme in (("wide", "light"), ("narrow", "dark"), ("wide", "dark"), ("narrow", "light")):
                if name not in KEPT and (size, scheme) not in (("wide", "light"), ("narrow", "dark")):
                    continue
                context, page, found = visit(browser, path, size, scheme)
                faults += found
                visits += 1
                if name in KEPT:
                    picture = name.replace("/", "-").removesuffix(".html")
                    page.screenshot(path=arguments.screenshots / f"{picture}-{size}-{scheme}.png")
                    for selector in ("main p", "main a", "main pre code", "main td"):
                        if page.query_selector(selector) and ratio(page, selector) < 4.5:
                            faults.append(
                                f"{name}, {scheme}: the text of `{selector}` has a contrast of "
                                f"{ratio(page, selector):.1f}"
                            )
                context.close()
        # The search must work from the file system, too.
        context, page, _ = visit(browser, site / "guide" / "index.html", "wide", "light")
        page.keyboard.press("s")
        page.keyboard.type("homography")
        page.wait_for_selector("#mdbook-searchresults li, #searchresults li", timeout=10_000)
        context.close()
        browser.close()
    assert not faults, "\n".join(faults)
    print(
        f"{len(pages)} pages checked in {visits} visits, light and dark, wide and narrow; "
        f"screenshots in {arguments.screenshots}"
    )


if __name__ == "__main__":
    main()

"""Opens every page of the guide in a browser: no request, error, warning or sideways scrolling; readable colours.

    check_site.py FOLDER --browser /path/to/chromium --screenshots FOLDER

FOLDER is the output of `cargo xtask docs`. Pages are opened from the file system, light and dark, wide and narrow;
screenshots of some are kept.
"""

import argparse
import pathlib

from playwright.sync_api import sync_playwright

SIZES = {"wide": {"width": 1280, "height": 900}, "narrow": {"width": 390, "height": 844}}
KEPT = ["index.html"] + [
    f"guide/{page}.html" for page in ("index", "python", "program", "results", "extending", "troubleshooting")
]
CONTRAST = (pathlib.Path(__file__).parent / "contrast.js").read_text()


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
    faults.extend(f"contrast {fault}" for fault in page.evaluate(CONTRAST)["faults"])
    return context, page, [f"{path.name}, {size}, {scheme}: {fault}" for fault in faults]


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
    missing = sorted(set(KEPT) - {page.relative_to(site).as_posix() for page in pages})
    assert not missing, f"no pages {missing}"
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

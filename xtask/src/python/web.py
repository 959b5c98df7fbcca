"""Puts the page and the npm package of `cargo xtask web` together: web.py WORKSPACE VERSION.

The page is one file that holds everything it needs, the forecaster as gzip in base64.
"""

import base64
import gzip
import json
import pathlib
import sys

LARGEST = 3_000_000  # bytes of the page, compressed


def main():
    root, version = pathlib.Path(sys.argv[1]), sys.argv[2]
    sources, made = root / "crates/ddl-web", root / "target/web"
    module = (made / "npm/ddl_forecast_bg.wasm").read_bytes()
    parts = {
        "version": version,
        "glue.js": (root / "target/wasm/page/ddl_forecast.js").read_text(),
        "sample.csv": (root / "datasets/sample.csv").read_text(),
        "forecaster": base64.b64encode(gzip.compress(module, mtime=0)).decode(),
    }
    parts |= {name: (sources / "page" / name).read_text() for name in ("page.css", "page.js", "worker.js")}
    report = root / "crates/ddl-report/src"
    for style in ("page/style.css", "figure/figure.css", "figure/plot.css"):
        parts[pathlib.Path(style).name] = (report / style).read_text()
    text = (sources / "page/index.html").read_text()
    for name, part in parts.items():
        assert "</script" not in part, name
        text = text.replace("{{" + name + "}}", part)
    page = made / "index.html"
    page.write_text(text)
    package = json.loads((sources / "npm/package.json").read_text()) | {"version": version}
    (made / "npm/package.json").write_text(json.dumps(package, indent=2) + "\n")
    compressed = len(gzip.compress(text.encode(), mtime=0))
    print(f"{page}: {page.stat().st_size / 1e6:.2f} MB, compressed {compressed / 1e6:.2f} MB")
    size = sum(file.stat().st_size for file in (made / "npm").iterdir())
    print(f"{made / 'npm'}: {size / 1e6:.2f} MB, its module compressed {len(gzip.compress(module)) / 1e6:.2f} MB")
    assert compressed <= LARGEST, f"the page is larger than {LARGEST} bytes: find out what grew"


if __name__ == "__main__":
    main()

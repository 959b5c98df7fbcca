"""Copies members of the wheels in a folder: WHEELS TARGET FROM=TO...

A FROM that ends in a slash is a tree. Nothing in the wheels is executed.
"""

import pathlib
import shutil
import sys
import zipfile


def main(wheels, target, *rules):
    left = dict(rule.split("=") for rule in rules)
    for wheel in map(zipfile.ZipFile, sorted(pathlib.Path(wheels).glob("*.whl"))):
        for source in [source for source in left if any(name.startswith(source) for name in wheel.namelist())]:
            place = left.pop(source)
            for name in wheel.namelist():
                path = pathlib.Path(target, place + name[len(source) :])
                if name.startswith(source) and not name.endswith("/") and ".." not in path.parts:
                    path.parent.mkdir(parents=True, exist_ok=True)
                    with wheel.open(name) as member, open(path, "wb") as file:
                        shutil.copyfileobj(member, file, 1 << 20)
    if left:
        sys.exit(f"the wheels in {wheels} have no {next(iter(left))}")


try:
    main(*sys.argv[1:])
except (OSError, zipfile.BadZipFile) as error:
    sys.exit(f"{error}".replace("\n", " "))

"""Copies chosen members of a zip archive: ARCHIVE FOLDER FROM=TO...

A FROM that ends in a slash is a whole tree. Nothing in the archive is executed, and names in the archive cannot
place a file outside TO.
"""

import pathlib
import shutil
import sys
import zipfile


def main(archive, folder, *rules):
    root = pathlib.Path(folder)
    with zipfile.ZipFile(archive) as wheel:
        names = [name for name in wheel.namelist() if not name.endswith("/")]
        for rule in rules:
            source, _, target = rule.partition("=")
            if source.endswith("/"):
                chosen = [(name, target + name[len(source) :]) for name in names if name.startswith(source)]
            else:
                chosen = [(name, target) for name in names if name == source]
            if not chosen:
                sys.exit(f"{archive} has no {source}")
            for name, place in chosen:
                if ".." in pathlib.PurePosixPath(place).parts:
                    sys.exit(f"{archive} has a member outside its tree: {name}")
                path = root / place
                path.parent.mkdir(parents=True, exist_ok=True)
                with wheel.open(name) as member, open(path, "wb") as file:
                    shutil.copyfileobj(member, file, 1 << 20)


try:
    main(*sys.argv[1:])
except (OSError, zipfile.BadZipFile) as error:
    sys.exit(f"{error}".replace("\n", " "))

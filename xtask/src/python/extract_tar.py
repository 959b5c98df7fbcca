"""Copies chosen members of a tar archive: ARCHIVE FOLDER MEMBER=NAME...

Nothing in the archive is executed, and every file gets the NAME given by the caller.
"""

import pathlib
import shutil
import sys
import tarfile


def main(archive, folder, *rules):
    wanted = dict(rule.rpartition("=")[::2] for rule in rules)
    with tarfile.open(archive) as tar:
        for member in tar:
            if member.isfile() and member.name in wanted:
                path = pathlib.Path(folder) / wanted.pop(member.name)
                with tar.extractfile(member) as source, open(path, "wb") as file:
                    shutil.copyfileobj(source, file, 1 << 20)
    if wanted:
        sys.exit(f"{archive} has no {next(iter(wanted))}")


try:
    main(*sys.argv[1:])
except (OSError, tarfile.TarError, EOFError) as error:
    sys.exit(f"{error}".replace("\n", " "))

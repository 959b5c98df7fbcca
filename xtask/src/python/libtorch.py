"""Unpacks libtorch from pinned wheels into FOLDER, completely or not at all: FOLDER REQUIREMENTS [WHEELS].

pip checks the SHA-256 sums of REQUIREMENTS. Nothing in the wheels is executed.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile

# The wheels for one Python: the libraries in them do not depend on it, so any Python 3 can fetch them.
PIP = (
    "download --no-deps --require-hashes --only-binary=:all: --no-cache-dir --disable-pip-version-check --quiet "
    "--timeout 60 --retries 3 --implementation cp --python-version 3.11 --platform manylinux_2_28_x86_64 "
    "--platform manylinux_2_25_x86_64 --platform manylinux_2_17_x86_64 --platform manylinux2014_x86_64"
)
# What is used from the wheels; a name that ends in a slash is a tree.
MEMBERS = {
    "torch/include/": "include/",
    "torch/lib/libtorch_cpu.so": "lib/libtorch_cpu.so",
    "torch/lib/libc10.so": "lib/libc10.so",
    "torch/lib/libgomp.so.1": "lib/libgomp.so.1",
    "nvidia/cu13/lib/libcudart.so.13": "lib/libcudart.so.13",
    "nvidia/cu13/lib/libcupti.so.13": "lib/libcupti.so.13",
    "torch-2.11.0.dist-info/licenses/": "licenses/torch/",
    "nvidia_cuda_runtime-13.0.96.dist-info/licenses/": "licenses/cuda-runtime/",
    "nvidia_cuda_cupti-13.0.85.dist-info/licenses/": "licenses/cuda-cupti/",
}
# Bytes of the wheels and of the unpacked libraries (495 MB measured), with a margin.
NEEDED = 543_563_777 + 560_000_000


def unpack(wheels, target):
    left = dict(MEMBERS)
    for wheel in map(zipfile.ZipFile, sorted(wheels.glob("*.whl"))):
        for source in [source for source in left if any(name.startswith(source) for name in wheel.namelist())]:
            place = left.pop(source)
            for name in wheel.namelist():
                path = target / (place + name[len(source) :])
                if name.startswith(source) and not name.endswith("/") and ".." not in path.parts:
                    path.parent.mkdir(parents=True, exist_ok=True)
                    with wheel.open(name) as member, open(path, "wb") as file:
                        shutil.copyfileobj(member, file, 1 << 20)
    if left:
        sys.exit(f"the wheels have no {next(iter(left))}")


def main(folder, requirements, given=None):
    folder = pathlib.Path(folder)
    folder.parent.mkdir(parents=True, exist_ok=True)
    free = shutil.disk_usage(folder.parent).free
    if free < NEEDED:
        sys.exit(
            f"{folder.parent} has {free // 10**6} MB free and {NEEDED // 10**6} MB are needed: make room, or choose "
            "another disk with `cargo xtask setup --cache DIR`"
        )
    with tempfile.TemporaryDirectory(prefix=".incoming-", dir=folder.parent) as work:
        work = pathlib.Path(work)
        work.chmod(0o755)
        wheels, made, pins = work / "wheels", work / "libtorch", work / "pins.txt"
        pins.write_text(requirements)
        local = ["--no-index", "--find-links", given] if given else []
        pip = [sys.executable, "-m", "pip", *PIP.split(), "--dest", wheels, "--requirement", pins, *local]
        # Standard output may be evaluated by a shell.
        if subprocess.run(pip, stdout=sys.stderr, check=False).returncode:
            sys.exit(
                f"{given} must hold the pinned wheels that docs/libtorch.md lists"
                if given
                else "pip could not download the wheels: connect to a package index, or give the wheels with `cargo "
                "xtask setup --wheel-dir DIR`, or an installed libtorch with LIBTORCH=DIR (docs/libtorch.md)"
            )
        unpack(wheels, made)
        # The binding links `torch`, which in the wheel is a shim that also needs the CUDA libraries.
        (made / "lib/libtorch.so").symlink_to("libtorch_cpu.so")
        # With this file the binding's build script compares the versions itself.
        version = re.search(r"^torch==(\S+)", requirements, re.MULTILINE)[1]
        (made / "build-version").write_text(version + "\n")
        # Written last: a folder without it is unfinished.
        (made / ".complete").write_text(requirements)
        if folder.exists():
            os.rename(folder, work / "replaced")
        os.rename(made, folder)


try:
    main(*sys.argv[1:])
except (OSError, zipfile.BadZipFile) as error:
    sys.exit(f"{error}".replace("\n", " "))

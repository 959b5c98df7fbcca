"""Brings pinned files into a folder: JSON with `sources`, `files` and `folder`, as in datasets/manifest.toml.

Every file must have its size and its SHA-256. Nothing in an archive is executed. Prints the name of the source that had
the last file; a failure prints one line.
"""

import base64
import hashlib
import html.parser
import io
import json
import pathlib
import ssl
import sys
import tarfile
import urllib.parse
import urllib.request


def opened(address, authorities=None):
    """Opens an address; user name and password move to a header, as urllib requires."""
    parts = urllib.parse.urlsplit(address)
    host = parts.netloc.rpartition("@")[2]
    request = urllib.request.Request(urllib.parse.urlunsplit(parts._replace(netloc=host)))
    request.add_header("Accept", "text/html, */*")
    if parts.username is not None:
        login = f"{urllib.parse.unquote(parts.username)}:{urllib.parse.unquote(parts.password or '')}"
        request.add_header("Authorization", "Basic " + base64.b64encode(login.encode()).decode())
    return urllib.request.urlopen(request, timeout=10, context=ssl.create_default_context(cafile=authorities))


def right(name, data, pin):
    if len(data) != pin["bytes"]:
        raise ValueError(f"{name}: {len(data)} bytes instead of {pin['bytes']}")
    if hashlib.sha256(data).hexdigest() != pin["sha256"]:
        raise ValueError(f"{name}: wrong contents: the SHA-256 is not the pinned one")
    return data


def is_right(path, pin):
    try:
        return bool(right(path.name, path.read_bytes(), pin))
    except (OSError, ValueError):
        return False


class Links(html.parser.HTMLParser):
    """The addresses of a simple index page."""

    def __init__(self, page):
        super().__init__()
        self.addresses = []
        self.feed(page)

    def handle_starttag(self, tag, attributes):
        self.addresses += [value for name, value in attributes if name == "href" and value]


def archive(source):
    """The archive of a package from pip's index. pip itself would run the archive's set-up to read its metadata."""
    from pip._internal.commands import create_command

    options, _ = create_command("download").parse_args([])
    if options.no_index:
        raise ValueError("pip is configured with no-index")
    complaint = "not listed"
    for index in [options.index_url, *options.extra_index_urls]:
        try:
            with opened(f"{index.rstrip('/')}/{source['package']}/", options.cert) as response:
                base, page = response.geturl(), response.read().decode("utf-8", "replace")
        except OSError as error:  # the next index may have it
            complaint = str(getattr(error, "reason", None) or error)
            continue
        for link in Links(page).addresses:
            address = urllib.parse.urldefrag(urllib.parse.urljoin(base, link)).url
            if urllib.parse.unquote(address.rpartition("/")[2]) == source["archive"]:
                with opened(address, options.cert) as response:
                    return right(source["archive"], response.read(source["bytes"] + 1), source)
    raise ValueError(f"{source['archive']} on pip's package index: {complaint}")


def fetch(source, files, folder):
    tar = tarfile.open(fileobj=io.BytesIO(archive(source))) if source["kind"] == "package" else None
    for file in files:
        if tar:
            data = tar.extractfile(source["member"].replace("{path}", file["path"])).read()
        else:
            with opened(source["address"].replace("{path}", file["path"])) as response:
                data = response.read(file["bytes"] + 1)
        right(file["name"], data, file)
        # Renamed into place when it is whole.
        work = folder / f".incoming-{file['name']}"
        work.write_bytes(data)
        work.replace(folder / file["name"])


def main(sources, files, folder):
    folder, name, reasons = pathlib.Path(folder), "an earlier run", []
    for source in sources:
        missing = [file for file in files if not is_right(folder / file["name"], file)]
        if not missing:
            break
        name = source["name"]
        try:
            fetch(source, missing, folder)
        except (OSError, KeyError, ValueError, tarfile.TarError) as error:
            reasons.append(f"{name}: {getattr(error, 'reason', None) or error}".replace("\n", " "))
    if all(is_right(folder / file["name"], file) for file in files):
        print(name)
    else:
        sys.exit("; ".join(reasons))


main(**json.loads(sys.argv[1]))

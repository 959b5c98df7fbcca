"""Finds a file on the package index like pip: PACKAGE FILE.

Prints JSON: the file's address and pip's certificate bundle. The index is the one that pip would use, from its
options, configuration files and environment.
"""

import html.parser
import json
import ssl
import sys
import urllib.parse
import urllib.request

from pip._internal.models.index import PyPI


class Links(html.parser.HTMLParser):
    """Collects the addresses of a simple index page."""

    def __init__(self):
        super().__init__()
        self.found = []

    def handle_starttag(self, tag, attributes):
        if tag == "a":
            self.found.extend(value for name, value in attributes if name == "href" and value)


def configuration():
    """Index addresses and certificate bundle of pip, with pip's defaults if pip's internal interface has changed."""
    try:
        from pip._internal.commands import create_command

        options, _ = create_command("download").parse_args([])
        if options.no_index:
            sys.exit("pip is configured with no-index")
        return [options.index_url, *options.extra_index_urls], options.cert
    except (ImportError, AttributeError):
        return [PyPI.simple_url], None


def main(package, name):
    indexes, authorities = configuration()
    context = ssl.create_default_context(cafile=authorities)
    complaints = []
    for index in indexes:
        page = f"{index.rstrip('/')}/{package}/"
        request = urllib.request.Request(page, headers={"Accept": "text/html"})
        try:
            with urllib.request.urlopen(request, timeout=10, context=context) as response:
                base, text = response.geturl(), response.read().decode("utf-8", "replace")
        except Exception as error:  # the next index may have it
            complaints.append(f"{getattr(error, 'reason', None) or error}")
            continue
        links = Links()
        links.feed(text)
        for link in links.found:
            address = urllib.parse.urldefrag(urllib.parse.urljoin(base, link)).url
            if urllib.parse.unquote(address.rpartition("/")[2]) == name:
                print(json.dumps({"address": address, "authorities": authorities or ""}))
                return
        complaints.append(f"{name} is not listed")
    sys.exit("; ".join(complaints).replace("\n", " "))


main(*sys.argv[1:])

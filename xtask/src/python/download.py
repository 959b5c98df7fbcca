"""Streams the bytes of one address to standard output: ADDRESS TIMEOUT_SECONDS [CA_FILE].

The caller checks length and hash. A failure prints one line to standard error.
"""

import base64
import ssl
import sys
import urllib.parse
import urllib.request


def request_for(address):
    """Moves user name and password of the address to a header, as urllib requires."""
    parts = urllib.parse.urlsplit(address)
    host = parts.netloc.rpartition("@")[2]
    request = urllib.request.Request(urllib.parse.urlunsplit(parts._replace(netloc=host)))
    if parts.username is not None:
        login = f"{urllib.parse.unquote(parts.username)}:{urllib.parse.unquote(parts.password or '')}"
        request.add_header("Authorization", "Basic " + base64.b64encode(login.encode()).decode())
    return request


def main(address, timeout, authorities=None):
    context = ssl.create_default_context(cafile=authorities or None)
    try:
        with urllib.request.urlopen(request_for(address), timeout=float(timeout), context=context) as response:
            while True:
                block = response.read(1 << 16)
                if not block:
                    break
                sys.stdout.buffer.write(block)
        sys.stdout.buffer.flush()
    except Exception as error:  # the caller needs any error in one line
        reason = getattr(error, "reason", None) or error
        host = urllib.parse.urlsplit(address).hostname or address
        sys.exit(f"{host}: {getattr(reason, 'strerror', None) or reason}".replace("\n", " "))


main(*sys.argv[1:])

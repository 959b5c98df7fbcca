"""The program ``ddl``: ``python -m ddl_forecast`` and the console script ``ddl``."""

import signal
import sys

from ddl_forecast import _core


def main() -> int:
    """Run the program with the arguments of this process and return its exit code."""
    # The program handles Ctrl-C itself, and ends without a message when its output is closed.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _core.main(["ddl", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())

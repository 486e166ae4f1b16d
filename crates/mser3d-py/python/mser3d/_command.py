"""The command ``mser3d``, as in the program that is built without Python."""

import signal
import sys

from . import _native


def main() -> int:
    """Runs the command with the arguments of this process and returns its exit code."""
    # Ctrl-C is the command's own business: it cleans up, and ends within a second.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _native.main(["mser3d", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())

"""The command line of the project: ``python -m limpid zwidth`` is ``cargo sim zwidth``."""

from __future__ import annotations

import signal
import sys

from . import _limpid

# No code of Python runs during a command that could see Python's own handler.
signal.signal(signal.SIGINT, signal.SIG_DFL)
sys.exit(_limpid.command(["host-sim", *sys.argv[1:]]))

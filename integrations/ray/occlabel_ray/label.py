"""Labelling one scene: what a worker runs."""

import ctypes
import signal
import subprocess
from dataclasses import dataclass
from enum import Enum

COMPLETE, USAGE, DEGRADED = 0, 2, 3
"""Exit codes of the program."""

PR_SET_PDEATHSIG = 1
"""See prctl(2)."""

PRCTL = getattr(ctypes.CDLL(None), "prctl", None)
"""Looked up here: between fork and exec, little may be done safely."""

LAST_CHARACTERS = 2000
"""How much of what the program said is kept."""


class Ending(Enum):
    """How a try ended."""

    COMPLETE = "complete"
    DEGRADED = "degraded"
    """Labelled, but something was left out; the run's report lists it."""
    FAILED = "failed"
    REFUSED = "refused"
    """By the command line or the configuration: no scene would do better."""


@dataclass(frozen=True)
class Try:
    """What came of labelling a scene once."""

    ending: Ending
    told: str = ""
    """What the program said at last."""


@dataclass(frozen=True)
class Line:
    """What every scene of a run is labelled with."""

    program: str
    flags: list[str]
    """Of `occlabel label`."""
    folder: str
    """Where relative paths begin."""
    timeout_s: float | None = None
    """After which a try has failed."""


def label(line: Line, shard: str) -> Try:
    """Labels a shard in a process that does not outlive this one.

    Whatever ends it, nothing is half-written: a second try goes on where the first one ended.
    """
    command = [line.program, "label", *line.flags, "--shard", shard, "--progress", "none"]
    try:
        ended = subprocess.run(
            command,
            cwd=line.folder,
            timeout=line.timeout_s,
            preexec_fn=die_with_parent,
            capture_output=True,
            text=True,
        )
    except subprocess.TimeoutExpired:
        return Try(Ending.FAILED, f"not done after {line.timeout_s} s")
    return Try(ending_of(ended.returncode), ended.stderr[-LAST_CHARACTERS:].strip())


def ending_of(code: int) -> Ending:
    """What an exit code says; a negative one is a signal's."""
    endings = {COMPLETE: Ending.COMPLETE, DEGRADED: Ending.DEGRADED, USAGE: Ending.REFUSED}
    return endings.get(code, Ending.FAILED)


def die_with_parent() -> None:
    """Has Linux kill this process when the one that started it is gone; elsewhere, does nothing."""
    if PRCTL is not None:
        PRCTL(PR_SET_PDEATHSIG, signal.SIGKILL)

"""Where scenes are labelled, one at a time: a process on a node."""

import os
import socket
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import astuple, dataclass

from occlabel_ray.label import Line, label
from occlabel_ray.plan import Refused

LOOK_S = 60.0
"""How long the program may take to say its version."""


@dataclass(frozen=True)
class Needs:
    """What a place has to have."""

    version: str
    """Of the program."""
    mark: str | None
    """A file in the output folder; none if the output is a store, which has one address."""


class Place:
    """Labels, on a node, what it is given."""

    def __init__(self, line: Line, needs: Needs) -> None:
        """Nothing is looked at yet."""
        self.line, self.needs = line, needs

    def fault(self) -> str:
        """What is amiss here; empty if nothing is."""
        fault = fault_of(self.line, self.needs)
        return fault and f"{socket.gethostname()}: {fault}"

    def label(self, shard: str) -> tuple:
        """A try, as its fields."""
        return astuple(label(self.line, shard))


def fault_of(line: Line, needs: Needs) -> str:
    """What of the needs is not met on this machine."""
    if not os.path.isdir(line.folder):
        return f"there is no folder {line.folder}, where the run was begun"
    if needs.mark is not None and not os.path.exists(needs.mark):
        return f"{os.path.dirname(needs.mark)} is not the folder that the driver has: share it"
    try:
        version = version_of(line)
    except (OSError, subprocess.SubprocessError) as error:
        return f"{line.program} cannot be started: {error}"
    if version != needs.version:
        return f"{line.program} is {version}, the driver's is {needs.version}"
    return ""


def version_of(line: Line) -> str:
    """What the program says that it is."""
    said = subprocess.run(
        [line.program, "--version"],
        cwd=line.folder,
        capture_output=True,
        text=True,
        timeout=LOOK_S,
        check=True,
    )
    return said.stdout.strip()


@contextmanager
def needs_of(line: Line, output: str) -> Iterator[Needs]:
    """What places have to have that write to an output; its folder is made."""
    try:
        version = version_of(line)
        mark = None if "://" in output else make_mark(os.path.join(line.folder, output))
    except (OSError, subprocess.SubprocessError) as error:
        raise Refused(f"error: {error}") from error
    try:
        yield Needs(version, mark)
    finally:
        if mark is not None:
            os.unlink(mark)


def make_mark(folder: str) -> str:
    """A file that whoever shares a folder finds in it."""
    os.makedirs(folder, exist_ok=True)
    number, mark = tempfile.mkstemp(dir=folder, prefix=".occlabel-ray-")
    os.close(number)
    return mark

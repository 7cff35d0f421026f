"""Samples how much disk the temporary files of running programs take, also of files without a name."""

import os
import pathlib
import threading

INTERVAL_S = 0.5
# The unit of st_blocks.
BLOCK_BYTES = 512


class Sampler:
    """While this context is open, `peak` is the most bytes that a folder held at a sample."""

    def __init__(self, folder, processes):
        self.folder, self.processes = pathlib.Path(folder).resolve(), processes
        self.peak = 0
        self.done = threading.Event()
        self.thread = threading.Thread(target=self.sample, daemon=True)

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *failure):
        self.done.set()
        self.thread.join()

    def sample(self):
        is_done = False
        while not is_done:
            is_done = self.done.wait(INTERVAL_S)
            self.peak = max(self.peak, used(self.folder, self.processes))


def used(folder, processes):
    """Bytes of all files in `folder`, and of those that processes, given by number, hold open there. A file
    without a name is only found among the open ones."""
    opened = (path for process in processes for path in entries(f"/proc/{process}/fd") if is_in(folder, path))
    found = {}
    for path in [*entries(folder), *opened]:
        try:
            facts = os.stat(path)
        except OSError:
            # Gone since it was listed.
            continue
        found[facts.st_dev, facts.st_ino] = facts.st_blocks * BLOCK_BYTES
    return sum(found.values())


def is_in(folder, link):
    try:
        return pathlib.Path(os.readlink(link)).is_relative_to(folder)
    except OSError:
        return False


def entries(folder):
    """The files right in a folder; none if it is gone, or is of a process that has ended."""
    try:
        return [entry.path for entry in os.scandir(folder) if not entry.is_dir(follow_symlinks=False)]
    except OSError:
        return []

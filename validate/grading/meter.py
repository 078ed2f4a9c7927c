"""The time of a worker: on the processor, asleep or waiting for a disk.  Waiting for the processor is free.

Busy neighbours therefore cost nothing.  Without /proc, all time counts that passes while we wait for the worker.
"""

import time
from pathlib import Path

WAKE = 1e-3                  # longest time that a message takes to wake the other process [s]
LOOK = 0.05                  # so often we look how a worker is that has not answered [s]
MOST = 4.0 * LOOK            # most sleep counted per look, because this process may have waited for the processor [s]


class Meter:
    """Counts the seconds of one worker after the other."""

    def __init__(self):
        self.used, self.slept, self.process, self.looked, self.worked = 0.0, 0.0, None, time.monotonic(), 0.0
        self.messages, self.ours = 0, time.thread_time()

    def follow(self, process):
        """Count from now on the worker that this process has started, which has just reported that it is ready."""
        self.process, self.looked = worker_of(process), time.monotonic()
        self.worked, self.ours = self.processor(), time.thread_time()

    def look(self, owes):
        """Count what has passed since the last look.  owes: it is the worker's turn.

        A worker does not sleep while this process computes its answer, nor while a message wakes one of them.
        """
        now, worked, ours = time.monotonic(), self.processor(), time.thread_time()
        passed, busy = min(now - self.looked, MOST), max(0.0, worked - self.worked)
        awake = busy + ours - self.ours + WAKE * self.messages
        self.looked, self.worked, self.ours, self.messages = now, worked, ours, 0
        self.used += busy
        if owes and self.sleeps():
            self.sleep(max(0.0, passed - awake))

    def sleep(self, seconds):
        """Count seconds in which the worker neither computed nor waited for the processor."""
        self.used, self.slept = self.used + seconds, self.slept + seconds

    def due(self):
        """Return whether it is time for another look."""
        return time.monotonic() - self.looked >= LOOK

    def processor(self):
        """Return seconds that all threads of the worker have had the processor."""
        try:
            return time.clock_gettime(~self.process << 3 | 2)          # clock_getcpuclockid(3) of another process
        except (AttributeError, OSError, TypeError):                   # no such clock, or it has ended
            return self.worked

    def sleeps(self):
        """Return whether it neither runs nor waits for the processor."""
        try:
            return Path(f"/proc/{self.process}/stat").read_text().rpartition(")")[2].split()[0] != "R"
        except OSError:
            return True


def worker_of(process):
    """Return its number: the last in a chain of only children, since bwrap's own processes come before it."""
    number = process.pid
    try:
        while children := Path(f"/proc/{number}/task/{number}/children").read_text().split():
            number = int(children[0])
    except OSError:
        pass
    return number

"""The pipes of a worker: frames to and from it, and what it prints.  Nothing here waits longer than it is told to."""

import contextlib
import os
import select
import time
from collections import deque

from . import wire

CHUNK = 1 << 18              # most bytes that are read at a time
LONGEST = wire.HEADER.size + wire.MAX_TREE + wire.MAX_ARRAYS       # of a frame [bytes]


class Ended(Exception):
    """The worker has closed the pipe."""


class Line:
    """The pipes of one worker process, read and written by this thread alone.

    heard(chunk) takes what the worker prints, and noted(chunk) what it writes into the pipe of notes.
    """

    def __init__(self, process, heard, notes, noted):
        self.to_it, self.from_it = process.stdin.fileno(), process.stdout.fileno()
        self.others = {process.stderr.fileno(): heard, notes.fileno(): noted}
        self.waiting, self.arrived = deque(), bytearray()        # memoryviews that are not written yet; bytes not taken
        self.poller, self.open = select.poll(), set()
        for number in (self.to_it, self.from_it, *self.others):
            os.set_blocking(number, False)
        for number in (self.from_it, *self.others):
            self.poller.register(number, select.POLLIN)
            self.open.add(number)

    def send(self, frame):
        """Write as much as the pipe takes now; `pump` writes the rest."""
        self.waiting.append(memoryview(frame))
        if len(self.waiting) == 1:
            self.write()

    def write(self):
        try:
            while self.waiting:
                first = self.waiting[0]
                rest = first[os.write(self.to_it, first):]
                if rest:
                    self.waiting[0] = rest
                else:
                    self.waiting.popleft()
        except BlockingIOError:
            self.poller.register(self.to_it, select.POLLOUT)
            return
        except OSError:                                          # it has ended: the next frame of it will tell
            self.waiting.clear()
        with contextlib.suppress(KeyError):
            self.poller.unregister(self.to_it)

    def pump(self, seconds):
        """Read and write what is possible, as soon as something is, but wait no longer than this.

        Raises WireError if more arrives than a frame can be long, and no one takes it.
        """
        if len(self.arrived) > LONGEST:
            raise wire.WireError("more than anyone asked for")
        for number, _ in self.poller.poll(1000.0 * seconds):
            if number == self.to_it:
                self.write()
            elif number == self.from_it:
                self.arrived += self.chunk(number)
            else:
                self.others[number](self.chunk(number))

    def chunk(self, number):
        """Read what has arrived in a pipe; nothing is left to wait for at its end."""
        try:
            chunk = os.read(number, CHUNK)
        except BlockingIOError:
            return b""
        except OSError:
            chunk = b""
        if not chunk and number in self.open:
            self.open.discard(number)
            self.poller.unregister(number)
        return chunk

    def frame(self):
        """Return the next (tree, arrays) as bytes, or None if it has not arrived.

        Raises Ended at the end, and WireError for what is no frame.
        """
        if len(self.arrived) >= wire.HEADER.size:
            tree, arrays = wire.sizes(self.arrived[:wire.HEADER.size])
            end = wire.HEADER.size + tree + arrays
            if len(self.arrived) >= end:
                head = bytes(self.arrived[wire.HEADER.size:end - arrays])
                body = bytes(self.arrived[end - arrays:end])
                del self.arrived[:end]
                return head, body
        if self.from_it not in self.open:
            if self.arrived:
                raise wire.WireError("a frame broke off")
            raise Ended
        return None

    def drain(self, seconds):
        """Take what still arrives until the worker's end; return whether it came in this time."""
        until = time.monotonic() + seconds
        self.waiting.clear()
        while self.open and (left := until - time.monotonic()) > 0.0:
            self.arrived.clear()
            self.pump(left)
        return not self.open

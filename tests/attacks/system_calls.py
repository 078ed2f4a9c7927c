"""What the kernel would do for any program.

Memory that is not counted, and things that two sandboxes have in common.
"""

import ctypes
import re
from contextlib import suppress
from pathlib import Path

from . import attack, looks


def numbers_of_calls(names):
    """{name: number} of the system calls among these names, from the library that has made the filter.

    They differ between machines.  A sandbox may lack the library, and without it there is no sandbox at all.
    """
    found = {}
    with suppress(OSError):
        library = ctypes.CDLL("libseccomp.so.2")
        found = {name: library.seccomp_syscall_resolve_name(name.encode()) for name in sorted(names)}
    return {name: number for name, number in found.items() if number >= 0}


CALL = f"""
import ctypes, errno, os
library = ctypes.CDLL(None, use_errno=True)
numbers = {numbers_of_calls(set(re.findall(r'"([a-z_0-9]+)"', Path(__file__).read_text())))}
def call(name, *arguments):
    return library.syscall(ctypes.c_long(numbers.get(name, -1)), *map(ctypes.c_long, arguments))
"""

KILLED = {
    "a key in the session's keyring": (
        "the next worker reads the hidden inputs there",
        'text = ctypes.c_char_p(b"user")\n'
        'print("FOUND", call("add_key", ctypes.cast(text, ctypes.c_void_p).value, '
        'ctypes.cast(text, ctypes.c_void_p).value, ctypes.cast(text, ctypes.c_void_p).value, 4, -3))',
    ),
    "a new keyring": ("a ring that is shared by name", 'print("FOUND", call("keyctl", 1, 0))'),
    "a key that is asked for": ("as above", 'print("FOUND", call("request_key", 0, 0, 0, -3))'),
    "shared memory": ("gigabytes that no limit counts", 'print("FOUND", call("shmget", 0, 5 << 30, 0o1600))'),
    "a message queue": ("as above", 'print("FOUND", call("msgget", 0, 0o1600))'),
    "semaphores": ("as above", 'print("FOUND", call("semget", 0, 250, 0o1600))'),
    "io_uring": (
        "calls that no filter sees",
        'print("FOUND", call("io_uring_setup", 8, ctypes.addressof(ctypes.create_string_buffer(120))))',
    ),
    "a program for the kernel": ("the kernel itself", 'print("FOUND", call("bpf", 0, 0, 0))'),
    "counters of the processor": (
        "what the neighbour does",
        'print("FOUND", call("perf_event_open", 0, 0, -1, -1, 0))',
    ),
    "tracing": (
        "the expected values in the parent's memory",
        'print("FOUND", library.ptrace(16, os.getppid(), None, None))',
    ),
    "a new namespace": ("to be root, and mount", 'print("FOUND", library.unshare(0x10000000))'),
    "a mount": ("a place to write", 'print("FOUND", library.mount(b"none", b"/tmp", b"tmpfs", 0, None))'),
    "another user": ("its limits", 'print("FOUND", library.setuid(1))'),
}
for name, (gain, text) in KILLED.items():
    attack(name, gain, CALL + text, lost=True, shows=("FOUND",))

looks("processes", CALL + """
# each has its own limit of memory, and lives on
for name, make in {
    "fork": os.fork,
    "forkpty": lambda: os.forkpty()[0],
    "spawn": lambda: os.posix_spawn("/bin/true", ["true"], {}),
    "clone": lambda: call("clone", 17, 0, 0, 0, 0),
    "clone without its own memory": lambda: call("clone", 0x4111, 0, 0, 0, 0),
    "clone3": lambda: call("clone3", 0, 88),
    "vfork": lambda: call("vfork"),
}.items():
    try:
        if make() == 0:
            os._exit(0)
        if ctypes.get_errno() != errno.ENOSYS:
            print("FOUND", name, ctypes.get_errno())
    except OSError:
        pass
""")
looks("memory beside the address space", CALL + """
import fcntl, socket, sys
sent = sys.modules["__main__"].outgoing.fileno()
for name, make in {
    "memfd": lambda: os.memfd_create("x"),
    "sockets": socket.socketpair,
    "a pipe": os.pipe,
    "a larger pipe": lambda: fcntl.fcntl(sent, 1031, 1 << 20),
    "pages of a pipe": lambda: os.splice(os.open(os.__file__, os.O_RDONLY), sent, 1),
}.items():
    try:
        print("FOUND", name, make())
    except (OSError, AttributeError):
        pass
for name in (
    "memfd_secret", "mq_open", "vmsplice", "tee", "timer_create",
    "epoll_create1", "eventfd2", "signalfd4", "remap_file_pages",
):
    if call(name, 0, 0, 0, 0) != -1 or ctypes.get_errno() != errno.ENOSYS:
        print("FOUND", name, ctypes.get_errno())
""")
looks("signals through a file that another sandbox sees, too", CALL + """
import fcntl, struct
file, folder = os.open(os.__file__, os.O_RDONLY), os.open(os.path.dirname(os.__file__), os.O_RDONLY)
for name, ask in {
    "flock": lambda: fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB),
    "a lock": lambda: fcntl.lockf(file, fcntl.LOCK_SH | fcntl.LOCK_NB),
    "a lock of the open file": lambda: fcntl.fcntl(file, 37, struct.pack("hhqqi4x", 0, 0, 0, 0, 0)),
    "whether there is a lock": lambda: fcntl.fcntl(file, 36, bytes(32)),
    "a lease": lambda: fcntl.fcntl(file, 1024, 0),
    "a watch on a folder": lambda: fcntl.fcntl(folder, 1026, 1),
    "a hint": lambda: fcntl.fcntl(file, 1035, bytes(8)),
    "the space on the disk": lambda: os.fstatvfs(file),
    "what is in the cache": lambda: os.preadv(file, [bytearray(10)], 0, os.RWF_NOWAIT),
}.items():
    try:
        print("FOUND", name, ask())
    except OSError:
        pass
library.mmap.restype = ctypes.c_void_p
there = library.mmap(None, ctypes.c_size_t(4096), 1, 1, file, ctypes.c_long(0))
for name, *arguments in (
    ("inotify_init1", 0), ("fanotify_init", 0, 0),
    ("mincore", there, 4096, there), ("cachestat", file, 0, 0, 0), ("fadvise64", file, 0, 0, 4),
    ("futex", there, 1, 1), ("futex", there, 0, 0), ("futex", there, 3, 1, 1), ("futex_wake", there, 1, 1, 2),
    ("sysinfo", there),
):
    if call(name, *arguments) != -1 or ctypes.get_errno() not in (errno.ENOSYS, errno.EAGAIN):
        print("FOUND", name, arguments, ctypes.get_errno())
os.close(file), os.close(folder)
if os.path.isdir("/proc") and os.listdir("/proc"):
    print("FOUND the counters in /proc")
""")

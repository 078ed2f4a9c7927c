"""Filter of the system calls of a student's code: bubblewrap loads it, and the system's libseccomp compiles it.

Only the calls of Python and NumPy are allowed.  Every other call fails as if the kernel did not have it (ENOSYS), which
libraries can handle.  A program therefore has no second process, no socket, and no shared memory outside the limit on
the address space.  It makes no files, folders or pipes, which the kernel keeps in memory that no limit covers.  Two
sandboxes cannot signal each other by a lock, lease, watch or wake-up on a file that both can read, nor by the numbers
of pipes, which the kernel counts for all.  One descriptor stays what it is until the program ends: the worker's notes
for the instructor go there.  A call that only an attack makes ends the program.

libseccomp compiles for the machine it is on, and its programs end a process that calls through another architecture.
*Source:* seccomp_rule_add(3), seccomp_export_bpf(3); linux/fcntl.h, linux/futex.h, linux/sched.h.
"""

import ctypes
import errno
import os
from functools import lru_cache

LIBRARY = "libseccomp.so.2"
ALLOWED = """
    read readv pread64 preadv write writev lseek dup
    open openat stat fstat lstat newfstatat statx access faccessat faccessat2 readlink readlinkat
    getdents getdents64 getcwd chdir fchdir
    select pselect6 poll ppoll
    brk mmap munmap mremap mprotect madvise
    execve exit exit_group wait4 waitid kill tkill tgkill
    rt_sigaction rt_sigprocmask rt_sigreturn rt_sigpending rt_sigsuspend sigaltstack restart_syscall pause
    getpid gettid getppid getuid geteuid getgid getegid getgroups getresuid getresgid getpgrp getpgid getsid
    getrlimit setrlimit getrusage times uname getrandom getcpu sched_yield sched_getaffinity
    time gettimeofday clock_gettime clock_getres nanosleep clock_nanosleep alarm getitimer setitimer
    arch_prctl set_tid_address set_robust_list get_robust_list rseq
""".split()
NEVER = """
    add_key request_key keyctl
    shmget shmat shmctl shmdt semget semop semctl semtimedop msgget msgsnd msgrcv msgctl
    ptrace process_vm_readv process_vm_writev pidfd_getfd kcmp userfaultfd perf_event_open bpf
    io_uring_setup io_uring_enter io_uring_register
    mount umount2 pivot_root chroot unshare setns open_tree move_mount fsopen fsconfig fsmount fspick mount_setattr
    init_module finit_module delete_module kexec_load kexec_file_load
    setuid setgid setreuid setregid setresuid setresgid setgroups capset
""".split()
ARGUMENTS = {                # {call: (which argument, [values])}, all others are refused
    # F_DUPFD F_GETFD F_SETFD F_GETFL F_SETFL F_DUPFD_CLOEXEC: no locks, leases, hints
    "fcntl": (1, [0, 1, 2, 3, 4, 1030]),
    "prlimit64": (0, [0]),                            # its own limits only
    "ioctl": (1, [0x5401, 0x5413, 0x5451, 0x5450]),   # TCGETS TIOCGWINSZ FIOCLEX FIONCLEX
}
FLAGS = {                    # {call: (which argument, bit that must be set, what it gets without it)}
    "clone": (0, 0x10000, None),                      # CLONE_THREAD
    # FUTEX_PRIVATE_FLAG; a thread that waits for another's end then asks repeatedly
    "futex": (1, 0x80, errno.EAGAIN),
}
KEPT = 40                    # descriptor that no program closes or turns elsewhere
ALL_BUT = {"close": 0, "dup2": 1, "dup3": 1}          # {call: which argument may not be KEPT}
KILL, ALLOW = 0x80000000, 0x7FFF0000                  # SCMP_ACT_…
OTHER, EQUAL, MASKED = 1, 4, 7                        # SCMP_CMP_…


class Comparison(ctypes.Structure):
    """scmp_arg_cmp"""
    _fields_ = [("argument", ctypes.c_uint), ("how", ctypes.c_int), ("a", ctypes.c_uint64), ("b", ctypes.c_uint64)]


def refused(error):
    """Return SCMP_ACT_ERRNO."""
    return 0x00050000 | error


@lru_cache(maxsize=1)
def program():
    """Return the filter, as bytes that bwrap --seccomp reads.  Raises OSError where it cannot be had."""
    try:
        library = ctypes.CDLL(LIBRARY)
    except OSError:
        raise OSError(errno.ENOENT, f"{LIBRARY} is not installed (Debian: apt-get install libseccomp2)") from None
    library.seccomp_init.restype = ctypes.c_void_p
    context = ctypes.c_void_p(library.seccomp_init(ctypes.c_uint32(refused(errno.ENOSYS))))
    if not context:
        raise OSError(errno.ENOMEM, f"{LIBRARY} makes no filter")
    try:
        # SCMP_FLTATR_ACT_BADARCH: kill the process, not only the thread
        library.seccomp_attr_set(context, 2, ctypes.c_uint32(KILL))
        for name, action, comparison in rules():
            number = library.seccomp_syscall_resolve_name(name.encode())
            if number < 0:                                             # of another architecture or a newer library
                continue
            array = (Comparison * 1)(*filter(None, [comparison]))
            count = ctypes.c_uint(comparison is not None)
            code = library.seccomp_rule_add_array(context, ctypes.c_uint32(action), number, count, array)
            if code:
                raise OSError(-code, f"{LIBRARY} refuses a rule about {name}: {os.strerror(-code)}")
        return exported(library, context)
    finally:
        library.seccomp_release(context)


def rules():
    """Yield (name, action, comparison or None) of every call that is not simply refused."""
    for name in ALLOWED:
        yield name, ALLOW, None
    for name in NEVER:
        yield name, KILL, None
    for name, (argument, values) in ARGUMENTS.items():
        for value in values:
            yield name, ALLOW, Comparison(argument, EQUAL, value, 0)
    for name, argument in ALL_BUT.items():
        yield name, ALLOW, Comparison(argument, OTHER, KEPT, 0)
    for name, (argument, bit, otherwise) in FLAGS.items():
        yield name, ALLOW, Comparison(argument, MASKED, bit, bit)
        if otherwise:
            yield name, refused(otherwise), Comparison(argument, MASKED, bit, 0)


def exported(library, context):
    """Return the program of a context."""
    reader, writer = os.pipe()
    try:
        code = library.seccomp_export_bpf(context, writer)             # some kB: a pipe holds 64
        if code:
            raise OSError(-code, f"{LIBRARY} makes no program: {os.strerror(-code)}")
        os.close(writer)
        writer = None
        with os.fdopen(reader, "rb", closefd=False) as pipe:
            return pipe.read()
    finally:
        os.close(reader)
        if writer is not None:
            os.close(writer)

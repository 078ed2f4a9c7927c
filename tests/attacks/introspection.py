"""For the answers, the tests, the seed and the expected values."""

from . import attack, looks

STEAL = """
def found(text, where):
    print("FOUND", where)
    space = {}
    try:
        exec(text.replace("from .", "from solutions."), space)
    except Exception:
        pass
    globals().update({
        name: space[name]
        for name in ("euler_step", "midpoint_step", "implicit_euler_step", "amplification_matrix")
        if name in space
    })
"""

looks("import solutions", STEAL + """
# the worked answers of this lesson
for name in ("solutions.integrators", "solutions", "solutions.springs", "lessons.springs",
        "validate.subject.modules", "tests.test_integrators", "tests.mutants.integrators"):
    try:
        module = __import__(name, fromlist=["euler_step"])
        if hasattr(module, "euler_step") or not name.startswith(("solutions", "lessons")):
            print("FOUND", name)
            globals().update({n: getattr(module, n) for n in ("euler_step", "midpoint_step") if hasattr(module, n)})
    except Exception:
        pass
""")
looks("a walk through the file system", STEAL + """
# the worked answers, the tests, git's objects, the compiler's cache
import os, sys
for top in ("/work", "/home", "/root", "/opt", "/srv", "/autograder", "/tmp", "/var", "/mnt", "/given", "/box",
        "/student", "/etc", "/run", "/usr/src", "/usr/local"):
    for here, folders, names in os.walk(top):
        folders[:] = [f for f in folders if os.path.join(here, f) not in (sys.prefix, sys.base_prefix)]  # later
        if ".git" in folders or "objects" in folders and "refs" in folders:
            print("FOUND git in", here)
        for name in names:
            if (
                name in ("test_integrators.py", "answers.md", "seed.txt", "marking.py", "wire.py")
                and here not in ("/box", "/tmp")
                or name.endswith((".nbi", ".nbc"))
            ):
                print("FOUND", here, name)
            if name.endswith((".py", ".ipynb", ".txt")) and "site-packages" not in here and here != "/student":
                try:
                    text = open(os.path.join(here, name)).read()
                except (OSError, ValueError):
                    continue
                if "BEGIN SOLUTION" in text or "return x + dt * v, v + dt * acceleration(t, x, v, p)" in text:
                    found(text, os.path.join(here, name))
""")
looks("what is installed", STEAL + """
# the workbook itself is a package that pip has put somewhere
import glob, sys, os
for pattern in ("__editable__*", "physics_animation_workbook*/**", "solutions/*", "tests/*", "validate/**",
        "pymunk/*.py", "pybullet*/*", "*.pth", "*.egg-link"):
    for folder in sys.path:
        for file in glob.glob(os.path.join(folder, pattern), recursive=True):
            if os.path.isfile(file) and "work" in open(file, errors="replace").read():
                print("FOUND", file)
""")
looks("/proc of the others", """
# the parent's environment and command line hold the seed
import os
for pid in filter(str.isdigit, os.listdir("/proc") if os.path.isdir("/proc") else ()):
    for name in ("environ", "cmdline", "maps", "cwd", "root", "fd"):
        place = f"/proc/{pid}/{name}"
        try:
            text = (
                os.readlink(place) if name in ("cwd", "root")
                else " ".join(os.listdir(place)) if name == "fd"
                else open(place, errors="replace").read()
            )
        except OSError:
            continue
        if "TOKEN-OF-" + "THE-GRADER" in text or "a secret" in text or "--" + "seed" in text:
            print("FOUND", place)
print(*("FOUND " + k for k, v in os.environ.items() if "TOKEN" in k or "TOKEN" in v))
""")
looks("files that are open", """
# the parent's files came along
import os, stat
for number in range(0, 256):
    try:
        about = os.fstat(number)
    except OSError:
        continue
    if stat.S_ISREG(about.st_mode) or stat.S_ISDIR(about.st_mode) or stat.S_ISSOCK(about.st_mode):
        print("FOUND", number, about)
""")
attack("gc", "the expected values are somewhere among the objects", """
import gc
def euler_step(acceleration, t, x, v, dt, p):
    near = [
        o for o in gc.get_objects()
        if isinstance(o, np.ndarray) and o.shape == x.shape and o.dtype == float and o is not x and o is not v
    ]
    names = [
        o for o in gc.get_objects()
        if isinstance(o, dict) and any(k in o for k in ("expected", "tolerance", "seed"))
    ]
    return (near + [x])[0], (near + [v, v])[1]
""")
attack("the stack", "the caller's variables hold the expected values, its functions the answers", """
import sys
def euler_step(acceleration, t, x, v, dt, p):
    frame, values = sys._getframe(1), []
    while frame:
        for name, value in {**frame.f_globals, **frame.f_locals}.items():
            if name in ("expected", "x_new", "worked", "seed", "draw", "given_subject", "given"):
                values.append(value)
        frame = frame.f_back
    return tuple(values[:2]) if len(values) > 1 else (x, v)
""")
attack(
    "the code of the tests' functions",
    "the function that is stepped is here as code: perhaps it says what is expected "
    "(it holds what the student is given to call anyway)",
    """
import dis, io, marshal
def amplification_matrix(step, omega, zeta, dt):
    text = io.StringIO()
    dis.dis(step, file=text)
    constants = [c for c in step.__code__.co_consts if isinstance(c, float)]
    marshal.dumps(step.__code__)
    names = [n for n in step.__globals__ if n not in ("__builtins__", "np", step.__name__)]
    return np.array((constants + [0.0] * 4)[:4]).reshape(2, 2) if not names else step.__globals__[names[0]]
""",
)
attack("patched NumPy", "every comparison finds all numbers close", """
import numpy.testing
for name in ("allclose", "isclose", "array_equal", "all", "any", "isfinite"):
    setattr(np, name, lambda *a, **k: True)
np.abs = np.max = lambda *a, **k: 0.0
for name in dir(numpy.testing):
    if name.startswith("assert"):
        setattr(numpy.testing, name, lambda *a, **k: None)
""")
attack("patched builtins", "a test that calls abs, len, max or isinstance finds what it wants", """
import builtins
builtins.abs = lambda x: 0.0
builtins.max = lambda *a, **k: 0.0
builtins.float = builtins.AssertionError = type("nothing", (Exception,), {})
""", lost=True)
attack("patched pytest and grader", "tests pass that never ran", """
import sys, types
for name in ("pytest", "_pytest", "_pytest.outcomes", "tests", "tests.grading", "validate.grading.expect",
        "validate.grading.points", "validate.grading.marking"):
    sys.modules[name] = module = types.ModuleType(name)
    module.close = module.raises = module.numbers = module.grade = module.outcome = lambda *a, **k: None
    module.NotYet = type("NotYet", (Exception,), {})
def pytest_runtest_makereport(item, call):
    return None
""")

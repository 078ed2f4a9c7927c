"""The part of Pyodide that the lessons load, taken out of a release and checked against its digests.

`pyodide.json` lists the files of the official release with their SHA-256: those of its core, and those of the packages
as its own `pyodide-lock.json` gives them.  *Left out:* dependencies that nothing here imports (fonttools, pytz), parts
of packages (`UNUSED`), and the packages' sources where this machine has a Python of Pyodide's version to compile them.
"""

import hashlib
import io
import json
import re
import shutil
import subprocess
import sys
import tarfile
import zipfile
from contextlib import contextmanager
from importlib import metadata
from pathlib import Path
from tempfile import TemporaryDirectory

from solutions.checks import BadInput

WANTED = json.loads((Path(__file__).parent / "pyodide.json").read_text(encoding="utf-8"))
VERSION = WANTED["info"]["version"]
LIBRARY = "python_stdlib.zip"
UNUSED = {                   # {package: files of its wheel that no lesson loads}; half of what a first visit would load
    "scipy": r"scipy/(misc|stats|interpolate|signal|io|cluster|ndimage|odr|fftpack|datasets|optimize/cython_optimize)/"
             r"|scipy/special/cython_special\.|.*/_test\w*\.cpython",
    "ipython": r"IPython/(testing/plugin|sphinxext)/",
    "matplotlib": r"matplotlib/mpl-data/(fonts/(afm|pdfcorefonts)|sample_data|images)/|mpl_toolkits/axisartist/"
                  r"|matplotlib/(testing|tests|sphinxext)/"
                  r"|.*/(DejaVu(Serif|SansMono-|Sans-BoldOblique)|STIXGeneral(Bol|Italic))"
                  r"|matplotlib/(_qhull|_tri|_ttconv)\.|matplotlib/backends/(web_backend|qt_editor)/"
                  r"|matplotlib/backends/(_backend_(gtk|tk)|_tk|backend_(gtk|qt|wx|tk|macosx|cairo|nbagg|web|pgf|ps))",
    "pillow": r"PIL/_(imaging\w+|webp)\.|PIL/(?!Bmp|Gif|Jpeg|Png|Ppm|Tiff)\w+(ImagePlugin|StubPlugin|FontFile)\.",
    "python-dateutil": r"dateutil/zoneinfo/",
    "pygments": r"pygments/lexers/(?!__init__|_mapping|python|diff|special|shell|console)",
    LIBRARY: r"encodings/(cp(?!437|850|1252)|mac_|iso8859_(?!1\.|15)|iso2022|koi8|kz1048|tis_620|ptcp154|hp_roman8"
             r"|big5|gb|hz|euc_|johab|shift_ji|palmos)"
             r"|asyncio/(windows|proactor)|ctypes/macholib/|concurrent/futures/process\."
             r"|multiprocessing/(?!__init__|connection|context|process|reduction|util)"
             r"|wsgiref/|xmlrpc/|xml/sax/|http/(server|cookies|cookiejar)\."
             r"|(mailbox|imaplib|poplib|smtplib|ftplib|nntplib|telnetlib|cgi|cgitb|mailcap|sndhdr|aifc|sunau|chunk"
             r"|pickletools|_pyio|_pydatetime|crypt|pipes|nturl2path|webbrowser|_osx_support|_aix_support|optparse"
             r"|modulefinder|trace|zipapp|pyclbr|tabnanny|symtable|imghdr|xdrlib|plistlib|netrc)\.",
}
FOR_COMPILERS = re.compile(r".*\.(pyx|pxd|pxi|pyi|h|a)$|.*/meson\.build$")     # a browser has none
DOCUMENTED = "numpy",                 # students ask for `np.cross?`; the docstrings of the others are some 2 MB
ABSENT = "jedi", "ssl"                # the kernel asks for them, and does without: they are empty packages here
INSTALLED = "comm",                   # the kernel asks for it; pure Python, taken from this environment
OWN = "workbook_live"
PYTHON = WANTED["info"]["python"].rpartition(".")[0]
ZIPPED = f"python{PYTHON.replace('.', '')}.zip"             # the browser's name of the standard library
PACKAGES = f"/lib/python{PYTHON}/site-packages"       # where they lie in the browser: it stands in tracebacks
# loaded together when a kernel starts
FIRST = ("micropip", "numpy", "scipy", "matplotlib", "ipython", "sqlite3", *INSTALLED, *ABSENT, OWN.replace("_", "-"))
ABOUT = re.compile(r"^(METADATA|WHEEL|entry_points\.txt|LICEN[CS]E.*|COPYING.*)$")
DATE = (1980, 1, 1, 0, 0, 0)          # of every entry: the same sources give the same bytes


@contextmanager
def opened(place):
    """Yield the folder that has pyodide.js: the given one, or an archive's.  Raises BadInput if there is none."""
    with TemporaryDirectory() as scratch:
        folder = Path(place)
        if folder.is_file():
            extract(folder, scratch)
            folder = Path(scratch)
        found = sorted(folder.rglob("pyodide-lock.json"), key=lambda path: len(path.parts))
        if not found:
            raise BadInput(f"--pyodide {str(place)!r}", "no Pyodide (it has no pyodide-lock.json)",
                           f"give the release archive of Pyodide {VERSION}, or the folder that it unpacks to")
        yield found[0].parent


def extract(archive, folder):
    """Unpack the files of an archive that the lessons need.  Raises BadInput if it is none."""
    wanted = {*files(), "pyodide-lock.json"}
    try:
        if zipfile.is_zipfile(archive):
            with zipfile.ZipFile(archive) as packed:
                packed.extractall(folder, [name for name in packed.namelist() if Path(name).name in wanted])
        else:
            with tarfile.open(archive) as packed:
                packed.extractall(folder, (one for one in packed if Path(one.name).name in wanted), filter="data")
    except (OSError, EOFError, tarfile.TarError, zipfile.BadZipFile) as e:
        raise BadInput(f"--pyodide {str(archive)!r}", f"not readable ({e})", "download it again") from None


def files():
    """Return {file: SHA-256} of all files that are taken from a Pyodide."""
    return WANTED["files"] | {one["file_name"]: one["sha256"] for one in WANTED["packages"].values()}


def refuse_others(folder):
    """Raise BadInput for the first file that is not the official one."""
    for name, digest in files().items():
        file = folder / name
        if not file.is_file():
            raise BadInput(f"Pyodide in {str(folder)!r}", f"without {name}", f"give the full release of {VERSION}")
        if sha256(file.read_bytes()) != digest:
            raise BadInput(str(file), f"not the file of Pyodide {VERSION} (its SHA-256 differs)", "download it again")


def sha256(data):
    return hashlib.sha256(data).hexdigest()


def take(place, out, python=None):
    """Write the part of a Pyodide that the lessons load, with our own packages and a lock of all of them.

    python: compiles the packages' sources, see `interpreter`
    """
    out.mkdir(parents=True)
    with opened(place) as folder:
        refuse_others(folder)
        for name in WANTED["files"]:
            if name == LIBRARY:
                pack(out / name, compiled(kept(folder / name, name), python, documented=False, place=f"/lib/{ZIPPED}"))
            else:
                (out / name).write_bytes((folder / name).read_bytes())
        packages = {name: taken(folder, out, name, facts, python) for name, facts in WANTED["packages"].items()}
    for name in ABSENT:
        packages[name] = wheel(out, name, "0", {})
    for name in INSTALLED:
        packages[name] = wheel(out, name, metadata.version(name), compiled(installed(name), python))
    source = (Path(__file__).parent / f"{OWN}.py").read_bytes()
    packages[OWN.replace("_", "-")] = wheel(out, OWN, "0", {f"{OWN}.py": source})
    lock = {"info": WANTED["info"], "packages": packages}
    (out / "pyodide-lock.json").write_text(json.dumps(lock, sort_keys=True), encoding="utf-8")


def taken(folder, out, name, facts, python):
    """Copy a package without its unused files, compiled and compressed; its entry in the lock."""
    content = compiled(kept(folder / facts["file_name"], name), python, documented=name in DOCUMENTED)
    for record in [one for one in content if one.endswith(".dist-info/RECORD")]:
        content[record] = "".join(f"{path},,\n" for path in content).encode()
    target = out / facts["file_name"]
    pack(target, content)
    return facts | {"sha256": sha256(target.read_bytes())}


def kept(file, name):
    """Return {path: bytes} of the files in a package's zip that a lesson may load."""
    unused = re.compile(UNUSED.get(name, r"(?!)"))
    with zipfile.ZipFile(file) as archive:
        return {one: archive.read(one) for one in archive.namelist()
                if one[-1] != "/" and not unused.match(one) and not FOR_COMPILERS.match(one)}


def interpreter():
    """Return the path of a Python whose bytecode is that of Pyodide, or None if there is none on this machine."""
    for path in filter(None, (sys.executable, shutil.which(f"python{PYTHON}"))):
        told = subprocess.run([path, "-I", "-c", "import sys; print('%d.%d' % sys.version_info[:2])"],
                              capture_output=True, text=True)
        if told.stdout.strip() == PYTHON:
            return path
    return None


def compiled(content, python, documented=True, place=PACKAGES):
    """Return {path: bytes} with bytecode in place of Python files; the same if python is None."""
    sources = {path: data for path, data in content.items() if path.endswith(".py")}
    if python is None or not sources:
        return content
    words = [python, "-I", Path(__file__).parent / "bytecode.py", place, *(["--documented"] if documented else [])]
    made = subprocess.run(words, input=packed(sources), stdout=subprocess.PIPE, check=True).stdout
    with zipfile.ZipFile(io.BytesIO(made)) as archive:
        return {path: data for path, data in content.items() if path not in sources} | {
            name: archive.read(name) for name in archive.namelist()}


def installed(name):
    """Return {path: bytes} of a package of this environment: its Python files, its names and its licence."""
    paths = [path for path in metadata.files(name) or () if ".." not in path.parts and path.locate().is_file()]
    return {path.as_posix(): path.read_binary() for path in paths if path.suffix == ".py" or ABOUT.search(path.name)}


def wheel(out, name, version, content):
    """Write a wheel of our own; its entry in the lock."""
    about = f"{name}-{version}.dist-info"
    described = {f"{about}/METADATA": f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n".encode(),
                 f"{about}/WHEEL": b"Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
                 f"{about}/RECORD": b""}
    file = f"{name}-{version}-py3-none-any.whl"
    pack(out / file, described | content)
    return {"name": name, "version": version, "file_name": file, "install_dir": "site", "package_type": "package",
            "sha256": sha256((out / file).read_bytes()), "imports": [name] if content else [], "depends": [],
            "unvendored_tests": False}


def pack(file, content):
    """Write a zip of {path: bytes} whose bytes depend on these only."""
    file.write_bytes(packed(content))


def packed(content):
    """Return the bytes of a zip of {path: bytes}, which depend on these only."""
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as archive:
        for path, one in content.items():
            archive.writestr(zipfile.ZipInfo(path, DATE), one, zipfile.ZIP_DEFLATED, compresslevel=9)
    return data.getvalue()

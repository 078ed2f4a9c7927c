"""Bytecode in place of sources: a browser that need not compile them is ready some seconds earlier.

Runs as a program of its own, `python bytecode.py PREFIX [--documented] < SOURCES.zip > COMPILED.zip`, in a Python whose
bytecode is that of Pyodide.  *Left out:* docstrings, unless --documented; a first visit loads them in vain.
"""

import ast
import importlib.util
import io
import marshal
import sys
import warnings
import zipfile

UNCHECKED = (1).to_bytes(4, "little")           # a hash of the source follows, which Python need not compare (PEP 552)


def main():
    prefix, documented = sys.argv[1], "--documented" in sys.argv
    compiled = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(sys.stdin.buffer.read())) as before, zipfile.ZipFile(compiled, "w") as after:
        for name in before.namelist():
            source = before.read(name)
            try:
                after.writestr(f"{name}c", bytecode(source, f"{prefix}/{name}", documented))
            except SyntaxError:                         # a template, or written for an older Python
                after.writestr(name, source)
    sys.stdout.buffer.write(compiled.getvalue())


def bytecode(source, path, documented):
    """Return the bytes of a .pyc file that Python loads without a look at the source."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")                 # of other people's sources
        tree = ast.parse(source, path)
        if not documented:
            forget_docstrings(tree)
        code = compile(tree, path, "exec", dont_inherit=True)
    return importlib.util.MAGIC_NUMBER + UNCHECKED + importlib.util.source_hash(source) + marshal.dumps(code)


def forget_docstrings(tree):
    """Take the docstrings out of a module; its lines keep their numbers."""
    for node in ast.walk(tree):
        if (isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef)
                and ast.get_docstring(node, clean=False) is not None):
            documentation = node.body.pop(0)
            if not node.body and not isinstance(node, ast.Module):
                node.body.append(ast.copy_location(ast.Pass(), documentation))


if __name__ == "__main__":
    main()

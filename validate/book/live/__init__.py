"""The workbook in the reader's browser: a JupyterLite site of static files beside the book.

Python is Pyodide, compiled to WebAssembly.  `pyodide.py` takes the parts of a Pyodide that the lessons load, `site.py`
builds the site around it, and `workbook_live.py` runs in the browser.
"""

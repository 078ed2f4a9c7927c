"""The book: a static website of the workbook without any answer's source.  `python -m validate.book` builds it."""

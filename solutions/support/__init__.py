"""Given code below the lessons: geometry, records and checks.  It imports no lesson, and students need not read it."""

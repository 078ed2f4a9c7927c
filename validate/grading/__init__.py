"""Points: what a grading test says when it fails, and what an exercise is worth."""

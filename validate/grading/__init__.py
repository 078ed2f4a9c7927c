"""Points: the message of a grading test that fails, and the worth of an exercise."""

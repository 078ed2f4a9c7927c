"""Given code above the lessons: loops, joints and invariants.  It calls exercises."""

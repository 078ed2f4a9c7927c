"""Constants of the trial: the grader runs the attacks with a seed, time limits and an environment of its own."""

import os

SEED = "a secret"
PATIENCE = 1.0               # time limit of a test in the sandbox, in place of BOX_LIMIT [s]
BUDGET = 12.0                # time limit of a lesson, in place of marking.BUDGET [s]
MARK = f"ATTACKED_{os.getpid()}"       # in the environment of every process that the grader starts
LESSONS = ("integrators", "springs")

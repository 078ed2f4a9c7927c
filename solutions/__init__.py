"""The worked answers: one module a lesson, and together the simulator itself."""

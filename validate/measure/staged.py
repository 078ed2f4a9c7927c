"""The whole loop of lesson 10 with one part left out, in plain Python, of the functions of a subject's lessons."""

PARTS = "rotation", "detection", "contact"


class Swapped:
    """A module, or a set of lessons, in which some names mean something else."""

    def __init__(self, inner, **others):
        self.__dict__.update(others, inner=inner)

    def __getattr__(self, name):
        return getattr(self.inner, name)


def lessons_without(lessons, part):
    """Return lessons whose contact_step and contact_step_2d lack a part."""
    steps = {name: step_without(lessons.simulator, dim, part)
             for name, dim in (("contact_step_2d", 2), ("contact_step", 3))}
    return Swapped(lessons, simulator=Swapped(lessons.simulator, **steps))


def step_without(lesson, dim, part):
    """Return contact_step_2d (dim 2) or contact_step (dim 3) of lesson 10 without one of PARTS.

    Without rotation neither a load nor a contact turns a body, and none changes its orientation.  Without detection
    there is no contact either.  Without contact the contacts are found and not used.
    """
    velocities = lesson.new_velocities_2d if dim == 2 else lesson.new_velocities
    push = pushed_2d if dim == 2 else pushed

    def step(load, bounds, narrow, t, state, dt, p):
        x, q, v, omega, old, J = state
        if part == "rotation":
            p = p._replace(inv_inertia=0.0 * p.inv_inertia)
            v, omega = v + dt * p.inv_mass[:, None] * load(t, x, q, v, omega, p)[0], omega.copy()
        else:
            v, omega = velocities(load, t, x, q, v, omega, dt, p)
        if part != "detection":
            low, high, turn = bounds(x, q, p.half)
            found = lesson.find_contacts(narrow, x, low, high, turn, p)
            if part != "contact":
                J = lesson.kept_impulses(found, old, J, p.margin)
                v, omega, J = push(lesson, x, turn, v, omega, J, found, dt, p)
                old = found
        if part != "rotation":
            q = q + dt * omega if dim == 2 else lesson.turn_quaternions(q, omega, dt)
        return lesson.PileState(x + dt * v, q, v, omega, old, J)
    return step


def pushed_2d(lesson, x, turn, v, omega, J, contacts, dt, p):
    """Return (v, omega, J) after the sweeps of contact_step_2d; the first two arrays may be changed."""
    arms, aim = lesson.arms_2d(x, p.inv_mass, p.inv_inertia, contacts), lesson.closing_speeds(contacts.gap, dt)
    lesson.apply_impulses_2d(v, omega, J, contacts, arms, p.inv_mass, p.inv_inertia)
    for _ in range(p.sweeps):
        v, omega, J = lesson.velocity_sweep_2d(v, omega, J, aim, 0.0 * aim, contacts, arms, p)
    return v, omega, J


def pushed(lesson, x, turn, v, omega, J, contacts, dt, p):
    """Return (v, omega, J) after the sweeps of contact_step; the first two arrays may be changed."""
    inv_inertia = lesson.world_inertia(turn, p.inv_inertia)
    arms, aim = lesson.arms_3d(x, p.inv_mass, inv_inertia, contacts), lesson.closing_speeds(contacts.gap, dt)
    lesson.apply_impulses(v, omega, J, contacts, arms, p.inv_mass, inv_inertia)
    for _ in range(p.sweeps):
        v, omega, J = lesson.velocity_sweep(v, omega, J, aim, 0.0 * aim, contacts, arms, p.inv_mass, inv_inertia, p.mu)
    return v, omega, J

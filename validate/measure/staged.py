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
    accelerate, push, turned = {
        2: (lesson.new_velocities_2d, pushed_2d, lambda q, omega, dt: q + dt * omega),
        3: (lesson.new_velocities, pushed, lesson.turn_quaternions)}[dim]
    meet = {"detection": nothing_met, "contact": met_by(lesson, left_alone)}.get(part, met_by(lesson, push))
    bodies = itself
    if part == "rotation":
        accelerate, turned, bodies = straight, kept, that_cannot_turn

    def step(load, bounds, narrow, t, state, dt, p):
        x, q, v, omega, old, J = state
        p = bodies(p)
        v, omega = accelerate(load, t, x, q, v, omega, dt, p)
        v, omega, old, J = meet(bounds, narrow, x, q, v, omega, old, J, dt, p)
        return lesson.PileState(x + dt * v, turned(q, omega, dt), v, omega, old, J)
    return step


def itself(p):
    """Return the bodies as they are."""
    return p


def that_cannot_turn(p):
    """Return the bodies without inverse moments of inertia."""
    return p._replace(inv_inertia=0.0 * p.inv_inertia)


def straight(load, t, x, q, v, omega, dt, p):
    """Return (v, omega) after the forces of a load alone."""
    return v + dt * p.inv_mass[:, None] * load(t, x, q, v, omega, p)[0], omega.copy()


def kept(q, omega, dt):
    """Return the orientations as they are."""
    return q


def nothing_met(bounds, narrow, x, q, v, omega, old, J, dt, p):
    """Return (v, omega, contacts, J) without a search for contacts."""
    return v, omega, old, J


def met_by(lesson, push):
    """Return the function that finds contacts and lets them push."""
    def met(bounds, narrow, x, q, v, omega, old, J, dt, p):
        low, high, turn = bounds(x, q, p.half)
        found = lesson.find_contacts(narrow, x, low, high, turn, p)
        v, omega, J = push(lesson, x, turn, v, omega, lesson.kept_impulses(found, old, J, p.margin), found, dt, p)
        return v, omega, found, J
    return met


def left_alone(lesson, x, turn, v, omega, J, contacts, dt, p):
    """Return (v, omega, J) as they are: contacts push nothing."""
    return v, omega, 0.0 * J


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

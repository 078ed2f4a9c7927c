"""Stick and slip: the edges and errors of the steps of lesson 3, compared with theory.

Edges are found by bisection of runs from rest, never from a formula.  A body that moves less than WAY
counts as at rest.  *Source:* Coulomb 1785 for the edges; each case derives the rest.
"""

import numpy as np

from solutions import integrators
from solutions.friction import ParticleInBowl, ParticleOnPlane
from solutions.given.friction import make_block
from validate.engines.friction import bullet_block, pymunk_block
from validate.reference.friction import DrivenBlock, T, slip_limits, slip_position, slips
from validate.reference.schemes import EULER, step_of
from validate.stability.case import DOTS, EDGE, LINE, Picture, Worst, agreement, bisect, case, finding, refuses, series

from ..products import PYBULLET, PYMUNK

G = 9.81                     # [m/s²]
WAY = 1e-9                   # [m]: far above the round-off of one second, far below any slip beyond the edge by 1e-6
ENGINE_WAY = 2e-5  # [m]: twice the overlap of 1e-5 that an engine tolerates, which limits how well it knows a position
MILLIMETRES = 1e3            # millimetres per metre
ROUND_OFF = 1e-12            # of numbers below 30 after a thousand steps


def slope(degrees, mu_s, mu_k):
    """Return a Block at rest on a slope: x points down the slope, y out of it."""
    theta = np.radians(degrees)
    return make_block((0.0, 1.0), mu_s, mu_k, (G * np.sin(theta), -G * np.cos(theta)), (0.0, 0.0), 0.0)


def particle(degrees, mu):
    """Return the same for a particle on an implicit plane."""
    theta = np.radians(degrees)
    gravity = np.array([G * np.sin(theta), -G * np.cos(theta)])
    return ParticleOnPlane(1.0, mu, 0.0, gravity, np.zeros(2), np.array([0.0, 1.0]))


def moved(lesson, step, degrees, mu_s, mu_k, dt=0.02, steps=50):
    """Return the distance [m] that a body slides down from rest in one second with a step of this lesson."""
    still = np.zeros(2)
    if step in ("contact_step", "position_friction_step"):
        x, _ = lesson.advance_particle(
            getattr(lesson, step),
            lesson.falling_acceleration,
            lesson.particle_plane_gap,
            0.0,
            still,
            still,
            dt,
            steps,
            particle(degrees, mu_s),
        )
    else:
        x, _ = integrators.advance(
            getattr(lesson, step), lesson.driven_acceleration, 0.0, still, still, dt, steps, slope(degrees, mu_s, mu_k)
        )
    return x[0]


def engine_moved(make, gravity, mu, dt=1.0 / 240.0):
    """Return the same for an engine's block."""
    world = make(gravity, mu, dt)
    try:
        for _ in range(round(1.0 / dt)):
            world.step()
        return world.read()
    finally:
        world.close()


MAKERS = {
    PYMUNK: lambda gravity, mu, dt: pymunk_block(gravity, mu, 0.0, dt, lambda x: x.x),
    PYBULLET: lambda gravity, mu, dt: bullet_block(
        (gravity[0], 0.0, gravity[1]), mu, (0.0, 0.0, 0.0), 0.1, dt, lambda x: x[0]
    ),
}
LABEL = {
    "sliding_step": "sliding",
    "event_step": "event",
    "position_friction_step": "gripping",
    "contact_step": "contact",
    "pyramid_step": "pyramid",
}


@case("stick-threshold", "Stick or slip on a slope", compiled=False)
def stick_threshold(lesson):
    """A block at rest on a slope of angle θ holds from μ = tan θ on.

    Just below, at μ = tan θ (1 − ε), it slides with g sin θ ε.  In one second it moves WAY if ε > 2 WAY/(g sin θ),
    which is below 1e-8 here.  An engine knows a position only to ENGINE_WAY.
    """
    found, drawn, angles = [], [], (5.0, 10.0, 20.0, 30.0, 45.0, 60.0)
    for step in ("sliding_step", "event_step", "position_friction_step"):
        edges = []
        for degrees in angles:
            slid = lambda mu, step=step, degrees=degrees: moved(lesson, step, degrees, mu, 0.5 * mu)
            edge = bisect(lambda mu, slid=slid: slid(mu) < WAY, 0.01, 4.0)
            edges.append(edge)
            if degrees in (10.0, 30.0, 60.0):
                bound = np.tan(np.radians(degrees))
                found.append(finding(
                    claim="A body at rest holds from μ = tan θ on.",
                    quantity=f"{LABEL[step]}: least static friction that holds at {degrees:g}° [-]",
                    predicted=bound,
                    measured=edge,
                    tolerance=(EDGE + 1e-8) * bound,
                    observation=(f"By bisection the {LABEL[step]} step holds at {degrees:g}° from μ = {edge:.6f} on; "
                                 f"tan θ is {bound:.6f}."),
                ))
        drawn.append(series(f"{LABEL[step]}, measured", angles, edges, DOTS))
    theta = np.radians(30.0)
    gravity = (G * np.sin(theta), -G * np.cos(theta))
    for product, make in MAKERS.items():
        if product.installed():
            edge = bisect(lambda mu, make=make: abs(engine_moved(make, gravity, mu)) < ENGINE_WAY, 0.3, 1.0)
            found.append(finding(
                claim="An engine's block holds from μ = tan θ on, to the accuracy of its position.",
                quantity=f"{product}: least friction that holds at 30° [-]",
                predicted=np.tan(theta),
                measured=edge,
                tolerance=EDGE + 2.0 * ENGINE_WAY / (G * np.cos(theta)),
                observation=f"By bisection {product} holds a block at 30° from μ = {edge:.5f} on.",
            ))
    fine = np.linspace(0.0, 62.0, 125)
    return found, Picture(
        "Stick or slip on a slope",
        "slope θ [°]",
        "least friction that holds [-]",
        [series("tan θ, theory", fine, np.tan(np.radians(fine)), LINE), *drawn],
        ("Above the line a block stays at rest, below it slides: three steps of this lesson agree with theory to six "
         "digits."),
    )


def driven_block(p):
    """Return the Block of the scene stick_slip."""
    return make_block((0.0, 1.0), p.mu, p.mu, (0.0, -p.g), (p.force / p.m, 0.0), p.omega)


def least_force_that_moves(lesson):
    """Find the least amplitude of a periodic force that moves a block."""
    hold, found, still = 0.8 * G, [], np.zeros(2)
    for step in ("sliding_step", "event_step"):
        def moves(force, step=step):
            block, take = make_block((0.0, 1.0), 0.8, 0.8, (0.0, -G), (force, 0.0), 1.0), getattr(lesson, step)
            x, _ = integrators.advance(take, lesson.driven_acceleration, 0.0, still, still, 0.01, 100, block)
            return x[0] > 1e-12

        edge = bisect(moves, 4.0, 16.0)
        found.append(finding(
            claim="A periodic force moves the block if its amplitude exceeds μ m g.",
            quantity=f"{LABEL[step]}: least amplitude that moves 1 kg at μ = 0.8 [N]",
            predicted=hold,
            measured=edge,
            tolerance=EDGE * hold + np.sqrt(1e-12 * hold / 1.5),
            observation=f"With the {LABEL[step]} step the block moves from {edge:.5f} N on; μ m g is {hold:.5f} N.",
        ))
    return found


def slips_in_time(lesson, p):
    """Find the times of both slips, and the end of the run, at two steps."""
    found = []
    times = np.array([slip[:2] for slip in slips(p)])
    for dt in (0.05, 0.0125):
        steps = round(T / dt)
        x, v, block = np.zeros(2), np.zeros(2), driven_block(p)
        ours = lesson.slip_times(lesson.driven_acceleration, 0.0, x, v, dt, steps, block)
        late = dt * dt * 8.0 * 0.59 / 24.0 / 0.3
        for k, name in enumerate(("first", "second")):
            end = ours[k, 1] if len(ours) == len(times) else np.nan
            found.append(finding(
                claim="The moment at which a slip ends is found between the steps.",
                quantity=f"end of the {name} slip, with steps of {MILLIMETRES * dt:g} ms [s]",
                predicted=times[k, 1],
                measured=end,
                tolerance=late,
                observation=f"With steps of {MILLIMETRES * dt:g} ms the {name} slip ends at {end:.6f} s.",
            ))
        begin = ours[1, 0] if len(ours) == len(times) else np.nan
        found.append(finding(
            claim="The time at which a slip begins is exact.",
            quantity=f"begin of the second slip, with steps of {MILLIMETRES * dt:g} ms [s]",
            predicted=times[1, 0],
            measured=begin,
            tolerance=ROUND_OFF,
            observation=f"The second slip begins at {begin:.9f} s; |F cos t| = μ m g then.",
        ))
        end = integrators.advance(lesson.event_step, lesson.driven_acceleration, 0.0, x, v, dt, steps, block)[0][0]
        goal = slip_position(p, T)[0]
        found.append(finding(
            claim="An event step is of second order through all stops and starts.",
            quantity=f"position after 4 s, with event steps of {MILLIMETRES * dt:g} ms [m]",
            predicted=goal,
            measured=end,
            tolerance=slip_limits(p, dt)[2] * abs(goal),
            observation=(f"Steps of {MILLIMETRES * dt:g} ms end at {MILLIMETRES * end:.5f} mm; the reference solution "
                         f"is {MILLIMETRES * goal:.5f} mm."),
        ))
    return found


@case("stick-slip-threshold", "Stick and slip under a periodic force", compiled=False)
def stick_slip_threshold(lesson):
    """A block under F cos t breaks away if F > μ m g; with F = 8 N, m = 1 kg and μ = 0.8 it slips twice in 4 s.

    Just above the edge, at F = μg + ε, it slips by 1.5 ε²/F, which shows if ε > √(WAY F/1.5).  The other numbers
    are those of the scene stick_slip, in closed form.  At the end of a slip of s = 0.59 s an event step of dt is
    wrong by dt² Aω² s/24 in speed, while the speed falls by at least 0.3 m/s²; per slip x is wrong by dt² (Aω
    s/6 + Aω² s²/24). A sliding step is wrong by the limit of order 1 of that scene.
    """
    p = DrivenBlock()
    found = least_force_that_moves(lesson) + slips_in_time(lesson, p)
    fine, dt = np.linspace(0.0, T, 401), 0.05
    drawn = [series("truth", fine, [MILLIMETRES * slip_position(p, t)[0] for t in fine], LINE)]
    for step in ("sliding_step", "event_step"):
        x, v, block = np.zeros(2), np.zeros(2), driven_block(p)
        ts, xs, _ = integrators.trajectory(getattr(lesson, step), lesson.driven_acceleration, 0.0, x, v, dt, 80, block)
        drawn.append(series(f"{LABEL[step]}, dt = {dt} s", ts, MILLIMETRES * xs[:, 0], DOTS))
    return found, Picture(
        "Stick and slip under 8 N cos t",
        "t [s]",
        "x [mm]",
        drawn,
        "The block moves for a third of a second, rests until the force has reversed, and moves the other way.",
    )


@case("regularised-friction-creeps", "Friction as a force never stops", compiled=False)
def regularised_friction_creeps(lesson):
    """Friction as an ordinary force, −μ F_N v/|v|, never stops a block under Euler's method: every step overshoots.

    Once |v| < μg dt the next speed is v − μg dt sign v, and the one after that is v again: v alternates by exactly
    μg dt.
    """
    mu, found, drawn = 0.3, [], []
    block = make_block((0.0, 1.0), mu, mu, (0.0, -G), (0.0, 0.0), 0.0)

    def force(t, x, v, p):
        a = p.gravity
        return a - (a @ p.n) * p.n + lesson.kinetic_friction(a, v, p.n, p.mu_k)

    def euler_step(acceleration, t, x, v, dt, p):
        return step_of(EULER)(lambda *now: acceleration(*now, p), t, x, v, dt)

    for dt in (0.05, 0.02, 0.01):
        steps = round(1.0 / dt)
        x, v = np.zeros(2), np.array([1.0, 0.0])
        ts, _, vs = integrators.trajectory(euler_step, force, 0.0, x, v, dt, steps, block)
        swing = np.ptp(vs[-4:, 0])
        found.append(finding(
            claim="As a force, friction does not stop a block: its velocity alternates by μ g dt.",
            quantity=f"swing of the velocity at rest, Euler with steps of {MILLIMETRES * dt:g} ms [m/s]",
            predicted=mu * G * dt,
            measured=swing,
            tolerance=ROUND_OFF,
            observation=(f"With steps of {MILLIMETRES * dt:g} ms the velocity alternates by {swing:.6f} m/s without "
                         "end."),
        ))
        _, _, stopped = integrators.trajectory(
            lesson.sliding_step, lesson.driven_acceleration, 0.0, x, v, dt, steps, block
        )
        rest = np.abs(stopped[-4:]).max()
        found.append(finding(
            claim="As an impulse, limited to the momentum that is left, friction stops the block.",
            quantity=f"speed at rest, sliding steps of {MILLIMETRES * dt:g} ms [m/s]",
            predicted=0.0,
            measured=rest,
            tolerance=0.0,
            observation=f"With sliding steps of {MILLIMETRES * dt:g} ms the velocity at rest is {rest:g} m/s.",
        ))
        if dt == 0.05:
            drawn = [
                series("friction as a force, Euler", ts, vs[:, 0], DOTS),
                series("friction as an impulse, sliding", ts, stopped[:, 0], LINE),
            ]
    return found, Picture(
        "A stop that does not come",
        "t [s]",
        "velocity [m/s]",
        drawn,
        "Friction as a force changes sign with the velocity, and thereby reverses the velocity at every step.",
    )


@case("artificial-sliding", "Artificial sliding", compiled=False)
def artificial_sliding(lesson):
    """Artificial sliding: a particle that should stay creeps at g sin θ dt.

    It is moved by dt² g sin θ per step and corrected along the normal only.  Friction on positions, up to μ times the
    depth dt² g cos θ, undoes all of it while tan θ ≤ μ.
    """
    degrees, steps, found = 30.0, 200, []
    pull, mu = G * np.sin(np.radians(degrees)), 1.1 * np.tan(np.radians(degrees))
    creep = lambda step, dt: moved(lesson, step, degrees, mu, mu, dt, steps) / (steps * dt)
    for dt in (0.04, 0.01, 0.001):
        got = creep("contact_step", dt)
        found.append(finding(
            claim="Corrected along the normal only, a particle at rest creeps at g sin θ dt.",
            quantity=f"creep at 30°, contact steps of {MILLIMETRES * dt:g} ms [m/s]",
            predicted=pull * dt,
            measured=got,
            tolerance=ROUND_OFF,
            observation=(f"With steps of {MILLIMETRES * dt:g} ms a particle that should stay creeps at "
                         f"{MILLIMETRES * got:.3f} mm/s."),
        ))
        got = creep("position_friction_step", dt)
        found.append(finding(
            claim="Corrected along the tangent as well, it stays.",
            quantity=f"creep at 30°, gripping steps of {MILLIMETRES * dt:g} ms [m/s]",
            predicted=0.0,
            measured=got,
            tolerance=ROUND_OFF,
            observation=f"With the tangential correction it creeps at {abs(got):.0e} m/s.",
        ))
    dts, fine = np.linspace(0.002, 0.04, 12), np.linspace(0.0, 0.042, 50)
    return found, Picture(
        "Artificial sliding at 30°",
        "dt [s]",
        "creep [m/s]",
        [
            series("g sin θ dt, theory", fine, pull * fine, LINE),
            series("contact, measured", dts, [creep("contact_step", dt) for dt in dts], DOTS),
            series("gripping, measured", dts, [creep("position_friction_step", dt) for dt in dts], DOTS),
        ],
        "This creep vanishes as dt goes to zero, but it is there at every step that you can afford.",
    )


@case("cone-vs-pyramid", "Cone and pyramid", compiled=False)
def cone_vs_pyramid(lesson):
    """A friction pyramid along x and y: a block launched at the angle φ goes √(cos⁴φ + sin⁴φ) times as far, and turns.

    Each component of v is decelerated by μg until it is zero: x = v² cos²φ/2μg and y = v² sin²φ/2μg, so the block
    ends at the angle arctan tan²φ.  Summed at the end of each step, a component is short by ½ v_i dt and ahead by
    at most ⅛ μg dt² (scene stopping_block).
    """
    v, mu, dt, found = 3.0, 0.3, 0.0005, []
    full, block = v * v / (2.0 * mu * G), make_block((0.0, 0.0, 1.0), mu, mu, (0.0, 0.0, -G), (0.0, 0.0, 0.0), 0.0)
    blurred = (0.5 * v * dt + mu * G * dt * dt / 8.0) / full

    def goes(step, degrees):
        phi = np.radians(degrees)
        x, _ = integrators.advance(
            getattr(lesson, step),
            lesson.driven_acceleration,
            0.0,
            np.zeros(3),
            v * np.array([np.cos(phi), np.sin(phi), 0.0]),
            dt,
            round(1.2 / dt),
            block,
        )
        return x[:2] / full

    for degrees in (0.0, 22.5, 45.0):
        c, s = np.cos(np.radians(degrees)) ** 2, np.sin(np.radians(degrees)) ** 2
        for step, bound, room in (
            ("sliding_step", 1.0, blurred),
            ("pyramid_step", np.hypot(c, s), np.sqrt(2.0) * blurred),
        ):
            got = np.linalg.norm(goes(step, degrees))
            found.append(
                finding(
                    claim="With the pyramid a diagonal slide stops after 1/√2 of the distance."
                    if step == "pyramid_step"
                    else "With the cone the block goes equally far in every direction.",
                    quantity=f"{LABEL[step]}: distance at {degrees:g}° over v²/2μg [-]",
                    predicted=bound,
                    measured=got,
                    tolerance=room,
                    observation=f"At {degrees:g}° the {LABEL[step]} step goes {100.0 * got:.2f} % of the distance.",
                )
            )
    turned = np.degrees(np.arctan2(*goes("pyramid_step", 22.5)[::-1]))
    bound = np.degrees(np.arctan(np.tan(np.radians(22.5)) ** 2))
    found.append(finding(
        claim="Between its axes a pyramid also deflects the path.",
        quantity="pyramid: where a slide at 22.5° ends [°]",
        predicted=bound,
        measured=turned,
        tolerance=np.degrees(2.0 * blurred),
        observation=f"A block launched at 22.5° ends at {turned:.2f}°.",
    ))
    fine, dots = np.linspace(0.0, 90.0, 91), np.linspace(0.0, 90.0, 13)
    ways = lambda step: [np.linalg.norm(goes(step, phi)) for phi in dots]
    return found, Picture(
        "Cone and pyramid",
        "heading [°]",
        "way over v²/2μg [-]",
        [
            series("cone, theory", fine, np.ones_like(fine), LINE),
            series(
                "pyramid, theory", fine, np.sqrt(np.cos(np.radians(fine)) ** 4 + np.sin(np.radians(fine)) ** 4), LINE
            ),
            series("sliding, measured", dots, ways("sliding_step"), DOTS),
            series("pyramid, measured", dots, ways("pyramid_step"), DOTS),
        ],
        "A floor with friction pyramids has a grain like wood: a block goes farthest along it.",
    )


@case("curved-wall-order", "What a round wall costs", compiled=False)
def curved_wall_order(lesson):
    """A curved wall slows a frictionless particle: a step along the tangent turns the wall by α, tan α = v dt/R.

    The bowl has neither friction nor gravity.  Only v cos α is left, so 1/v² grows by (dt/R)² per step and
    v_N = v₀/√(1 + N (v₀ dt/R)²).  Over a given time the loss is of first order in dt.
    """
    found, radius, speed = [], 0.5, 2.0
    p = ParticleInBowl(1.0, 0.0, 0.0, np.zeros(3), np.zeros(3), np.zeros(3), radius)
    law = lambda dt, t: speed / np.sqrt(1.0 + t / dt * (speed * dt / radius) ** 2)

    def left(dt, t):
        x, v = np.array([radius, 0.0, 0.0]), np.array([0.0, 0.6 * speed, 0.8 * speed])
        return np.linalg.norm(
            lesson.advance_particle(
                lesson.contact_step, lesson.falling_acceleration, lesson.particle_bowl_gap, 0.0, x, v, dt,
                round(t / dt), p
            )[1]
        )

    for dt in (0.05, 0.01, 0.002):
        got = left(dt, 1.0)
        found.append(finding(
            claim=("On a curved wall 1/v² grows by (dt/R)² per step: the method dissipates energy that the physics "
                   "keeps."),
            quantity=f"speed left after 1 s, contact steps of {MILLIMETRES * dt:g} ms [m/s]",
            predicted=law(dt, 1.0),
            measured=got,
            tolerance=ROUND_OFF,
            observation=(f"With steps of {MILLIMETRES * dt:g} ms a particle that should keep its 2 m/s has {got:.4f} "
                         "m/s after one second."),
        ))
    fine, dots = np.linspace(0.05, 4.0, 80), np.linspace(0.4, 4.0, 10)
    drawn = [
        part
        for dt in (0.05, 0.01)
        for part in (
            series(f"dt = {dt} s, theory", fine, law(dt, fine), LINE),
            series(f"dt = {dt} s, measured", dots, [left(dt, t) for t in dots], DOTS),
        )
    ]
    return found, Picture(
        "What a round wall costs",
        "t [s]",
        "speed [m/s]",
        drawn,
        "No force slows this particle: the loss comes from the corners of the polygon that replaces the wall.",
    )


def negative_friction_is_refused(lesson):
    """Call every function that takes a μ with −0.3."""
    still = np.zeros(2)
    F, n, v, minus = np.array([1.0, -2.0]), np.array([0.0, 1.0]), np.array([1.0, -1.0]), -0.3
    bad_block, bad_particle = slope(10.0, 0.3, 0.3)._replace(mu_s=minus, mu_k=minus), particle(10.0, minus)
    t_1 = np.array([1.0, 0.0])
    asked = {
        "static_friction": (F, n, minus),
        "kinetic_friction": (F, v, n, minus),
        "incline_acceleration": (0.1, minus, minus, G),
        "friction_impulse": (v, 1.0, 1.0, minus),
        "pyramid_impulse": (v, 1.0, 1.0, minus, t_1, t_1),
        "particle_contact_impulse": (v, n, 1.0, 0.0, minus),
        "sliding_step": (lesson.driven_acceleration, 0.0, still, still, 0.1, bad_block),
        "event_step": (lesson.driven_acceleration, 0.0, still, still, 0.1, bad_block),
        "advance_particle": (
            lesson.contact_step,
            lesson.falling_acceleration,
            lesson.particle_plane_gap,
            0.0,
            still,
            still,
            0.1,
            1,
            bad_particle,
        ),
    }
    refused = sum(refuses(getattr(lesson, name), arguments, "-0.3") for name, arguments in asked.items())
    return [finding(
        claim="A negative coefficient of friction is refused, and the message gives its value.",
        quantity="functions that name μ = −0.3 in their error [of 9]",
        predicted=len(asked),
        measured=refused,
        tolerance=0.0,
        observation=f"{refused} of {len(asked)} functions refuse μ = −0.3 with a message that contains it.",
    )]


def slopes_without_and_with_infinite_friction(lesson):
    """Release a block on slopes with μ = ∞ and with μ = 0."""
    found = []
    for step in ("sliding_step", "event_step", "position_friction_step"):
        got = moved(lesson, step, 89.9, np.inf, np.inf)
        found.append(finding(
            claim="Infinite friction holds on any slope short of the vertical.",
            quantity=f"{LABEL[step]}: distance in one second at 89.9°, μ = ∞ [m]",
            predicted=0.0,
            measured=got,
            tolerance=WAY,
            observation=f"With μ = ∞ the {LABEL[step]} step moves {got:g} m at 89.9°.",
        ))
    for step in ("sliding_step", "position_friction_step"):
        got, dt, steps = moved(lesson, step, 30.0, 0.0, 0.0), 0.02, 50
        bound = 0.5 * G * np.sin(np.radians(30.0)) * steps * dt * (steps + 1) * dt
        found.append(finding(
            claim="Without friction a block slides down with g sin θ.",
            quantity=f"{LABEL[step]}: distance in one second at 30°, μ = 0 [m]",
            predicted=bound,
            measured=got,
            tolerance=ROUND_OFF,
            observation=(f"With μ = 0 the {LABEL[step]} step goes {got:.6f} m, as symplectic Euler does: g sin θ t (t "
                         "+ dt)/2."),
        ))
    return found


def infinite_friction_stops_at_once(lesson):
    """Take one step of a block at 10⁶ m/s."""
    still = np.zeros(2)
    fast = np.array([1e6, 0.0])
    _, v = lesson.sliding_step(lesson.driven_acceleration, 0.0, still, fast, 1e-3, slope(0.0, np.inf, np.inf))
    return [finding(
        claim="Infinite friction stops a block within one step, and the result is finite.",
        quantity="speed one step after 10⁶ m/s, μ = ∞ [m/s]",
        predicted=0.0,
        measured=np.abs(v).max(),
        tolerance=0.0,
        observation=f"One step after 10⁶ m/s on μ = ∞ the speed is {np.abs(v).max():g} m/s.",
    )]


@case("extreme-coefficients", "Extreme friction", compiled=False)
def extreme_coefficients(lesson):
    """Extremes: no friction, infinite friction, no load, a fast launch, and a negative μ that must be refused by name.

    A block with μ = ∞ holds at 89.9° and stops from 10⁶ m/s within one step.  With μ = 0 it slides down with g sin θ.
    """
    found = negative_friction_is_refused(lesson) + slopes_without_and_with_infinite_friction(lesson)
    found += infinite_friction_stops_at_once(lesson)
    exponents, n = np.linspace(-3.0, 6.0, 10), np.array([0.0, 1.0])
    after = [
        np.linalg.norm(lesson.particle_contact_impulse(10.0**y * np.array([1.0, -1.0]), n, 1.0, 0.5, 0.4)) / 10.0**y
        for y in exponents
    ]
    return found, Picture(
        "The same impact at any speed",
        "log₁₀ of the speed [m/s]",
        "impulse over m v [-]",
        [
            series("theory", exponents, np.full(10, 1.5 * np.hypot(1.0, 0.4)), LINE),
            series("contact, measured", exponents, after, DOTS),
        ],
        "From a millimetre to a thousand kilometres per second: Coulomb's law has no characteristic speed.",
    )


# ---------------------------------------------------------------------------------------------- each law by itself

TRIED = 50                   # random bodies and forces [-]


def nearest_in_disc(y, radius):
    """Return the point of the disc |y| ≤ radius that is nearest to y."""
    size = np.linalg.norm(y)
    return y if size <= radius else radius / size * y


def frame(rng):
    """Return three random unit vectors at right angles."""
    return np.linalg.qr(rng.normal(size=(3, 3)))[0].T


def nearest_in_square(y, side):
    """Return the point of the square |y_1| ≤ side, |y_2| ≤ side in the plane z = 0 that is nearest to y."""
    return np.clip(y * [1.0, 1.0, 0.0], -side, side)


def particle_after(law, p, friction_of_positions, t, x, v, dt, steps):
    """Return (x, v) after steps of a particle on a plane: free, then out along the normal, rebound, and friction."""
    for k in range(steps):
        v = v + dt * law(t + k * dt)
        x, fall, slip = x + dt * v, -(v @ p.n), v - (v @ p.n) * p.n
        depth = -((x - p.point) @ p.n)
        if depth > 0.0:
            x = x + depth * p.n
            if fall > 0.0:
                v = slip + nearest_in_disc(-slip, p.mu * (1.0 + p.e) * fall) + p.e * fall * p.n
                x = x + friction_of_positions * nearest_in_disc(-dt * slip, p.mu * depth)
    return x, v


@case("laws-of-friction", "Each law of friction by itself", compiled=False)
def laws_of_friction(lesson):
    """The cone, the pyramid, a slope, a block and a particle, with masses, restitution, and μ_s above μ_k."""
    rng = np.random.default_rng(31)
    worst = Worst()

    for _ in range(TRIED):
        n, t_1, t_2 = frame(rng)
        m, load, j_n, (mu_k, more) = *rng.uniform(0.5, 2.0, 3), rng.uniform(0.1, 0.6, 2)
        mu_s, slip = mu_k + more, rng.normal() * t_1 + rng.normal() * t_2

        # forces of a support, pressed on with `load` and lifted by it
        for away in (-1.0, 1.0):
            F_N = max(0.0, -away * load)
            for share in (0.95, 1.05):                          # of what static friction can hold
                F = away * load * n + share * mu_s * load * t_1
                worst.note("normal", lesson.normal_force(F, n), F_N)
                worst.note("static", lesson.static_friction(F, n, mu_s), -min(share * mu_s * load, mu_s * F_N) * t_1)
            v = slip + rng.normal() * n
            worst.note("kinetic", lesson.kinetic_friction(F, v, n, mu_k), -mu_k * F_N * slip / np.linalg.norm(slip))

        # impulses: what is nearest to −m v_t in the disc of radius μ j_n, or in the square
        for mu in np.array((0.5, 0.95, 1.05)) * m * np.linalg.norm(slip) / j_n:
            worst.note("cone", lesson.friction_impulse(slip, m, j_n, mu), nearest_in_disc(-m * slip, mu * j_n))
            sides = np.clip((-m * slip @ t_1, -m * slip @ t_2), -mu * j_n, mu * j_n)
            worst.note("pyramid", lesson.pyramid_impulse(slip, m, j_n, mu, t_1, t_2), sides[0] * t_1 + sides[1] * t_2)

        # a slope: it holds to μ_s, and from there on μ_k counts
        for steep, slides in ((0.99, 0.0), (1.01, 1.0)):
            theta, g = np.arctan(steep * mu_s), rng.uniform(1.0, 20.0)
            pull = slides * g * np.cos(theta) * (np.tan(theta) - mu_k)
            worst.note("slope", lesson.incline_acceleration(theta, mu_s, mu_k, g), pull)

        # a block on a plane that gravity presses on or lifts off; at rest it holds between the two μ
        dt = rng.uniform(0.01, 0.1)
        for away, share in ((-1.0, 0.99), (-1.0, 1.01), (1.0, 0.5)):
            a_n = max(0.0, -away * load)
            p = lesson.make_block(m * n, mu_s, mu_k, away * load * n + share * mu_s * load * t_1, np.zeros(3), 1.0)
            for start in (0.0 * slip, slip):
                free = start + dt * share * mu_s * load * t_1
                holds = not np.any(start) and share * mu_s * load <= mu_s * a_n
                end = 0.0 * slip if holds else free + nearest_in_disc(-free, mu_k * dt * a_n)
                x, v = lesson.sliding_step(lesson.driven_acceleration, 0.0, t_2, start, dt, p)
                worst.note("block", (x, v), np.array((t_2 + dt * end, end)))

        # a hollow: its distance and the derivative of that, for a bowl and for a trough along a slanting axis
        centre, x, radius = rng.normal(size=3), rng.normal(size=3), rng.uniform(3.0, 5.0)
        for axis in (np.zeros(3), t_1):
            p = ParticleInBowl(m, mu_k, 0.5, np.zeros(3), centre, axis, radius)

            def distance(x, centre=centre, axis=axis, radius=radius):
                r = x - centre - ((x - centre) @ axis) * axis
                return radius - np.sqrt(np.sum(r * r))

            slope_of = np.array([distance(x + 1e-20j * e).imag for e in np.eye(3)]) / 1e-20
            phi, normal = lesson.particle_bowl_gap(x, p)
            worst.note("hollow", (phi, *normal), (distance(x), *slope_of))

        # a particle that hits with m, e and μ: friction has the whole normal impulse, rebound included
        e, fall = rng.uniform(0.1, 0.9), 10.0 ** rng.uniform(-4.0, 0.0)
        for mu in np.array((0.5, 0.95, 1.05)) * np.linalg.norm(slip) / ((1.0 + e) * fall):
            J = lesson.particle_contact_impulse(slip - fall * n, n, m, e, mu)
            after = slip + nearest_in_disc(-slip, mu * (1.0 + e) * fall) + e * fall * n
            worst.note("particle", slip - fall * n + J / m, after)
            p = ParticleOnPlane(m, mu, e, np.zeros(3), centre, n)
            _, v = lesson.contact_step(lesson.falling_acceleration, lesson.particle_plane_gap, 0.0, centre,
                                       slip - fall * n, dt, p)
            worst.note("particle", v, after)
            depth, moved = dt * fall, dt * (slip - fall * n)
            shift = nearest_in_disc(-dt * slip, mu * depth)
            worst.note("shift", lesson.friction_position_correction(moved, n, depth, mu), shift)
            x, _ = lesson.position_friction_step(lesson.falling_acceleration, lesson.particle_plane_gap, 0.0, centre,
                                                 slip - fall * n, dt, p)
            worst.note("shift", x, centre + dt * slip + shift)

        # two steps under a force that changes: inside on the way in, inside on the way out, outside; then the pyramid
        t, still, swing = rng.uniform(), rng.normal(size=3), rng.normal(size=3)
        law = lambda t, still=still, swing=swing: still + np.cos(3.0 * t) * swing
        p = ParticleOnPlane(m, mu_k, e, still, centre, n)
        for gap, v_n in ((-0.2, -1.5), (-0.4, 1.5), (0.3, -1.5)):
            start = centre + slip + gap * n, slip + v_n * n
            for step, more in (("contact_step", 0.0), ("position_friction_step", 1.0)):
                got = lesson.advance_particle(getattr(lesson, step), lambda t, x, v, p, law=law: law(t),
                                              lesson.particle_plane_gap, t, *start, dt, 2, p)
                worst.note("steps", got, particle_after(law, p, more, t, *start, dt, 2))
        p = lesson.make_block((0.0, 0.0, 1.0), mu_s, mu_k, still - [0.0, 0.0, 5.0], swing, 3.0)
        free = slip * [1.0, 1.0, 0.0] + dt * law(t) * [1.0, 1.0, 0.0]
        end = free + nearest_in_square(-free, mu_k * dt * max(0.0, 5.0 - law(t)[2]))
        got = lesson.pyramid_step(lesson.driven_acceleration, t, centre, slip * [1.0, 1.0, 0.0], dt, p)
        worst.note("block", got, (centre + dt * end, end))
    # μ is up to 10⁴ where a particle hits slowly, which costs four digits
    claims = {
        "normal": ("A support pushes against a load, and does not hold what is pulled away.", "normal force [N]"),
        "static": ("Static friction holds to μ_s F_N, and equals that beyond.", "static friction [N]"),
        "kinetic": ("Kinetic friction is μ_k F_N against the slip, whatever its speed.", "kinetic friction [N]"),
        "cone": ("The impulse of the cone is the nearest to what stops the slip.", "impulse of the cone [N s]"),
        "pyramid": ("The impulse of the pyramid is the nearest along each side.", "impulse of the pyramid [N s]"),
        "slope": ("A slope holds below tan θ = μ_s; above, it pulls with g (sin θ − μ_k cos θ).",
                  "acceleration [m/s²]"),
        "block": ("A block holds by μ_s, slides by μ_k, and is free where it is lifted.",
                  "state of the block [m, m/s]"),
        "hollow": ("The normal of a bowl and of a trough is the derivative of the distance.",
                   "distance and normal [m, -]"),
        "particle": ("A particle rebounds by e, and slips by what μ (1 + e) leaves.", "velocity of the particle [m/s]"),
        "steps": ("Steps of a particle are one after the other, each under the force of its beginning.",
                  "state of the particle [m, m/s]"),
        "shift": ("The position slips back by μ times its depth at most.", "position [m]"),
    }
    return [agreement(claim, f"largest error of the {quantity}", worst[name], 1e-10)
            for name, (claim, quantity) in claims.items()], None


@case("times-of-stops-and-starts", "When a block stops and when it starts", compiled=False)
def stops_and_starts(lesson):
    """Constant forces: it stops after v/(μ_k a_n − a_t).  A periodic force breaks away where it passes μ_s a_n.

    A force that grows with time bends the speed: the step under kinetic friction is then the midpoint rule.
    """
    rng = np.random.default_rng(32)
    worst = Worst()
    for _ in range(TRIED):
        n, t_1, _ = frame(rng)
        load, speed, mu_k, more = rng.uniform(5.0, 15.0), rng.uniform(0.5, 2.0), *rng.uniform(0.1, 0.6, 2)
        mu_s, pull = mu_k + more, rng.uniform(-0.5, 0.9) * mu_k * load
        p = lesson.make_block(n, mu_s, mu_k, -load * n + pull * t_1, np.zeros(3), 1.0)
        after = speed / (mu_k * load - pull)
        for dt in (0.7 * after, 2.0 * after):
            tau, x, v = lesson.advance_to_event(lesson.driven_acceleration, 0.0, 0.0 * n, speed * t_1, dt, p)
            lasts = min(dt, after)
            end = speed - lasts * (mu_k * load - pull) if dt < after else 0.0
            truth = lasts, *((speed * lasts - 0.5 * (mu_k * load - pull) * lasts**2) * t_1), *(end * t_1)
            worst.keep("stops", np.max(np.abs(np.array((tau, *x, *v)) - truth)))
            if dt > after and np.any(v):                        # a stop is a stop: round-off would count as motion
                worst["stops"] = np.inf

        # −drive sin ωt, from 0 on, passes μ_s a_n at ωt = π/6; a_n = load + press sin ωt
        press, omega, begin = rng.uniform(0.1, 0.5) * load, rng.uniform(1.0, 3.0), np.arccos(0.5)
        drive = 2.0 * mu_s * load + mu_s * press
        for sign in (-1.0, 1.0):
            p = lesson.make_block(n, mu_s, mu_k, -load * n, sign * drive * t_1 + press * n, omega)
            at = 0.5 * np.pi / omega
            tau, x, _ = lesson.advance_to_event(lesson.driven_acceleration, at, n, 0.0 * n, 1.0 / omega, p)
            worst.keep("starts", abs(tau - (0.5 * np.pi - begin) / omega), np.max(np.abs(x - n)))
            d = lesson.slip_direction(lesson.driven_acceleration, at + 1.01 * tau, n, 0.0 * n, p)
            worst.keep("starts", np.max(np.abs(d + sign * t_1)))

        dt, t = rng.uniform(0.05, 0.2), rng.uniform(0.0, 1.0)
        x, v = lesson.kinetic_friction_step(lesson.driven_acceleration, t, 0.0 * n, speed * t_1, dt, t_1, p)
        force = lambda t, p=p, load=load, mu_k=mu_k, t_1=t_1, press=press: (
            p.drive @ t_1 * np.cos(p.omega * t) - mu_k * (load - press * np.cos(p.omega * t)))
        mean = speed + 0.5 * dt * force(t)
        truth = np.array((dt * mean * t_1, (speed + dt * force(t + 0.5 * dt)) * t_1))
        worst.keep("midpoint", np.max(np.abs(np.array((x, v)) - truth)))

        # it stops and slides back at once, where static friction does not hold; without load and pull it stays
        p = lesson.make_block(n, mu_s, mu_k, -load * n - 1.2 * mu_s * load * t_1, np.zeros(3), 1.0)
        after = speed / ((mu_k + 1.2 * mu_s) * load)
        ours = lesson.slip_times(lesson.driven_acceleration, t, 0.0 * n, speed * t_1, 0.7 * after, 3, p)
        truth = np.array(((t, t + after), (t + after, t + 2.1 * after)))
        worst.keep("slips", np.max(np.abs(ours - truth)) if ours.shape == truth.shape else np.inf)
        p = lesson.make_block(n, mu_s, mu_k, 0.0 * n, 0.0 * n, 1.0)
        worst.keep("slips", np.max(np.abs(lesson.slip_direction(lesson.driven_acceleration, t, n, 0.0 * n, p))))
    return [agreement("Under constant forces a block stops after v/(μ_k a_n − a_t), completely.",
                      "time, place and velocity of a stop: largest error [s, m, m/s]", worst["stops"], 1e-9),
            agreement("A block breaks away where the force passes μ_s a_n, to the side of the force.",
                      "time of a start: largest error [s]", worst["starts"], 1e-9),
            agreement("A block that static friction does not hold slides back at once, in a slip of its own.",
                      "times of slips: largest error [s]", worst["slips"], 1e-9),
            agreement("Between events its motion is that of the midpoint rule.",
                      "state after a step: largest error [m, m/s]", worst["midpoint"], 1e-9)], None

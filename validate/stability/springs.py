"""Forces of lesson 2 that no scene runs, in cases where each of their terms matters.

A force is compared with the derivative of its energy, taken by a step along the imaginary axis, which has no
noticeable truncation error.  *Source:* Squire and Trapp 1998 for that derivative.
"""

import numpy as np

from validate.stability.case import case

EARTH, RADIUS, GM = 5.9722e24, 6.371e6, 3.986004418e14    # mass [kg], mean radius [m], G times the mass [m³/s²]
G_SI = 6.67430e-11                                        # CODATA 2018 [m³/(kg s²)]
IMAGINARY = 1e-20                                         # step of the derivative [m]
NEARLY = 1e-6                                             # a gap that is still open [m]
CASES = 50                                                # random configurations of each force
ROUNDED = 1e-12                                           # of a few dozen roundings of 1.1e-16, relative


def gradient(energy, x):
    """Return ∇U at x (d,): the imaginary part of U(x + ih eₖ) over h."""
    steps = IMAGINARY * 1j * np.eye(len(x))
    return np.array([energy(x + step).imag for step in steps]) / IMAGINARY


def length(r):
    """Return |r|, also of complex vectors: √Σ r², without conjugates."""
    return np.sqrt(np.sum(r * r))


def gravity_error(lesson, rng):
    """Return the relative error of Newton's attraction at two random places, from U = −G m_a m_b/r."""
    x_a, x_b, (m_a, m_b, G) = rng.normal(size=3), 3.0 + rng.normal(size=3), rng.uniform(0.5, 2.0, 3)
    truth = -gradient(lambda x: -G * m_a * m_b / length(x_b - x), x_a)
    return length(lesson.universal_gravity(x_a, x_b, m_a, m_b, G) - truth) / length(truth)


def constraint_errors(lesson, rng):
    """Return {name: relative error} of soft constraints and contacts on a random sphere, from U = ½k C²."""
    centre, x, v = rng.normal(size=3), rng.normal(size=3), rng.normal(size=3)
    R, k, k_d = rng.uniform(0.5, 2.0, 3)
    surface = lambda x: length(x - centre) - R
    C, slope = surface(x), gradient(surface, x)
    rate = slope @ v
    pull = -gradient(lambda x: 0.5 * k * surface(x) ** 2, x)
    power = lesson.soft_constraint_force(C, rate, slope, k, k_d) @ v
    deep, slow = -abs(C), 0.5 * k * abs(C) / k_d                 # the damper alone would pull from 2 `slow` on
    contact = lambda C, rate: lesson.soft_contact_force(C, rate, slope, k, k_d)
    return {
        "soft": length(lesson.soft_constraint_force(C, 0.0, slope, k, k_d) - pull) / (k * abs(C)),
        "power": abs(power - pull @ v + k_d * rate**2) / (k * abs(C * rate) + k_d * rate**2),
        "contact": length(contact(deep, slow) - 0.5 * k * abs(C) * slope) / (k * abs(C)),
        "free": np.max([*(length(contact(gap, -10.0 * slow)) for gap in (abs(C), NEARLY, 0.0)),
                        length(contact(deep, 3.0 * slow))]),
    }


@case("forces", "Forces are derivatives of energies", compiled=False)
def forces(lesson, check):
    """Compare forces with derivatives of energies: U = −G m_a m_b/r for gravity, U = ½k C² for a soft constraint.

    The damper of the constraint takes k_d Ċ² of power.
    """
    rng = np.random.default_rng(21)
    errors = [{"gravity": gravity_error(lesson, rng), **constraint_errors(lesson, rng)} for _ in range(CASES)]
    for name, claim in (
            ("gravity", "Newton's attraction is the derivative of −G m_a m_b/r."),
            ("soft", "A soft constraint without damper is the derivative of ½k C²."),
            ("power", "Its damper takes the power k_d Ċ²."),
            ("contact", "A soft contact pushes with −(k C + k_d Ċ) as long as that is a push."),
            ("free", "A soft contact neither pulls nor acts at a distance.")):
        check.agree(claim, f"{name}: largest error [-]", np.max([one[name] for one in errors]), ROUNDED)
    weight = lesson.universal_gravity(np.zeros(3), np.array([0.0, 0.0, -RADIUS]), 1.0, EARTH, G_SI)
    # G is known to 2.2e-5, and so is the mass of the Earth; their product is known to 2e-9.
    check.agree("Near the ground a kilogram weighs GM/R².", "weight of a kilogram: relative error [-]",
                length(weight - np.array([0.0, 0.0, -GM / RADIUS**2])) / (GM / RADIUS**2), 5e-5)


@case("lecture-step", "The lecture's step of a mass-spring-damper system", compiled=False)
def lecture_step(lesson, check):
    """Compare the lecture's step with a computation by hand: v += dt a,  x += dt (v_old + v_new)/2.

    Two masses are on a line with a fixed end.
    a₁ = g + (wind − k_v v₁ − T₁ + T₂)/m₁,  a₂ = g + (wind − k_v v₂ − T₂)/m₂,  T = k (l − rest) + k_d l̇.
    """
    rng, worst = np.random.default_rng(22), 0.0
    for _ in range(CASES):
        y = np.cumsum(rng.uniform(0.5, 1.5, 3))                  # the first one is fixed
        v, m, (k, k_d, k_v, g, wind, dt) = rng.normal(size=3) * [0.0, 1.0, 1.0], rng.uniform(0.5, 2.0, 3), \
            rng.uniform(0.1, 1.0, 6)
        rest = np.diff(np.cumsum(rng.uniform(0.5, 1.5, 3)))
        stretched = np.stack((np.zeros(3), np.append(0.0, np.cumsum(rest))), axis=1)
        network = lesson.make_spring_network(stretched, m, [0], [(0, 1), (1, 2)], k, k_d, (0.0, g), (0.0, wind), k_v)
        x, xv = np.stack((np.zeros(3), y), axis=1), np.stack((np.zeros(3), v), axis=1)
        T = k * (np.diff(y) - rest) + k_d * np.diff(v)
        a = np.array([0.0, g + (wind - k_v * v[1] - T[0] + T[1]) / m[1], g + (wind - k_v * v[2] - T[1]) / m[2]])
        v_new = v + dt * a
        got_x, got_v = lesson.mass_spring_damper_step(0.3, x, xv, dt, network)
        truth = np.concatenate((y + 0.5 * dt * (v + v_new), v_new))
        got = np.concatenate((got_x[:, 1], got_v[:, 1]))
        worst = np.maximum(worst, np.max(np.abs(got - truth)) / np.max(np.abs(truth)))
    claim = "The lecture's step adds gravity, wind, drag, springs and dampers, and moves with the mean velocity."
    check.agree(claim, "state after a step: largest relative error [-]", worst, ROUNDED)


def angle_between(r_a, r_c):
    """Return the angle from r_a to r_c, also of complex vectors: arctan has a derivative there, arctan2 has none."""
    across, along = r_a[0] * r_c[1] - r_a[1] * r_c[0], r_a @ r_c
    return np.arctan(across / along) + (0.0 if along.real > 0.0 else np.copysign(np.pi, across.real))


@case("angular-spring-forces", "An angular spring with unequal arms", compiled=False)
def angular_spring(lesson, check):
    """Compare an angular spring with U = ½k(θ − rest)² for arms of any length, any angle and any rest angle.

    θ − rest is within half a turn.
    """
    rng, worst, force, moment = np.random.default_rng(23), 0.0, 0.0, 0.0
    for _ in range(CASES):
        places, angle, k = rng.normal(size=6), rng.uniform(-np.pi, np.pi), rng.uniform(0.5, 2.0)
        for mirror in (1.0, -1.0):                               # past half a turn on either side
            x, rest = places * np.tile((1.0, mirror), 3), mirror * angle

            def energy(x, rest=rest, k=k):
                turn = angle_between(x[:2] - x[2:4], x[4:] - x[2:4]) - rest
                return 0.5 * k * (turn - 2.0 * np.pi * np.round(turn.real / (2.0 * np.pi))) ** 2

            truth = -gradient(energy, x).reshape(3, 2)
            F = np.array(lesson.angular_spring_forces(x[:2], x[2:4], x[4:], rest, k))
            largest = np.max(np.abs(F))
            worst = np.maximum(worst, np.max(np.abs(F - truth)) / np.max(np.abs(truth)))
            force = np.maximum(force, np.max(np.abs(F.sum(axis=0))) / largest)
            moment = np.maximum(moment, abs(np.sum(x[::2] * F[:, 1] - x[1::2] * F[:, 0])) / largest)
    check.agree("The forces on both ends and on the hinge are the derivative of ½k(θ − rest)².",
                "forces: largest relative error [-]", worst, 1e-10)
    check.agree("They add up to zero.", "sum of the forces over the largest [-]", force, ROUNDED)
    check.agree("They have no moment.", "sum of the moments over the largest force [m]", moment, ROUNDED)


def convex_stiffness(r, k, rest):
    """Return (force, positive part of −∂F/∂r) of a spring along r (3,), by derivatives along the imaginary axis."""
    push = lambda r: k * (length(r) - rest) * r / length(r)
    hessian = np.array([push(r + IMAGINARY * 1j * e).imag for e in np.eye(3)]) / IMAGINARY
    values, axes = np.linalg.eigh(hessian)
    return push(r), axes * np.maximum(values, 0.0) @ axes.T


def dense_net(x, v, pairs, k, k_d, rest):
    """Return (K (d, d), D (d, d), F (n, 3), blocks (s, 3, 3)) of a net, d = 3n: −∂F/∂x, −∂F/∂v, forces, parts of K."""
    n = len(x)
    K, D, F, blocks = np.zeros((3 * n, 3 * n)), np.zeros((3 * n, 3 * n)), np.zeros((n, 3)), []
    for s, (i, j) in enumerate(pairs):
        r, u = x[j] - x[i], v[j] - v[i]
        push, positive = convex_stiffness(r, k[s], rest[s])
        along = r / length(r)
        ends = np.kron(np.eye(n)[i] - np.eye(n)[j], np.eye(3))
        K += ends.T @ positive @ ends
        D += ends.T @ (k_d[s] * np.outer(along, along)) @ ends
        F[i] += push + k_d[s] * (u @ along) * along
        F[j] -= push + k_d[s] * (u @ along) * along
        blocks.append(positive)
    return K, D, F, np.array(blocks)


@case("large-step", "The linearly implicit step of a mesh", compiled=False)
def large_step(lesson, check):
    """Compare the large step with (M + h k_v − h ∂F/∂v − h² ∂F/∂x) Δv = h (M a + h ∂F/∂x v), solved densely.

    The derivatives are those of energies.  ∂F/∂x of a compressed spring has a sideways push, which the method
    leaves out: it keeps the positive part of K.
    """
    rng, stiffness, steps = np.random.default_rng(24), 0.0, 0.0
    pairs = np.array([(0, 1), (1, 2), (2, 3), (3, 0), (0, 2), (1, 4), (3, 4)])
    for _ in range(CASES // 5):
        x, v, m = rng.normal(size=(5, 3)), rng.normal(size=(5, 3)), rng.uniform(0.5, 2.0, 5)
        k, k_d, rest = rng.uniform(50.0, 200.0, 7), rng.uniform(0.5, 2.0, 7), rng.uniform(0.5, 2.0, 7)
        gravity, wind, k_v, h = rng.normal(size=3), rng.normal(size=3), rng.uniform(0.1, 1.0), rng.uniform(0.05, 0.2)
        v[0] = 0.0
        network = lesson.make_spring_network(x, m, [0], pairs, k, k_d, gravity, wind, k_v)._replace(rest=rest)
        K, D, F, positive = dense_net(x, v, pairs, k, k_d, rest)
        blocks = np.array(lesson.spring_stiffness(x, network)[0])
        stiffness = np.maximum(stiffness, np.max(np.abs(blocks - positive) / k[:, None, None]))
        M, free = np.repeat(m, 3), np.repeat(np.arange(5) > 0, 3)
        right = h * (M * np.tile(gravity, 5) + (F + wind - k_v * v).ravel() - h * K @ v.ravel())
        A = np.diag(M + h * k_v) + h * D + h * h * K
        v_new = v.ravel().copy()
        v_new[free] += np.linalg.solve(A[np.ix_(free, free)], right[free])
        got_x, got_v = lesson.implicit_spring_network_step(lesson.spring_network_acceleration, 0.0, x, v, h, network)
        truth = np.concatenate((x.ravel() + h * v_new, v_new))
        steps = np.maximum(steps, np.max(np.abs(np.concatenate((got_x.ravel(), got_v.ravel())) - truth)))
    # conjugate gradients end at 1e-10 of the right-hand side; A has a condition below 1e3
    check.agree("The stiffness of a spring is the positive part of the second derivative of its energy.",
                "blocks of K over k: largest error [-]", stiffness, 1e-10)
    check.agree("A large step solves the linearised equations of all points together.",
                "state after a step: largest error [m, m/s]", steps, 1e-6)


@case("hand", "A hand that pulls a point", compiled=False)
def hand(lesson, check):
    """Compare steps under the force of the hand with y⁺ = (1 − h B)⁻¹ y: implicit Euler of a damped oscillator.

    B = [[0, 1], [−k/m, −c/m]] acts on the way from the target and on the velocity.  An explicit damper would be stable
    only for h c/m < 2, and here h c/m reaches 1e6.
    """
    rng, worst = np.random.default_rng(27), 0.0
    for _ in range(CASES):
        m, h = 10.0 ** rng.uniform(-3.0, 1.0), rng.uniform(1e-3, 0.1)
        k, c = m / h**2 * 10.0 ** rng.uniform(-2.0, 6.0), m / h * 10.0 ** rng.uniform(-2.0, 6.0)
        x, v, target = rng.normal(size=(3, 2))
        B = np.array(((0.0, 1.0), (-k / m, -c / m)))
        _, truth = np.linalg.solve(np.eye(2) - h * B, (x - target, v))
        got = v + h / m * lesson.hand_force(x, v, target, k, c, m, h)
        worst = np.maximum(worst, np.max(np.abs(got - truth)) / (length(v) + length(x - target) / h))
    check.agree("The hand takes one step of implicit Euler, however stiff it is.",
                "velocity after a step: largest error over |v| + |x − target|/h [-]", worst, 5e-15)


@case("grids", "Springs of a grid", compiled=False)
def grids(lesson, check):
    """Count all pairs of nodes that are joined: their rows and columns differ by an offset."""
    wrong = 0
    for rows, cols in ((1, 1), (1, 4), (3, 2), (4, 5)):
        place = [divmod(k, cols) for k in range(rows * cols)]
        for offsets in (lesson.STRUCTURAL, lesson.SHEAR, lesson.BEND, lesson.STRUCTURAL + lesson.SHEAR + lesson.BEND,
                        ((-1, 0), (-2, 1))):
            truth = sorted((i, j) for i, (r, c) in enumerate(place) for j, (s, d) in enumerate(place)
                           if (s - r, d - c) in offsets)
            wrong += sorted(map(tuple, lesson.grid_pairs(rows, cols, offsets).tolist())) != truth
    lengths = [np.hypot(*offset) for offset in lesson.STRUCTURAL + lesson.SHEAR + lesson.BEND]
    found = abs(sum(lengths) - (2.0 + 2.0 * np.sqrt(2.0) + 4.0))           # 1, 1, √2, √2, 2, 2
    drawn = lesson.randomised(8.0, 0.25, np.array([0.0, 0.5, 1.0])) - np.array([6.0, 8.0, 10.0])
    check.agree("A grid joins the nodes whose rows and columns differ by an offset, and no others.",
                "grids with other pairs [of 20]", wrong, 0.0)
    check.agree("Threads are 1, diagonals √2 and every second node 2 apart.", "sum of the offsets: error [-]",
                found, ROUNDED)
    check.agree("A quantity that is drawn at random is uniformly distributed about its value.",
                "least, middle and largest draw: error [N/m]", np.max(np.abs(drawn)), ROUNDED)


# ---------------------------------------------------------------------------------------------- stiff cloth

TILT, G = 0.5, 9.81          # of the slope [rad]; gravity [m/s²]
STIFF = (1e2, 1e5, 1e8)      # of threads between points of 10 g [N/m]
FRAME, FRAMES = 1.0 / 60.0, 60           # a step [s], and their number
STRAIN, MASS = 0.01, 0.01    # of all threads at the start [-]; of a point [kg]


def slid(lesson, step, k):
    """Return (x, v, strains) of a stretched cloth of 4 by 4 points after a second on a slope without friction.

    y is the normal of the slope.  After each step the slope pushes points below it out, and stops the velocity into it.
    """
    grid = 0.1 * np.stack((np.tile(np.arange(4.0), 4), np.zeros(16), np.repeat(np.arange(4.0), 4)), axis=1)
    pairs = lesson.grid_pairs(4, 4, lesson.STRUCTURAL + lesson.SHEAR)
    cloth = lesson.make_spring_network(grid, MASS, [], pairs, k, 0.0, (G * np.sin(TILT), -G * np.cos(TILT), 0.0),
                                       np.zeros(3), 0.0)
    x, v = (1.0 + STRAIN) * (grid - grid.mean(axis=0)), 0.0 * grid
    for n in range(FRAMES):
        x, v = step(lesson.spring_network_acceleration, n * FRAME, x, v, FRAME, cloth)
        x[:, 1], v[:, 1] = np.maximum(x[:, 1], 0.0), np.where(x[:, 1] < 0.0, 0.0, v[:, 1])
    return x, v, lengths(x, cloth) / cloth.rest - 1.0


def explicit(acceleration, t, x, v, dt, network):
    """Take a step of symplectic Euler."""
    v = v + dt * acceleration(t, x, v, network)
    return x + dt * v, v


def lengths(x, network):
    """Return the lengths of all springs [m]."""
    return np.linalg.norm(x[network.j] - x[network.i], axis=1)


@case("stiff-cloth-on-a-slope", "A stiff cloth on a slope, in steps of a sixtieth of a second", compiled=False)
def stiff_cloth_on_a_slope(lesson, check):
    """Check that a cloth slides by ½ g sin θ t (t + dt) for any stiffness of its threads, and loses their strain.

    A translation strains no thread, so the cloth moves as one point does by symplectic Euler.  Implicit Euler
    multiplies an oscillation by (1 + (ω dt)²)^(−1/2) per step, and the slowest one has ω² = (2 − √2) k/m, that of
    four points in a row.  Symplectic Euler is stable for ω dt < 2 only.  The fastest ω² is above (2 + √2) k/m,
    which is too fast for all three cloths.  Conjugate gradients end at 1e-10 of the right-hand side.
    """
    t = FRAME * FRAMES
    way, exploded = 0.5 * G * np.sin(TILT) * t * (t + FRAME), 0
    for k in STIFF:
        x, _, strain = slid(lesson, lesson.implicit_spring_network_step, k)
        left = STRAIN * (1.0 + (2.0 - np.sqrt(2.0)) * k / MASS * FRAME**2) ** (-0.5 * FRAMES)
        check.agree("A cloth slides like a point, for any stiffness.",
                    f"way of the centre in 1 s less ½ g sin θ t (t + dt), k = {k:g} N/m [m]",
                    abs(x[:, 0].mean() - way) + np.max(np.abs(x[:, 1])), 1e-10 * way)
        check.agree("A large step removes the strain of stiff threads.",
                    f"largest strain after 1 s, k = {k:g} N/m [-]", np.max(np.abs(strain)), left + ROUNDED)
        with np.errstate(all="ignore"):
            exploded += not np.max(np.abs(slid(lesson, explicit, k)[2])) < 1.0
    check("With explicit steps of this length every one of these cloths diverges.",
          "cloths that symplectic Euler strains by more than 1 [of 3]", law=len(STIFF), found=exploded, within=0.0,
          saw=f"{exploded} of {len(STIFF)} cloths diverge.")


@case("sag", "Sag of a chain, and a body of one's own", compiled=False)
def sag(lesson, check):
    """Compare the predicted sag with the solution of the equations of balance, and weigh a body of one's own."""
    for n in (1, 5, 20):
        balance = 40.0 * (2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1))
        balance[-1, -1] = 40.0
        law, found = np.linalg.solve(balance, np.full(n, 0.02 * 9.81))[-1], lesson.chain_sag(n, 0.02, 40.0, 9.81)
        check("A chain sags by the loads of all its springs.", f"sag of {n} points [m]", law=law, found=found,
              within=1e-12 * law, saw=f"{n} points of 20 g sag by {found:.4g} m.")
    x, pairs, _ = lesson.my_body(0.4)
    rows = np.zeros((len(pairs), *np.shape(x)))
    for row, (i, j) in zip(rows, pairs, strict=True):
        row[i], row[j] = x[i] - x[j], x[j] - x[i]
    free = np.size(x) - np.linalg.matrix_rank(rows.reshape(len(pairs), -1))
    check("A body of one's own moves without a change of its springs in three ways, as a rigid body does.",
          "motions that change no spring [-]", law=3, found=free, within=0.0, saw=f"There are {free} of them.")

"""Lesson 10: stale velocities, forgotten bodies, floors that stand still, events that come too late."""

import numpy as np

from solutions import simulator as worked
from solutions.rotation import rotation_matrix
from solutions.support.broad_phase import Pairs

from . import collection

wrong, right, edit, MUTANTS = collection(worked)


def edits(numbers, *rows):
    """A wrong answer to each of these exercises for each row: what is wrong, the right text, the wrong text."""
    for number in numbers.split():
        for row in rows:
            edit(number, *row)


# 10.1 and 10.2 --------------------------------------------------------------------------------------------------
@right("10.1", "body by body")
def new_velocities_2d(load, t, x, q, v, omega, dt, p):
    F, tau = load(t, x, q, v, omega, p)
    v, omega = v.copy(), omega.copy()
    for i in range(len(v)):
        v[i] += dt * p.inv_mass[i] * F[i]
        omega[i] += dt * p.inv_inertia[i] * tau[i]
    return v, omega


@right("10.2", "in body coordinates")
def new_velocities(load, t, x, q, v, omega, dt, p):
    F, tau = load(t, x, q, v, omega, p)
    omega = omega.copy()
    for i in np.flatnonzero(np.all(p.inv_inertia > 0.0, axis=1)):
        R, I = rotation_matrix(q[i]), 1.0 / p.inv_inertia[i]
        w = R.T @ omega[i]
        omega[i] += dt * R @ ((R.T @ tau[i] - np.cross(w, I * w)) / I)
    return v + (dt * p.inv_mass * F.T).T, omega


FORCE, LOADS = "v + dt * p.inv_mass[:, None] * F", "load(t, x, q, v, omega, p)"
edits("10.1 10.2",
      ("evaluates the load at time 0", "load(t, x", "load(0.0, x"),
      ("evaluates the load at t + dt", "load(t, x", "load(t + dt, x"),
      ("evaluates the load at time dt", "load(t, x", "load(dt, x"),
      ("evaluates the load at the next positions", "load(t, x,", "load(t, x + dt * v,"),
      ("evaluates the load for bodies at rest", "v, omega, p)", "0.0 * v, 0.0 * omega, p)"),
      ("exchanges x and v in the call of the load", LOADS, "load(t, v, q, x, omega, p)"),
      ("uses the weight in place of the load", "load(t, x", "weight(t, x"),
      ("uses gravity in place of the forces", "p.inv_mass[:, None] * F", "p.gravity"),
      ("adds gravity to the forces of the load", "p.inv_mass[:, None] * F", "(p.inv_mass[:, None] * F + p.gravity)"),
      ("forgets dt beside the force", "v + dt * p.inv_mass", "v + p.inv_mass"),
      ("has dt twice beside the force", "v + dt * p.inv_mass", "v + dt * dt * p.inv_mass"),
      ("uses half of dt beside the force", "v + dt * p.inv_mass", "v + 0.5 * dt * p.inv_mass"),
      ("subtracts the force", "v + dt * p.inv_mass", "v - dt * p.inv_mass"),
      ("divides by the inverse mass", "p.inv_mass[:, None] * F", "F / p.inv_mass[:, None]"),
      ("forgets the mass", "dt * p.inv_mass[:, None] * F", "dt * F * (p.inv_mass[:, None] > 0.0)"),
      ("omits the inverse mass: forces move immovable rows, too", "dt * p.inv_mass[:, None] * F", "dt * F"),
      ("multiplies by the mass in place of its inverse", "p.inv_mass[:, None] * F",
       "np.where(p.inv_mass > 0.0, 1.0 / np.maximum(p.inv_mass, 1e-300), 0.0)[:, None] * F"),
      ("moves immovable bodies", "p.inv_mass[:, None] * F", "np.maximum(p.inv_mass, 0.1)[:, None] * F"),
      ("uses the inverse mass of the first row for all", "p.inv_mass[:, None]", "p.inv_mass[0]"),
      ("uses the inverse inertia for the force", "p.inv_mass[:, None]", "p.inv_inertia.reshape(len(v), -1)[:, :1]"),
      ("does not change the velocity", FORCE, "v.copy()"),
      ("adds up the forces on all rows", "p.inv_mass[:, None] * F", "p.inv_mass[:, None] * F.sum(axis=0)"),
      ("stops rows of infinite mass", FORCE, f"np.where(p.inv_mass[:, None] > 0.0, {FORCE}, 0.0)"),
      ("omits the force on what cannot turn", FORCE,
       f"np.where(p.inv_inertia.reshape(len(v), -1)[:, :1] > 0.0, {FORCE}, v)"),
      ("changes its input in place", FORCE, "np.add(v, dt * p.inv_mass[:, None] * F, out=v)"),
      ("omits the load of the last row", LOADS, f"{LOADS}; F[-1], tau[-1] = 0.0, 0.0"),
      ("omits the load of the first row", LOADS, f"{LOADS}; F[0], tau[0] = 0.0, 0.0"),
      ("applies forces along the first axis only", LOADS, f"{LOADS}; F[:, 1:] = 0.0"),
      ("applies forces along the last axis only", LOADS, f"{LOADS}; F[:, :-1] = 0.0"),
      ("stops planes that move", LOADS,
       f"{LOADS}; n = len(p.half); v, omega = v.copy(), omega.copy(); v[n:], omega[n:] = 0.0, 0.0"),
      ("stops rows of infinite mass before it evaluates the load", f"F, tau = {LOADS}",
       f"v = np.where(p.inv_mass[:, None] > 0.0, v, 0.0); F, tau = {LOADS}"))

TORQUE = "omega + dt * p.inv_inertia * tau"
edits("10.1",
      ("returns the change of the velocity in place of the velocity", "v + dt * p.inv_mass", "dt * p.inv_mass"),
      ("evaluates the load for bodies that turn and do not move", "q, v, omega, p)", "q, 0.0 * v, omega, p)"),
      ("evaluates the load at the angle 0", "load(t, x, q", "load(t, x, 0.0 * q"),
      ("uses the mean of the inverse masses for all", "p.inv_mass[:, None]", "np.mean(p.inv_mass)"),
      ("omits the force on the last row", LOADS, f"{LOADS}; F[-1] = 0.0"),
      ("does not change the spin", TORQUE, "omega"),
      ("reverses the torque", "omega + dt *", "omega - dt *"),
      ("forgets dt beside the torque", "omega + dt * p", "omega + p"),
      ("has dt twice beside the torque", "omega + dt * p", "omega + dt * dt * p"),
      ("forgets dt beside force and torque", f"{FORCE}, omega + dt *", "v + p.inv_mass[:, None] * F, omega +"),
      ("uses half of dt beside force and torque", f"{FORCE}, omega + dt",
       f"{FORCE.replace('dt', '0.5 * dt')}, omega + 0.5 * dt"),
      ("divides by the inverse inertia", "p.inv_inertia * tau", "tau / p.inv_inertia"),
      ("divides by the inverses of both mass and inertia", f"{FORCE}, {TORQUE}",
       "v + dt * F / p.inv_mass[:, None], omega + dt * tau / p.inv_inertia"),
      ("divides by the inverses of mass and inertia where they are above 0", f"{FORCE}, {TORQUE}",
       "v + dt * np.where(p.inv_mass > 0.0, F.T / np.where(p.inv_mass > 0.0, p.inv_mass, 1.0), 0.0).T, "
       "omega + dt * np.where(p.inv_inertia > 0.0, tau / np.where(p.inv_inertia > 0.0, p.inv_inertia, 1.0), 0.0)"),
      ("omits the inverse inertia: torques turn all rows", "p.inv_inertia * tau", "tau"),
      ("multiplies by the inertia in place of its inverse", "p.inv_inertia * tau",
       "np.where(p.inv_inertia > 0.0, 1.0 / np.maximum(p.inv_inertia, 1e-300), 0.0) * tau"),
      ("exchanges force and torque: uses the inverse mass for the torque", "p.inv_inertia * tau", "p.inv_mass * tau"),
      ("uses the inverse inertia of the first row for all", "p.inv_inertia *", "p.inv_inertia[0] *"),
      ("stops rows of infinite inertia from turning", TORQUE, f"np.where(p.inv_inertia > 0.0, {TORQUE}, 0.0)"),
      ("stops rows of infinite mass from turning", TORQUE, f"np.where(p.inv_mass > 0.0, {TORQUE}, 0.0)"),
      ("omits the torque on rows of infinite mass", TORQUE, f"np.where(p.inv_mass > 0.0, {TORQUE}, omega)"),
      ("evaluates the torque with the new velocity", "p.inv_inertia * tau",
       f"p.inv_inertia * load(t, x, q, {FORCE}, omega, p)[1]"),
      ("evaluates the load at the next angles", "load(t, x, q,", "load(t, x, q + dt * omega,"),
      ("exchanges q and omega in the call of the load", LOADS, "load(t, x, omega, v, q, p)"),
      ("averages the loads at the beginning and the end", LOADS,
       f"{LOADS}; late = load(t + dt, x, q, {FORCE}, {TORQUE}, p); "
       "F, tau = 0.5 * (F + late[0]), 0.5 * (tau + late[1])"),
      ("adds the torque of the force about the origin", LOADS,
       f"{LOADS}; tau = tau + x[:, 0] * F[:, 1] - x[:, 1] * F[:, 0]"),
      ("ignores forces below 1e-6 N", LOADS, f"{LOADS}; F = np.where(np.abs(F) < 1e-6, 0.0, F)"),
      ("returns the changes only", f"{FORCE}, omega + dt", "dt * p.inv_mass[:, None] * F, dt"),
      ("returns accelerations", f"{FORCE}, omega + dt * p", "p.inv_mass[:, None] * F, p"),
      ("returns omega before v", f"{FORCE}, {TORQUE}", f"{TORQUE}, {FORCE}"))

TURN = "angular_acceleration(q[i], omega[i], tau[i], 1.0 / p.inv_inertia[i])"
ROTATE = "unrotate(q[i] * np.array([1.0, -1.0, -1.0, -1.0]), {})"       # from the body to the world
edits("10.2",
      ("reverses the torque", "omega[i], tau[i], 1.0", "omega[i], -tau[i], 1.0"),
      ("omits the gyroscopic term", "omega[i], tau[i], 1.0", "0.0 * omega[i], tau[i], 1.0"),
      ("reverses the gyroscopic term", TURN, f"(2.0 * {TURN.replace('omega[i]', '0.0 * omega[i]')} - {TURN})"),
      ("adds the gyroscopic term twice", TURN, f"(2.0 * {TURN} - {TURN.replace('omega[i]', '0.0 * omega[i]')})"),
      ("omits the torque", "omega[i], tau[i], 1.0", "omega[i], 0.0 * tau[i], 1.0"),
      ("multiplies the torque by the inverse inertia without changing to body axes", TURN, "p.inv_inertia[i] * tau[i]"),
      ("uses the inverse inertia in place of the inertia", "1.0 / p.inv_inertia[i]", "p.inv_inertia[i]"),
      ("uses the first moment of inertia for all axes", "1.0 / p.inv_inertia[i]",
       "1.0 / p.inv_inertia[i, 0] * np.ones(3)"),
      ("uses the mean moment of inertia for all axes", "1.0 / p.inv_inertia[i]",
       "np.mean(1.0 / p.inv_inertia[i]) * np.ones(3)"),
      ("uses the moments of inertia in reverse order", "1.0 / p.inv_inertia[i]", "1.0 / p.inv_inertia[i, ::-1]"),
      ("ignores the orientation", "(q[i],", "(np.array([1.0, 0.0, 0.0, 0.0]),"),
      ("uses the orientation of the first row for all", "(q[i],", "(q[0],"),
      ("uses the inverse orientation", "(q[i],", "(q[i] * np.array([1.0, -1.0, -1.0, -1.0]),"),
      ("uses the torque of the first row for all", "tau[i],", "tau[0],"),
      ("uses the inertia of the first row for all", "1.0 / p.inv_inertia[i]", "1.0 / p.inv_inertia[0]"),
      ("tests the mass in place of the inertia", "p.inv_inertia[i, 0] > 0.0", "p.inv_mass[i] > 0.0"),
      ("omits the torque on rows of infinite mass", "if p.inv", "if p.inv_mass[i] > 0.0 and p.inv"),
      ("omits the torque on heavy bodies", "p.inv_inertia[i, 0] > 0.0", "p.inv_inertia[i, 0] > 1e-3"),
      ("leaves out bodies without torque", "if p.inv", "if tau[i].any() and p.inv"),
      ("leaves out bodies that do not turn yet", "if p.inv", "if omega[i].any() and p.inv"),
      ("stops rows of infinite inertia from turning", "float_copy(omega)", "omega * (p.inv_inertia > 0.0)"),
      ("stops rows of infinite mass from turning", "return v, omega",
       "omega[p.inv_mass == 0.0] = 0.0; return v, omega"),
      ("ends at the first row that cannot turn", "if p.inv_inertia[i, 0] > 0.0:",
       "if p.inv_inertia[i, 0] == 0.0:\n            break\n        else:"),
      ("changes the spin of the first row only", "range(omega.shape[0])", "range(1)"),
      ("omits the spin of the last row", "range(omega.shape[0])", "range(omega.shape[0] - 1)"),
      ("omits the spin of the first row", "range(omega.shape[0])", "range(1, omega.shape[0])"),
      ("forgets dt beside the angular acceleration", "omega[i] + dt * angular", "omega[i] + angular"),
      ("has dt twice beside the angular acceleration", "omega[i] + dt * angular", "omega[i] + dt * dt * angular"),
      ("uses half of dt beside the angular acceleration", "omega[i] + dt * angular", "omega[i] + 0.5 * dt * angular"),
      ("subtracts the angular acceleration", "omega[i] + dt", "omega[i] - dt"),
      ("returns the angular acceleration in place of ω", "omega[i] = omega[i] + dt * angular",
       "omega[i] = dt * angular"),
      ("evaluates the torque with the new velocity", "for i in", "tau = load(t, x, q, v, omega, p)[1]\n    for i in"),
      ("adds the torque of the force about the origin", LOADS, f"{LOADS}; tau = tau + np.cross(x, F)"),
      ("takes the torque to be in body coordinates", " tau[i],", f" {ROTATE.format('tau[i]')},"),
      ("takes ω to be in body coordinates", "(q[i], omega[i], tau", "(q[i], unrotate(q[i], omega[i]), tau"),
      ("returns ω in body coordinates", f"omega[i] + dt * {TURN}", f"unrotate(q[i], omega[i] + dt * {TURN})"),
      ("evaluates the angular acceleration in the middle of the step", TURN,
       TURN.replace("omega[i]", f"omega[i] + 0.5 * dt * {TURN}")),
      ("averages the angular acceleration over the step", TURN,
       f"(0.5 * {TURN} + 0.5 * {TURN.replace('omega[i]', f'omega[i] + dt * {TURN}')})"),
      ("returns omega before v", "return v, omega", "return omega, v"))


edits("10.1 10.2",
      ("changes the forces that the load has returned", "p.inv_mass[:, None] * F",
       "np.multiply(p.inv_mass[:, None], F, out=F)"))
edits("10.1",
      ("changes the torques that the load has returned", "p.inv_inertia * tau",
       "np.multiply(p.inv_inertia, tau, out=tau)"),
      ("evaluates the load for bodies that do not turn", "q, v, omega, p)", "q, v, 0.0 * omega, p)"),
      ("evaluates the load in the middle of the step", "load(t, x", "load(t + 0.5 * dt, x"),
      ("multiplies the columns of two rows by their inverse masses", "p.inv_mass[:, None] * F",
       "(p.inv_mass if len(v) == 2 else p.inv_mass[:, None]) * F"))
edits("10.2",
      ("limits the spin to 10 rad/s in the gyroscopic term", "omega[i], tau[i], 1.0",
       "np.clip(omega[i], -10.0, 10.0), tau[i], 1.0"),
      ("uses the spin of the first row for all", "omega[i], tau[i], 1.0", "omega[0], tau[i], 1.0"),
      ("evaluates the load for bodies that do not turn", "q, v, omega, p)", "q, v, 0.0 * omega, p)"),
      ("evaluates the load for bodies that turn and do not move", "q, v, omega, p)", "q, 0.0 * v, omega, p)"),
      ("sorts the moments of inertia", "1.0 / p.inv_inertia[i]", "np.sort(1.0 / p.inv_inertia[i])"))

WITHOUT = "omega[i] * ({}), tau[i], 1.0"                                 # the gyroscopic term, unless this holds
edits("10.1 10.2",
      ("sets no body in motion that is at rest", FORCE, f"np.where(v.any(axis=1)[:, None], {FORCE}, v)"),
      ("returns v itself where no force acts", FORCE, f"({FORCE} if F.any() else v)"),
      ("loses the row of one body alone", FORCE, f"np.squeeze({FORCE})"),
      ("does not move bodies above 10⁶ kg", "p.inv_mass[:, None]",
       "np.where(p.inv_mass < 1e-6, 0.0, p.inv_mass)[:, None]"))
edits("10.1",
      ("sets no body turning that does not turn yet", TORQUE, f"{TORQUE} * (omega != 0.0)"),
      ("omits torques on bodies on which no force acts", TORQUE, f"{TORQUE} * F.any(axis=1)"),
      ("omits torques on bodies that rest and on which no force acts", TORQUE,
       f"{TORQUE} * (v.any(axis=1) | (omega != 0.0) | F.any(axis=1))"),
      ("evaluates the force with the new spin", LOADS, f"{LOADS}; F = load(t, x, q, v, {TORQUE}, p)[0]"),
      ("evaluates the force at the next angles", LOADS, f"{LOADS}; F = load(t, x, q + dt * omega, v, omega, p)[0]"),
      ("omits forces with equal coordinates", "p.inv_mass[:, None] * F",
       "p.inv_mass[:, None] * F * (F[:, :1] != F[:, 1:])"),
      ("returns omega itself where no torque acts", TORQUE, f"({TORQUE} if tau.any() else omega)"),
      ("returns v and omega themselves where no load can change them", LOADS,
       f"{LOADS}\n    if not (p.inv_mass.any() or p.inv_inertia.any()): return v, omega"))
edits("10.2",
      ("omits torques on bodies that rest and on which no force acts", "if p.inv",
       "if (F[i].any() or omega[i].any()) and p.inv"),
      ("evaluates the force at the next orientations", f"F, tau = {LOADS}",
       f"F, tau = load(t, x, turn_quaternions(q, omega, dt), v, omega, p)[0], {LOADS}[1]"),
      ("omits the gyroscopic term where the first two moments are equal", "omega[i], tau[i], 1.0",
       WITHOUT.format("p.inv_inertia[i, 0] != p.inv_inertia[i, 1]")),
      ("omits the gyroscopic term where the last two moments are equal", "omega[i], tau[i], 1.0",
       WITHOUT.format("p.inv_inertia[i, 1] != p.inv_inertia[i, 2]")),
      ("omits the gyroscopic term where the first and the last moment are equal", "omega[i], tau[i], 1.0",
       WITHOUT.format("p.inv_inertia[i, 0] != p.inv_inertia[i, 2]")),
      ("omits the gyroscopic term where moments differ by less than a tenth", "omega[i], tau[i], 1.0",
       WITHOUT.format("np.max(p.inv_inertia[i]) > 1.1 * np.min(p.inv_inertia[i])")),
      ("omits the gyroscopic term where q = (1, 0, 0, 0)", "omega[i], tau[i], 1.0", WITHOUT.format("q[i, 0] != 1.0")),
      ("omits the gyroscopic term where ω has no part along one of the body's axes", "omega[i], tau[i], 1.0",
       WITHOUT.format("np.min(np.abs(unrotate(q[i], omega[i]))) > 1e-9")),
      ("does not turn bodies with moments above 10⁶ kg m²", "p.inv_inertia[i, 0] > 0.0", "p.inv_inertia[i, 0] > 1e-6"))


# 10.3 and 10.4 --------------------------------------------------------------------------------------------------
@right("10.3", "changes of positions apart")
def free_step_2d(load, t, x, q, v, omega, dt, p):
    faster, turning = worked.new_velocities_2d(load, t, x, q, v, omega, dt, p)
    return np.array([x[i] + dt * faster[i] for i in range(len(x))]), q + turning * dt, faster, turning


@right("10.4", "with the quaternions of all bodies at once, whose first number is positive")
def free_step(load, t, x, q, v, omega, dt, p):
    v, omega = worked.new_velocities(load, t, x, q, v, omega, dt, p)
    q = worked.turn_quaternions(q, omega, dt)
    return x + dt * v, np.where(q[:, :1] < 0.0, -q, q), v, omega


STOPPED = "np.where(p.inv_mass > 0.0, {0}.T, 0.0).T"                     # rows of infinite mass stand still
for number, name, turned in (("10.3", "new_velocities_2d", "q + dt * {}"),
                             ("10.4", "new_velocities", "turn_quaternions(q, {}, dt)")):
    first, new_q = f"v, omega = {name}(load, t, x, q, v, omega, dt, p)", turned.format("omega")
    after, half = f"old, spin = v, omega; {first}; return ", first.replace("dt, p", "0.5 * dt, p")
    edits(number,
          ("moves the positions with the old velocities", first, f"{after}x + dt * old, {new_q}, v, omega"),
          ("rotates with the old angular velocities", first, f"{after}x + dt * v, {turned.format('spin')}, v, omega"),
          ("moves and rotates with the old velocities", first,
           f"{after}x + dt * old, {turned.format('spin')}, v, omega"),
          ("moves the positions with the mean of old and new velocities", first,
           f"{after}x + 0.5 * dt * (old + v), {new_q}, v, omega"),
          ("rotates with the mean of old and new angular velocities", first,
           f"{after}x + dt * v, {turned.format('(0.5 * spin + 0.5 * omega)')}, v, omega"),
          ("moves and rotates with the means of old and new velocities", first,
           f"{after}x + 0.5 * dt * (old + v), {turned.format('(0.5 * spin + 0.5 * omega)')}, v, omega"),
          ("moves first, and evaluates the load at the new positions", first,
           f"x, q = x + dt * v, {new_q}; {first}; return x, q, v, omega"),
          ("moves first, and evaluates the load at the new positions and time", first,
           f"x, q = x + dt * v, {new_q}; {first.replace('t, x', 't + dt, x')}; return x, q, v, omega"),
          ("loads for half a step, moves, loads for the other half", first,
           f"{half}; x, q = x + dt * v, {new_q}; {half.replace('t, x', 't + dt, x')}; return x, q, v, omega"),
          ("evaluates the load at t + dt", "load, t, x", "load, t + dt, x"),
          ("evaluates the load at time 0", "load, t, x", "load, 0.0, x"),
          ("evaluates the load at t + ½ dt", "load, t, x", "load, t + 0.5 * dt, x"),
          ("evaluates the load at the next positions", "load, t, x,", "load, t, x + dt * v,"),
          ("uses the weight in place of the load", "(load,", "(weight,"),
          ("omits the load", first, "v, omega = v.copy(), omega.copy()"),
          ("adds the load twice", first, f"{first}; {first}"),
          ("adds the load for half of the step only", first, half),
          ("forgets dt beside v", "x + dt * v", "x + v"),
          ("has dt twice beside v", "x + dt * v", "x + dt * dt * v"),
          ("moves the positions by half a step", "x + dt * v", "x + 0.5 * dt * v"),
          ("moves backwards", "x + dt * v", "x - dt * v"),
          ("does not move the positions", "x + dt * v", "x"),
          ("moves all rows with the velocity of the first one", "x + dt * v", "x + dt * v[0]"),
          ("changes its input in place", "x + dt * v", "np.add(x, dt * v, out=x)"),
          ("does not move rows of infinite mass", "x + dt * v", f"x + dt * {STOPPED.format('v')}"),
          ("does not rotate rows of infinite mass", first,
           f"{after}x + dt * v, {turned.format(STOPPED.format('omega'))}, v, omega"),
          ("neither moves nor rotates rows of infinite mass", first,
           f"{after}x + dt * {STOPPED.format('v')}, {turned.format(STOPPED.format('omega'))}, v, omega"),
          ("does not rotate rows of infinite inertia", first,
           f"{after}x + dt * v, {turned.format('(p.inv_inertia > 0.0) * omega')}, v, omega"),
          ("stops rows of infinite mass", first, f"{first}; v[p.inv_mass == 0.0] = 0.0"),
          ("does not move planes", first,
           f"{after}x + dt * v * (np.arange(len(v)) < len(p.half))[:, None], {new_q}, v, omega"),
          ("does not rotate planes", first,
           f"{after}x + dt * v, {turned.format('(omega.T * (np.arange(len(v)) < len(p.half))).T')}, v, omega"),
          ("neither moves nor rotates planes", first,
           f"{after}x + dt * v * (np.arange(len(v)) < len(p.half))[:, None], "
           f"{turned.format('(omega.T * (np.arange(len(v)) < len(p.half))).T')}, v, omega"),
          ("does not move the last row", first,
           f"{after}x + dt * np.append(v[:-1], 0.0 * v[-1:], axis=0), {new_q}, v, omega"),
          ("does not move the first row", first,
           f"{after}x + dt * np.append(0.0 * v[:1], v[1:], axis=0), {new_q}, v, omega"),
          ("returns the old velocities", first, f"{after}x + dt * v, {new_q}, old, omega"),
          ("returns the old angular velocities", first, f"{after}x + dt * v, {new_q}, v, spin"),
          ("returns the old velocities, both v and ω", first, f"{after}x + dt * v, {new_q}, old, spin"),
          ("returns v before q", first, f"{first}; return x + dt * v, v, {new_q}, omega"),
          ("exchanges v and ω in what it returns", first, f"{first}; return x + dt * v, {new_q}, omega, v"))

FIRST = "v, omega = new_velocities_2d(load, t, x, q, v, omega, dt, p)"
edits("10.3",
      ("adds ½ g dt² to the positions", "x + dt * v", "x + dt * v + 0.5 * dt * dt * p.gravity"),
      ("rotates all rows with the mean angular velocity", "q + dt * omega", "q + dt * np.mean(omega)"),
      ("returns q before x", "x + dt * v, q + dt * omega,", "q + dt * omega, x + dt * v,"),
      ("does not change the angles", "q + dt * omega", "q"),
      ("changes the angles in place", "q + dt * omega", "np.add(q, dt * omega, out=q)"),
      ("changes its input in place", "x + dt * v, q + dt * omega",
       "np.add(x, dt * v, out=x), np.add(q, dt * omega, out=q)"),
      ("rotates the other way", "q + dt * omega", "q - dt * omega"),
      ("forgets dt beside ω", "q + dt * omega", "q + omega"),
      ("forgets dt beside v and ω", "x + dt * v, q + dt * omega", "x + v, q + omega"),
      ("adds the old and the new velocities without halving", FIRST,
       f"old, spin = v, omega; {FIRST}; return x + dt * (old + v), q + dt * (spin + omega), v, omega"),
      ("adds ½ a dt² to the motion with the new velocity", FIRST, f"old, spin = v, omega; {FIRST}; return "
       "x + dt * v + 0.5 * dt * (v - old), q + dt * omega + 0.5 * dt * (omega - spin), v, omega"),
      ("moves for half a step before the load, and for half a step after it", FIRST,
       f"x, q = x + 0.5 * dt * v, q + 0.5 * dt * omega; {FIRST}; "
       "return x + 0.5 * dt * v, q + 0.5 * dt * omega, v, omega"),
      ("makes two steps of half the length", FIRST, "; ".join(2 * [
          "dt = 0.5 * dt", FIRST, "x, q = x + dt * v, q + dt * omega", "dt = 2.0 * dt"]) + "; return x, q, v, omega"),
      ("takes angles into −π … π", "q + dt * omega", "(q + dt * omega + np.pi) % (2.0 * np.pi) - np.pi"),
      ("takes angles into 0 … 2π", "q + dt * omega", "(q + dt * omega) % (2.0 * np.pi)"),
      ("rotates by the size of ω", "q + dt * omega", "q + dt * np.abs(omega)"),
      ("rotates all rows like the first one", "q + dt * omega", "q + dt * omega[0]"),
      ("has the angles in degrees", "q + dt * omega", "q + dt * np.degrees(omega)"),
      ("rotates the places about the origin, too", "x + dt * v",
       "x + dt * v + dt * np.stack((-omega * x[:, 1], omega * x[:, 0]), axis=1)"),
      ("evaluates the load in the middle of the step", FIRST,
       FIRST.replace("x, q, v", "x + 0.5 * dt * v, q + 0.5 * dt * omega, v")),
      ("evaluates the load at the end of the step", FIRST, f"old, spin = v, omega; {FIRST}; v, omega = "
       "new_velocities_2d(load, t, x + dt * v, q + dt * omega, old, spin, dt, p)"))

FIRST, UPDATE = "v, omega = new_velocities(load, t, x, q, v, omega, dt, p)", "quaternion_update(q[i], omega[i], dt)"
RATE = "np.array([0.0, omega[i, 0], omega[i, 1], omega[i, 2]])"
UNIT = "y = {}; q[i] = y / np.sqrt(y @ y)"
edits("10.4",
      ("multiplies by ω from the right, as if it were in body axes", f"q[i] = {UPDATE}",
       UNIT.format(f"q[i] + 0.5 * dt * quaternion_product(q[i], {RATE})")),
      ("does not normalise the quaternions", UPDATE, f"q[i] + 0.5 * dt * quaternion_product({RATE}, q[i])"),
      ("returns quaternions that are not normalised", UPDATE, f"1.01 * {UPDATE}"),
      ("normalises before adding q̇ dt, not after", f"q[i] = {UPDATE}",
       f"y = q[i] / np.sqrt(q[i] @ q[i]); q[i] = y + 0.5 * dt * quaternion_product({RATE}, y)"),
      ("omits the ½ in q̇ = ½ ω q", f"q[i] = {UPDATE}", UNIT.format(f"q[i] + dt * quaternion_product({RATE}, q[i])")),
      ("uses the exponential in place of quaternion_update", UPDATE,
       "quaternion_product(exponential(dt * omega[i]), q[i])"),
      ("uses the exponential, from the right", UPDATE, "quaternion_product(q[i], exponential(dt * omega[i]))"),
      ("moves and rotates with mean velocities, and uses the exponential", FIRST,
       f"old, spin = v, omega; {FIRST}; return x + 0.5 * dt * (old + v), np.stack([quaternion_product("
       "exponential(0.5 * dt * (spin[i] + omega[i])), q[i]) for i in range(len(q))]), v, omega"),
      ("converts ω to body axes before the update", UPDATE, "quaternion_update(q[i], unrotate(q[i], omega[i]), dt)"),
      ("rotates the other way", "omega[i], dt)", "-omega[i], dt)"),
      ("returns the inverse orientation", f"q[i] = {UPDATE}", f"q[i] = {UPDATE}; q[i, 1:] *= -1.0"),
      ("forgets dt in the update of q", "omega[i], dt)", "omega[i], 1.0)"),
      ("has dt twice in the update of q", "omega[i], dt)", "omega[i], dt * dt)"),
      ("rotates by half of the step", "omega[i], dt)", "omega[i], 0.5 * dt)"),
      ("makes two updates of q with half of the step", UPDATE,
       "quaternion_update(quaternion_update(q[i], omega[i], 0.5 * dt), omega[i], 0.5 * dt)"),
      ("rotates about z only", "omega[i], dt)", "omega[i] * np.array([0.0, 0.0, 1.0]), dt)"),
      ("does not rotate the bodies", f"q[i] = {UPDATE}", "pass"),
      ("rotates the first row only", "range(q.shape[0])", "range(1)"),
      ("changes the quaternions in place", "q = float_copy(q)", "pass"),
      ("omits the rotation of the last row", "range(q.shape[0])", "range(q.shape[0] - 1)"),
      ("omits the rotation of the first row", "range(q.shape[0])", "range(1, q.shape[0])"),
      ("uses the spin of the first row for all", "omega[i], dt)", "omega[0], dt)"),
      ("rotates before it evaluates the load", FIRST,
       f"spin = omega; q = turn_quaternions(q, omega, dt); {FIRST}; return x + dt * v, q, v, omega"),
      ("evaluates the load with the new orientation", FIRST,
       f"y = turn_quaternions(q, omega, dt); {FIRST.replace('x, q, v', 'x, y, v')}"),
      ("returns ω in body axes", "return x + dt * v, q, v, omega",
       "return x + dt * v, q, v, np.stack([unrotate(q[i], omega[i]) for i in range(len(q))])"),
      ("omits the gyroscopic term", FIRST,
       "F, tau = load(t, x, q, v, omega, p); "
       "v, omega = v + dt * p.inv_mass[:, None] * F, omega + dt * p.inv_inertia * tau"))


edit("10.3", "leaves out ways below 1 nm", "x + dt * v", "np.where(np.abs(dt * v) > 1e-9, x + dt * v, x)")
edit("10.4", "leaves out spins below 1 µrad/s", "q[i] = quaternion",
     "if dot(omega[i], omega[i]) > 1e-12: q[i] = quaternion")

edits("10.3 10.4", ("loses the row of one body alone", "x + dt * v", "np.squeeze(x + dt * v)"))
FIRST = "v, omega = new_velocities_2d(load, t, x, q, v, omega, dt, p)"
edits("10.3",
      ("does not move bodies that do not turn", "x + dt * v",
       "x + dt * v * ((omega != 0.0) | (p.inv_inertia == 0.0))[:, None]"),
      ("does not move rows of infinite mass that do not turn", "x + dt * v",
       "x + dt * v * ((p.inv_mass > 0.0) | (omega != 0.0))[:, None]"),
      ("does not turn bodies that do not move along", "q + dt * omega", "q + dt * omega * v.any(axis=1)"),
      ("moves bodies below 0.1 kg with the mean of old and new velocities", FIRST, f"old = v; {FIRST}; "
       "return x + np.where(p.inv_mass[:, None] > 10.0, 0.5 * dt * (old + v), dt * v), q + dt * omega, v, omega"))
edits("10.4",
      ("turns by a quarter turn per step at most", "omega[i], dt)",
       "omega[i] * min(1.0, 2.0 / max(norm(omega[i]) * dt, 1e-300)), dt)"),
      ("takes the angle |ω| dt modulo 2π", "omega[i], dt)",
       "omega[i] * np.remainder(norm(omega[i]) * dt, 2.0 * np.pi) / max(norm(omega[i]) * dt, 1e-300), dt)"),
      ("uses the exponential for small angles", UPDATE,
       f"{UPDATE} if norm(omega[i]) * dt > 0.01 else quaternion_product(exponential(dt * omega[i]), q[i])"))


# 10.5 -----------------------------------------------------------------------------------------------------------
@right("10.5", "tries all pairs")
def find_contacts(narrow, x, low, high, turn, p):
    first, partner = [0], []
    for i in range(len(p.half)):
        partner += [j for j in range(i + 1, len(x))
                    if p.inv_mass[i] + p.inv_mass[j] + np.sum(p.inv_inertia[i] + p.inv_inertia[j]) > 0.0]
        first.append(len(partner))
    pairs = Pairs(np.array(first, np.int64), np.array(partner, np.int64))
    return narrow(x, turn, p.half, p.planes, pairs, p.margin)


@right("10.5", "with wider boxes, whose contacts the narrow phase leaves out")
def find_contacts(narrow, x, low, high, turn, p):                        # noqa: F811
    pairs = worked.movable_pairs(worked.near_pairs(low - 2.0 * p.margin, high + 2.0 * p.margin, p.planes), p)
    return narrow(x[:len(p.half)], turn, p.half, p.planes, pairs, p.margin)


NARROW = "narrow(x, turn, p.half, p.planes, pairs, p.margin)"
KEPT = "ContactSet(np.searchsorted(c.a[k], np.arange(len(p.half) + 1)), c.a[k], c.b[k], c.n[k], c.p[k], c.gap[k])"
SOME = "many = [(i, j) for i in range(len(p.half)) for j in pairs.partner[pairs.first[i]:pairs.first[i + 1]] if {}]; " \
    "pairs = pairs._replace(first=np.array([sum(a < i for a, _ in many) for i in range(len(p.half) + 1)]), " \
    "partner=np.array([j for _, j in many], dtype=np.int64)); return"
BOTH = "low - p.margin, high + p.margin"
edits("10.5",
      ("does not widen the boxes by the margin", BOTH, "low, high"),
      ("widens the boxes downwards only", "high + p.margin", "high"),
      ("widens the boxes upwards only", "low - p.margin", "low"),
      ("raises the lower corners by the margin in place of lowering them", "low - p.margin", "low + p.margin"),
      ("lowers the upper corners by the margin in place of raising them", "high + p.margin", "high - p.margin"),
      ("narrows the boxes by the margin in place of widening them", BOTH, "low + p.margin, high - p.margin"),
      ("widens the boxes by half of the margin", BOTH, "low - 0.5 * p.margin, high + 0.5 * p.margin"),
      ("widens the boxes by a tenth of the margin", BOTH, "low - 0.1 * p.margin, high + 0.1 * p.margin"),
      ("widens the boxes by a part of their size", BOTH, "low - p.margin * p.half, high + p.margin * p.half"),
      ("widens the boxes along the first axis only", BOTH,
       "low - p.margin * np.eye(low.shape[1])[0], high + p.margin * np.eye(low.shape[1])[0]"),
      ("widens the boxes along the last axis only", BOTH,
       "low - p.margin * np.eye(low.shape[1])[-1], high + p.margin * np.eye(low.shape[1])[-1]"),
      ("exchanges low and high", BOTH, "high + p.margin, low - p.margin"),
      ("uses the centres in place of the boxes", BOTH, "x[:len(low)] - p.margin, x[:len(low)] + p.margin"),
      ("uses the boxes of bodies that are not turned", BOTH,
       "x[:len(low)] - p.half - p.margin, x[:len(low)] + p.half + p.margin"),
      ("changes its input in place", BOTH, "np.subtract(low, p.margin, out=low), np.add(high, p.margin, out=high)"),
      ("finds only what overlaps", "pairs, p.margin)", "pairs, 0.0)"),
      ("finds only what overlaps by the margin", "pairs, p.margin)", "pairs, -p.margin)"),
      ("uses twice the margin", "pairs, p.margin)", "pairs, 2.0 * p.margin)"),
      ("uses half of the margin in the narrow phase", "pairs, p.margin)", "pairs, 0.5 * p.margin)"),
      ("has no limit of the gap", "pairs, p.margin)", "pairs, np.inf)"),
      ("uses a margin of 1 cm in place of p.margin", "pairs = ", "p = p._replace(margin=0.01); pairs = "),
      ("uses a margin of 5 cm in place of p.margin", "pairs = ", "p = p._replace(margin=0.05); pairs = "),
      ("finds contacts between immovable bodies, too", "p.planes), p)",
       "p.planes), p._replace(inv_mass=p.inv_mass + 1.0))"),
      ("omits contacts of bodies that only turn", "p.planes), p)",
       "p.planes), p._replace(inv_inertia=0.0 * p.inv_inertia))"),
      ("omits contacts of bodies that do not turn", "p.planes), p)",
       "p.planes), p._replace(inv_mass=0.0 * p.inv_mass))"),
      ("finds contacts of two movable bodies only", "return",
       SOME.format("p.inv_mass[i] > 0.0 and p.inv_mass[j] > 0.0")),
      ("finds contacts only where the first body is movable", "return", SOME.format("p.inv_mass[i] > 0.0")),
      ("finds contacts only where the second body is movable", "return", SOME.format("p.inv_mass[j] > 0.0")),
      ("finds contacts of neighbouring numbers only", "return", SOME.format("j == i + 1")),
      ("omits the contacts of the last body", "return", SOME.format("i < len(p.half) - 1")),
      ("omits the contacts of the first body", "return", SOME.format("i > 0")),
      ("omits the contacts between bodies", "return", SOME.format("j >= len(p.half)")),
      ("omits the planes", "high + p.margin, p.planes)", "high + p.margin, p.planes[:0])"),
      ("uses the first plane only", "high + p.margin, p.planes)", "high + p.margin, p.planes[:1])"),
      ("omits the last plane", "high + p.margin, p.planes)", "high + p.margin, p.planes[:-1])"),
      ("finds nothing where there is no plane", "return", SOME.format("len(p.planes)")),
      ("moves the planes by the margin", "p.half, p.planes, pairs", "p.half, p.planes + p.margin, pairs"),
      ("adds the margin to the sizes of the bodies", "turn, p.half,", "turn, p.half + p.margin,"),
      ("adds the margin to the centres", "narrow(x,", "narrow(x + p.margin,"),
      ("uses round_contacts for bodies of all shapes", "narrow(x", "round_contacts(x"),
      ("hands over zeros in place of the rotations", "narrow(x, turn,", "narrow(x, 0.0 * turn,"),
      ("takes the bodies as not turned in the narrow phase", "narrow(x, turn,",
       "narrow(x, np.zeros(turn.shape) + (np.array([1.0, 0.0]) if turn.ndim == 2 else np.eye(3)),"),
      ("omits what overlaps", f"return {NARROW}", f"c = {NARROW}; k = c.gap >= 0.0; return {KEPT}"),
      ("keeps one contact of each pair", f"return {NARROW}", f"c = {NARROW}; k = np.array([s == 0 or "
       f"(c.a[s], c.b[s]) != (c.a[s - 1], c.b[s - 1]) for s in range(c.a.size)], dtype=bool); return {KEPT}"),
      ("reverses the normals", NARROW, f"(lambda c: c._replace(n=-c.n))({NARROW})"),
      ("reverses the gaps", NARROW, f"(lambda c: c._replace(gap=-c.gap))({NARROW})"),
      ("subtracts the margin from the gaps", NARROW, f"(lambda c: c._replace(gap=c.gap - p.margin))({NARROW})"),
      ("loses the numbers of the first contacts of each body", NARROW,
       f"(lambda c: c._replace(first=0 * c.first))({NARROW})"),
      ("sorts the contacts by their gaps", f"return {NARROW}",
       f"c = {NARROW}; k = np.argsort(c.gap); return ContactSet(c.first, *(part[k] for part in c[1:]))"),
      ("returns the pairs", NARROW, "pairs"),
      ("returns the gaps only", NARROW, f"{NARROW}.gap"))


edits("10.5",
      ("widens the boxes by 1 m, regardless of the margin", "low - p.margin, high + p.margin", "low - 1.0, high + 1.0"),
      ("finds gaps a little larger than the margin", "pairs, p.margin)", "pairs, p.margin * (1.0 + 1e-6))"),
      ("finds gaps a little smaller than the margin only", "pairs, p.margin)", "pairs, p.margin * (1.0 - 1e-6))"),
      ("takes heavy bodies for immovable", "p.planes), p)", "p.planes), p._replace("
       "inv_mass=np.where(p.inv_mass > 1e-3, p.inv_mass, 0.0)))"),
      ("doubles the sizes of the bodies", "turn, p.half", "turn, 2.0 * p.half"),
      ("uses the sizes of the first body for all", "turn, p.half", "turn, 0.0 * p.half + p.half[0]"),
      ("uses the planes from the last to the first", "p.half, p.planes, pairs",
       "p.half, np.ascontiguousarray(p.planes[::-1]), pairs"),
      ("uses the rotation of the first body for all", "turn, p.half", "0.0 * turn + turn[:1], p.half"))

edits("10.5",
      ("omits the planes where there is one body", "high + p.margin, p.planes)",
       "high + p.margin, p.planes if len(p.half) > 1 else p.planes[:0])"),
      ("uses the transposed rotations in space", "turn, p.half",
       "np.ascontiguousarray(turn.transpose(0, 2, 1)) if turn.ndim == 3 else turn, p.half"),
      ("uses the opposite angles in the plane", "turn, p.half",
       "turn * np.array([1.0, -1.0]) if turn.ndim == 2 else turn, p.half"),
      ("loses the signs of cosine and sine in the plane", "turn, p.half",
       "np.abs(turn) if turn.ndim == 2 else turn, p.half"),
      ("omits pairs of bodies with the same centre", "return",
       SOME.format("j >= len(p.half) or np.any(x[i] != x[j])")))


# 10.6 and 10.7 --------------------------------------------------------------------------------------------------
@right("10.6", "impulses once more from the start")
def contact_step_2d(load, bounds, narrow, t, state, dt, p):
    v, omega = worked.new_velocities_2d(load, t, state.x, state.q, state.v, state.omega, dt, p)
    contacts = worked.find_contacts(narrow, state.x, *bounds(state.x, state.q, p.half), p)
    arms = worked.arms_2d(state.x, p.inv_mass, p.inv_inertia, contacts)
    J = worked.kept_impulses(contacts, state.contacts, state.J, p.margin)
    worked.apply_impulses_2d(v, omega, J, contacts, arms, p.inv_mass, p.inv_inertia)
    aim, give = -np.maximum(contacts.gap, 0.0) / dt, np.zeros(len(contacts.gap))
    sweep = 0
    while sweep < p.sweeps:
        v, omega, J = worked.velocity_sweep_2d(v, omega, J, aim, give, contacts, arms, p)
        sweep += 1
    return worked.PileState(state.x + dt * v, state.q + dt * omega, v, omega, contacts, J)


@right("10.7", "in another order")
def contact_step(load, bounds, narrow, t, state, dt, p):
    low, high, turn = bounds(state.x, state.q, p.half)
    contacts = worked.find_contacts(narrow, state.x, low, high, turn, p)
    inertia = worked.world_inertia(turn, p.inv_inertia)
    arms = worked.arms_3d(state.x, p.inv_mass, inertia, contacts)
    v, omega = worked.new_velocities(load, t, state.x, state.q, state.v, state.omega, dt, p)
    J = worked.kept_impulses(contacts, state.contacts, state.J, p.margin)
    worked.apply_impulses(v, omega, J, contacts, arms, p.inv_mass, inertia)
    aim = worked.closing_speeds(contacts.gap, dt)
    for _ in range(p.sweeps):
        v, omega, J = worked.velocity_sweep(v, omega, J, aim, np.zeros(len(aim)), contacts, arms, p.inv_mass, inertia,
                                            p.mu)
    return worked.PileState(state.x + dt * v, worked.turn_quaternions(state.q, omega, dt), v, omega, contacts, J)


DETECT = "contacts = find_contacts(narrow, x, low, high, turn, p)"
KEEP = "J = kept_impulses(contacts, old, J, p.margin)"
CHOSEN = "contacts = (lambda c, k: ContactSet(np.searchsorted(c.a[k], np.arange(len(p.half) + 1)), c.a[k], c.b[k], " \
    "c.n[k], c.p[k], c.gap[k]))(contacts, {})"
NORMAL = "contacts.n * np.sum(J * contacts.n, axis=1).reshape(-1, 1)"
LOOP = "for _ in range(p.sweeps):"
for number, name, dimension, moved, apply, sweep in (
        ("10.6", "new_velocities_2d", "2d", "q + dt * omega",
         "apply_impulses_2d(v, omega, J, contacts, arms, p.inv_mass, p.inv_inertia)",
         "velocity_sweep_2d(v, omega, J, aim, 0.0 * aim, contacts, arms, p)"),
        ("10.7", "new_velocities", "3d", "turn_quaternions(q, omega, dt)",
         "apply_impulses(v, omega, J, contacts, arms, p.inv_mass, inv_inertia)",
         "velocity_sweep(v, omega, J, aim, 0.0 * aim, contacts, arms, p.inv_mass, inv_inertia, p.mu)")):
    loads, arms = f"v, omega = {name}(load, t, x, q, v, omega, dt, p)", f"arms, aim = arms_{dimension}("
    ends, spin = f"return PileState(x + dt * v, {moved}, v, omega, contacts, J)", moved.replace
    first = f"{loads}; before, spun = v.copy(), omega.copy()"
    beside = "y, r = x + dt * v, " + moved
    edits(number,
          ("evaluates the load at time 0", "(load, t, x", "(load, 0.0, x"),
          ("evaluates the load at t + dt", "(load, t, x", "(load, t + dt, x"),
          ("evaluates the load at the next positions", "(load, t, x,", "(load, t, x + dt * v,"),
          ("applies the old impulses before the loads", apply,
           f"v, omega = state.v.copy(), state.omega.copy(); {apply}; {loads}"),
          ("remembers impulses only where the number of contacts has not changed", KEEP,
           f"{KEEP} if old.a.size == contacts.a.size else 0.0 * contacts.p"),
          ("forgets impulses that would pull now", KEEP,
           f"{KEEP}; J = J * (np.sum(J * contacts.n, axis=1)[:, None] > 0.0)"),
          ("ends the sweeps where impulses change by less than 1 nN s", LOOP,
           f"{LOOP}\n        if _ and np.max(np.abs(J - last), initial=0.0) < 1e-9: break\n        last = J.copy()"),
          ("makes one sweep only where there is one body", "range(p.sweeps)",
           "range(p.sweeps if len(p.half) > 1 else 1)"),
          ("makes 50 sweeps at most", "range(p.sweeps)", "range(min(p.sweeps, 50))"),
          ("moves bodies apart that overlap", ends,
           "for k in np.flatnonzero(contacts.gap < 0.0): x = x - 0.2 * contacts.gap[k] * np.outer(np.arange(len(x)) == "
           f"contacts.a[k], contacts.n[k])\n    {ends}"),
          ("limits velocities to 100 m/s", ends, f"v = np.clip(v, -100.0, 100.0); {ends}"),
          ("uses the gaps for the speeds at which they close", "closing_speeds(contacts.gap, dt)",
           "np.minimum(-contacts.gap, 0.0)"),
          ("moves with the mean of old and new velocities", ends,
           ends.replace("x + dt * v", "x + 0.5 * dt * (v + state.v)")),
          ("stops rows of infinite mass at the end", ends, f"v[p.inv_mass == 0.0] = 0.0; {ends}"),
          ("keeps half of the distance of the margin only", "J, p.margin)", "J, 0.5 * p.margin)"),
          ("takes two bodies of 1 kg for the arms", f"{arms}x, p.inv_mass,", f"{arms}x, np.ones(p.inv_mass.size),"),
          ("uses the contacts of the last step", DETECT, f"{DETECT}; contacts = old if old.a.size else contacts"),
          ("uses the weight in place of the load", "(load, t", "(weight, t"),
          ("omits the forces", loads, "v, omega = v.copy(), omega.copy()"),
          ("adds the load twice", loads, f"{loads}; {loads}"),
          ("adds the load for half of the step only", loads, loads.replace("omega, dt", "omega, 0.5 * dt")),
          ("adds the load after the contact", loads,
           f"PileState = lambda a, b, c, d, *rest: type(state)(a, b, *{name}(load, t, x, q, c, d, dt, p), *rest); "
           "v, omega = v.copy(), omega.copy()"),
          ("adds the load after the contact, and moves with it", loads,
           f"PileState = lambda a, b, c, d, *rest: (lambda v, omega: type(state)(x + dt * v, {moved}, v, omega, *rest))"
           f"(*{name}(load, t, x, q, c, d, dt, p)); v, omega = v.copy(), omega.copy()"),
          ("moves first, with the old velocities", loads,
           f"{beside}; {loads}; PileState = lambda a, b, *rest: type(state)(y, r, *rest); x, q = y, r"),
          ("changes its input in place", loads,
           f"{loads.replace('v, omega =', 'state.v[:], state.omega[:] =')}; v, omega = state.v, state.omega"),
          ("does nothing where there is no contact", DETECT, f"{DETECT}\n    if contacts.a.size == 0: return state"),
          ("omits the load where there is no contact", DETECT,
           f"{DETECT}\n    if contacts.a.size == 0: v, omega = state.v.copy(), state.omega.copy()"),
          ("keeps the old contacts where there is no new one", DETECT,
           f"{DETECT}\n    if contacts.a.size == 0: return PileState(x + dt * v, {moved}, v, omega, old, J)"),
          ("stops rows of infinite mass", loads, f"{loads}; v[p.inv_mass == 0.0] = 0.0"),
          ("stops rows of infinite mass from turning", loads, f"{loads}; omega[p.inv_mass == 0.0] = 0.0"),
          ("stops planes that move", loads, f"{loads}; v[len(p.half):] = 0.0; omega[len(p.half):] = 0.0"),
          ("uses the bounds of bodies that have moved on", "bounds(x, q,", "bounds(x + dt * v, q,"),
          ("uses the bounds of bodies that have turned on", "bounds(x, q,", f"bounds(x, {moved},"),
          ("looks for contacts of bodies that are not turned", "bounds(x, q,",
           "bounds(x, np.zeros(q.shape) + (0.0 if q.ndim == 1 else np.array([1.0, 0.0, 0.0, 0.0])),"),
          ("looks for contacts at the positions after the step", "low, high, turn = bounds(x, q, p.half)",
           f"{beside}; low, high, turn = bounds(y, r, p.half); "
           "PileState = lambda x_, q_, *rest: type(state)(y, r, *rest); x = y"),
          ("looks for contacts at the positions after the step, and moves again from the old ones",
           DETECT, f"low, high, turn = bounds(x + dt * v, q, p.half); {DETECT.replace('x, low', 'x + dt * v, low')}"),
          ("looks for contacts of bodies that have moved and turned, and moves again from the old places",
           "low, high, turn = bounds(x, q, p.half)", f"begun = x, q; {beside}; low, high, turn = bounds(y, r, p.half); "
           "x = y; PileState = lambda _, __, v, omega, *rest: "
           f"(lambda x, q: type(state)(x + dt * v, {moved}, v, omega, *rest))(*begun)"),
          ("looks for contacts within a margin of nothing", DETECT,
           DETECT.replace(", p)", ", p._replace(margin=1e-9))")),
          ("looks for contacts within the way of a step, not the margin", DETECT,
           DETECT.replace(", p)", ", p._replace(margin=dt * np.max(np.abs(v))))")),
          ("uses the contacts of the last step", DETECT, "contacts = old"),
          ("uses only contacts that overlap", DETECT, f"{DETECT}; {CHOSEN.format('contacts.gap <= 0.0')}"),
          ("uses only contacts within half of the margin", DETECT,
           f"{DETECT}; {CHOSEN.format('contacts.gap <= 0.5 * p.margin')}"),
          ("uses contacts with planes only", DETECT, f"{DETECT}; {CHOSEN.format('contacts.b >= len(p.half)')}"),
          ("uses contacts between bodies only", DETECT, f"{DETECT}; {CHOSEN.format('contacts.b < len(p.half)')}"),
          ("omits the last contact", DETECT,
           f"{DETECT}; {CHOSEN.format('np.arange(contacts.a.size) < contacts.a.size - 1')}"),
          ("takes the arms from the positions after the step", f"{arms}x,", f"{arms}x + dt * v,"),
          ("stops bodies that are not in contact yet", "closing_speeds(contacts.gap, dt)", "0.0 * contacts.gap"),
          ("reverses the closing speeds", "closing_speeds(contacts.gap, dt)", "-closing_speeds(contacts.gap, dt)"),
          ("aims at gap/dt in place of −gap/dt", "closing_speeds(contacts.gap, dt)", "contacts.gap / dt"),
          ("aims at −gap/dt where bodies overlap, too, and pushes them out", "closing_speeds(contacts.gap, dt)",
           "-contacts.gap / dt"),
          ("pushes bodies that overlap out by a fifth of the overlap", "closing_speeds(contacts.gap, dt)",
           "np.where(contacts.gap > 0.0, 1.0, 0.2) * -contacts.gap / dt"),
          ("uses the maximum of −gap/dt and 0 in place of the minimum", "closing_speeds(contacts.gap, dt)",
           "np.maximum(-contacts.gap / dt, 0.0)"),
          ("forgets dt in the closing speeds", "closing_speeds(contacts.gap, dt)", "np.minimum(-contacts.gap, 0.0)"),
          ("uses the gap in place of the closing speed", "closing_speeds(contacts.gap, dt)", "contacts.gap"),
          ("uses targets other than the closing speeds", "closing_speeds(contacts.gap, dt)",
           "-closing_speeds(contacts.gap, dt) + 0.1"),
          ("lets gaps close in two steps", "closing_speeds(contacts.gap, dt)",
           "closing_speeds(contacts.gap, 2.0 * dt)"),
          ("lets gaps close in half a step", "closing_speeds(contacts.gap, dt)",
           "closing_speeds(contacts.gap, 0.5 * dt)"),
          ("makes every contact soft", "0.0 * aim", "0.0 * aim + 1.0"),
          ("hands over aim in place of give", "0.0 * aim", "aim"),
          ("exchanges aim and give", "aim, 0.0 * aim", "0.0 * aim, aim"),
          ("starts from zero impulses in every step", KEEP, "J = np.zeros(contacts.p.shape)"),
          ("does not apply the impulses that it keeps", apply, "pass"),
          ("applies the impulses that it keeps, and then starts from zero", apply, f"{apply}; J = 0.0 * J"),
          ("applies the impulses that it keeps twice", apply, f"{apply}; {apply}"),
          ("applies the impulses that it keeps with the other sign", apply, apply.replace("omega, J", "omega, -J")),
          ("applies the impulses that it keeps times dt", apply, apply.replace("omega, J", "omega, dt * J")),
          ("applies the impulses that it keeps without their torque", apply,
           apply.replace("inv_inertia)", "inv_inertia * 0.0)")),
          ("applies all impulses again after the sweeps", ends, f"{apply}; {ends}"),
          ("applies all impulses again in each sweep", LOOP, f"{LOOP}\n        {apply}"),
          ("applies all impulses again before each sweep but the first", LOOP,
           f"for k in range(p.sweeps):\n        if k > 0: {apply}"),
          ("ends the sweeps when they change the impulses by less than a thousandth", LOOP,
           f"last = np.inf\n    {LOOP}\n        if J.size == 0 or "
           "np.max(np.abs(J - last)) < 1e-3 * np.max(np.abs(J)): break\n        last = J"),
          ("keeps impulses from beyond the margin, too", KEEP, "J = kept_impulses(contacts, old, J, np.inf)"),
          ("keeps impulses only from nearer than a part of the margin", KEEP,
           "J = kept_impulses(contacts, old, J, 0.1 * p.margin)"),
          ("keeps nine tenths of the impulses", KEEP, f"{KEEP}; J = 0.9 * J"),
          ("keeps the normal part of the impulses only", KEEP, f"{KEEP}; J = {NORMAL}"),
          ("keeps the friction part of the impulses only", KEEP, f"{KEEP}; J = J - {NORMAL}"),
          ("exchanges the new and the old contacts in kept_impulses", "kept_impulses(contacts, old",
           "kept_impulses(old, contacts"),
          ("keeps the old impulses as they are, wherever their contacts were", KEEP,
           "J = J.copy() if J.shape == contacts.p.shape else np.zeros(contacts.p.shape)"),
          ("makes one sweep only", LOOP, "for _ in range(1):"),
          ("makes one sweep too few", LOOP, "for _ in range(p.sweeps - 1):"),
          ("makes one sweep too many", LOOP, "for _ in range(p.sweeps + 1):"),
          ("makes ten sweeps, regardless of p.sweeps", LOOP, "for _ in range(10):"),
          ("makes twice as many sweeps", LOOP, "for _ in range(2 * p.sweeps):"),
          ("makes no sweep", LOOP, "for _ in range(0):"),
          ("begins each sweep with zero impulses", "omega, J, aim", "omega, 0.0 * J, aim"),
          ("begins each sweep with the velocities before the first one", f"v, omega, J = {sweep}",
           f"_, _, J = {sweep}"),
          ("returns the impulses that it has kept, not those of the sweeps", f"v, omega, J = {sweep}",
           f"v, omega, _ = {sweep}"),
          ("uses the closing speeds in the first sweep only", f"v, omega, J = {sweep}",
           f"v, omega, J = {sweep}; aim = 0.0 * aim"),
          ("moves in every sweep", f"v, omega, J = {sweep}", f"v, omega, J = {sweep}; x = x + dt / p.sweeps * v; "
           "PileState = lambda x_, *rest: type(state)(x, *rest)"),
          ("moves the positions with the old velocities", "x + dt * v,", "x + dt * state.v,"),
          ("rotates with the old angular velocities", moved, spin("omega", "state.omega")),
          ("moves and rotates with the old velocities", f"x + dt * v, {moved}",
           f"x + dt * state.v, {spin('omega', 'state.omega')}"),
          ("moves the positions with the velocities before contact", loads,
           f"{first}; PileState = lambda x_, *rest: type(state)(x + dt * before, *rest)"),
          ("rotates with the angular velocities before contact", loads,
           f"{first}; PileState = lambda x_, q_, *rest: type(state)(x_, {spin('omega', 'spun')}, *rest)"),
          ("moves and rotates with the velocities before contact", loads,
           f"{loads}; {beside}; PileState = lambda x_, q_, *rest: type(state)(y, r, *rest)"),
          ("moves and rotates with the means of old and new velocities", f"x + dt * v, {moved}",
           f"x + 0.5 * dt * (v + state.v), {spin('omega', '(0.5 * omega + 0.5 * state.omega)')}"),
          ("forgets dt beside v", "x + dt * v", "x + v"),
          ("forgets dt beside ω", moved, {"2d": "q + omega", "3d": "turn_quaternions(q, omega, 1.0)"}[dimension]),
          ("does not move the bodies", "x + dt * v", "x"),
          ("does not rotate the bodies", moved, "q"),
          ("rotates the other way", moved, spin("omega", "(-omega)")),
          ("does not move rows of infinite mass", "x + dt * v", "x + dt * v * (p.inv_mass > 0.0)[:, None]"),
          ("does not rotate rows of infinite mass", moved, spin("omega", "(omega.T * (p.inv_mass > 0.0)).T")),
          ("neither moves nor rotates rows of infinite mass", f"x + dt * v, {moved}",
           f"x + dt * v * (p.inv_mass > 0.0)[:, None], {spin('omega', '(omega.T * (p.inv_mass > 0.0)).T')}"),
          ("does not rotate rows of infinite inertia", moved, spin("omega", "(omega * (p.inv_inertia > 0.0))")),
          ("does not move planes", "x + dt * v", "x + dt * v * (np.arange(len(v)) < len(p.half))[:, None]"),
          ("does not rotate planes", moved, spin("omega", "(omega.T * (np.arange(len(v)) < len(p.half))).T")),
          ("neither moves nor rotates planes", f"x + dt * v, {moved}",
           f"x + dt * v * (np.arange(len(v)) < len(p.half))[:, None], "
           f"{spin('omega', '(omega.T * (np.arange(len(v)) < len(p.half))).T')}"),
          ("returns the old velocities", "v, omega, contacts, J)", "state.v, state.omega, contacts, J)"),
          ("returns the velocities before contact", loads,
           f"{first}; PileState = lambda x_, q_, v_, w_, *rest: type(state)(x_, q_, before, spun, *rest)"),
          ("returns the old contacts", "v, omega, contacts, J)", "v, omega, old, J)"),
          ("returns the old impulses", "v, omega, contacts, J)", "v, omega, contacts, state.J)"),
          ("returns zero impulses", "v, omega, contacts, J)", "v, omega, contacts, 0.0 * J)"),
          ("returns v before q", ends, f"return PileState(x + dt * v, v, {moved}, omega, contacts, J)"),
          ("puts slow bodies to rest", ends, f"v = np.where(np.abs(v) < 1e-2, 0.0, v); {ends}"))

edits("10.6",
      ("takes angles into −π … π", "q + dt * omega", "(q + dt * omega + np.pi) % (2.0 * np.pi) - np.pi"),
      ("omits the inertia in the arms", "arms_2d(x, p.inv_mass, p.inv_inertia,",
       "arms_2d(x, p.inv_mass, 0.0 * p.inv_inertia,"),
      ("uses the inverse mass for the inertia in the arms", "arms_2d(x, p.inv_mass, p.inv_inertia,",
       "arms_2d(x, p.inv_mass, p.inv_mass,"),
      ("applies the impulses that it keeps without their force", "arms, p.inv_mass,", "arms, 0.0 * p.inv_mass,"),
      ("omits the friction", "arms, p)", "arms, p._replace(mu=0.0))"),
      ("has no limit of the friction", "arms, p)", "arms, p._replace(mu=np.inf))"),
      ("uses a friction of 0.5 for all scenes", "arms, p)", "arms, p._replace(mu=0.5))"))

MATRICES, BODY = "world_inertia(turn, p.inv_inertia)", "np.stack([np.diag(row) for row in p.inv_inertia])"
edits("10.7",
      ("uses the inertia in body axes in place of world axes", MATRICES, BODY),
      ("uses the inertia in body axes for the arms", "arms_3d(x, p.inv_mass, inv_inertia,",
       f"arms_3d(x, p.inv_mass, {BODY},"),
      ("uses the inertia in body axes for the impulses that it keeps", "arms, p.inv_mass, inv_inertia)",
       f"arms, p.inv_mass, {BODY})"),
      ("uses the inertia in body axes for the sweeps", "inv_inertia, p.mu)", f"{BODY}, p.mu)"),
      ("transposes the rotations", "world_inertia(turn,", "world_inertia(turn.transpose(0, 2, 1),"),
      ("uses the rotation of the first body for all", "world_inertia(turn,", "world_inertia(0.0 * turn + turn[:1],"),
      ("uses the inertia of the orientation after the step", "world_inertia(turn,",
       "world_inertia(bounds(x, turn_quaternions(q, omega, dt), p.half)[2],"),
      ("uses the inertia in place of its inverse", MATRICES,
       "world_inertia(turn, np.where(p.inv_inertia > 0.0, 1.0 / np.maximum(p.inv_inertia, 1e-300), 0.0))"),
      ("uses the first moment of inertia for all axes", MATRICES,
       "world_inertia(turn, p.inv_inertia[:, :1] * np.ones(3))"),
      ("uses the mean of the inverse moments for all axes", MATRICES,
       "world_inertia(turn, np.mean(p.inv_inertia, axis=1).reshape(-1, 1) * np.ones(3))"),
      ("omits the gyroscopic term", "v, omega = new_velocities(load, t, x, q, v, omega, dt, p)",
       "F, tau = load(t, x, q, v, omega, p); v, omega = v + dt * p.inv_mass[:, None] * F, omega + dt * np.stack(["
       + ROTATE.format("p.inv_inertia[i] * unrotate(q[i], tau[i])") + " for i in range(len(q))])"),
      ("returns the impulses that it has kept, not those of the sweeps", KEEP,
       f"{KEEP}; kept = J.copy(); PileState = lambda *parts: type(state)(*parts[:5], kept)"),
      ("uses the exponential in place of turn_quaternions", "turn_quaternions(q, omega, dt)",
       "np.stack([quaternion_product(exponential(dt * omega[i]), q[i]) for i in range(len(q))])"),
      ("does not normalise the quaternions", "turn_quaternions(q, omega, dt)",
       "np.stack([q[i] + 0.5 * dt * quaternion_product(np.append(0.0, omega[i]), q[i]) for i in range(len(q))])"),
      ("multiplies by ω from the right, as if it were in body axes", "turn_quaternions(q, omega, dt)",
       "np.stack([y / np.sqrt(y @ y) for y in (r + 0.5 * dt * quaternion_product(r, np.append(0.0, w)) for r, w in "
       "zip(q, omega))])"),
      ("omits the friction", "p.mu)", "0.0)"),
      ("has no limit of the friction", "p.mu)", "np.inf)"),
      ("uses a friction of 0.5 for all scenes", "p.mu)", "0.5)"))

edits("10.6 10.7",
      ("returns the old contacts where there are as many", "v, omega, contacts, J)",
       "v, omega, old if old.a.size == contacts.a.size else contacts, J)"),
      ("returns normals and places of the old contacts where there are as many", "v, omega, contacts, J)",
       "v, omega, contacts._replace(n=old.n, p=old.p) if old.p.shape == contacts.p.shape else contacts, J)"),
      ("makes no sweep where there is no plane", LOOP, "for _ in range(p.sweeps if len(p.planes) else 0):"),
      ("makes twice as many sweeps where there is no plane", LOOP,
       "for _ in range(p.sweeps if len(p.planes) else 2 * p.sweeps):"),
      ("forgets the impulses of contacts with a gap", KEEP, f"{KEEP} * (contacts.gap < 1e-12)[:, None]"),
      ("forgets the impulses of contacts that overlap", KEEP, f"{KEEP} * (contacts.gap > -1e-12)[:, None]"),
      ("forgets the impulses on bodies that cannot turn", KEEP,
       f"{KEEP} * p.inv_inertia.reshape(len(x), -1)[contacts.a].any(axis=1)[:, None]"),
      ("forgets the impulses between two bodies", KEEP, f"{KEEP} * (contacts.b >= len(p.half))[:, None]"),
      ("forgets the impulses of rows of infinite mass that move", KEEP,
       f"{KEEP} * (1.0 - (p.inv_mass[contacts.b] == 0.0) * v[contacts.b].any(axis=1))[:, None]"),
      ("forgets the impulses of contacts that part", KEEP,
       f"{KEEP} * (np.sum((v[contacts.a] - v[contacts.b]) * contacts.n, axis=1) < 1e-12)[:, None]"))
edits("10.6",
      ("omits the friction where there is no plane", "arms, p)", "arms, p if len(p.planes) else p._replace(mu=0.0))"),
      ("takes infinite friction for 1000", "arms, p)", "arms, p._replace(mu=min(p.mu, 1000.0)))"))
edits("10.7",
      ("omits the friction where there is no plane", "p.mu)", "p.mu if len(p.planes) else 0.0)"),
      ("takes infinite friction for 1000", "p.mu)", "min(p.mu, 1000.0))"))


# 10.8 -----------------------------------------------------------------------------------------------------------
@right("10.8", "coordinate by coordinate")
def support_velocity(place, ball):
    r, w = place - ball.centre, ball.floor_omega
    return ball.floor_v + np.array([w[1] * r[2] - w[2] * r[1], w[2] * r[0] - w[0] * r[2], w[0] * r[1] - w[1] * r[0]])


SUPPORT, WAY = "point_velocity(ball.floor_v, ball.floor_omega, place - ball.centre)", "place - ball.centre"
edits("10.8",
      ("multiplies by μ where that is below 1", "return point", "return min(ball.mu, 1.0) * point"),
      ("multiplies the rotation by the radius", "ball.floor_omega, place", "ball.radius * ball.floor_omega, place"),
      ("takes ω for turns per second", "ball.floor_omega, place", "2.0 * np.pi * ball.floor_omega, place"),
      ("uses the way along x only", "place - ball.centre)", "(place - ball.centre) * np.array([1.0, 0.0, 0.0]))"),
      ("uses the way along y only", "place - ball.centre)", "(place - ball.centre) * np.array([0.0, 1.0, 0.0]))"),
      ("takes slow floors for floors at rest", "return point_velocity(ball.floor_v,",
       "return point_velocity(np.where(np.abs(ball.floor_v) > 1e-9, ball.floor_v, 0.0),"))
edits("10.8",
      ("rotates about the origin", WAY, "place"),
      ("adds the centre", WAY, "place + ball.centre"),
      ("uses the centre in place of the way from it", WAY, "ball.centre"),
      ("reverses the rotation", "ball.floor_omega, place", "-ball.floor_omega, place"),
      ("rotates in place", "point_velocity(ball.floor_v", "point_velocity(0.0 * ball.floor_v"),
      ("omits the rotation", "ball.floor_omega, place", "0.0 * ball.floor_omega, place"),
      ("exchanges velocity and rotation", "ball.floor_v, ball.floor_omega", "ball.floor_omega, ball.floor_v"),
      ("subtracts the velocity of the centre", "point_velocity(ball.floor_v", "point_velocity(-ball.floor_v"),
      ("reverses the whole velocity", SUPPORT, f"-{SUPPORT}"),
      ("adds the velocity of the centre twice", "point_velocity(ball.floor_v", "point_velocity(2.0 * ball.floor_v"),
      ("multiplies ω and the way entry by entry, without a cross product", SUPPORT,
       f"ball.floor_v + ball.floor_omega * ({WAY})"),
      ("multiplies the way by |ω|, without a cross product", SUPPORT,
       f"ball.floor_v + norm(ball.floor_omega) * ({WAY})"),
      ("goes down to the lowest point from the place", WAY, f"{WAY} - np.array([0.0, 0.0, ball.radius])"),
      ("goes up by the radius from the place", WAY, f"{WAY} + np.array([0.0, 0.0, ball.radius])"),
      ("uses the arm of the lowest point in place of the place", WAY, "np.array([0.0, 0.0, -ball.radius])"),
      ("omits the height of the place above the centre", WAY, f"({WAY}) * np.array([1.0, 1.0, 0.0])"),
      ("reverses the height of the place above the centre", WAY, f"({WAY}) * np.array([1.0, 1.0, -1.0])"),
      ("omits the height of the centre", WAY, "place - ball.centre * np.array([1.0, 1.0, 0.0])"),
      ("omits the vertical velocity", SUPPORT, f"{SUPPORT} * np.array([1.0, 1.0, 0.0])"),
      ("uses the rotation about z only", "ball.floor_omega, place",
       "ball.floor_omega * np.array([0.0, 0.0, 1.0]), place"),
      ("rotates about z with the whole size of ω", "ball.floor_omega, place",
       "np.array([0.0, 0.0, norm(ball.floor_omega)]), place"),
      ("forgets the minus in ω_z (−y, x)", SUPPORT,
       f"ball.floor_v + ball.floor_omega[2] * np.array([({WAY})[1], ({WAY})[0], 0.0])"),
      ("has the wrong sign in the second coordinate of the cross product", SUPPORT,
       f"ball.floor_v + np.array([1.0, -1.0, "
       f"1.0]) * cross(ball.floor_omega, {WAY})"),
      ("uses half of ω", "ball.floor_omega, place", "0.5 * ball.floor_omega, place"),
      ("uses 2/7 of ω", "ball.floor_omega, place", "2.0 / 7.0 * ball.floor_omega, place"),
      ("converts ω to degrees", "ball.floor_omega, place", "np.degrees(ball.floor_omega), place"),
      ("divides the way by its length", WAY, f"({WAY}) / norm({WAY})"),
      ("returns the speed", SUPPORT, f"norm({SUPPORT})"),
      ("returns two coordinates only", SUPPORT, f"{SUPPORT}[:2]"),
      ("returns the sizes of the coordinates", SUPPORT, f"np.abs({SUPPORT})"),
      ("exchanges x and y", SUPPORT, f"{SUPPORT}[np.array([1, 0, 2])]"),
      ("subtracts the velocity of the centre from the way", WAY, f"{WAY} - ball.floor_v"),
      ("adds the velocity of the centre to the way", WAY, f"{WAY} + ball.floor_v"),
      ("uses ω × (ω × r), which is an acceleration", SUPPORT,
       f"ball.floor_v + cross(ball.floor_omega, cross(ball.floor_omega, {WAY}))"),
      ("uses ω × v of the centre in place of ω × r", SUPPORT, "ball.floor_v + cross(ball.floor_omega, ball.floor_v)"),
      ("omits ω about z", "ball.floor_omega, place", "ball.floor_omega * np.array([1.0, 1.0, 0.0]), place"),
      ("converts ω from degrees", "ball.floor_omega, place", "np.radians(ball.floor_omega), place"),
      ("returns zero for a floor that does not rotate", "return",
       "return np.zeros(3) if norm(ball.floor_omega) == 0.0 else"),
      ("returns zero at the centre", "return", f"return np.zeros(3) if norm({WAY}) == 0.0 else"),
      ("adds gravity", SUPPORT, f"{SUPPORT} + ball.gravity"),
      ("changes its input in place", WAY, "np.subtract(place, ball.centre, out=place)"))


# 10.9 -----------------------------------------------------------------------------------------------------------
@right("10.9", "by the change of the velocity")
def carried_step(load, t, x, q, v, omega, dt, ball):
    pushed, turned = worked.stop_slip(v, omega, worked.support_velocity(x + dt * v, ball), dt, ball)
    _, _, v_new, omega_new = worked.rigid_body_step(load, t, x, q, pushed, turned, dt, ball)
    spin = worked.exponential(dt * (omega + 0.5 * (omega_new - omega)))
    return x + dt * (v + 0.5 * (v_new - v)), worked.quaternion_product(spin, q), v_new, omega_new


AHEAD, MIDDLE = "support_velocity(x + dt * v, ball)", "0.5 * dt * (omega + omega_new)"
ROTATED = f"quaternion_product(exponential({MIDDLE}), q)"
SLIP = f"pushed, turned = stop_slip(v, omega, {AHEAD}, dt, ball)"
LOADED = "rigid_body_step(load, t, x, q, pushed, turned, dt, ball)"
edits("10.9",
      ("takes the velocity of the floor at the old position", AHEAD, "support_velocity(x, ball)"),
      ("takes the velocity of the floor half a step ahead", AHEAD, "support_velocity(x + 0.5 * dt * v, ball)"),
      ("takes the velocity of the floor two steps ahead", AHEAD, "support_velocity(x + 2.0 * dt * v, ball)"),
      ("takes the velocity of the floor a step behind", AHEAD, "support_velocity(x - dt * v, ball)"),
      ("forgets dt in the place of the floor", AHEAD, "support_velocity(x + v, ball)"),
      ("takes the velocity of the floor where gravity would take the ball", AHEAD,
       "support_velocity(x + dt * v + 0.5 * dt * dt * ball.gravity, ball)"),
      ("evaluates the load at the next position", "(load, t, x,", "(load, t, x + dt * v,"),
      ("lets friction act twice, before and after the load", SLIP,
       f"{SLIP}; a, b = pushed, turned; _, _, a, b = rigid_body_step(load, t, x, q, a, b, dt, ball); "
       f"v_new, omega_new = stop_slip(a, b, {AHEAD}, dt, ball); "
       f"return x + 0.5 * dt * (v + v_new), {ROTATED}, v_new, omega_new"),
      ("takes the floor to be at rest", AHEAD, "0.0 * x"),
      ("omits the rotation of the floor", AHEAD, "ball.floor_v"),
      ("reverses the velocity of the floor", AHEAD, f"-{AHEAD}"),
      ("takes the velocity of the floor where the ball is with the mean velocity", SLIP,
       f"{SLIP}; pushed, turned = stop_slip(v, omega, support_velocity(x + 0.5 * dt * (v + pushed), ball), dt, ball)"),
      ("omits the friction of the floor", "t, x, q, pushed, turned, dt", "t, x, q, v, omega, dt"),
      ("starts the step with the old velocity", "q, pushed, turned", "q, v, turned"),
      ("starts the step with the old spin", "q, pushed, turned", "q, pushed, omega"),
      ("lets friction act for half of the step", f"{AHEAD}, dt, ball", f"{AHEAD}, 0.5 * dt, ball"),
      ("lets friction act for a second", f"{AHEAD}, dt, ball", f"{AHEAD}, 1.0, ball"),
      ("lets friction act twice", SLIP, f"{SLIP}; pushed, turned = stop_slip(pushed, turned, {AHEAD}, dt, ball)"),
      ("lets friction act after the load, not before it", LOADED, f"{LOADED.replace('pushed, turned', 'v, omega')}; "
       f"v_new, omega_new = stop_slip(v_new, omega_new, {AHEAD}, dt, ball)"),
      ("has no limit of the friction", SLIP, SLIP.replace("dt, ball)", "dt, ball._replace(mu=1e9))")),
      ("uses the spin relative to the floor", "stop_slip(v, omega,", "stop_slip(v, omega - ball.floor_omega,"),
      ("uses the velocity relative to the floor, and the floor again", "stop_slip(v,", f"stop_slip(v - {AHEAD},"),
      ("evaluates the load at time 0", "rigid_body_step(load, t, x", "rigid_body_step(load, 0.0, x"),
      ("evaluates the load at t + dt", "rigid_body_step(load, t, x", "rigid_body_step(load, t + dt, x"),
      ("applies the load for half of the step", "turned, dt, ball)", "turned, 0.5 * dt, ball)"),
      ("omits the load", f"_, _, v_new, omega_new = {LOADED}", "v_new, omega_new = pushed, turned"),
      ("adds the load twice", f"_, _, v_new, omega_new = {LOADED}", f"_, _, v_new, omega_new = {LOADED}; "
       f"_, _, v_new, omega_new = {LOADED.replace('pushed, turned', 'v_new, omega_new')}"),
      ("moves the position with the new velocity", "0.5 * dt * (v + v_new)", "dt * v_new"),
      ("moves with the old velocity", "0.5 * dt * (v + v_new)", "dt * v"),
      ("moves with the velocity after friction, without the load", "0.5 * dt * (v + v_new)", "dt * pushed"),
      ("moves with the mean of the velocities before and after friction", "(v + v_new)", "(v + pushed)"),
      ("moves with the mean of the velocities before and after the load", "(v + v_new)", "(pushed + v_new)"),
      ("moves and rotates with the means of the velocities before and after the load", LOADED,
       f"{LOADED}; v, omega = pushed, turned"),
      ("adds ½ dt² times the change of velocity", "0.5 * dt * (v + v_new)", "dt * v + 0.5 * dt * dt * (v_new - v)"),
      ("adds the velocities without halving", "x + 0.5 * dt", "x + dt"),
      ("forgets dt beside the mean velocity", "x + 0.5 * dt *", "x + 0.5 *"),
      ("does not move", "x + 0.5 * dt * (v + v_new)", "x"),
      ("uses the orientation of rigid_body_step", f"q = {ROTATED}", f"_, q, _, _ = {LOADED}"),
      ("uses position and orientation of rigid_body_step", f"_, _, v_new, omega_new = {LOADED}", f"return {LOADED}"),
      ("rotates with the new spin", MIDDLE, "dt * omega_new"),
      ("rotates with the old spin", MIDDLE, "dt * omega"),
      ("rotates with the mean of the spins before and after friction", "(omega + omega_new)", "(omega + turned)"),
      ("does not rotate", ROTATED, "q"),
      ("rotates the other way", MIDDLE, f"-{MIDDLE}"),
      ("adds the rotations without halving", "exponential(0.5 * dt", "exponential(dt"),
      ("halves the mean rotation once more", "exponential(0.5 * dt", "exponential(0.25 * dt"),
      ("uses quaternion_update in place of the exponential", ROTATED,
       "quaternion_update(q, 0.5 * (omega + omega_new), dt)"),
      ("multiplies the rotation from the right, as if it were in body coordinates", ROTATED,
       f"quaternion_product(q, exponential({MIDDLE}))"),
      ("converts the mean spin to body axes", MIDDLE, "0.5 * dt * unrotate(q, omega + omega_new)"),
      ("returns the old spin", "q, v_new, omega_new", "q, v_new, omega"),
      ("returns the old velocity", "q, v_new, omega_new", "q, v, omega_new"),
      ("returns the old velocity and spin", "q, v_new, omega_new", "q, v, omega"),
      ("returns the velocities after friction, without the load", "q, v_new, omega_new", "q, pushed, turned"),
      ("returns v before q", "q, v_new, omega_new", "v_new, q, omega_new"),
      ("changes its input in place", "x + 0.5 * dt * (v + v_new)", "np.add(x, 0.5 * dt * (v + v_new), out=x)"))


# 10.10 ----------------------------------------------------------------------------------------------------------
@right("10.10", "from the deceleration of the slip")
def slip_time(v, omega, ball):
    r = np.array([0.0, 0.0, -ball.radius])
    u = (v + np.cross(omega, r))[:2]
    size = np.hypot(u[0], u[1])
    if size == 0.0:
        return 0.0
    K = 1.0 / ball.m + ball.radius**2 / ball.I_body[0]
    force = ball.mu * ball.m * -ball.gravity[2] if ball.gravity[2] < 0.0 else 0.0
    slower = force * K - ball.gravity[:2] @ u / size
    return size / slower if slower > 0.0 else np.inf


SPUN, RUBS = "ball.m * ball.radius * ball.radius / ball.I_body[0]", "cone_radius(ball.mu, -ball.gravity[2])"
ENDS, LOWEST = "size / rate if rate > 0.0 else np.inf", "point_velocity(v, omega, np.array([0.0, 0.0, -ball.radius]))"
edits("10.10",
      ("uses the size of the slip along x only", "norm(slip)", "abs(slip[0])"),
      ("returns zero where nothing changes the slip", "np.inf", "(0.0 if rate == 0.0 else np.inf)"),
      ("returns infinity for infinite friction", "if rate > 0.0", "if 0.0 < rate < np.inf"),
      ("uses the velocity of the highest point, or reverses the spin", "-ball.radius]", "ball.radius]"),
      ("uses an arm of length 1 in place of the radius", "-ball.radius]", "-1.0]"),
      ("omits the spin", "point_velocity(v, omega,", "point_velocity(v, 0.0 * omega,"),
      ("omits the velocity of the centre", "point_velocity(v,", "point_velocity(0.0 * v,"),
      ("adds |ω| times the radius along x", LOWEST, "v + norm(omega) * ball.radius * np.array([1.0, 0.0, 0.0])"),
      ("keeps the vertical part of the slip", "slip[2] = 0.0", "pass"),
      ("uses the slip along x only", "slip[2] = 0.0", "slip[2] = 0.0; slip[1] = 0.0"),
      ("uses the speed of the centre in place of the slip", "norm(slip)", "norm(v * np.array([1.0, 1.0, 0.0]))"),
      ("uses the speed of the centre, with its vertical part, in place of the slip", "norm(slip)", "norm(v)"),
      ("uses the slip along the velocity only", "norm(slip)", "abs(dot(slip, v)) / np.maximum(norm(v), 1e-300)"),
      ("omits the effect of friction on the spin", f"(1.0 + {SPUN})", "1.0"),
      ("counts the effect of friction on the spin only", f"(1.0 + {SPUN})", f"({SPUN})"),
      ("reverses the effect of friction on the spin", "(1.0 + ball.m", "(1.0 - ball.m"),
      ("uses the reciprocal of m r²/I", SPUN, "ball.I_body[0] / (ball.m * ball.radius * ball.radius)"),
      ("divides by 1 + I/(m r²)", f"(1.0 + {SPUN})",
       "1.0 / (1.0 + ball.I_body[0] / (ball.m * ball.radius * ball.radius))"),
      ("uses the inertia of a solid ball for all balls", f"(1.0 + {SPUN})", "3.5"),
      ("forgets the mass beside the inertia", "1.0 + ball.m *", "1.0 +"),
      ("has the mass twice beside the inertia", "1.0 + ball.m *", "1.0 + ball.m * ball.m *"),
      ("forgets the square of the radius", "ball.radius * ball.radius /", "ball.radius /"),
      ("does not divide by the moment of inertia", "/ ball.I_body[0])", ")"),
      ("adds gravity along the slope in place of subtracting it", "- along", "+ along"),
      ("omits gravity along the slope", "- along", ""),
      ("takes gravity along the slope to help the slip always", "- along", "- abs(along)"),
      ("ignores gravity that brakes the slip", "- along", "- np.maximum(along, 0.0)"),
      ("ignores gravity that helps the slip", "- along", "- np.minimum(along, 0.0)"),
      ("does not divide u · g by |u|", "dot(slip, ball.gravity) / size", "dot(slip, ball.gravity)"),
      ("uses the coordinate x of gravity along the slope", "dot(slip, ball.gravity) / size", "ball.gravity[0]"),
      ("lets gravity along the slope turn the ball, too", f"(1.0 + {SPUN}) - along",
       f"(1.0 + {SPUN}) - along * (1.0 + {SPUN})"),
      ("uses the whole gravity in the friction", RUBS, "ball.mu * norm(ball.gravity)"),
      ("uses 9.81 m/s² in the friction", RUBS, "ball.mu * 9.81"),
      ("uses g_z with its sign: friction speeds the slip up", RUBS, "ball.mu * ball.gravity[2]"),
      ("multiplies friction by the mass", RUBS, f"ball.m * {RUBS}"),
      ("omits the friction coefficient", RUBS, "-ball.gravity[2]"),
      ("forgets gravity in the friction", RUBS, "ball.mu"),
      ("returns infinity where the ball does not slip", "return 0.0", "return np.inf"),
      ("takes a slow slip for none", "size == 0.0", "size < 1e-3"),
      ("returns a finite time where the slip never ends", ENDS, "size / rate"),
      ("returns the size of a time that is negative", ENDS, "size / abs(rate)"),
      ("returns a huge time where the slip never ends", ENDS, "size / np.maximum(rate, 1e-30)"),
      ("returns zero where it slips forever", "else np.inf", "else 0.0"),
      ("returns −1 where it slips forever", "else np.inf", "else -1.0"),
      ("returns None where it slips forever", "else np.inf", "else None"),
      ("returns infinity where gravity helps the slip", "if rate > 0.0", "if rate > 0.0 and along <= 0.0"),
      ("returns infinity on every slope", "if rate > 0.0", "if rate > 0.0 and along == 0.0"),
      ("returns infinity where there is no friction, even if gravity brakes", "if rate > 0.0",
       "if rate > 0.0 and ball.mu > 0.0"),
      ("returns the rate, not the time", "return size / rate", "return rate"),
      ("returns the reciprocal", "return size / rate", "return rate / size"),
      ("returns half of the time, as for a way", "return size / rate", "return 0.5 * size / rate"),
      ("squares the slip", "return size / rate", "return size * size / rate"),
      ("divides by the radius", "return size / rate", "return size / ball.radius / rate"),
      ("returns the time until the centre stops", "return size / rate", "return norm(v) / rate"),
      ("changes its input in place", LOWEST, "np.add(v, cross(omega, np.array([0.0, 0.0, -ball.radius])), out=v)"),
      ("sets v_z to 0 in its input", "slip[2] = 0.0", "slip[2] = v[2] = 0.0"))


# 10.11 ----------------------------------------------------------------------------------------------------------
@right("10.11", "as a loop over both parts")
def exact_rolling_step(load, t, x, q, v, omega, dt, ball):
    state, first = (x, q, v, omega), min(dt, worked.slip_time(v, omega, ball))
    for begins, part in ((t, first), (t + first, dt - first)):
        state = worked.average_rolling_step(load, begins, *state, part, ball)
    return state


@right("10.11", "in one part where it slips or rolls all the time")
def exact_rolling_step(load, t, x, q, v, omega, dt, ball):               # noqa: F811
    ends = worked.slip_time(v, omega, ball)
    if ends == 0.0 or ends >= dt:
        return worked.average_rolling_step(load, t, x, q, v, omega, dt, ball)
    x, q, v, omega = worked.average_rolling_step(load, t, x, q, v, omega, ends, ball)
    return worked.average_rolling_step(load, t + ends, x, q, v, omega, dt - ends, ball)


UNTIL, ONE = "np.minimum(dt, slip_time(v, omega, ball))", "average_rolling_step(load, t, x, q, v, omega, first, ball)"
TWO = "average_rolling_step(load, t + first, x, q, v, omega, dt - first, ball)"
ROLLING = "rigid_body_step(load, {}, x, q, *stop_slip(v, omega, 0.0 * v, {}, ball), {}, ball)"
edits("10.11",
      ("does not divide the step where the slip ends", UNTIL, "dt"),
      ("advances the first part only", TWO, "x, q, v, omega"),
      ("lets the first part be longer than the step", UNTIL, "slip_time(v, omega, ball)"),
      ("lets the first part be longer than the step, if it ends at all", f"first = {UNTIL}",
       "first = slip_time(v, omega, ball); first = dt if first == np.inf else first"),
      ("uses rolling_step's positions in both parts", f"first = {UNTIL}", f"first = {UNTIL}; "
       f"x, q, v, omega = {ROLLING.format('t', 'first', 'first')}; "
       f"return {ROLLING.format('t + first', '(dt - first)', 'dt - first')}"),
      ("evaluates the loads at times from 0", f"first = {UNTIL}", f"first = {UNTIL}; t = 0.0"),
      ("takes the longer of the two times", "np.minimum(dt, slip", "np.maximum(dt, slip"),
      ("makes the second part as long as the step", "omega, dt - first, ball)", "omega, dt, ball)"),
      ("makes the second part, if there is one, as long as the step", "omega, dt - first, ball)",
       "omega, dt if first < dt else 0.0, ball)"),
      ("goes back in the second part", "dt - first", "first - dt"),
      ("makes the second part as long as the first", "omega, dt - first, ball)", "omega, first, ball)"),
      ("exchanges the lengths of both parts", UNTIL, f"dt - {UNTIL}"),
      ("advances each part by half of the step", f"first = {UNTIL}", "first = 0.5 * dt"),
      ("ends the first part after half of the slip time", "slip_time(v, omega, ball))",
       "0.5 * slip_time(v, omega, ball))"),
      ("ends the first part after twice the slip time", "slip_time(v, omega, ball))",
       "2.0 * slip_time(v, omega, ball))"),
      ("ends the first part a little too early", UNTIL, f"0.99 * {UNTIL}"),
      ("ends the first part a little too late", "slip_time(v, omega, ball))", "1.01 * slip_time(v, omega, ball))"),
      ("exchanges v and ω in the call of slip_time", "slip_time(v, omega,", "slip_time(omega, v,"),
      ("omits the spin in the call of slip_time", "slip_time(v, omega,", "slip_time(v, 0.0 * omega,"),
      ("evaluates the first part at time 0", "average_rolling_step(load, t, x", "average_rolling_step(load, 0.0, x"),
      ("evaluates the first part at t + dt", "average_rolling_step(load, t, x", "average_rolling_step(load, t + dt, x"),
      ("starts the second part at the length of the first, not at t plus it", "load, t + first", "load, first"),
      ("starts the second part at time t", "load, t + first", "load, t"),
      ("starts the second part at t + dt", "load, t + first", "load, t + dt"),
      ("starts the second part from the state at the beginning", "x, q, v, omega = average", "_, _, _, _ = average"),
      ("starts the second part at the old position", "x, q, v, omega = average", "_, q, v, omega = average"),
      ("starts the second part with the old orientation", "x, q, v, omega = average", "x, _, v, omega = average"),
      ("starts the second part with the old velocity", "x, q, v, omega = average", "x, q, _, omega = average"),
      ("starts the second part with the old spin", "x, q, v, omega = average", "x, q, v, _ = average"),
      ("starts the second part with the old velocity and spin", "x, q, v, omega = average", "x, q, _, _ = average"),
      ("omits the friction in the first part", "omega, first, ball)", "omega, first, ball._replace(mu=0.0))"),
      ("omits the friction in the second part", "dt - first, ball)", "dt - first, ball._replace(mu=0.0))"),
      ("uses rolling_step's positions in the first part", ONE, ROLLING.format("t", "first", "first")),
      ("uses rolling_step's positions in the second part", TWO,
       ROLLING.format("t + first", "(dt - first)", "dt - first")),
      ("uses rigid_body_step, without friction, in the first part", ONE, ONE.replace("average_rolling", "rigid_body")),
      ("uses rigid_body_step, without friction, in the second part", TWO, TWO.replace("average_rolling", "rigid_body")),
      ("leaves a ball that rolls where it is", f"first = {UNTIL}",
       f"first = {UNTIL}\n    if first == 0.0: return x, q, v, omega"),
      ("leaves a ball that slips for the whole step where it is", f"first = {UNTIL}",
       f"first = {UNTIL}\n    if first == dt: return x, q, v, omega"),
      ("leaves a ball that never ceases to slip where it is", f"first = {UNTIL}",
       f"first = {UNTIL}\n    if slip_time(v, omega, ball) == np.inf: return x, q, v, omega"),
      ("lets the ball roll on with the velocities at the end of the slip", TWO,
       "(x + (dt - first) * v, quaternion_product(exponential((dt - first) * omega), q), v, omega)"),
      ("sets ω by hand in the second part, and loses the spin about z", f"return {TWO}",
       f"omega = np.array([-v[1], v[0], 0.0]) / ball.radius; return {TWO}"),
      ("loses the spin about z in the second part", f"return {TWO}",
       f"omega = omega * np.array([1.0, 1.0, 0.0]); return {TWO}"),
      ("returns the velocities at the end of the slip", f"return {TWO}",
       "v_1, w_1 = v, omega; " + f"x, q, _, _ = {TWO}; return x, q, v_1, w_1"),
      ("advances a whole step after both parts", f"return {TWO}", f"x, q, v, omega = {TWO}; "
       "return average_rolling_step(load, t + dt, x, q, v, omega, dt, ball)"),
      ("uses the mean of the positions after both parts", f"return {TWO}",
       f"y = x; x, q, v, omega = {TWO}; return 0.5 * (x + y), q, v, omega"),
      ("returns v before q", f"return {TWO}", f"x, q, v, omega = {TWO}; return x, v, q, omega"))


# 10.12 ----------------------------------------------------------------------------------------------------------
@right("10.12", "by the impulse at the corner")
def corner_impact(v, omega, r, inv_mass, inv_inertia):
    lever = np.array([-r[1], r[0]])
    K = inv_mass * np.eye(2) + inv_inertia * np.outer(lever, lever)
    J = -np.linalg.solve(K, v + omega * lever)
    return v + inv_mass * J, omega + inv_inertia * (lever @ J)


SQUARE, ACROSS = "(r[0] * r[0] + r[1] * r[1])", "np.array([r[1], -r[0]])"
MOMENT, ANGULAR = f"1.0 / inv_inertia + {SQUARE} / inv_mass", "L = omega / inv_inertia - cross_2d(r, v) / inv_mass"
SPIN_OF = f"omega = L / ({MOMENT})"
AFTER = f"return omega * {ACROSS}, omega"
edits("10.12",
      ("lets nothing that turns to the left turn back", SPIN_OF,
       f"spin, omega = omega, L / ({MOMENT}); omega = max(omega, 0.0) if spin > 0.0 else omega"),
      ("lets nothing that turns to the right turn back", SPIN_OF,
       f"spin, omega = omega, L / ({MOMENT}); omega = min(omega, 0.0) if spin < 0.0 else omega"),
      ("halves the new spin", "omega = L / (", "omega = 0.5 * L / ("),
      ("exchanges masses and their inverses in the inertia about the corner",
       "(1.0 / inv_inertia + (r[0] * r[0] + r[1] * r[1]) / inv_mass)",
       "(inv_inertia + (r[0] * r[0] + r[1] * r[1]) * inv_mass)"),
      ("omits the orbital angular momentum", "omega / inv_inertia - cross_2d(r, v) / inv_mass", "omega / inv_inertia"),
      ("omits the spin in the angular momentum", "omega / inv_inertia - cross", "-cross"),
      ("reverses the orbital angular momentum", "- cross_2d(r, v)", "+ cross_2d(r, v)"),
      ("reverses the spin in the angular momentum", "L = omega /", "L = -omega /"),
      ("forgets the mass beside r × v", "cross_2d(r, v) / inv_mass", "cross_2d(r, v)"),
      ("uses the mass in place of its inverse beside r × v", "cross_2d(r, v) / inv_mass", "cross_2d(r, v) * inv_mass"),
      ("uses the inertia's inverse in place of the inertia", "omega / inv_inertia", "omega * inv_inertia"),
      ("exchanges inv_mass and inv_inertia, or takes them for m and I", ANGULAR,
       f"inv_mass, inv_inertia = 1.0 / inv_mass, 1.0 / inv_inertia; {ANGULAR}"),
      ("uses r · v in place of r × v", "cross_2d(r, v)", "(r @ v)"),
      ("uses |r| |v| in place of r × v", "cross_2d(r, v)", "np.sqrt(r @ r) * np.sqrt(v @ v)"),
      ("uses the inertia about the centre, not about the corner", f"({MOMENT})", "(1.0 / inv_inertia)"),
      ("uses m |r|² alone as the inertia about the corner", f"({MOMENT})", f"({SQUARE} / inv_mass)"),
      ("subtracts m |r|² from the inertia", "inv_inertia + (r", "inv_inertia - (r"),
      ("halves m |r|²", SQUARE, f"0.5 * {SQUARE}"),
      ("adds the inverses of the two parts of the inertia", SPIN_OF,
       f"omega = L * (inv_inertia + inv_mass / {SQUARE})"),
      ("uses 4/3 m |r|², the inertia of a block, for all bodies", MOMENT, f"4.0 / 3.0 * {SQUARE} / inv_mass"),
      ("forgets the mass in the inertia about the corner", f"{SQUARE} / inv_mass", SQUARE),
      ("forgets the square of the distance", f"{SQUARE} / inv_mass", f"np.sqrt{SQUARE} / inv_mass"),
      ("uses r_x only in the distance", SQUARE, "(r[0] * r[0])"),
      ("uses r_y only in the distance", SQUARE, "(r[1] * r[1])"),
      ("uses Housner's ratio for all bodies", SPIN_OF, f"omega = omega * (1.0 - 1.5 * r[0] ** 2 / {SQUARE})"),
      ("uses Housner's ratio with the angle to the other side", SPIN_OF,
       f"omega = omega * (1.0 - 1.5 * r[1] ** 2 / {SQUARE})"),
      ("keeps the energy in place of the angular momentum", SPIN_OF,
       f"omega = np.sqrt(((v @ v) / inv_mass + omega * omega / inv_inertia) / ({MOMENT}))"),
      ("keeps the energy in place of the angular momentum, and the sign of ω", SPIN_OF,
       f"omega = np.sign(omega) * np.sqrt(((v @ v) / inv_mass + omega * omega / inv_inertia) / ({MOMENT}))"),
      ("uses the size of the angular momentum", SPIN_OF, f"omega = abs(L) / ({MOMENT})"),
      ("keeps the spin, and only moves the centre round the corner", SPIN_OF, "pass"),
      ("returns the angular momentum in place of ω", "omega = L / (", "omega = L; _ = 1.0 / ("),
      ("returns the old spin", ANGULAR,
       f"old = omega; {ANGULAR}; omega = L / ({MOMENT}); return omega * {ACROSS}, old"),
      ("uses the old spin for the velocity", ANGULAR,
       f"old = omega; {ANGULAR}; omega = L / ({MOMENT}); return old * {ACROSS}, omega"),
      ("changes nothing", AFTER, "return v, (L + cross_2d(r, v) / inv_mass) * inv_inertia"),
      ("stops the body", AFTER, "return 0.0 * v, 0.0 * omega"),
      ("sets the velocity of the centre to zero", f"omega * {ACROSS}", "0.0 * v"),
      ("keeps the velocity of the centre", f"omega * {ACROSS}", "v"),
      ("keeps v, and divides by the inertia about the centre", SPIN_OF, "return v, L * inv_inertia"),
      ("rotates away from the corner", ACROSS, "np.array([-r[1], r[0]])"),
      ("moves along r in place of across it", ACROSS, "r"),
      ("moves by ω (r_y, r_x): forgets the minus", ACROSS, "np.array([r[1], r[0]])"),
      ("moves by ω (−r_y, −r_x)", ACROSS, "np.array([-r[1], -r[0]])"),
      ("exchanges r_x and r_y in the velocity", ACROSS, "np.array([-r[0], r[1]])"),
      ("divides the velocity by |r|", ACROSS, f"{ACROSS} / np.sqrt(r @ r)"),
      ("keeps the speed of the centre", f"omega * {ACROSS}", f"np.sqrt(v @ v) / np.sqrt(r @ r) * {ACROSS}"),
      ("reverses ω and v", SPIN_OF, f"omega = -L / ({MOMENT})"),
      ("bounces: adds the impulse twice", ANGULAR, f"old = omega; {ANGULAR}; omega = L / ({MOMENT}); "
       f"return 2.0 * omega * {ACROSS} - v, 2.0 * omega - old"),
      ("stops only the velocity of the corner along y", ANGULAR,
       "J = -(v[1] + omega * r[0]) / (inv_mass + inv_inertia * r[0] ** 2); "
       "return v + J * inv_mass * np.array([0.0, 1.0]), omega + inv_inertia * r[0] * J"),
      ("stops only the velocity of the corner along x", ANGULAR,
       "J = -(v[0] - omega * r[1]) / (inv_mass + inv_inertia * r[1] ** 2); "
       "return v + J * inv_mass * np.array([1.0, 0.0]), omega - inv_inertia * r[1] * J"),
      ("stops only the velocity of the centre along r", ANGULAR, "return v - (v @ r) / (r @ r) * r, omega"),
      ("divides the velocity of the corner by 1/m + |r|²/I, regardless of its direction", ANGULAR,
       "lever = np.array([-r[1], r[0]]); J = -(v + omega * lever) / (inv_mass + inv_inertia * (r @ r)); "
       "return v + inv_mass * J, omega + inv_inertia * (lever @ J)"),
      ("takes r from the corner to the centre", ANGULAR, f"r = -r; {ANGULAR}"),
      ("uses the corner on the other side", ANGULAR, f"r = r * np.array([-1.0, 1.0]); {ANGULAR}"),
      ("returns ω before v", AFTER, f"return omega, omega * {ACROSS}"),
      ("returns v only", AFTER, f"return omega * {ACROSS}"),
      ("changes its input in place", f"omega * {ACROSS}", f"np.multiply(omega, {ACROSS}, out=v)"))


# 10.13 and 10.14 ------------------------------------------------------------------------------------------------
@right("10.13", "each kind for all bodies")
def mechanical_energy(x, q, v, omega, p):
    moves = np.flatnonzero(p.inv_mass > 0.0)
    m = 1.0 / p.inv_mass[moves]
    spin = sum(0.5 * np.sum((rotation_matrix(q[i]).T @ omega[i]) ** 2 / p.inv_inertia[i])
               for i in moves if p.inv_inertia[i, 0] > 0.0)
    return np.sum(0.5 * m * np.sum(v[moves] ** 2, axis=1)) - m @ (x[moves] @ p.gravity) + spin


@right("10.14", "with whole tensors")
def momenta(x, q, v, omega, p):
    P, L = np.zeros(3), np.zeros(3)
    for i in np.flatnonzero(p.inv_mass > 0.0):
        R, one = rotation_matrix(q[i]), v[i] / p.inv_mass[i]
        P, L = P + one, L + np.cross(x[i], one)
        if p.inv_inertia[i].any():
            L = L + R @ np.diag(1.0 / p.inv_inertia[i]) @ R.T @ omega[i]
    return P, L


COUNTS, ROTATES = "if p.inv_mass[i] > 0.0:", "if p.inv_inertia[i, 0] > 0.0:"
edits("10.13 10.14",
      ("counts the first row only", "range(x.shape[0])", "range(1)"),
      ("omits the first row", "range(x.shape[0])", "range(1, x.shape[0])"),
      ("omits the last row", "range(x.shape[0])", "range(x.shape[0] - 1)"),
      ("ends at the first row that cannot move", COUNTS, "if p.inv_mass[i] == 0.0: break\n        else:"),
      ("omits bodies that cannot turn", COUNTS, "if p.inv_mass[i] > 0.0 and p.inv_inertia[i, 0] > 0.0:"),
      ("divides by an inverse mass of zero", COUNTS, "if True:"),
      ("counts rows with inv_mass 0 that can turn, too", COUNTS, "if p.inv_mass[i] + p.inv_inertia[i, 0] > 0.0:"),
      ("divides by an inverse inertia of zero", ROTATES, "if True:"),
      ("ends at the first row that cannot turn", ROTATES, "if p.inv_inertia[i, 0] == 0.0: break\n            else:"),
      ("uses the orientation of the first row for all", "(q[i], omega", "(q[0], omega"),
      ("ignores the orientation", "(q[i], omega", "(np.array([1.0, 0.0, 0.0, 0.0]), omega"),
      ("uses the inverse orientation", "(q[i], omega", "(q[i] * np.array([1.0, -1.0, -1.0, -1.0]), omega"),
      ("uses the inertia of the first row for all", "p.inv_inertia[i])", "p.inv_inertia[0])"),
      ("uses the moments of inertia in reverse order", "p.inv_inertia[i])", "p.inv_inertia[i, ::-1])"),
      ("uses the first moment of inertia for all axes", "p.inv_inertia[i])", "(p.inv_inertia[i, 0] * np.ones(3)))"),
      ("uses the mean of the inverse moments for all axes", "p.inv_inertia[i])",
       "(np.mean(p.inv_inertia[i]) * np.ones(3)))"))

KINETIC, POTENTIAL = "0.5 * dot(v[i], v[i])", "- dot(p.gravity, x[i])"
MASS, ROTATION = "x[i])) / p.inv_mass[i]", "0.5 * np.sum(w * w / p.inv_inertia[i])"
edits("10.13",
      ("reverses the sign of the energy of translation", "0.5 * dot(v[i], v[i])", "-0.5 * dot(v[i], v[i])"),
      ("divides by the number of rows", "return energy", "return energy / x.shape[0]"),
      ("reverses the sign of the potential energy", POTENTIAL, "+ dot(p.gravity, x[i])"),
      ("omits the potential energy", POTENTIAL, ""),
      ("forgets the mass in the potential energy", POTENTIAL, "- dot(p.gravity, x[i]) * p.inv_mass[i]"),
      ("uses z only in the potential energy", POTENTIAL, "- p.gravity[2] * x[i, 2]"),
      ("uses |g| z in the potential energy", POTENTIAL, "+ norm(p.gravity) * x[i, 2]"),
      ("uses 9.81 z in the potential energy", POTENTIAL, "+ 9.81 * x[i, 2]"),
      ("measures heights from the first row", POTENTIAL, "- dot(p.gravity, x[i] - x[0])"),
      ("measures heights from the lowest row", POTENTIAL, "- dot(p.gravity, x[i] - x[np.argmin(x[:, 2])])"),
      ("omits the factor ½ of the translation", KINETIC, "dot(v[i], v[i])"),
      ("omits the translation", KINETIC, "0.0"),
      ("forgets the square of the speed", KINETIC, "0.5 * norm(v[i])"),
      ("uses v_x only", KINETIC, "0.5 * v[i, 0] ** 2"),
      ("adds ω × x to the velocity", KINETIC, "0.5 * norm(v[i] + cross(omega[i], x[i])) ** 2"),
      ("forgets the mass", MASS, "x[i]))"),
      ("multiplies by the inverse mass", MASS, "x[i])) * p.inv_mass[i]"),
      ("omits the rotation", ROTATION, "0.0"),
      ("omits the factor ½ of the rotation", "0.5 * np.sum", "np.sum"),
      ("omits the factor ½ of translation and rotation", "return energy", "return energy + np.sum((energy + np.sum("
       "x[p.inv_mass > 0.0] @ p.gravity / p.inv_mass[p.inv_mass > 0.0])))"),
      ("multiplies by the inverse inertia in place of the inertia", "w * w / p.inv_inertia[i]",
       "w * w * p.inv_inertia[i]"),
      ("forgets the inertia", "w * w / p.inv_inertia[i]", "w * w"),
      ("forgets the squares of ω", "w * w / p", "w / p"),
      ("squares the sum of I ω", "np.sum(w * w / p.inv_inertia[i])", "np.sum(w / p.inv_inertia[i]) ** 2"),
      ("uses the rotation about z only", "np.sum(w * w / p.inv_inertia[i])", "(w * w / p.inv_inertia[i])[2]"),
      ("keeps the last row only", "energy += (0.5", "energy = (0.5"),
      ("counts rows with inv_mass 0 with a mass of 1", COUNTS,
       "if p.inv_mass[i] == 0.0: energy += 0.5 * dot(v[i], v[i])\n        else:"),
      ("counts the rotation of rows with inv_mass 0, too", COUNTS,
       "if p.inv_mass[i] == 0.0 and p.inv_inertia[i, 0] > 0.0: w = unrotate(q[i], omega[i]); "
       f"energy += {ROTATION}\n        {COUNTS}"),
      ("returns the energy per mass", "return energy", "return energy / np.sum(1.0 / p.inv_mass[p.inv_mass > 0.0])"),
      ("returns the size of the energy", "return energy", "return abs(energy)"))

ORBIT, OWN = "cross(x[i], v[i]) / p.inv_mass[i]", "body_angular_momentum(q[i], omega[i], 1.0 / p.inv_inertia[i])"
edits("10.14",
      ("converts ω to body axes", "omega[i], 1.0", "unrotate(q[i], omega[i]), 1.0"),
      ("adds velocities in place of momenta", "P += v[i] / p.inv_mass[i]", "P += v[i]"),
      ("multiplies by the inverse mass", "P += v[i] / p.inv_mass[i]", "P += v[i] * p.inv_mass[i]"),
      ("multiplies the orbital part by the inverse mass", ORBIT, "cross(x[i], v[i]) * p.inv_mass[i]"),
      ("forgets the mass in the orbital part", ORBIT, "cross(x[i], v[i])"),
      ("omits the orbital angular momentum", ORBIT, "0.0"),
      ("takes v × x in place of x × v", "cross(x[i], v[i])", "cross(v[i], x[i])"),
      ("measures places from the first row", "cross(x[i], v[i])", "cross(x[i] - x[0], v[i])"),
      ("measures velocities from the first row", "cross(x[i], v[i])", "cross(x[i], v[i] - v[0])"),
      ("adds gravity to the momentum", "P += v[i] / p.inv_mass[i]", "P += v[i] / p.inv_mass[i] + p.gravity"),
      ("adds ω × x to the velocity in P", "P += v[i]", "P += (v[i] + cross(omega[i], x[i]))"),
      ("squares the velocities", "P += v[i]", "P += v[i] * v[i]"),
      ("omits the spin", OWN, "0.0"),
      ("subtracts the spin", f"L += {OWN}", f"L -= {OWN}"),
      ("halves the spin", OWN, f"0.5 * {OWN}"),
      ("uses ω alone as the spin", OWN, "omega[i]"),
      ("leaves the spin in body axes", OWN, "unrotate(q[i], omega[i]) / p.inv_inertia[i]"),
      ("takes ω to be in body axes", OWN, ROTATE.format("omega[i] / p.inv_inertia[i]")),
      ("uses the inverse inertia in place of the inertia", "1.0 / p.inv_inertia[i]", "p.inv_inertia[i]"),
      ("multiplies the spin by the mass", OWN, f"{OWN} / p.inv_mass[i]"),
      ("squares ω", "omega[i], 1.0", "omega[i] * omega[i], 1.0"),
      ("keeps the momentum of the last row only", "P += v", "P = v"),
      ("keeps the orbital part of the last row only", "L += cross", "L = cross"),
      ("loses the orbital part where a row can turn", f"L += {OWN}", f"L = {OWN}"),
      ("has one array for P and L", "P, L = np.zeros(3), np.zeros(3)", "P = L = np.zeros(3)"),
      ("counts rows with inv_mass 0 with a mass of 1", COUNTS, "if p.inv_mass[i] == 0.0: P += v[i]\n        else:"),
      ("counts the spin of rows with inv_mass 0, too", COUNTS,
       f"if p.inv_mass[i] == 0.0 and p.inv_inertia[i, 0] > 0.0: L += {OWN}\n        {COUNTS}"),
      ("returns L about the centre of mass", "return P, L", "k = p.inv_mass > 0.0; return P, L - cross(np.sum(x[k].T / "
       "p.inv_mass[k], axis=1) / np.sum(1.0 / p.inv_mass[k]), P)"),
      ("returns the mean velocity in place of the momentum", "return P, L",
       "return P / np.sum(1.0 / p.inv_mass[p.inv_mass > 0.0]), L"),
      ("returns L along z only", "return P, L", "return P, L * np.array([0.0, 0.0, 1.0])"),
      ("returns the sizes of P and L", "return P, L", "return norm(P), norm(L)"),
      ("returns P and L in one array", "return P, L", "return np.concatenate((P, L))"),
      ("returns P only", "return P, L", "return P"),
      ("returns L only", "return P, L", "return L"),
      ("returns L first", "return P, L", "return L, P"))


# 10.15 ----------------------------------------------------------------------------------------------------------
@right("10.15", "by all pairs of times")
def gain_without_source(energies, work):
    energies, work = worked.checked_histories(energies, work)
    rest = energies - work
    return max(rest[k] - rest[:k + 1].min() for k in range(len(rest)))


@right("10.15", "from behind")
def gain_without_source(energies, work):                                 # noqa: F811
    energies, work = worked.checked_histories(energies, work)
    rest = energies - work
    return np.max(np.maximum.accumulate(rest[::-1])[::-1] - rest)


CHECK, REST, DONE = "checked_histories(energies, work)", "energies[k] - work[k]", "return gain"
OVER = "for k in range(energies.size):"
PAIRS = "return max([0.0] + [{} for k in range(energies.size) for j in range(k + 1)])"
ALL = "e = energies - work; return {}"
edits("10.15",
      ("takes gains below 1e-12 J for none", DONE, "return gain if gain > 1e-12 else 0.0"),
      ("measures the gain from the mean value", "rest - lowest", "rest - np.mean(energies - work)"),
      ("returns the lowest value, too", DONE, "return gain, lowest"),
      ("does not check its input", CHECK, "energies, work"),
      ("does not check its input", CHECK, "np.asarray(energies), np.asarray(work)"),
      ("checks the energies only", CHECK, "checked_histories(energies, energies)[0], np.asarray(work, dtype=float)"),
      ("exchanges energies and work in the check", f"energies, work = {CHECK}",
       "work, energies = checked_histories(work, energies)"),
      ("does not use the arrays of the check", f"energies, work = {CHECK}", CHECK),
      ("does not check its input", CHECK,
       "(np.array(one, dtype=float) for one in zip(*zip(energies, work)))"),
      ("adds the work in place of subtracting it", REST, "energies[k] + work[k]"),
      ("omits the work", REST, "energies[k]"),
      ("omits the energies", REST, "work[k]"),
      ("subtracts the size of the work", REST, "energies[k] - abs(work[k])"),
      ("adds up the work, which is added up already", OVER, f"work = np.cumsum(work)\n    {OVER}"),
      ("omits the work at the earlier time", OVER,
       f"{PAIRS.format('energies[k] - work[k] - energies[j]')}\n    {OVER}"),
      ("omits the work at the later time", OVER, f"{PAIRS.format('energies[k] - energies[j] + work[j]')}\n    {OVER}"),
      ("subtracts the size of the work between the two times", OVER,
       f"{PAIRS.format('energies[k] - energies[j] - abs(work[k] - work[j])')}\n    {OVER}"),
      ("subtracts the work of the whole run from the largest gain of energy", OVER,
       f"return max(0.0, {PAIRS[7:].format('energies[k] - energies[j]')} - work[-1] + work[0])\n    {OVER}"),
      ("measures the gain since the beginning, not since the lowest point",
       "np.minimum(lowest, rest)", "energies[0] - work[0]"),
      ("measures the gain since the last time", "np.minimum(lowest, rest)",
       "energies[k - 1] - work[k - 1] if k else rest"),
      ("measures the gain since the last time but one", "np.minimum(lowest, rest)",
       "energies[k - 2] - work[k - 2] if k > 1 else rest"),
      ("measures the gain since the lowest point of the whole run", OVER,
       ALL.format("np.max(e[np.argmin(e):]) - np.min(e)") + f"\n    {OVER}"),
      ("measures the gain up to the highest point of the whole run", OVER,
       ALL.format("np.max(e) - np.min(e[:np.argmax(e) + 1])") + f"\n    {OVER}"),
      ("measures the gain from the first to the last time", OVER,
       ALL.format("max(0.0, e[-1] - e[0])") + f"\n    {OVER}"),
      ("begins with a lowest value of zero", "np.inf, 0.0", "0.0, 0.0"),
      ("compares a time with earlier times only, so that the result may be negative", OVER,
       ALL.format("max(e[k] - e[j] for k in range(e.size) for j in range(k))") + f"\n    {OVER}"),
      ("returns the largest step, which may be negative", OVER, ALL.format("np.max(np.diff(e))") + f"\n    {OVER}"),
      ("returns the size of the largest step, up or down", OVER,
       ALL.format("np.max(np.abs(np.diff(e)))") + f"\n    {OVER}"),
      ("returns the mean step", OVER, ALL.format("max(0.0, np.mean(np.diff(e)))") + f"\n    {OVER}"),
      ("adds up all steps that go up", OVER, ALL.format("np.sum(np.maximum(0.0, np.diff(e)))") + f"\n    {OVER}"),
      ("returns the largest value of E − W", DONE, "return np.max(energies - work)"),
      ("returns the lowest value of E − W", DONE, "return lowest"),
      ("returns the gain at the end, not the largest one", "np.maximum(gain, rest - lowest)", "rest - lowest"),
      ("returns the largest loss", OVER,
       ALL.format("max(e[j] - e[k] for k in range(e.size) for j in range(k + 1))") + f"\n    {OVER}"),
      ("returns zero, regardless of the histories", "np.maximum(gain, rest - lowest)",
       "np.maximum(gain, lowest - rest)"),
      ("returns the largest minus the smallest, regardless of their order", DONE,
       "return np.max(energies - work) - np.min(energies - work)"),
      ("omits the last time", "range(energies.size)", "range(energies.size - 1)"),
      ("omits the first time", "range(energies.size)", "range(1, energies.size)"),
      ("looks at every second time only", "range(energies.size)", "range(0, energies.size, 2)"),
      ("forgets the lowest point after each new gain", "gain = np.maximum(gain, rest - lowest)",
       "gain, lowest = (rest - lowest, rest) if rest - lowest > gain else (gain, lowest)"),
      ("takes small gains for none", DONE, "return gain if gain > 1e-6 else 0.0"),
      ("reverses the sign of the gain", DONE, "return -gain"),
      ("divides by the first energy", DONE, "return gain / abs(energies[0])"),
      ("divides by the number of times", DONE, "return gain / energies.size"),
      ("returns the number of a time, too", DONE, "return gain, k"),
      ("returns whether there is a gain", DONE, "return gain > 0.0"))


# 10.16 ----------------------------------------------------------------------------------------------------------
@right("10.16", "with lists, and with two looks at the clock for each run")
def compare(full, minimal, runs, clock):
    rows = []
    for _ in range(runs):
        times, ends = [], []
        for run in (full, minimal):
            began = clock()
            ends.append(run())
            times.append(clock() - began)
        rows.append((np.abs(ends[0] - ends[1]).max(), times[0] / times[1]))
    off, ratios = np.array(rows).T
    return off.max(), np.median(ratios)


@right("10.16", "with four readings of the clock in each round")
def compare(full, minimal, runs, clock):                                 # noqa: F811
    ratios, differences = [], []
    for _ in range(runs):
        t_0 = clock()
        slow = full()
        t_1, t_2 = clock(), clock()
        quick = minimal()
        t_3 = clock()
        ratios.append((t_1 - t_0) / (t_3 - t_2))
        differences.append(np.max(np.abs(slow - quick)))
    return np.max(differences), np.median(ratios)


RATIO, LARGEST = "(between - began) / (clock() - between)", "np.max(np.abs(slow - quick))"
MOST, MEDIAN = f"np.maximum(difference, {LARGEST})", "np.median(ratios)"
SEPARATE = "a, b = np.zeros(runs), np.zeros(runs)\n    for k in range(runs):\n        began = clock(); " \
    "slow = full(); " \
    "between = clock(); quick = minimal(); a[k], b[k] = between - began, clock() - between\n        " \
    f"difference = {MOST}\n    return difference, {{}}\n    for k in range(runs):"
edits("10.16",
      ("divides the minimal time by the full time", RATIO, "(clock() - between) / (between - began)"),
      ("subtracts the times in place of dividing them", RATIO, "(between - began) - (clock() - between)"),
      ("takes the ratio of whole seconds", RATIO, "(between - began) // (clock() - between)"),
      ("times both runs in place of the minimal one", RATIO, "(between - began) / (clock() - began)"),
      ("times both runs in place of the full one", RATIO, "(clock() - began) / (clock() - between)"),
      ("times all rounds since the first one", "began = clock()", "began = clock() if k == 0 else began"),
      ("uses a clock of its own", "for k in", "import time; clock = time.perf_counter\n    for k in"),
      ("uses the mean of the ratios in place of the median", MEDIAN, "np.mean(ratios)"),
      ("uses the geometric mean of the ratios in place of the median", MEDIAN, "np.exp(np.mean(np.log(ratios)))"),
      ("uses the largest ratio", MEDIAN, "np.max(ratios)"),
      ("takes the smallest of the ratios", MEDIAN, "np.min(ratios)"),
      ("uses the first ratio", MEDIAN, "ratios[0]"),
      ("uses the last ratio", MEDIAN, "ratios[-1]"),
      ("uses the ratio in the middle without sorting", MEDIAN, "ratios[runs // 2]"),
      ("uses the upper of the two ratios in the middle", MEDIAN, "np.sort(ratios)[runs // 2]"),
      ("uses the lower of the two ratios in the middle", MEDIAN, "np.sort(ratios)[(runs - 1) // 2]"),
      ("adds up the ratios", MEDIAN, "np.sum(ratios)"),
      ("returns the ratios, not their median", MEDIAN, "ratios"),
      ("returns the ratio in per cent", MEDIAN, "100.0 * np.median(ratios)"),
      ("returns the share of the time that is saved", MEDIAN, "1.0 - 1.0 / np.median(ratios)"),
      ("divides the medians of the times", "for k in range(runs):", SEPARATE.format("np.median(a) / np.median(b)")),
      ("divides the sums of the times", "for k in range(runs):", SEPARATE.format("np.sum(a) / np.sum(b)")),
      ("divides the shortest times", "for k in range(runs):", SEPARATE.format("np.min(a) / np.min(b)")),
      ("calls the functions in another order", "slow = full()", "minimal(); slow = full()"),
      ("calls the full loop twice", "slow = full()", "full(); slow = full()"),
      ("compares the results before it stops the clock", "quick = minimal()",
       f"quick = minimal(); difference = {MOST}"),
      ("calls the minimal loop twice", "quick = minimal()", "minimal(); quick = minimal()"),
      ("begins with a round that it does not time", "for k in", "full(); minimal()\n    for k in"),
      ("calls the full loop only", "quick = minimal()", "quick = full()"),
      ("calls the full loop in all rounds first", "for k in range(runs):",
       "slows, a = [], np.zeros(runs)\n    for k in range(runs):\n        began = clock(); slows.append(full()); "
       "a[k] = clock() - began\n    for k in range(runs):\n        began = clock(); quick = minimal(); "
       "ratios[k] = a[k] / (clock() - began); slow = slows[k]; "
       f"difference = {MOST}\n    return difference, np.median(ratios)\n    for k in range(runs):"),
      ("makes one round only", "range(runs)", "range(1)"),
      ("makes one round fewer", "range(runs)", "range(runs - 1)"),
      ("omits negative differences", LARGEST, "np.max(slow - quick)"),
      ("omits positive differences", LARGEST, "np.max(quick - slow)"),
      ("returns the mean difference, not the largest one", LARGEST, "np.mean(np.abs(slow - quick))"),
      ("returns the sum of the differences, not the largest one", LARGEST, "np.sum(np.abs(slow - quick))"),
      ("returns the length of the difference", LARGEST, "np.sqrt(np.sum((slow - quick) ** 2))"),
      ("returns the largest length of a row of the difference", LARGEST,
       "np.max(np.sqrt(np.sum((slow - quick) ** 2, axis=-1)))"),
      ("divides the difference by the largest number", LARGEST, f"{LARGEST} / np.max(np.abs(slow))"),
      ("compares the sizes of the numbers", LARGEST, "np.max(np.abs(np.abs(slow) - np.abs(quick)))"),
      ("compares the largest numbers", LARGEST, "abs(np.max(slow) - np.max(quick))"),
      ("compares the last number only", LARGEST, "np.abs(slow - quick).ravel()[-1]"),
      ("compares the last row only", LARGEST, "np.max(np.abs(slow - quick)[-1])"),
      ("compares the first row only", LARGEST, "np.max(np.abs(slow - quick)[0])"),
      ("adds up the differences of all runs", MOST, f"difference + {LARGEST}"),
      ("returns the mean of the differences of all runs", MOST, f"difference + {LARGEST} / runs"),
      ("returns the difference of the last run", MOST, LARGEST),
      ("returns the difference of the first run", MOST, f"difference if k else {LARGEST}"),
      ("returns the smallest difference of a run", MOST, f"np.minimum(difference if k else np.inf, {LARGEST})"),
      ("compares with the full loop of the first round", "between = clock()",
       "between = clock(); reference = slow if k == 0 else reference; slow = reference"),
      ("compares with the minimal loop of the last round", "difference = np.maximum",
       "last, quick = quick, last if k else quick; difference = np.maximum"),
      ("returns the ratio before the difference", "return difference, np.median(ratios)",
       "return np.median(ratios), difference"),
      ("returns the ratio only", "return difference, np.median(ratios)", "return np.median(ratios)"))


# 10.8 to 10.16: right for inputs of the usual size only ---------------------------------------------------------
edits("10.8",
      ("takes a slow rotation for none", "return",
       "if norm(ball.floor_omega) < 1e-6: return ball.floor_v.copy()\n    return"),
      ("cuts the way from the centre off at 100 m", WAY, f"np.clip({WAY}, -100.0, 100.0)"),
      ("takes places within a radius of the centre for the centre", "return",
       f"if norm({WAY}) < ball.radius: return ball.floor_v.copy()\n    return"))
edits("10.9",
      ("evaluates the load at t + dt/2", "rigid_body_step(load, t, x", "rigid_body_step(load, t + 0.5 * dt, x"),
      ("evaluates the load with the velocities before friction", "rigid_body_step(load,",
       "rigid_body_step(lambda t, x, q, a, b, ball: load(t, x, q, v, omega, ball),"),
      ("evaluates the load with q = 1", "t, x, q, pushed", "t, x, np.array([1.0, 0.0, 0.0, 0.0]), pushed"),
      ("evaluates the load with the spin before friction", "rigid_body_step(load,",
       "rigid_body_step(lambda t, x, q, a, b, ball: load(t, x, q, a, omega, ball),"),
      ("applies the load in two halves", LOADED,
       f"{LOADED.replace('pushed, turned, dt', '*' + LOADED.replace(' dt,', ' 0.5 * dt,') + '[2:], 0.5 * dt')}"))
edits("10.10",
      ("takes a slip below 1e-12 m/s for none", "size == 0.0", "size < 1e-12"),
      ("limits the time to 10 s", ENDS, "min(10.0, size / rate) if rate > 0.0 else np.inf"),
      ("takes a small rate for none", "if rate > 0.0", "if rate > 1e-6"),
      ("takes large friction for infinite", "along =", "if ball.mu > 10.0: return 0.0\n    along ="),
      ("limits finite friction to 100", "cone_radius(ball.mu,",
       "cone_radius(ball.mu if np.isinf(ball.mu) else min(ball.mu, 100.0),"))
edits("10.11",
      ("omits a second part that is short", f"return {TWO}",
       f"return {TWO} if dt - first > 1e-5 else (x, q, v, omega)"),
      ("evaluates the second load in the middle of the second part", "load, t + first, x",
       "load, t + 0.5 * (dt + first), x"))
edits("10.12",
      ("changes nothing where the corner moves up", ANGULAR,
       f"if v[1] + omega * r[0] > 0.0: return v.copy(), omega\n    {ANGULAR}"),
      ("changes nothing where the corner moves towards the centre", ANGULAR,
       f"if (v + omega * np.array([-r[1], r[0]])) @ r < 0.0: return v.copy(), omega\n    {ANGULAR}"),
      ("takes a slow spin for none", AFTER, f"omega = 0.0 if abs(omega) < 1e-6 else omega; {AFTER}"),
      ("lets no body be heavier than 100 kg beside r × v", "cross_2d(r, v) / inv_mass",
       "cross_2d(r, v) / max(inv_mass, 1e-2)"),
      ("lets no moment of inertia be above 1000 kg m² beside ω", "omega / inv_inertia",
       "omega / max(inv_inertia, 1e-3)"),
      ("cuts r off at 1 m", ANGULAR, f"r = r / max(1.0, np.sqrt(r @ r)); {ANGULAR}"))
edits("10.13 10.14",
      ("sorts the moments of inertia", "p.inv_inertia[i])", "np.sort(p.inv_inertia[i])[::-1])"),
      ("takes heavy bodies for immovable", COUNTS, "if p.inv_mass[i] > 1e-6:"),
      ("omits light bodies", COUNTS, "if 0.0 < p.inv_mass[i] < 1e6:"),
      ("omits the rotation of heavy bodies", ROTATES, "if p.inv_inertia[i, 0] > 1e-6:"))
edits("10.15",
      ("needs two times", OVER, f"rest = energies[1] - work[1]\n    {OVER}"),
      ("looks back over a hundred times only", OVER, "e = energies - work\n    return "
       f"max(e[k] - np.min(e[max(0, k - 100):k + 1]) for k in range(e.size))\n    {OVER}"),
      ("takes gains below 1e-10 of the energy for none", DONE,
       "return gain if gain > 1e-10 * abs(energies[0]) else 0.0"))
edits("10.16",
      ("takes differences below 1e-9 for none", "return difference,", "return difference * (difference > 1e-9),"),
      ("compares the first eight numbers only", LARGEST, "np.max(np.abs(slow - quick).ravel()[:8])"),
      ("takes times below a millisecond for one", RATIO, "(between - began) / max(clock() - between, 1e-3)"))


# 10.9 to 10.16: everyday mistakes -------------------------------------------------------------------------------
edits("10.9",
      ("rotates with the mean of the spins before and after the load", "(omega + omega_new)", "(turned + omega_new)"),
      ("returns the spin after friction, without the load", "q, v_new, omega_new", "q, v_new, turned"),
      ("adds the velocity of the floor to that of the ball", "x + 0.5 * dt * (v + v_new)",
       "x + dt * ball.floor_v + 0.5 * dt * (v + v_new)"),
      ("loses the spin about the normal", "return x", "omega_new[2] = 0.0; return x"),
      ("subtracts the old velocity from the new one", "(v + v_new)", "(v_new - v)"),
      ("rotates by half steps with the old and with the new spin", ROTATED,
       "quaternion_product(exponential(0.5 * dt * omega_new), quaternion_product(exponential(0.5 * dt * omega), q))"),
      ("turns the ball with the floor", "return x", "omega_new[2] = ball.floor_omega[2]; return x"),
      ("does not turn a ball that turns slowly", "(omega + omega_new)",
       "(omega + omega_new) * (norm(omega + omega_new) > 1e-3)"),
      ("does not move a ball that rolls slowly", "(v + v_new)", "(v + v_new) * (norm(v + v_new) > 1e-6)"))
edits("10.10",
      ("subtracts the speed of the rim from that of the centre", "size = norm(slip)",
       "size = abs(np.hypot(v[0], v[1]) - ball.radius * np.hypot(omega[0], omega[1]))"),
      ("limits the friction to 1", "cone_radius(ball.mu,", "cone_radius(min(ball.mu, 1.0),"),
      ("limits the time to 1 s", ENDS, "min(1.0, size / rate) if rate > 0.0 else np.inf"))
edits("10.11",
      ("uses infinite friction in the second part", "dt - first, ball)", "dt - first, ball._replace(mu=np.inf))"),
      ("omits gravity along the slope in the call of slip_time", "slip_time(v, omega, ball)",
       "slip_time(v, omega, ball._replace(gravity=ball.gravity * np.array([0.0, 0.0, 1.0])))"),
      ("moves with the new velocity in the second part", f"return {TWO}",
       f"_, b, c, d = {TWO}; return x + (dt - first) * c, b, c, d"))
edits("10.12",
      ("uses the inverse mass in place of the mass in the inertia about the corner", f"{SQUARE} / inv_mass",
       f"{SQUARE} * inv_mass"),
      ("uses the inverse inertia in the inertia about the corner", "(1.0 / inv_inertia", "(inv_inertia"),
      ("adds the new velocity to the old one", AFTER, f"return v + omega * {ACROSS}, omega"),
      ("returns ω with the wrong sign", AFTER, f"return omega * {ACROSS}, -omega"),
      ("does not let the body turn clockwise", AFTER, f"omega = max(omega, 0.0); {AFTER}"),
      ("solves for each coordinate of the impulse alone", ANGULAR,
       "lever = np.array([-r[1], r[0]]); J = -(v + omega * lever) / (inv_mass + inv_inertia * lever * lever); "
       "return v + inv_mass * J, omega + inv_inertia * (lever @ J)"))
edits("10.13",
      ("does not let the energy be negative", "return energy", "return max(energy, 0.0)"),
      ("measures heights from the mean of all places", POTENTIAL, "- dot(p.gravity, x[i] - np.mean(x, axis=0))"),
      ("uses the mass of the first row for all", MASS, "x[i])) / p.inv_mass[np.argmax(p.inv_mass > 0.0)]"),
      ("omits v_z", KINETIC, "0.5 * (v[i, 0] ** 2 + v[i, 1] ** 2)"),
      ("keeps the last rotation only", "energy += 0.5 * np.sum", "energy = 0.5 * np.sum"))
edits("10.14",
      ("measures places from the mean of all places", "cross(x[i], v[i])", "cross(x[i] - np.mean(x, axis=0), v[i])"),
      ("returns means over the rows", "return P, L", "return P / x.shape[0], L / x.shape[0]"))
edits("10.15",
      ("subtracts the work until the time before", REST, "energies[k] - work[max(k - 1, 0)]"),
      ("takes the differences of the work, which is a sum", OVER, f"work = np.diff(work, prepend=0.0)\n    {OVER}"),
      ("subtracts only work that is positive", REST, "energies[k] - max(work[k], 0.0)"),
      ("uses the sizes of the energies", REST, "abs(energies[k]) - work[k]"),
      ("returns the largest rise without a fall in between", OVER, "gain = now = 0.0; e = energies - work\n"
       "    for k in range(1, e.size): now = now + e[k] - e[k - 1] if e[k] > e[k - 1] else 0.0; gain = max(gain, now)\n"
       f"    return gain\n    {OVER}"))
edits("10.16",
      ("uses a mean without the smallest and the largest ratio", MEDIAN, "np.mean(np.sort(ratios)[1:-1])"),
      ("divides by the median of the minimal times", "for k in range(runs):",
       SEPARATE.format("np.median(a / np.median(b))")),
      ("rounds the ratio", MEDIAN, "np.round(np.median(ratios), 2)"))


# 10.8 to 10.17: right unless something is 0, equal, or alone ----------------------------------------------------
edits("10.8",
      ("returns floor_v at the origin", "return", "if not np.any(place): return ball.floor_v.copy()\n    return"),
      ("omits the rotation of fast floors", "ball.floor_omega, place",
       "ball.floor_omega * (norm(ball.floor_v) < 10.0), place"))
edits("10.9",
      ("omits the friction of a floor at rest", SLIP,
       f"{SLIP}\n    if not np.any({AHEAD}): pushed, turned = v, omega"),
      ("takes a friction of 0 for 1", f"{AHEAD}, dt, ball",
       f"{AHEAD}, dt, ball if ball.mu > 0.0 else ball._replace(mu=1.0)"),
      ("takes the velocity of the floor at the old position while the ball slips", SLIP,
       f"{SLIP}; free, _ = stop_slip(v, omega, {AHEAD}, dt, ball._replace(mu=np.inf)); pushed, turned = "
       "(pushed, turned) if norm(free - pushed) < 1e-12 else stop_slip(v, omega, support_velocity(x, ball), dt, ball)"),
      ("leaves a ball at rest where it is if the floor rests and is level, regardless of the load", SLIP,
       "if not (v.any() or omega.any() or ball.gravity[:2].any() or ball.floor_v.any() or ball.floor_omega.any()): "
       f"return x.copy(), q.copy(), v.copy(), omega.copy()\n    {SLIP}"),
      ("omits friction that changes v by less than 0.1 mm/s", SLIP,
       f"{SLIP}\n    if norm(pushed - v) < 1e-4: pushed, turned = v, omega"))
edits("10.10",
      ("returns infinity where gravity does not press the ball on the floor", "if rate > 0.0",
       "if rate > 0.0 and ball.gravity[2] < 0.0"),
      ("lets the floor pull: uses |g_z| where gravity lifts the ball", RUBS,
       "cone_radius(ball.mu, abs(ball.gravity[2]))"),
      ("returns zero where μ = ∞, even if the floor carries nothing", "size == 0.0",
       "size == 0.0 or np.isinf(ball.mu)"),
      ("multiplies μ by a load of 0, also where μ = ∞", RUBS, "ball.mu * max(0.0, -ball.gravity[2])"),
      ("returns zero where v = 0", "size == 0.0", "size == 0.0 or not v.any()"),
      ("loses the signs of the slip where v = 0", "dot(slip,", "dot(slip if v.any() else np.abs(slip),"),
      ("returns zero where v_z is below 0", "size == 0.0", "size == 0.0 or v[2] < 0.0"))
GOES_ON = f"if {{}}: return x + dt * v, quaternion_product(exponential(dt * omega), q), v, omega\n    first = {UNTIL}"
edits("10.11",
      ("lets a ball that rolls keep its velocity, also on a slope", f"first = {UNTIL}",
       GOES_ON.format("slip_time(v, omega, ball) == 0.0")),
      ("leaves a ball at rest where it is, also on a slope", f"first = {UNTIL}",
       GOES_ON.format("not (v.any() or omega.any())")),
      ("leaves a ball at rest where it is if the floor is level, regardless of the load", f"first = {UNTIL}",
       GOES_ON.format("not (v.any() or omega.any() or ball.gravity[:2].any())")),
      ("evaluates the load at t + dt where the ball does not slip", "load, t + first, x",
       "load, t + (first if first > 0.0 else dt), x"),
      ("leaves a ball where it is that only spins about the vertical, also on a slope", f"first = {UNTIL}",
       GOES_ON.format("not (v.any() or omega[:2].any())")),
      ("leaves a ball where it is that spins with v = 0", f"first = {UNTIL}", GOES_ON.format("not v.any()")),
      ("lets a ball slide on that does not spin", f"first = {UNTIL}", GOES_ON.format("not omega.any()")),
      ("omits gravity along the floor where there is no friction", f"first = {UNTIL}",
       GOES_ON.format("ball.mu == 0.0")),
      ("omits gravity along the floor where it does not press the ball on the floor", f"first = {UNTIL}",
       GOES_ON.format("ball.gravity[2] >= 0.0")),
      ("takes a slip below 1 mm/s for none", UNTIL,
       f"{UNTIL} if norm({LOWEST} * np.array([1.0, 1.0, 0.0])) > 1e-3 else 0.0"),
      ("keeps v where friction is infinite, and changes only ω", f"first = {UNTIL}",
       "omega = omega if ball.mu < np.inf else np.array([-v[1], v[0], ball.radius * omega[2]]) / ball.radius; "
       f"first = {UNTIL}"))
edits("10.12",
      ("does not turn a body that does not turn yet", "cross_2d(r, v) / inv_mass",
       "cross_2d(r, v) / inv_mass * (omega != 0.0)"),
      ("changes nothing where v = 0", ANGULAR, f"if not v.any(): return v.copy(), omega\n    {ANGULAR}"),
      ("stops the centre and keeps ω where v is along r", ANGULAR,
       f"if abs(cross_2d(r, v)) < 1e-12: return np.zeros(2), omega\n    {ANGULAR}"),
      ("stops v_y only where the corner is below the centre", ANGULAR,
       f"if r[0] == 0.0: return np.array([v[0], 0.0]), omega\n    {ANGULAR}"),
      ("changes nothing where the centre itself hits the edge", ANGULAR,
       f"if not r.any(): return v.copy(), omega\n    {ANGULAR}"))
edits("10.13 10.14",
      ("omits bodies that do not move along", COUNTS, "if p.inv_mass[i] > 0.0 and v[i].any():"),
      ("omits bodies at the origin", COUNTS, "if p.inv_mass[i] > 0.0 and x[i].any():"),
      ("ignores the orientation where the first two moments are equal", "(q[i], omega",
       "(q[i] if p.inv_inertia[i, 0] != p.inv_inertia[i, 1] else np.array([1.0, 0.0, 0.0, 0.0]), omega"))
edits("10.13",
      ("omits the height of bodies that do not turn", POTENTIAL, f"{POTENTIAL} * omega[i].any()"),
      ("omits the height of one body alone", POTENTIAL, f"{POTENTIAL} * (len(x) > 1)"),
      ("omits the factor ½ of the translation where a body does not turn", KINETIC,
       "(0.5 if omega[i].any() else 1.0) * dot(v[i], v[i])"),
      ("omits the rotation where there is no gravity", ROTATES, "if p.inv_inertia[i, 0] > 0.0 and p.gravity.any():"),
      ("uses the first moment of inertia for all axes where q = (1, 0, 0, 0)", "p.inv_inertia[i])",
       "(p.inv_inertia[i] if q[i, 0] != 1.0 else p.inv_inertia[i, 0] * np.ones(3)))"))
edits("10.14",
      ("omits the orbital part of bodies that do not turn", ORBIT, f"{ORBIT} * omega[i].any()"),
      ("returns no momentum of one body alone", "return P, L", "return P * (len(x) > 1), L"))
edits("10.15", ("returns zero for two times", DONE, "return gain if energies.size != 2 else 0.0"))
edits("10.16",
      ("returns a ratio of 1 for one round", MEDIAN, f"{MEDIAN} if runs > 1 else 1.0"),
      ("compares the first hundred numbers only", LARGEST, "np.max(np.abs(slow - quick).ravel()[:100])"),
      ("loses a NaN", MOST, f"max(difference, {LARGEST})"),
      ("loses a NaN of the minimal loop", MOST,
       "np.maximum(difference, np.max(np.abs(slow - np.where(np.isnan(quick), slow, quick))))"),
      ("loses a NaN in which both loops end", LARGEST,
       "np.max(np.where(np.isnan(slow) & np.isnan(quick), 0.0, np.abs(slow - quick)))"))


# 10.1 to 10.16: right for numbers of the order of one ---------------------------------------------------------------
LOADS = "F, tau = load(t, x, q, v, omega, p)"
edits("10.1 10.2",
      ("takes a velocity below 1 mm/s for 0", LOADS, f"{LOADS}; v = np.where(np.abs(v) < 1e-3, 0.0, v)"),
      ("takes a velocity above 1000 m/s for 1000 m/s", LOADS, f"{LOADS}; v = np.clip(v, -1e3, 1e3)"),
      ("omits forces below 0.01 N", LOADS, f"{LOADS}; F = np.where(np.abs(F) < 1e-2, 0.0, F)"))
edits("10.3 10.4",
      ("takes a place beyond 10 km for 10 km", "return x + dt * v", "return np.clip(x + dt * v, -1e4, 1e4)"),
      ("keeps the place of a body that moves by less than 1 µm", "return x + dt * v",
       "return x + np.where(np.abs(dt * v) < 1e-6, 0.0, dt * v)"))
edits("10.5",
      ("takes a place beyond 100 m for 100 m", "narrow(x, turn", "narrow(np.clip(x, -100.0, 100.0), turn"),
      ("takes a margin below 1 mm for 1 mm", "pairs, p.margin", "pairs, max(p.margin, 1e-3)"))
edits("10.6 10.7", ("keeps the place of a body that moves by less than 1 µm", "return PileState(x + dt * v",
                    "return PileState(x + np.where(np.abs(dt * v) < 1e-6, 0.0, dt * v)"))
edits("10.8",
      ("takes a floor that turns faster than 100 rad/s for one with 100 rad/s", "ball.floor_omega",
       "np.clip(ball.floor_omega, -100.0, 100.0)"))
edits("10.9",
      ("takes a velocity above 100 m/s for 100 m/s", SLIP, f"v = np.clip(v, -100.0, 100.0); {SLIP}"),
      ("takes a ball below 1 cm for a point, which slides", SLIP,
       f"{SLIP}; pushed, turned = (pushed, turned) if ball.radius > 1e-2 else (v, omega)"))
edits("10.10",
      ("takes a slip above 100 m/s for 100 m/s", "slip[2] = 0.0", "slip[2] = 0.0; slip = np.clip(slip, -100.0, 100.0)"),
      ("returns zero for a ball below 1 cm", "size == 0.0", "size == 0.0 or ball.radius < 1e-2"))
edits("10.11",
      ("takes a velocity above 100 m/s for 100 m/s", f"first = {UNTIL}",
       f"v = np.clip(v, -100.0, 100.0); first = {UNTIL}"))
edits("10.12",
      ("takes a velocity above 100 m/s for 100 m/s", ANGULAR, f"v = np.clip(v, -100.0, 100.0); {ANGULAR}"),
      ("takes a corner within 1 cm for the centre", ANGULAR, f"r = r * (np.hypot(r[0], r[1]) > 1e-2); {ANGULAR}"))
edits("10.13", ("omits the translation of bodies below 1 cm/s", KINETIC, f"{KINETIC} * (norm(v[i]) > 1e-2)"))
edits("10.14", ("omits the orbital part within 1 cm of the origin", ORBIT, f"{ORBIT} * (norm(x[i]) > 1e-2)"))
edits("10.15", ("takes an energy above 1 MJ for 1 MJ", REST, "min(energies[k], 1e6) - work[k]"))
edits("10.16",
      ("returns a ratio of at most 10", MEDIAN, f"min({MEDIAN}, 10.0)"),
      ("returns a difference of at most 1000", "return difference", "return np.minimum(difference, 1e3)"))


# 10.17 --------------------------------------------------------------------------------------------------------------
@right("10.17", "step by step")
def stopping_depth(speed, gap, margin, dt):
    start, steps = gap, 0
    while gap > margin:
        steps += 1
        gap = start - steps * speed * dt
    return max(0.0, -gap)


edit("10.17", "lets the body stop at the surface, however fast it is", "steps * speed * dt - gap", "0.0 * gap")
edit("10.17", "takes a step less", "np.ceil", "np.floor")
edit("10.17", "takes a step more", "steps * speed", "(steps + 1.0) * speed")
edit("10.17", "takes a step more where a gap is exactly the margin", "np.ceil((gap - margin) / (speed * dt))",
     "(np.floor((gap - margin) / (speed * dt)) + 1.0)")
edit("10.17", "takes the margin off the depth", "steps * speed * dt - gap", "steps * speed * dt - gap - margin")
edit("10.17", "looks for the contact without a margin", "(gap - margin) / (speed * dt)", "gap / (speed * dt)")
edit("10.17", "adds the margin to the gap", "(gap - margin)", "(gap + margin)")
edit("10.17", "returns a negative depth for a body that stops above the floor",
     "np.maximum(0.0, steps * speed * dt - gap)", "steps * speed * dt - gap")
edit("10.17", "lets a part of a step count",
     "np.ceil((gap - margin) / (speed * dt))", "(gap - margin) / (speed * dt)")
edit("10.17", "takes one step, wherever the body begins",
     "np.maximum(0.0, np.ceil((gap - margin) / (speed * dt)))", "1.0 + 0.0 * margin")
edit("10.17", "takes the worst case, one whole step less the margin, regardless of the gap", "steps * speed * dt - gap",
     "speed * dt - margin")
edit("10.17", "takes one whole step for the depth, regardless of the gap", "steps * speed * dt - gap", "speed * dt")
COUNT = "np.ceil((gap - margin) / (speed * dt))"
edits("10.17",
      ("takes at most 1000 steps", COUNT, f"np.minimum(1000.0, {COUNT})"),
      ("counts the steps to six digits", COUNT, "np.ceil(np.round((gap - margin) / (speed * dt), 6))"),
      ("computes the number of steps in single precision", COUNT, "np.ceil(np.float32((gap - margin) / (speed * dt)))"),
      ("takes a margin of 0 for 1 mm", "gap - margin", "gap - (margin or 1e-3)"),
      ("takes a margin below 1 mm for 0", "gap - margin", "gap - (margin if margin >= 1e-3 else 0.0)"),
      ("rounds the gap to 1 mm", "gap - margin", "np.round(gap, 3) - margin"),
      ("returns zero where the gap is below 1 mm", "return np", "return 0.0 if gap < 1e-3 else np"),
      ("returns at most 1 m", "return", "return 1.0 if steps * speed * dt - gap > 1.0 else"),
      ("takes a speed above 100 m/s for 100 m/s", "steps = np", "speed = np.minimum(speed, 100.0); steps = np"),
      ("takes a speed below 1 cm/s for rest", "return np", "return 0.0 if speed < 0.01 else np"),
      ("takes a step above 0.1 s for 0.1 s", "steps = np", "dt = np.minimum(dt, 0.1); steps = np"),
      ("lets a fast body that begins within the margin take a step", "return np",
       "steps = 1.0 if gap <= margin and speed * dt > 10.0 * gap else steps; return np"))


# 10.18 --------------------------------------------------------------------------------------------------------------
@right("10.18", "as a small letter")
def may_be_extrapolated():
    return "b"


edit("10.18", "chooses an error that falls with the root of the step: half a step leaves 71 % of it",
     '"B"', '"A"')
edit("10.18", "chooses a result of second order: for this one 4/3 t(dt/2) − 1/3 t(dt) is right",
     '"B"', '"C"')
edit("10.18", "chooses equal changes per halving: such a result has no limit",
     '"B"', '"D"')


# 10.19 --------------------------------------------------------------------------------------------------------------
FLOOR = np.array([[0.0, 1.0, 0.0]])


@right("10.19", "a heap that falls, one box above the other")
def my_scene(n):
    x = np.stack((0.07 * (np.arange(n) % 2), 0.1 + 0.25 * np.arange(n)), axis=1)
    return x, np.zeros(n), np.zeros((n, 2)), np.full((n, 2), 0.1), FLOOR


@right("10.19", "a ring of boxes that fly to its centre, without a floor")
def ring(n):
    angle = 2.0 * np.pi * np.arange(n) / n
    out = np.stack((np.cos(angle), np.sin(angle)), axis=1)
    return list(out), angle, -1.0 * out, np.full((n, 2), 0.15), np.zeros((0, 3))


edit("10.19", "does not move: the first domino stands, too", "return x, q, v,",
     "v[0, 0], q[0], x[0, 0], x[0, 1] = 0.0, 0.0, 0.0, high\n    return x, q, v,")
edit("10.19", "pushes the first domino away from the others", "q[0], v[0, 0] = -lean, 1.0",
     "q[0], v[0, 0] = -lean, -1.0")
edit("10.19", "places the dominoes too far apart", "0.3 * k", "0.6 * k")
edit("10.19", "places the dominoes inside each other", "0.3 * k", "0.08 * k")
edit("10.19", "begins below the floor", "[0.0, 1.0, 0.0]", "[0.0, 1.0, -0.1]")
edit("10.19", "throws the dominoes so fast that they stop inside each other", "-lean, 1.0", "-lean, 8.0")
edit("10.19", "always has four boxes", "wide, high, lean = 0.05, 0.2, 0.4", "n, wide, high, lean = 4, 0.05, 0.2, 0.4")
edit("10.19", "has boxes as thin as paper", "wide, high, lean = 0.05,", "wide, high, lean = 0.001,")
edit("10.19", "makes one of eight boxes so large that it reaches into the floor", "x, q, v, half, np",
     "x, q, v, half + 0.41 * (n == 8) * (x >= np.max(x)), np")
edit("10.19", "places all boxes but the first two too far apart if there are five", "0.3 * k",
     "0.3 * k + (n == 5 and k > 1)")


# fixed numbers in place of zero, and zero by one number only ----------------------------------------------------
edits("10.1 10.2",
      ("takes forces below 1e-12 N for 0", "p.inv_mass[:, None] * F", "p.inv_mass[:, None] * F * (np.abs(F) > 1e-12)"),
      ("does not move bodies above 1e12 kg", "p.inv_mass[:, None]", "(p.inv_mass * (p.inv_mass > 1e-12))[:, None]"),
      ("uses masses of at least 1e-9 kg", "p.inv_mass[:, None]", "np.minimum(p.inv_mass, 1e9)[:, None]"))
edits("10.1",
      ("takes torques below 1e-12 N m for 0", "p.inv_inertia * tau", "p.inv_inertia * tau * (np.abs(tau) > 1e-12)"),
      ("does not turn bodies above 1e12 kg m²", "p.inv_inertia * tau", "p.inv_inertia * (p.inv_inertia > 1e-12) * tau"))
edits("10.2",
      ("does not turn bodies above 1e12 kg m²", "p.inv_inertia[i, 0] > 0.0", "p.inv_inertia[i, 0] > 1e-12"),
      ("does not turn a body at rest where τ_x is 0", "if p.inv", "if (tau[i, 0] != 0.0 or omega[i].any()) and p.inv"),
      ("does not turn a body at rest where the numbers of τ add up to 0", "if p.inv",
       "if (tau[i].sum() != 0.0 or omega[i].any()) and p.inv"))
edits("10.3 10.4",
      ("takes ways below 1e-12 m for 0", "x + dt * v", "x + dt * v * (np.abs(dt * v) > 1e-12)"))
edits("10.3", ("takes angles below 1e-12 for 0", "q + dt * omega", "q + dt * omega * (np.abs(dt * omega) > 1e-12)"))
edits("10.4", ("does not turn bodies below 1e-12 rad/s", "q[i] = quat", "if norm(omega[i]) > 1e-12: q[i] = quat"))
edits("10.6 10.7",
      ("puts bodies to rest that turn more slowly than 1e-6 rad/s", "return PileState(x",
       "omega = np.where(np.abs(omega) < 1e-6, 0.0, omega); return PileState(x"),
      ("takes a step of at most 0.1 s", "low, high, turn = bounds", "dt = min(dt, 0.1); low, high, turn = bounds"),
      ("takes gaps below 1e-9 m for 0", "closing_speeds(contacts.gap, dt)",
       "closing_speeds(contacts.gap * (np.abs(contacts.gap) > 1e-9), dt)"),
      ("does not move bodies above 1e13 kg", "low, high, turn = bounds",
       "p = p._replace(inv_mass=p.inv_mass * (p.inv_mass > 1e-13)); low, high, turn = bounds"),
      ("lets no impulse turn a wheel on an axle", "low, high, turn = bounds",
       "p = p._replace(inv_inertia=(p.inv_inertia.T * (p.inv_mass > 0.0)).T); low, high, turn = bounds"),
      ("forgets impulses below 1e-9 N s", "old, J, p.margin", "old, J * (np.abs(J) > 1e-9), p.margin"),
      ("remembers impulses up to 1 cm at most", "old, J, p.margin", "old, J, min(p.margin, 0.01)"),
      ("remembers impulses up to 1 cm at least", "old, J, p.margin", "old, J, max(p.margin, 0.01)"))
edits("10.8",
      ("takes a spin below 1e-12 rad/s for 0", "ball.floor_omega",
       "ball.floor_omega * (np.abs(ball.floor_omega) > 1e-12)"),
      ("takes a velocity below 1e-16 m/s for 0", "ball.floor_v", "ball.floor_v * (np.abs(ball.floor_v) > 1e-16)"),
      ("takes a place within 1e-9 m of the centre for the centre", "place - ball.centre",
       "(place - ball.centre) * (np.abs(place - ball.centre) > 1e-9)"))
edits("10.9",
      ("takes a step of at most a second", SLIP, f"dt = min(dt, 1.0); {SLIP}"),
      ("does not turn a ball by less than 1e-15 rad", "exponential(0.5 * dt * (omega + omega_new))",
       "exponential(0.5 * dt * (omega + omega_new) * (norm(dt * omega) > 1e-15))"))
edits("10.10",
      ("takes a slip below 1e-15 m/s for none", "size == 0.0", "size < 1e-15"),
      ("takes a rate below 1e-12 m/s² for none", "rate > 0.0", "rate > 1e-12"),
      ("divides by at least 1e-12 m/s²", "size / rate", "size / max(rate, 1e-12)"),
      ("takes a rate far below that of gravity for none", "rate > 0.0", "rate > 1e-6 * abs(along)"),
      ("returns at most 1e9 s", "size / rate", "min(size / rate, 1e9)"))
edits("10.11",
      ("leaves out a second part below 1e-12 s", "return average",
       "if dt - first < 1e-12: return x, q, v, omega\n    return average"),
      ("leaves out a first part below 1e-12 s", "x, q, v, omega = average",
       "if first > 1e-12: x, q, v, omega = average"))
edits("10.12",
      ("takes a corner within 1e-6 m of the centre for the centre", "return omega * np",
       "omega = omega if r @ r > 1e-12 else L * inv_inertia; return omega * np"),
      ("takes an angular velocity below 1e-12 rad/s for 0", "return omega * np",
       "omega = omega if abs(omega) > 1e-12 else 0.0; return omega * np"),
      ("adds a small number to what it divides by", "(1.0 / inv_inertia +", "(1e-12 + 1.0 / inv_inertia +"))
edits("10.13 10.14",
      ("omits bodies above 1e12 kg", "p.inv_mass[i] > 0.0", "p.inv_mass[i] > 1e-12"),
      ("omits the rotation of bodies above 1e12 kg m²", "p.inv_inertia[i, 0] > 0.0", "p.inv_inertia[i, 0] > 1e-12"))
edits("10.15",
      ("takes gains below 1e-15 J for none", DONE, "return gain if gain > 1e-15 else 0.0"),
      ("takes gains below 1e-12 of the energy for none", DONE,
       "return gain if gain > 1e-12 * np.max(np.abs(energies)) else 0.0"))
edits("10.16",
      ("looks for the largest along two axes only", "np.max(np.abs(slow - quick))",
       "np.max(np.max(np.abs(slow - quick), axis=0), axis=-1)"),
      ("takes differences below 1e-14 for none", "np.max(np.abs(slow - quick))",
       "np.max(np.abs(slow - quick) * (np.abs(slow - quick) > 1e-14))"),
      ("divides by at least a microsecond", "/ (clock() - between)", "/ max(clock() - between, 1e-6)"))
edits("10.17",
      ("takes a step less where a billionth of a way is left", "np.ceil((gap - margin) / (speed * dt))",
       "np.ceil((gap - margin) / (speed * dt) - 1e-9)"))

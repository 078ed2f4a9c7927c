"""Lesson 6: wrong sides, nearest features, times and cases at the end."""

from ..mutants import collisions as answers
from . import collection

fault, wrong_answer, FAULTS = collection("collisions")

fault("plane_distance", "p @ plane.n + plane.d", "p @ plane.n - plane.d",
      "the plane is on the other side of the origin")
fault("plane_impact_time", "plane_distance(x_0, plane) - r", "plane_distance(x_0, plane)",
      "before the step the ball is a point")
fault("plane_impact_time", "before / (before + after)", "0.99 * before / (before + after)",
      "it hits 1 % too early in the step")
fault("cylinder_contact", "np.array([x[0], 0.0, 0.0])", "np.array([0.0, 0.0, 0.0])",
      "the cylinder is a ball at the origin")
fault("cylinder_impact_time", "s = C / (np.sqrt(D) - B)", "s = (np.sqrt(D) - B) / A",
      "the ball stops where it leaves the cylinder")
fault("cylinder_impact_time", "rho = R + r", "rho = R", "the ball is a point")
fault("closest_on_segment", "np.minimum(1.0, np.maximum(0.0, (p - a) @ along / length_squared))",
      "np.maximum(0.0, (p - a) @ along / length_squared)", "the segment has no second end")
fault("triangle_cylinder_gap", "edge_axis_distance(c, a)", "edge_axis_distance(a, b)",
      "one edge of the cloth is never looked at")
fault("triangle_cylinder_gap", "np.all(turns > 0.0) or np.all(turns < 0.0)", "np.all(turns > 0.0)",
      "a clockwise triangle around the axis does not touch it")
fault("closest_on_triangle", "closest_on_segment(p, c, a))", "closest_on_segment(p, a, b))",
      "the third edge is never nearest")
fault("closest_on_triangle", "dot(cross(a - c, q - c), N) >= 0.0", "True",
      "beyond the third edge a point counts as inside")
fault("ball_box", "i = np.argmin(depth)", "i = np.argmax(box.half)", "a ball inside leaves along the longest axis")
fault("ball_box", "1.0 if y[i] >= 0.0 else -1.0", "1.0", "it leaves through the positive side always")
fault("swept_box", "np.minimum(low, low + move)", "np.minimum(low, low - move)", "the box grows to the wrong side")
fault("all_pairs", "range(i + 1, len(low))", "range(i + 1, len(low) - 1)", "the last box is never tested")
fault("find_intersections", "waiting.append((i, down_b + 1))", "waiting.append((i, down_b))",
      "a branch of the tree is never visited")
fault("separating_edge", "gap = np.minimum(gap, n @ (b[j] - a[i]))", "gap = n @ (b[j] - a[i])",
      "only the last corner counts")
wrong_answer(answers.FIRST_CORNER_ONLY)
wrong_answer(answers.SUM_OF_DISTANCES)
fault("clip", "if s_i <= 0.0:", "if s_i < 0.0:", "corners exactly on the line are cut off")
fault("box_separation", "- half_width(b, axis)", "- half_width(a, axis)", "the second box has the size of the first")
fault("box_separation", "range(15)", "range(6)", "pairs of edges are never tried")
fault("gjk", "support(b, v)", "support(b, -v)", "the support of the second body is on its far side")
wrong_answer(answers.FIELD_WITH_A_JUMP)
fault("repulsion", "g = distance - radius", "g = distance", "the obstacle is a point")
fault("steer", "2.0 * (radius - offset)", "(radius - offset)", "it moves aside by half of what it needs")
fault("steer", "tau <= 0.0 or", "", "it steers around what it has passed")
fault("ball_contact", "np.sqrt(r @ r) - r_a - r_b", "np.sqrt(r @ r) - r_a", "the gap leaves out the second radius")

# drawn up without a look at those above
wrong_answer(answers.MISSES_THE_END)
fault("plane_impact_time", "t + dt * before", "dt * before", "times count from the beginning of the step")
wrong_answer(answers.CYLINDER_MISSES_THE_END)
fault("edge_axis_distance", "y_a[0] == y_b[0] and", "y_a[0] == y_b[0] or", "an edge at one height is taken for a point")
wrong_answer(answers.FACE_IS_OUTSIDE)
wrong_answer(answers.SIGN_OF_ZERO)
fault("ball_box", "x + depth[i] * n", "x + (depth[i] + r) * n", "the point on the box is outside it")
fault("all_pairs", "range(i + 1, len(low))", "range(i + 1, len(low) - (i == 0))",
      "the first and the last box are never compared")
fault("steer", "np.array([-e[1], e[0]])", "np.array([e[1], -e[0]])", "it turns right for what is straight ahead")
fault("gjk", "weights @ q, 0.0)", "q[0], 0.0)", "the nearest point of the second body is a corner")
fault("ball_contact", "x_b + r_b * n", "x_b + r_a * n", "the point on the second ball is not on it")
fault("ball_plane", "x - distance * plane.n", "x - (distance - r) * plane.n", "the point on the plane is not on it",
      of="given.collisions")
fault("cylinder_hit", "(moment - t) / dt", "moment / dt", "right for steps that begin at 0", of="given.collisions")
fault("continuous_step", "(moment - t) * v", "moment * v", "right for steps that begin at 0", of="given.collisions")
fault("capsule_capsule", "p, r_a, q, r_b", "p, r_b, q, r_a", "the radii are exchanged", of="given.collisions")
fault("points_plane", "if distance <= 0.0:", "if distance < 0.0:", "a corner that just touches has no contact",
      of="given.collisions")
fault("box_box", "(k - 6) // 3, -n)", "(k - 6) // 3, n)", "the edge of the first box is that on its far side",
      of="given.collisions")
fault("make_plane", "y[-1] / length", "y[-1]", "the distance from the origin is not scaled", of="given.collisions")
fault("flock_energy", "0.5 * p.gather", "p.gather", "the pull to the middle counts twice", of="given.collisions")
fault("boxes_touch", "low_a[i, c] > high_b[j, c]", "low_a[i, c] >= high_b[j, c]", "boxes that just touch do not",
      of="support.trees")
fault("touching_items", "b.order[m]", "a.order[m]", "items of the second tree have the numbers of the first",
      of="support.trees")

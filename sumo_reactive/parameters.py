"""Every constant with its unit, symbol and source. Names carry the unit where it is not plain from the name."""

# --- nominal trajectory C -------------------------------------------------------------------------------------------
CURVE_STEP_M = 0.5
"""Arc length between samples of C."""

COMFORT_LATERAL_ACCELERATION = 3.0
"""m/s²; cornering speed of the plan is √(this / curvature)."""

MAX_LATERAL_ACCELERATION = 4.0
"""m/s²; a command that exceeds it is discarded (centrifugal limit, F&L 1991, §3.2)."""

LANE_CHANGE_DURATION_S = 3.0
"""Time of a lane change at road speed."""

MIN_LANE_CHANGE_LENGTH_M = 12.0
"""Room of a lane change at walking speed: a car of 3.6 m turning radius moves 3.2 m aside in 6.4 m; twice that is smooth."""

PLAN_HORIZON_M = 2000.0
"""C is planned this far ahead and prolonged before it runs out."""

# --- vehicle ---------------------------------------------------------------------------------------------------------
WHEELBASE_FRACTION = 0.6
"""Wheelbase / length; passenger cars range from 0.57 to 0.64."""

FRONT_OVERHANG_FRACTION = 0.18
"""From the front axle to the front bumper / length."""

MAX_STEERING_ANGLE = 0.65
"""rad, φmax: a car of 5 m then turns with a front-axle radius of 5 m."""

MAX_STEERING_RATE = 1.0
"""rad/s, φ̇max."""

COMFORT_DECELERATION = 2.5
"""m/s², planned braking."""
